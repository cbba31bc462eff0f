//! Eight doubles in a register of AVX-512, rounded to nearest: for kernels that are written once over vectors.

#![expect(unsafe_code, reason = "intrinsics; reached only through the door, which has asked the processor")]

use super::elementary::{Fused, MANTISSA, ONE_EXPONENT, SHIFT_BITS, SHIFTED_BIAS, last_index};
use super::kernel::Lanes;
use core::arch::x86_64::{
    __m512d, __mmask8, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm512_abs_pd, _mm512_add_epi64, _mm512_add_pd,
    _mm512_and_si512, _mm512_castpd_si512, _mm512_castsi512_pd, _mm512_cmp_pd_mask, _mm512_cmplt_epi64_mask,
    _mm512_div_pd, _mm512_fmadd_pd, _mm512_fmsub_pd, _mm512_i64gather_pd, _mm512_loadu_pd, _mm512_mask_add_epi64,
    _mm512_mask_blend_epi64, _mm512_mask_blend_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd, _mm512_or_si512,
    _mm512_set1_epi64, _mm512_set1_pd, _mm512_setzero_si512, _mm512_slli_epi64, _mm512_sqrt_pd, _mm512_srli_epi64,
    _mm512_storeu_pd, _mm512_sub_pd, _mm512_test_epi64_mask, _mm512_xor_si512,
};

/// Eight doubles; a mask is one bit a lane.
#[derive(Clone, Copy)]
pub(super) struct Wide(pub(super) __m512d);

// SAFETY of every block below: the door builds these vectors only inside functions with AVX-512F, on a processor that
// has it; loads and stores are of slices whose length is asserted, and gathered indices are less than the length.
impl Lanes for Wide {
    type Mask = __mmask8;
    const N: usize = 8;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        assert!(from.len() >= 8);
        Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        assert!(to.len() >= 8);
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(x) })
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(unsafe { _mm512_add_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(unsafe { _mm512_sub_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(unsafe { _mm512_mul_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        Self(unsafe { _mm512_div_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm512_castsi512_pd(_mm512_xor_si512(_mm512_castpd_si512(self.0), _mm512_set1_epi64(i64::MIN))) })
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Self(unsafe { _mm512_min_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Self(unsafe { _mm512_max_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn product_less(self, b: Self, c: Self) -> Self {
        Self(unsafe { _mm512_fmsub_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn less(self, b: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn less_equal(self, b: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn equal(self, b: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask8, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn both(a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }
    #[inline(always)]
    fn either(a: __mmask8, b: __mmask8) -> __mmask8 {
        a | b
    }
    #[inline(always)]
    fn all(mask: __mmask8) -> bool {
        mask == 0xff
    }
    #[inline(always)]
    fn above_if(self, mask: __mmask8) -> Self {
        step(self, mask, 1)
    }
    #[inline(always)]
    fn below_if(self, mask: __mmask8) -> Self {
        step(self, mask, -1)
    }
}

/// Bits count upwards for positive and downwards for negative numbers.
#[inline(always)]
fn step(x: Wide, mask: __mmask8, up: i64) -> Wide {
    unsafe {
        let bits = _mm512_castpd_si512(x.0);
        let negative = _mm512_cmplt_epi64_mask(bits, _mm512_setzero_si512());
        let by = _mm512_mask_blend_epi64(negative, _mm512_set1_epi64(up), _mm512_set1_epi64(-up));
        Wide(_mm512_castsi512_pd(_mm512_mask_add_epi64(bits, mask, bits, by)))
    }
}

impl Fused for Wide {
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(unsafe { _mm512_fmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn gather<const SIZE: usize>(self, table: &[f64; SIZE]) -> Self {
        unsafe {
            let last = _mm512_set1_epi64(const { last_index(SIZE) });
            let index = _mm512_and_si512(_mm512_castpd_si512(self.0), last);
            Self(_mm512_i64gather_pd::<8>(index, table.as_ptr()))
        }
    }
    #[inline(always)]
    fn power_of_64ths(self) -> Self {
        // The low bits of `n >> 6` move into the exponent field; those above leave the number.
        unsafe {
            let k = _mm512_slli_epi64::<52>(_mm512_srli_epi64::<6>(_mm512_castpd_si512(self.0)));
            Self(_mm512_castsi512_pd(_mm512_add_epi64(k, _mm512_set1_epi64(ONE_EXPONENT))))
        }
    }
    #[inline(always)]
    fn has_bits(self, bits: i64) -> __mmask8 {
        unsafe { _mm512_test_epi64_mask(_mm512_castpd_si512(self.0), _mm512_set1_epi64(bits)) }
    }
    #[inline(always)]
    fn mantissa_exponent(self) -> (Self, Self) {
        unsafe {
            let bits = _mm512_castpd_si512(self.0);
            let mantissa = _mm512_and_si512(bits, _mm512_set1_epi64(MANTISSA));
            let mantissa = _mm512_or_si512(mantissa, _mm512_set1_epi64(ONE_EXPONENT));
            let exponent = _mm512_add_epi64(_mm512_srli_epi64::<52>(bits), _mm512_set1_epi64(SHIFT_BITS));
            let exponent = _mm512_sub_pd(_mm512_castsi512_pd(exponent), _mm512_set1_pd(SHIFTED_BIAS));
            (Self(_mm512_castsi512_pd(mantissa)), Self(exponent))
        }
    }
    #[inline(always)]
    fn not(mask: __mmask8) -> __mmask8 {
        !mask
    }
    #[inline(always)]
    fn flags(mask: __mmask8) -> u32 {
        mask.into()
    }
}
