//! Several doubles at once, in the vector registers of each back end.
//!
//! Kernels are generic over [`Vector`] and compiled for every back end by [`backends!`]. Every lane does the operations
//! of a scalar, so the bits do not depend on the width; `mul_add` is fused on every back end.

#![expect(clippy::inline_always, reason = "the operations are compiled inside functions with wider instruction sets")]
#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "intrinsics; reached only where the processor has them")
)]

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A vector of doubles.
pub(crate) trait Vector:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Its lanes as an array.
    type Array: AsRef<[f64]> + AsMut<[f64]> + Copy;
    /// Number of lanes, at most 8.
    const N: usize;
    /// True if a fused product is one instruction.
    const FUSED: bool;

    fn splat(x: f64) -> Self;
    /// The first `N` numbers of the slice, which has at least `N`.
    fn load(from: &[f64]) -> Self;
    fn store(self, to: &mut [f64]);
    /// `self * b + c`, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    fn abs(self) -> Self;
    /// The smaller; `b` where one is NaN.
    fn least(self, b: Self) -> Self;
    /// The larger; `b` where one is NaN.
    fn most(self, b: Self) -> Self;
    /// `yes` where `self > 0`, elsewhere `no`.
    fn choose(self, yes: Self, no: Self) -> Self;
    fn array(self) -> Self::Array;

    /// Lane `i` is `f(i)`.
    #[inline(always)]
    fn from_fn(f: impl Fn(usize) -> f64) -> Self {
        let mut lanes = [0.0; 8];
        for (i, lane) in lanes[..Self::N].iter_mut().enumerate() {
            *lane = f(i);
        }
        Self::load(&lanes)
    }
}

/// `a + b` exactly (Knuth), barring overflow.
#[inline(always)]
pub(crate) fn two_sum<V: Vector>(a: V, b: V) -> (V, V) {
    let s = a + b;
    let b_part = s - a;
    (s, (a - (s - b_part)) + (b - b_part))
}

/// `a b` exactly, for products between 2^-960 and 2^960 of factors below 2^960, or zero; by a fused product, or by
/// splitting where there is none (Dekker).
#[inline(always)]
pub(crate) fn two_product<V: Vector>(a: V, b: V) -> (V, V) {
    let p = a * b;
    if V::FUSED {
        return (p, a.mul_add(b, -p));
    }
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

#[inline(always)]
fn halves<V: Vector>(x: V) -> (V, V) {
    let scaled = V::splat(134_217_729.0) * x;
    let high = scaled - (scaled - x);
    (high, x - high)
}

macro_rules! operators {
    ($name:ident $($trait:ident $method:ident |$a:ident, $b:ident| $body:expr;)*) => {$(
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                Self($body)
            }
        }
    )*};
}

/// One double: the rest of a row, and every entry where there are no vectors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct One(pub f64);

operators! { One
    Add add |a, b| a + b;
    Sub sub |a, b| a - b;
    Mul mul |a, b| a * b;
    Div div |a, b| a / b;
}

