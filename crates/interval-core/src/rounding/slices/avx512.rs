//! Eight doubles in a register of AVX-512, whose instructions carry their rounding with them.

#![expect(unsafe_code, reason = "intrinsics; reached only through the door, which has asked the processor")]

use super::door::Block;
use std::arch::x86_64::{
    __m512d, __mmask8, _CMP_LE_OQ, _CMP_LT_OQ, _CMP_UNORD_Q, _MM_FROUND_NO_EXC, _MM_FROUND_TO_NEG_INF,
    _MM_FROUND_TO_POS_INF, _mm512_add_pd, _mm512_add_round_pd, _mm512_castpd_si512, _mm512_castsi512_pd,
    _mm512_cmp_pd_mask, _mm512_div_round_pd, _mm512_loadu_pd, _mm512_mask_blend_pd, _mm512_mask_cmp_pd_mask,
    _mm512_max_pd, _mm512_min_pd, _mm512_mul_round_pd, _mm512_set1_epi64, _mm512_set1_pd, _mm512_setzero_pd,
    _mm512_sqrt_round_pd, _mm512_storeu_pd, _mm512_sub_pd, _mm512_sub_round_pd, _mm512_xor_si512,
};

/// Rounding downward, stated by the instruction itself (AVX-512 embedded rounding).
const DOWN: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
/// Rounding upward, stated by the instruction itself.
const UP: i32 = _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC;

/// Eight doubles.
#[derive(Clone, Copy)]
pub(super) struct Avx512(__m512d);

type Outcome = (Avx512, Avx512, bool);

// SAFETY of every block below: the door calls these functions only inside functions with AVX-512F, on a processor that
// has it; loads and stores are of slices whose length is asserted.
impl Block for Avx512 {
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
    fn proper(lo: Self, hi: Self) -> bool {
        unsafe { not_negative(0xff, _mm512_sub_pd(hi.0, lo.0)) == 0xff }
    }
    #[inline(always)]
    fn both_proper(a: Self, b: Self, c: Self, d: Self) -> bool {
        unsafe { not_negative(not_negative(0xff, _mm512_sub_pd(b.0, a.0)), _mm512_sub_pd(d.0, c.0)) == 0xff }
    }
}

/// -0 becomes +0.
#[inline(always)]
fn plain_zero(x: __m512d) -> Avx512 {
    Avx512(unsafe { _mm512_add_pd(x, _mm512_setzero_pd()) })
}

#[inline(always)]
fn neg(x: __m512d) -> __m512d {
    unsafe { _mm512_castsi512_pd(_mm512_xor_si512(_mm512_castpd_si512(x), _mm512_set1_epi64(i64::MIN))) }
}

#[inline(always)]
fn less(x: __m512d, y: __m512d) -> __mmask8 {
    unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(x, y) }
}

#[inline(always)]
fn select(mask: __mmask8, yes: __m512d, no: __m512d) -> __m512d {
    unsafe { _mm512_mask_blend_pd(mask, no, yes) }
}

/// The lanes of `mask` that are at least zero.
#[inline(always)]
fn not_negative(mask: __mmask8, x: __m512d) -> __mmask8 {
    unsafe { _mm512_mask_cmp_pd_mask::<_CMP_LE_OQ>(mask, _mm512_setzero_pd(), x) }
}

/// True if no lane is NaN or infinite: the difference of the bounds tells.
#[inline(always)]
fn bounded(lo: __m512d, hi: __m512d) -> bool {
    unsafe { less(_mm512_sub_pd(hi, lo), _mm512_set1_pd(f64::INFINITY)) == 0xff }
}

/// Infinities add up to the right bounds; only an empty operand beside an unbounded one gives NaN.
#[inline(always)]
pub(super) fn add(a: Avx512, b: Avx512, c: Avx512, d: Avx512) -> Outcome {
    unsafe {
        let (lo, hi) = (_mm512_add_round_pd::<DOWN>(a.0, c.0), _mm512_add_round_pd::<UP>(b.0, d.0));
        (plain_zero(lo), plain_zero(hi), _mm512_cmp_pd_mask::<_CMP_UNORD_Q>(lo, hi) == 0)
    }
}

#[inline(always)]
pub(super) fn sub(a: Avx512, b: Avx512, c: Avx512, d: Avx512) -> Outcome {
    unsafe {
        let (lo, hi) = (_mm512_sub_round_pd::<DOWN>(a.0, d.0), _mm512_sub_round_pd::<UP>(b.0, c.0));
        (plain_zero(lo), plain_zero(hi), _mm512_cmp_pd_mask::<_CMP_UNORD_Q>(lo, hi) == 0)
    }
}

