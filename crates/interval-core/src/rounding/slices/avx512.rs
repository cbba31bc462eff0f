//! Interval operations on eight doubles in a register of AVX-512, whose instructions carry their rounding with them.

#![expect(unsafe_code, reason = "intrinsics; reached only through the door, which has asked the processor")]

use super::avx512_lanes::Wide;
use super::kernel::Lanes as _;
use core::arch::x86_64::{
    _CMP_UNORD_Q, _MM_FROUND_NO_EXC, _MM_FROUND_TO_NEG_INF, _MM_FROUND_TO_POS_INF, _mm512_add_round_pd,
    _mm512_cmp_pd_mask, _mm512_div_round_pd, _mm512_mul_round_pd, _mm512_sqrt_round_pd, _mm512_sub_round_pd,
};

/// Rounding downward, stated by the instruction itself (AVX-512 embedded rounding).
const DOWN: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
/// Rounding upward, stated by the instruction itself.
const UP: i32 = _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC;

type Outcome = (Wide, Wide, bool);

// SAFETY of every block below: the door calls these functions only inside functions with AVX-512F, on a processor that
// has it.

#[inline(always)]
fn added<const MODE: i32>(a: Wide, b: Wide) -> Wide {
    Wide(unsafe { _mm512_add_round_pd::<MODE>(a.0, b.0) })
}

#[inline(always)]
fn less_by<const MODE: i32>(a: Wide, b: Wide) -> Wide {
    Wide(unsafe { _mm512_sub_round_pd::<MODE>(a.0, b.0) })
}

#[inline(always)]
fn times<const MODE: i32>(a: Wide, b: Wide) -> Wide {
    Wide(unsafe { _mm512_mul_round_pd::<MODE>(a.0, b.0) })
}

#[inline(always)]
fn over<const MODE: i32>(a: Wide, b: Wide) -> Wide {
    Wide(unsafe { _mm512_div_round_pd::<MODE>(a.0, b.0) })
}

#[inline(always)]
fn root<const MODE: i32>(a: Wide) -> Wide {
    Wide(unsafe { _mm512_sqrt_round_pd::<MODE>(a.0) })
}

#[inline(always)]
fn zero() -> Wide {
    Wide::splat(0.0)
}

/// -0 becomes +0.
#[inline(always)]
fn plain_zero(x: Wide) -> Wide {
    x.add(zero())
}

/// True if no lane is NaN or infinite: the difference of the bounds tells.
#[inline(always)]
fn bounded(lo: Wide, hi: Wide) -> bool {
    hi.sub(lo).less(Wide::splat(f64::INFINITY)) == 0xff
}

/// True if no lane is NaN.
#[inline(always)]
fn numbers(lo: Wide, hi: Wide) -> bool {
    unsafe { _mm512_cmp_pd_mask::<_CMP_UNORD_Q>(lo.0, hi.0) == 0 }
}

/// Infinities add up to the right bounds; only an empty operand beside an unbounded one gives NaN.
#[inline(always)]
pub(super) fn add(a: Wide, b: Wide, c: Wide, d: Wide) -> Outcome {
    let (lo, hi) = (added::<DOWN>(a, c), added::<UP>(b, d));
    (plain_zero(lo), plain_zero(hi), numbers(lo, hi))
}

#[inline(always)]
pub(super) fn sub(a: Wide, b: Wide, c: Wide, d: Wide) -> Outcome {
    let (lo, hi) = (less_by::<DOWN>(a, d), less_by::<UP>(b, c));
    (plain_zero(lo), plain_zero(hi), numbers(lo, hi))
}

/// As the kernel's: two products a bound, chosen by the signs of `a` and `b`. A product of zero and infinity is NaN;
/// where the minimum or maximum passes over it the other product is the right result, else the result is not bounded.
#[inline(always)]
pub(super) fn mul(a: Wide, b: Wide, c: Wide, d: Wide) -> Outcome {
    let (a_negative, b_negative) = (a.less(zero()), b.less(zero()));
    let (ya, za) = (Wide::select(a_negative, d, c), Wide::select(a_negative, c, d));
    let (yb, zb) = (Wide::select(b_negative, d, c), Wide::select(b_negative, c, d));
    let lo = times::<DOWN>(a, ya).min(times::<DOWN>(b, yb));
    let hi = times::<UP>(a, za).max(times::<UP>(b, zb));
    (plain_zero(lo), plain_zero(hi), bounded(lo, hi))
}

#[inline(always)]
pub(super) fn div(a: Wide, b: Wide, c: Wide, d: Wide) -> Outcome {
    let turn = d.less(zero());
    let (a, b) = (Wide::select(turn, b.neg(), a), Wide::select(turn, a.neg(), b));
    let (c, d) = (Wide::select(turn, d.neg(), c), Wide::select(turn, c.neg(), d));
    let lo = over::<DOWN>(a, Wide::select(a.less(zero()), c, d));
    let hi = over::<UP>(b, Wide::select(b.less(zero()), d, c));
    // A bounded quotient of non-empty intervals by one without zero; an empty divisor turns into c > d.
    let ordered = a.less_equal(b) & c.less_equal(d);
    let sound = (ordered & zero().less(c)) == 0xff && bounded(lo, hi);
    (plain_zero(lo), plain_zero(hi), sound)
}

#[inline(always)]
pub(super) fn square(a: Wide, b: Wide) -> Outcome {
    let small = a.max(b.neg()).max(zero());
    let large = a.neg().max(b);
    let (lo, hi) = (times::<DOWN>(small, small), times::<UP>(large, large));
    // An empty interval has an infinite smallest magnitude.
    (plain_zero(lo), plain_zero(hi), bounded(lo, hi))
}

#[inline(always)]
pub(super) fn sqrt(a: Wide, b: Wide) -> Outcome {
    let (lo, hi) = (root::<DOWN>(a.max(zero())), root::<UP>(b));
    (plain_zero(lo), plain_zero(hi), bounded(lo, hi))
}

/// A row times 16 packed columns. All bounds are finite: a lower sum can only fall to -inf, an upper one only rise to
/// inf, so nothing is NaN.
#[cfg(feature = "linalg")]
#[inline(always)]
pub(super) fn group_product(a: (&[f64], &[f64]), block: (&[f64], &[f64]), sums: &mut ([f64; 16], [f64; 16])) {
    let (mut lo, mut hi) = ([zero(); 2], [zero(); 2]);
    let rows = block.0.chunks_exact(16).zip(block.1.chunks_exact(16));
    for ((&from, &to), (c_row, d_row)) in a.0.iter().zip(a.1).zip(rows) {
        let (from_negative, to_negative) = (if from < 0.0 { 0xff } else { 0 }, if to < 0.0 { 0xff } else { 0 });
        let (x, y) = (Wide::splat(from), Wide::splat(to));
        for half in 0..2 {
            let (c, d) = (Wide::load(&c_row[8 * half..]), Wide::load(&d_row[8 * half..]));
            let p = times::<DOWN>(x, Wide::select(from_negative, d, c));
            let q = times::<DOWN>(y, Wide::select(to_negative, d, c));
            let r = times::<UP>(x, Wide::select(from_negative, c, d));
            let s = times::<UP>(y, Wide::select(to_negative, c, d));
            lo[half] = added::<DOWN>(lo[half], p.min(q));
            hi[half] = added::<UP>(hi[half], r.max(s));
        }
    }
    for half in 0..2 {
        plain_zero(lo[half]).store(&mut sums.0[8 * half..]);
        plain_zero(hi[half]).store(&mut sums.1[8 * half..]);
    }
}
