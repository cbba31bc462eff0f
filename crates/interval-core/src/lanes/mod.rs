//! Several doubles at once, in the vector registers of each back end.
//!
//! Kernels are generic over [`Vector`] and compiled for every back end by [`backends!`]. Every lane does the operations
//! of a scalar, so the bits do not depend on the width; `mul_add` is fused on every back end.

#![expect(clippy::inline_always, reason = "the operations are compiled inside functions with wider instruction sets")]

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

// Below the macro that they use.
#[cfg(target_arch = "x86_64")]
#[macro_use]
mod x86;
#[cfg(avx512)]
#[clippy::msrv = "1.89"]
mod avx512;

#[cfg(avx512)]
pub(crate) use avx512::Wide;
#[cfg(target_arch = "x86_64")]
pub(crate) use x86::{Four, Two};

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
                #[cfg(avx512)]
                #[target_feature(enable = "avx512f,avx2,fma")]
                #[allow(clippy::too_many_arguments, reason = "the arguments of the kernel")]
                unsafe fn wide($($arg: $type),*) $(-> $ret)? { $kernel::<$crate::lanes::Wide>($($arg),*) }
                #[target_feature(enable = "avx2,fma")]
                #[allow(clippy::too_many_arguments, reason = "the arguments of the kernel")]
                unsafe fn middle($($arg: $type),*) $(-> $ret)? { $kernel::<$crate::lanes::Four>($($arg),*) }
                match backend {
                    // SAFETY: the processor has the features.
                    #[cfg(avx512)]
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