/// As the kernel's: two products a bound, chosen by the signs of `a` and `b`. A product of zero and infinity is NaN;
/// where the minimum or maximum passes over it the other product is the right result, else the result is not bounded.
#[inline(always)]
pub(super) fn mul(a: Avx512, b: Avx512, c: Avx512, d: Avx512) -> Outcome {
    unsafe {
        let zero = _mm512_setzero_pd();
        let (a_negative, b_negative) = (less(a.0, zero), less(b.0, zero));
        let (ya, za) = (select(a_negative, d.0, c.0), select(a_negative, c.0, d.0));
        let (yb, zb) = (select(b_negative, d.0, c.0), select(b_negative, c.0, d.0));
        let lo = _mm512_min_pd(_mm512_mul_round_pd::<DOWN>(a.0, ya), _mm512_mul_round_pd::<DOWN>(b.0, yb));
        let hi = _mm512_max_pd(_mm512_mul_round_pd::<UP>(a.0, za), _mm512_mul_round_pd::<UP>(b.0, zb));
        (plain_zero(lo), plain_zero(hi), bounded(lo, hi))
    }
}

#[inline(always)]
pub(super) fn div(a: Avx512, b: Avx512, c: Avx512, d: Avx512) -> Outcome {
    unsafe {
        let zero = _mm512_setzero_pd();
        let turn = less(d.0, zero);
        let (a, b) = (select(turn, neg(b.0), a.0), select(turn, neg(a.0), b.0));
        let (c, d) = (select(turn, neg(d.0), c.0), select(turn, neg(c.0), d.0));
        let lo = _mm512_div_round_pd::<DOWN>(a, select(less(a, zero), c, d));
        let hi = _mm512_div_round_pd::<UP>(b, select(less(b, zero), d, c));
        // A bounded quotient of non-empty intervals by one without zero; an empty divisor turns into c > d.
        let ordered = _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b) & _mm512_cmp_pd_mask::<_CMP_LE_OQ>(c, d);
        let sound = (ordered & less(zero, c)) == 0xff && bounded(lo, hi);
        (plain_zero(lo), plain_zero(hi), sound)
    }
}

#[inline(always)]
pub(super) fn square(a: Avx512, b: Avx512) -> Outcome {
    unsafe {
        let small = _mm512_max_pd(_mm512_max_pd(a.0, neg(b.0)), _mm512_setzero_pd());
        let large = _mm512_max_pd(neg(a.0), b.0);
        let (lo, hi) = (_mm512_mul_round_pd::<DOWN>(small, small), _mm512_mul_round_pd::<UP>(large, large));
        // An empty interval has an infinite smallest magnitude.
        (plain_zero(lo), plain_zero(hi), bounded(lo, hi))
    }
}

#[inline(always)]
pub(super) fn sqrt(a: Avx512, b: Avx512) -> Outcome {
    unsafe {
        let lo = _mm512_sqrt_round_pd::<DOWN>(_mm512_max_pd(a.0, _mm512_setzero_pd()));
        let hi = _mm512_sqrt_round_pd::<UP>(b.0);
        (plain_zero(lo), plain_zero(hi), bounded(lo, hi))
    }
}

/// A row times 16 packed columns. All bounds are finite: a lower sum can only fall to -inf, an upper one only rise to
/// inf, so nothing is NaN.
#[cfg(feature = "linalg")]
#[inline(always)]
pub(super) fn group_product(a: (&[f64], &[f64]), block: (&[f64], &[f64]), sums: &mut ([f64; 16], [f64; 16])) {
    unsafe {
        let zero = _mm512_setzero_pd();
        let (mut lo, mut hi) = ([zero; 2], [zero; 2]);
        let rows = block.0.chunks_exact(16).zip(block.1.chunks_exact(16));
        for ((&from, &to), (c_row, d_row)) in a.0.iter().zip(a.1).zip(rows) {
            let (from_negative, to_negative) = (if from < 0.0 { 0xff } else { 0 }, if to < 0.0 { 0xff } else { 0 });
            let (x, y) = (_mm512_set1_pd(from), _mm512_set1_pd(to));
            for half in 0..2 {
                let (c, d) = (Avx512::load(&c_row[8 * half..]).0, Avx512::load(&d_row[8 * half..]).0);
                let p = _mm512_mul_round_pd::<DOWN>(x, select(from_negative, d, c));
                let q = _mm512_mul_round_pd::<DOWN>(y, select(to_negative, d, c));
                let r = _mm512_mul_round_pd::<UP>(x, select(from_negative, c, d));
                let s = _mm512_mul_round_pd::<UP>(y, select(to_negative, c, d));
                lo[half] = _mm512_add_round_pd::<DOWN>(lo[half], _mm512_min_pd(p, q));
                hi[half] = _mm512_add_round_pd::<UP>(hi[half], _mm512_max_pd(r, s));
            }
        }
        for half in 0..2 {
            plain_zero(lo[half]).store(&mut sums.0[8 * half..]);
            plain_zero(hi[half]).store(&mut sums.1[8 * half..]);
        }
    }
}