impl Neg for One {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Vector for One {
    type Array = [f64; 1];
    const N: usize = 1;
    const FUSED: bool = cfg!(any(target_arch = "aarch64", target_feature = "fma"));

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(x)
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        Self(from[0])
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self.0;
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(self.0.mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn least(self, b: Self) -> Self {
        Self(if self.0 < b.0 { self.0 } else { b.0 })
    }
    #[inline(always)]
    fn most(self, b: Self) -> Self {
        Self(if self.0 > b.0 { self.0 } else { b.0 })
    }
    #[inline(always)]
    fn choose(self, yes: Self, no: Self) -> Self {
        if self.0 > 0.0 { yes } else { no }
    }
    #[inline(always)]
    fn array(self) -> [f64; 1] {
        [self.0]
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use x86::{Four, Two, Wide};

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Vector;
    use std::arch::x86_64::{
        __m128d, __m256d, __m512d, _CMP_GT_OQ, _mm_add_pd, _mm_and_pd, _mm_andnot_pd, _mm_cmpgt_pd, _mm_div_pd,
        _mm_loadu_pd, _mm_max_pd, _mm_min_pd, _mm_mul_pd, _mm_or_pd, _mm_set1_pd, _mm_setzero_pd, _mm_storeu_pd,
        _mm_sub_pd, _mm_xor_pd, _mm256_add_pd, _mm256_andnot_pd, _mm256_blendv_pd, _mm256_cmp_pd, _mm256_div_pd,
        _mm256_fmadd_pd, _mm256_loadu_pd, _mm256_max_pd, _mm256_min_pd, _mm256_mul_pd, _mm256_set1_pd,
        _mm256_setzero_pd, _mm256_storeu_pd, _mm256_sub_pd, _mm256_xor_pd, _mm512_abs_pd, _mm512_add_pd,
        _mm512_castpd_si512, _mm512_castsi512_pd, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_fmadd_pd, _mm512_loadu_pd,
        _mm512_mask_blend_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd, _mm512_set1_epi64, _mm512_set1_pd,
        _mm512_setzero_pd, _mm512_storeu_pd, _mm512_sub_pd, _mm512_xor_si512,
    };
    use std::ops::{Add, Div, Mul, Neg, Sub};

    // SAFETY of every block below: these vectors are built only inside functions whose instruction set has them, on a
    // processor that was asked for it; loads and stores are of slices whose length is asserted.
    macro_rules! vector {
        (
            $(#[$meta:meta])* $name:ident($inner:ty) $lanes:literal, $fused:literal,
            $set:ident $loadu:ident $storeu:ident $min:ident $max:ident $add:ident $sub:ident $mul:ident $div:ident,
            neg |$n:ident| $neg:expr, abs |$x:ident| $abs:expr, fused |$a:ident, $b:ident, $c:ident| $fma:expr,
            choose |$m:ident, $yes:ident, $no:ident| $choose:expr
        ) => {
            $(#[$meta])*
            #[derive(Clone, Copy)]
            pub(crate) struct $name($inner);
            operators! { $name
                Add add |a, b| unsafe { $add(a, b) };
                Sub sub |a, b| unsafe { $sub(a, b) };
                Mul mul |a, b| unsafe { $mul(a, b) };
                Div div |a, b| unsafe { $div(a, b) };
            }
            impl Neg for $name {
                type Output = Self;
                #[inline(always)]
                fn neg(self) -> Self {
                    let $n = self.0;
                    Self(unsafe { $neg })
                }
            }
            impl Vector for $name {
                type Array = [f64; $lanes];
                const N: usize = $lanes;
                const FUSED: bool = $fused;

                #[inline(always)]
                fn splat(x: f64) -> Self {
                    Self(unsafe { $set(x) })
                }
                #[inline(always)]
                fn load(from: &[f64]) -> Self {
                    assert!(from.len() >= $lanes);
                    Self(unsafe { $loadu(from.as_ptr()) })
                }
                #[inline(always)]
                fn store(self, to: &mut [f64]) {
                    assert!(to.len() >= $lanes);
                    unsafe { $storeu(to.as_mut_ptr(), self.0) }
                }
                #[inline(always)]
                fn mul_add(self, other: Self, third: Self) -> Self {
                    let ($a, $b, $c) = (self, other, third);
                    $fma
                }
                #[inline(always)]
                fn abs(self) -> Self {
                    let $x = self.0;
                    Self(unsafe { $abs })
                }
                #[inline(always)]
                fn least(self, b: Self) -> Self {
                    Self(unsafe { $min(self.0, b.0) })
                }
                #[inline(always)]
                fn most(self, b: Self) -> Self {
                    Self(unsafe { $max(self.0, b.0) })
                }
                #[inline(always)]
                fn choose(self, first: Self, second: Self) -> Self {
                    let ($m, $yes, $no) = (self.0, first.0, second.0);
                    Self(unsafe { $choose })
                }
                #[inline(always)]
                fn array(self) -> [f64; $lanes] {
                    let mut lanes = [0.0; $lanes];
                    self.store(&mut lanes);
                    lanes
                }
            }
        };
    }

    vector! {
        /// SSE2, which every processor of the architecture has; fused products are the library's.
        Two(__m128d) 2, false,
        _mm_set1_pd _mm_loadu_pd _mm_storeu_pd _mm_min_pd _mm_max_pd _mm_add_pd _mm_sub_pd _mm_mul_pd _mm_div_pd,
        neg |x| _mm_xor_pd(x, _mm_set1_pd(-0.0)),
        abs |x| _mm_andnot_pd(_mm_set1_pd(-0.0), x),
        fused |a, b, c| {
            let (a, b, c) = (a.array(), b.array(), c.array());
            Self::from_fn(|i| a[i].mul_add(b[i], c[i]))
        },
        choose |m, yes, no| {
            let mask = _mm_cmpgt_pd(m, _mm_setzero_pd());
            _mm_or_pd(_mm_and_pd(mask, yes), _mm_andnot_pd(mask, no))
        }
    }
    vector! {
        /// AVX2 and FMA.
        Four(__m256d) 4, true,
        _mm256_set1_pd _mm256_loadu_pd _mm256_storeu_pd _mm256_min_pd _mm256_max_pd
        _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd,
        neg |x| _mm256_xor_pd(x, _mm256_set1_pd(-0.0)),
        abs |x| _mm256_andnot_pd(_mm256_set1_pd(-0.0), x),
        fused |a, b, c| Self(unsafe { _mm256_fmadd_pd(a.0, b.0, c.0) }),
        choose |m, yes, no| _mm256_blendv_pd(no, yes, _mm256_cmp_pd::<_CMP_GT_OQ>(m, _mm256_setzero_pd()))
    }
    vector! {
        /// AVX-512F.
        Wide(__m512d) 8, true,
        _mm512_set1_pd _mm512_loadu_pd _mm512_storeu_pd _mm512_min_pd _mm512_max_pd
        _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd,
        neg |x| _mm512_castsi512_pd(_mm512_xor_si512(_mm512_castpd_si512(x), _mm512_set1_epi64(i64::MIN))),
        abs |x| _mm512_abs_pd(x),
        fused |a, b, c| Self(unsafe { _mm512_fmadd_pd(a.0, b.0, c.0) }),
        choose |m, yes, no| _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(m, _mm512_setzero_pd()), no, yes)
    }
}

/// Defines a function with a back end as its first argument from a kernel that is generic over the vector.
macro_rules! backends {
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) $(-> $ret:ty)? = $kernel:ident) => {
        $(#[$meta])*
        #[cfg_attr(
            target_arch = "x86_64",
            expect(unsafe_code, reason = "the processor is asked for the features before they are used")
        )]
        #[allow(clippy::too_many_arguments, reason = "the arguments of the kernel")]
        $vis fn $name(backend: $crate::rounding::slices::Backend, $($arg: $type),*) $(-> $ret)? {
            #[cfg(target_arch = "x86_64")]
            {
                use $crate::rounding::slices::Backend;
                #[target_feature(enable = "avx512f,avx2,fma")]
                #[allow(clippy::too_many_arguments, reason = "the arguments of the kernel")]
                fn wide($($arg: $type),*) $(-> $ret)? { $kernel::<$crate::lanes::Wide>($($arg),*) }
                #[target_feature(enable = "avx2,fma")]
                #[allow(clippy::too_many_arguments, reason = "the arguments of the kernel")]
                fn middle($($arg: $type),*) $(-> $ret)? { $kernel::<$crate::lanes::Four>($($arg),*) }
                match backend {
                    // SAFETY: the processor has the features.
                    Backend::Avx512 if backend.is_available() => unsafe { wide($($arg),*) },
                    Backend::Avx2 if backend.is_available() => unsafe { middle($($arg),*) },
                    _ => $kernel::<$crate::lanes::Two>($($arg),*),
                }
            }
            #[cfg(not(target_arch = "x86_64"))]
            {
                let _ = backend;
                $kernel::<$crate::lanes::One>($($arg),*)
            }
        }
    };
}
pub(crate) use backends;
