//! Two doubles in a register of SSE2, which every x86-64 processor has; products by Dekker's splitting.

#![expect(unsafe_code, reason = "intrinsics")]

use super::kernel::Lanes;
use core::arch::x86_64::{
    __m128d, _mm_add_epi64, _mm_add_pd, _mm_and_pd, _mm_andnot_pd, _mm_castpd_si128, _mm_castsi128_pd, _mm_cmpeq_pd,
    _mm_cmple_pd, _mm_cmplt_pd, _mm_div_pd, _mm_loadu_pd, _mm_max_pd, _mm_min_pd, _mm_movemask_pd, _mm_mul_pd,
    _mm_or_pd, _mm_set1_pd, _mm_shuffle_epi32, _mm_sqrt_pd, _mm_srai_epi32, _mm_storeu_pd, _mm_sub_epi64, _mm_sub_pd,
    _mm_xor_pd, _mm_xor_si128,
};

/// Two doubles; a mask has all bits of a lane set, or none.
#[derive(Clone, Copy)]
pub(super) struct Sse2(__m128d);

impl Sse2 {
    /// Veltkamp's splitting.
    #[inline(always)]
    fn halves(self) -> (Self, Self) {
        let scaled = self.mul(Self::splat(134_217_729.0));
        let high = scaled.sub(scaled.sub(self));
        (high, self.sub(high))
    }
}

// SAFETY of every block below: SSE2 belongs to the architecture; loads and stores are of slices whose length is
// asserted.
impl Lanes for Sse2 {
    type Mask = __m128d;
    const N: usize = 2;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        assert!(from.len() >= 2);
        Self(unsafe { _mm_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        assert!(to.len() >= 2);
        unsafe { _mm_storeu_pd(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(unsafe { _mm_set1_pd(x) })
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(unsafe { _mm_add_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(unsafe { _mm_sub_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(unsafe { _mm_mul_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        Self(unsafe { _mm_div_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm_andnot_pd(_mm_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm_xor_pd(_mm_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self(unsafe { _mm_min_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self(unsafe { _mm_max_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn product_less(self, b: Self, c: Self) -> Self {
        // The halves of 26 bits multiply exactly; a factor above 2^996 overflows in the splitting and gives NaN. The
        // product is equal to c or next to it, so that their difference is exact too.
        let ((ah, al), (bh, bl)) = (self.halves(), b.halves());
        let p = self.mul(b);
        let error = ah.mul(bh).sub(p).add(ah.mul(bl)).add(al.mul(bh)).add(al.mul(bl));
        p.sub(c).add(error)
    }
    #[inline(always)]
    fn less(self, b: Self) -> __m128d {
        unsafe { _mm_cmplt_pd(self.0, b.0) }
    }
    #[inline(always)]
    fn less_equal(self, b: Self) -> __m128d {
        unsafe { _mm_cmple_pd(self.0, b.0) }
    }
    #[inline(always)]
    fn equal(self, b: Self) -> __m128d {
        unsafe { _mm_cmpeq_pd(self.0, b.0) }
    }
    #[inline(always)]
    fn select(mask: __m128d, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm_or_pd(_mm_and_pd(mask, yes.0), _mm_andnot_pd(mask, no.0)) })
    }
    #[inline(always)]
    fn both(a: __m128d, b: __m128d) -> __m128d {
        unsafe { _mm_and_pd(a, b) }
    }
    #[inline(always)]
    fn either(a: __m128d, b: __m128d) -> __m128d {
        unsafe { _mm_or_pd(a, b) }
    }
    #[inline(always)]
    fn all(mask: __m128d) -> bool {
        unsafe { _mm_movemask_pd(mask) == 0b11 }
    }
    #[inline(always)]
    fn above_if(self, mask: __m128d) -> Self {
        // Bits count upwards for positive and downwards for negative numbers; a set lane is -1 as a number.
        unsafe {
            let bits = _mm_castpd_si128(self.0);
            let negative = _mm_shuffle_epi32::<0b1111_0101>(_mm_srai_epi32::<31>(bits));
            let step = _mm_sub_epi64(_mm_xor_si128(_mm_castpd_si128(mask), negative), negative);
            Self(_mm_castsi128_pd(_mm_sub_epi64(bits, step)))
        }
    }
    #[inline(always)]
    fn below_if(self, mask: __m128d) -> Self {
        unsafe {
            let bits = _mm_castpd_si128(self.0);
            let negative = _mm_shuffle_epi32::<0b1111_0101>(_mm_srai_epi32::<31>(bits));
            let step = _mm_sub_epi64(_mm_xor_si128(_mm_castpd_si128(mask), negative), negative);
            Self(_mm_castsi128_pd(_mm_add_epi64(bits, step)))
        }
    }
}
