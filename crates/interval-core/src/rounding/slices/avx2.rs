//! Four doubles in a register of AVX2, products with FMA.

#![expect(unsafe_code, reason = "intrinsics; reached only through the door, which has asked the processor")]

use super::elementary::{Fused, MANTISSA, ONE_EXPONENT, SHIFT_BITS, SHIFTED_BIAS, last_index};
use super::kernel::Lanes;
use core::arch::x86_64::{
    __m256d, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_epi64, _mm256_add_pd, _mm256_and_pd, _mm256_and_si256,
    _mm256_andnot_pd, _mm256_blendv_pd, _mm256_castpd_si256, _mm256_castsi256_pd, _mm256_cmp_pd, _mm256_cmpeq_epi64,
    _mm256_cmpgt_epi64, _mm256_div_pd, _mm256_fmadd_pd, _mm256_fmsub_pd, _mm256_i64gather_pd, _mm256_loadu_pd,
    _mm256_max_pd, _mm256_min_pd, _mm256_movemask_pd, _mm256_mul_pd, _mm256_or_pd, _mm256_or_si256, _mm256_set1_epi64x,
    _mm256_set1_pd, _mm256_setzero_si256, _mm256_slli_epi64, _mm256_sqrt_pd, _mm256_srli_epi64, _mm256_storeu_pd,
    _mm256_sub_epi64, _mm256_sub_pd, _mm256_xor_pd, _mm256_xor_si256,
};

/// Four doubles; a mask has all bits of a lane set, or none.
#[derive(Clone, Copy)]
pub(super) struct Avx2(__m256d);

// SAFETY of every block below: the door builds these vectors only inside functions with AVX2 and FMA, on a processor
// that has them; loads and stores are of slices whose length is asserted.
impl Lanes for Avx2 {
    type Mask = __m256d;
    const N: usize = 4;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        assert!(from.len() >= 4);
        Self(unsafe { _mm256_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        assert!(to.len() >= 4);
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(x) })
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(unsafe { _mm256_add_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(unsafe { _mm256_sub_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(unsafe { _mm256_mul_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        Self(unsafe { _mm256_div_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self(unsafe { _mm256_min_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self(unsafe { _mm256_max_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn product_less(self, b: Self, c: Self) -> Self {
        Self(unsafe { _mm256_fmsub_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn less(self, b: Self) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn less_equal(self, b: Self) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn equal(self, b: Self) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_EQ_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn select(mask: __m256d, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm256_blendv_pd(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn both(a: __m256d, b: __m256d) -> __m256d {
        unsafe { _mm256_and_pd(a, b) }
    }
    #[inline(always)]
    fn either(a: __m256d, b: __m256d) -> __m256d {
        unsafe { _mm256_or_pd(a, b) }
    }
    #[inline(always)]
    fn all(mask: __m256d) -> bool {
        unsafe { _mm256_movemask_pd(mask) == 0b1111 }
    }
    #[inline(always)]
    fn above_if(self, mask: __m256d) -> Self {
        // Bits count upwards for positive and downwards for negative numbers; a set lane is -1 as a number.
        unsafe {
            let bits = _mm256_castpd_si256(self.0);
            let negative = _mm256_cmpgt_epi64(_mm256_setzero_si256(), bits);
            let step = _mm256_sub_epi64(_mm256_xor_si256(_mm256_castpd_si256(mask), negative), negative);
            Self(_mm256_castsi256_pd(_mm256_sub_epi64(bits, step)))
        }
    }
    #[inline(always)]
    fn below_if(self, mask: __m256d) -> Self {
        unsafe {
            let bits = _mm256_castpd_si256(self.0);
            let negative = _mm256_cmpgt_epi64(_mm256_setzero_si256(), bits);
            let step = _mm256_sub_epi64(_mm256_xor_si256(_mm256_castpd_si256(mask), negative), negative);
            Self(_mm256_castsi256_pd(_mm256_add_epi64(bits, step)))
        }
    }
}

impl Fused for Avx2 {
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(unsafe { _mm256_fmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn gather<const SIZE: usize>(self, table: &[f64; SIZE]) -> Self {
        // The index is less than the length.
        unsafe {
            let last = _mm256_set1_epi64x(const { last_index(SIZE) });
            let index = _mm256_and_si256(_mm256_castpd_si256(self.0), last);
            Self(_mm256_i64gather_pd::<8>(table.as_ptr(), index))
        }
    }
    #[inline(always)]
    fn power_of_64ths(self) -> Self {
        // The low bits of `n >> 6` move into the exponent field; those above leave the number.
        unsafe {
            let k = _mm256_slli_epi64::<52>(_mm256_srli_epi64::<6>(_mm256_castpd_si256(self.0)));
            Self(_mm256_castsi256_pd(_mm256_add_epi64(k, _mm256_set1_epi64x(ONE_EXPONENT))))
        }
    }
    #[inline(always)]
    fn has_bits(self, bits: i64) -> __m256d {
        unsafe {
            let bits = _mm256_set1_epi64x(bits);
            let none = _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_castpd_si256(self.0), bits), _mm256_setzero_si256());
            Self::not(_mm256_castsi256_pd(none))
        }
    }
    #[inline(always)]
    fn mantissa_exponent(self) -> (Self, Self) {
        unsafe {
            let bits = _mm256_castpd_si256(self.0);
            let mantissa = _mm256_and_si256(bits, _mm256_set1_epi64x(MANTISSA));
            let mantissa = _mm256_or_si256(mantissa, _mm256_set1_epi64x(ONE_EXPONENT));
            let exponent = _mm256_add_epi64(_mm256_srli_epi64::<52>(bits), _mm256_set1_epi64x(SHIFT_BITS));
            let exponent = _mm256_sub_pd(_mm256_castsi256_pd(exponent), _mm256_set1_pd(SHIFTED_BIAS));
            (Self(_mm256_castsi256_pd(mantissa)), Self(exponent))
        }
    }
    #[inline(always)]
    fn not(mask: __m256d) -> __m256d {
        unsafe { _mm256_xor_pd(mask, _mm256_castsi256_pd(_mm256_set1_epi64x(-1))) }
    }
    #[inline(always)]
    fn flags(mask: __m256d) -> u32 {
        u32::from_ne_bytes(unsafe { _mm256_movemask_pd(mask) }.to_ne_bytes())
    }
}
