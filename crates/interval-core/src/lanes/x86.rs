//! Vectors of AVX2 and of SSE2, which every processor of x86-64 has.

#![expect(unsafe_code, reason = "intrinsics; reached only where the processor has them")]

use super::Vector;
use std::arch::x86_64::{
    __m128d, __m256d, _CMP_GT_OQ, _mm_add_pd, _mm_and_pd, _mm_andnot_pd, _mm_cmpgt_pd, _mm_div_pd, _mm_loadu_pd,
    _mm_max_pd, _mm_min_pd, _mm_mul_pd, _mm_or_pd, _mm_set1_pd, _mm_setzero_pd, _mm_storeu_pd, _mm_sub_pd, _mm_xor_pd,
    _mm256_add_pd, _mm256_andnot_pd, _mm256_blendv_pd, _mm256_cmp_pd, _mm256_div_pd, _mm256_fmadd_pd, _mm256_loadu_pd,
    _mm256_max_pd, _mm256_min_pd, _mm256_mul_pd, _mm256_set1_pd, _mm256_setzero_pd, _mm256_storeu_pd, _mm256_sub_pd,
    _mm256_xor_pd,
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
