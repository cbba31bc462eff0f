//! Vectors of AVX-512.

#![expect(unsafe_code, reason = "intrinsics; reached only where the processor has them")]

use super::Vector;
use std::arch::x86_64::{
    __m512d, _CMP_GT_OQ, _mm512_abs_pd, _mm512_add_pd, _mm512_castpd_si512, _mm512_castsi512_pd, _mm512_cmp_pd_mask,
    _mm512_div_pd, _mm512_fmadd_pd, _mm512_loadu_pd, _mm512_mask_blend_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd,
    _mm512_set1_epi64, _mm512_set1_pd, _mm512_setzero_pd, _mm512_storeu_pd, _mm512_sub_pd, _mm512_xor_si512,
};
use std::ops::{Add, Div, Mul, Neg, Sub};

// SAFETY: as in `x86`.
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
