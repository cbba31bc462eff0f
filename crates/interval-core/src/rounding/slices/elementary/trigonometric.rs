//! Sine and cosine of a vector of intervals.

use super::double_double::{Dd, fast_two_sum, two_product, two_sum};
use super::fused::{Fused, nearest, polynomial};
use super::tables::Columns;
use crate::elementary::{Angle, TABLES, Turning, WAVE_ERROR};

/// Arguments of the kernel in size: from here the functions are no neighbours of 0 and 1, and a count of quarter turns
/// has 27 bits. 2^-27 and 2^27.
const SMALL: f64 = f64::from_bits((1023 - 27) << 52);
const MODERATE: f64 = 134_217_728.0;

/// An angle `k pi/2 + r`.
struct Reduced<L> {
    r: Dd<L>,
    /// `k`, and the same shifted.
    k: L,
    shifted: L,
}

/// Lane by lane the operations of `elementary::trigonometric::reduce`, for `|x| <= 2^27`.
#[inline(always)]
fn reduce<L: Fused>(x: L) -> Reduced<L> {
    let (shifted, k) = nearest(x.mul(L::splat(TABLES.quarters_per_radian)));
    let [a, b, c] = TABLES.half_pi;
    let (a, b, c) = (L::splat(a), L::splat(b), L::splat(c));
    let (p, q) = (two_product(k, a), two_product(k, b));
    let t = two_sum(p.lo.neg(), q.hi.neg());
    let s = two_sum(x.sub(p.hi), t.hi);
    let r = fast_two_sum(s.hi, s.lo.add(t.lo.sub(k.mul_add(c, q.lo))));
    Reduced { r, k, shifted }
}

impl<L: Fused> Reduced<L> {
    /// Completed quarter turns: the number `q` with `q pi/2 <= x < (q + 1) pi/2`.
    #[inline(always)]
    fn quarter_turns(&self) -> L {
        let zero = L::splat(0.0);
        self.k.sub(L::select(self.r.hi.less(zero), L::splat(1.0), zero))
    }

    /// `sin |r|` and `cos |r|` by the addition theorems about the nearest `c = j/128`, lane by lane the operations of
    /// `elementary::trigonometric::kernel`, whose relative error is below 2^-69.5.
    #[inline(always)]
    fn parts(&self, columns: &Columns) -> Parts<L> {
        let turned = self.r.hi.less(L::splat(0.0));
        let a = Dd::select(turned, self.r.neg(), self.r);
        let (shifted, j) = nearest(a.hi.mul(L::splat(128.0)));
        let h = two_sum(a.hi.sub(j.mul(L::splat(1.0 / 128.0))), a.lo);
        let square = h.square();
        let z = square.hi;
        let sin_tail = polynomial(z, [1.0 / 362_880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0]);
        let cos_tail = polynomial(z, [1.0 / 40_320.0, -1.0 / 720.0, 1.0 / 24.0]);
        Parts {
            turned,
            sin: Dd { hi: shifted.gather(&columns.sin[0]), lo: shifted.gather(&columns.sin[1]) },
            cos: Dd { hi: shifted.gather(&columns.cos[0]), lo: shifted.gather(&columns.cos[1]) },
            sin_h: h.add_f64(z.mul(h.hi).mul(sin_tail)),
            cos_h_less_one: square.scale(-0.5).add_f64(z.mul(z).mul(cos_tail)),
        }
    }

    /// The function with its maximum after `top` quarter turns: `sin(r + k pi/2) = cos(r + (k - 1) pi/2)`.
    #[inline(always)]
    fn wave(&self, top: f64, columns: &Columns) -> Dd<L> {
        let turn = self.shifted.sub(L::splat(top));
        let value = self.parts(columns).sine_or_cosine(turn.has_bits(1));
        // Negative in the second and third quarter.
        Dd::select(turn.add(L::splat(1.0)).has_bits(2), value.neg(), value)
    }

    /// `tan r` or `-cot r`, with a quotient's error more.
    #[inline(always)]
    fn tan(&self, columns: &Columns) -> Dd<L> {
        let parts = self.parts(columns);
        let odd = self.shifted.has_bits(1);
        let over = parts.sine_or_cosine(L::not(odd));
        Dd::select(odd, over.neg(), over).div(parts.sine_or_cosine(odd))
    }
}

/// What the addition theorems put together for `r = ±(c + h)`.
struct Parts<L: Fused> {
    /// True where `r` is negative.
    turned: L::Mask,
    /// Of `c`.
    sin: Dd<L>,
    cos: Dd<L>,
    sin_h: Dd<L>,
    cos_h_less_one: Dd<L>,
}

impl<L: Fused> Parts<L> {
    /// `sin r` where the mask holds, elsewhere `cos r`.
    #[inline(always)]
    fn sine_or_cosine(&self, sine: L::Mask) -> Dd<L> {
        let x = Dd::select(sine, self.sin, self.cos);
        let y = Dd::select(sine, self.cos, self.sin.neg());
        let value = x.add(x.mul(self.cos_h_less_one).add(y.mul(self.sin_h)));
        Dd::select(L::both(sine, self.turned), value.neg(), value)
    }
}

/// True where some integer `q` with `first < q <= last` is `residue` modulo `period`, 2 or 4, for whole numbers below
/// 2^30 in size.
#[inline(always)]
fn passes<L: Fused>(first: L, last: L, residue: f64, period: f64) -> L::Mask {
    periods(first, residue, period).less(periods(last, residue, period))
}

/// `floor((q - residue) / period)`: the integer nearest to half the largest remainder less. Nothing is rounded before.
#[inline(always)]
fn periods<L: Fused>(q: L, residue: f64, period: f64) -> L {
    let half = L::splat((period - 1.0) / (2.0 * period));
    nearest(q.sub(L::splat(residue)).mul(L::splat(1.0 / period)).sub(half)).1
}

/// Lanes in the range of the kernel.
#[inline(always)]
fn within<L: Fused>(a: L, b: L) -> L::Mask {
    let (small, moderate) = (L::splat(SMALL), L::splat(MODERATE));
    let (left, right) = (a.abs(), b.abs());
    let away = L::both(small.less_equal(left), small.less_equal(right));
    let moderate = L::both(left.less_equal(moderate), right.less_equal(moderate));
    L::both(a.less_equal(b), L::both(away, moderate))
}

/// Both bounds of the function with its maximum after `top` quarter turns, and the lanes where they are the tightest.
#[inline(always)]
pub(super) fn wave<L: Fused>(a: L, b: L, top: f64, columns: &Columns) -> (L, L, L::Mask) {
    let (left, right) = (reduce(a), reduce(b));
    let (first, last) = (left.quarter_turns(), right.quarter_turns());
    let (low, high) = (passes(first, last, top + 2.0, 4.0), passes(first, last, top, 4.0));
    let (left, right) = (left.wave(top, columns), right.wave(top, columns));
    let ((left_down, left_known), (right_down, right_known)) = (left.down(WAVE_ERROR), right.down(WAVE_ERROR));
    let ((left_up, _), (right_up, _)) = (left.up(WAVE_ERROR), right.up(WAVE_ERROR));
    let (one, known) = (L::splat(1.0), L::both(left_known, right_known));
    let lo = L::select(low, one.neg(), left_down.min(right_down));
    let hi = L::select(high, one, left_up.max(right_up));
    let narrow = b.sub(a).less_equal(L::splat(Angle::WHOLE));
    (lo, hi, L::both(known, L::both(narrow, within(a, b))))
}

/// Both bounds of the tangent, everything where a pole is passed, and the lanes where they are the tightest.
#[inline(always)]
pub(super) fn tan<L: Fused>(a: L, b: L, columns: &Columns) -> (L, L, L::Mask) {
    let (left, right) = (reduce(a), reduce(b));
    let pole = passes(left.quarter_turns(), right.quarter_turns(), 1.0, 2.0);
    let (lo, lo_known) = left.tan(columns).down(WAVE_ERROR);
    let (hi, hi_known) = right.tan(columns).up(WAVE_ERROR);
    let infinity = L::splat(f64::INFINITY);
    let known = L::either(pole, L::both(lo_known, hi_known));
    (L::select(pole, infinity.neg(), lo), L::select(pole, infinity, hi), L::both(known, within(a, b)))
}
