//! Sine, cosine and tangent.

use super::ball::Ball;
use super::decide;
use super::double_double::{Dd, fast_two_sum, two_product, two_sum};
use super::multiprecision::{Bracket, settle, sin_cos};
use super::nearest;
use super::tables::{TABLES, Tables};
use crate::integers::Integer;
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// Relative error of sine and cosine and, with a quotient more, of the tangent, doubled and more.
pub(crate) const ERROR: f64 = f64::from_bits((1023 - 68) << 52);
/// Below this the second term of the series, at most `x^2 / 2` of the value, is less than half the distance to the
/// neighbouring double.
const TINY: f64 = f64::from_bits((1023 - 27) << 52);
/// Up to here a count of quarter turns fits 27 bits.
const MODERATE: f64 = 134_217_728.0;

/// `x = k pi/2 + r`, `|r| < 0.7855`, for `|x| <= 2^27`.
///
/// `pi/2 = a + b + c` within 2^-160. Exact are: the products `k a` and `k b` as double-doubles; `x - p.hi`, as the two
/// differ by less than a factor of two (Sterbenz) or `k = 0`; both sums `t` and `s`. The rounded parts lie below 2^-79,
/// so their error is below 2^-131 and, with the constant's `k 2^-160`, stands against `|r| > 2^-62` (no double is
/// nearer to a multiple of pi/2): 2^-69.5 relative, and 2^-100 wherever `|r|` is not tiny.
#[inline(always)]
fn reduce(x: f64, tables: &Tables) -> (Dd, i64) {
    let k = nearest(x * tables.quarters_per_radian);
    let [a, b, c] = tables.half_pi;
    let (p, q) = (two_product(k, a), two_product(k, b));
    let t = two_sum(-p.lo, -q.hi);
    let s = two_sum(x - p.hi, t.hi);
    let r = fast_two_sum(s.hi, s.lo + (t.lo - k.mul_add(c, q.lo)));
    #[expect(clippy::cast_possible_truncation, reason = "an integer below 2^28")]
    let count = k as i64;
    (r, count)
}

/// `sin r` or `cos r`, `|r| < 0.7855`: `r = c + h`, `c = j/128`, `|h| <= 2^-8`.
///
/// `h^3/6` and `h^4/24` with the further terms (below 2^-26.5) are evaluated in double with four roundings that count:
/// 2^-77.5 absolute, against a sine of at least 2^-8 where `j > 0`, and `h^2/6` of that relative to `h` where `j = 0`:
/// 2^-69.5.
#[inline(always)]
pub(super) fn kernel(r: Dd, cosine: bool, tables: &Tables) -> Dd {
    let a = r.with_sign(r.hi);
    let j = nearest(a.hi * 128.0);
    // Exact (Sterbenz).
    let h = two_sum(a.hi - j / 128.0, a.lo);
    let square = h.square();
    let z = square.hi;
    let sin_tail = z.mul_add(z.mul_add(z.mul_add(1.0 / 362_880.0, -1.0 / 5040.0), 1.0 / 120.0), -1.0 / 6.0);
    let cos_tail = z.mul_add(z.mul_add(1.0 / 40_320.0, -1.0 / 720.0), 1.0 / 24.0);
    let sin_h = h.add_f64(z * h.hi * sin_tail);
    let cos_less_one = square.scale(-0.5).add_f64(z * z * cos_tail);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of at most 101")]
    let (s, c) = tables.sin_cos[j as usize];
    // sin(c + h) and cos(c + h) by the addition theorems, in one form: x + (x (cos h - 1) + y sin h).
    let (x, y) = if cosine { (c, -s) } else { (s, c) };
    let value = x + (x * cos_less_one + y * sin_h);
    if cosine { value } else { value.with_sign(r.hi) }
}

/// A finite angle, reduced once for all that is asked of it.
#[derive(Clone, Copy)]
pub(crate) struct Angle {
    pub(super) x: f64,
    /// Remainder and count of quarter turns, for angles up to [`MODERATE`].
    pub(super) reduced: Option<(Dd, i64)>,
}

/// An angle of some unit, reduced once for all that is asked of it.
pub(crate) trait Turning: Copy {
    /// A width from which on an interval of angles holds a whole turn.
    const WHOLE: f64;

    /// The angle of a finite double.
    fn new(x: f64) -> Self;

    /// The number of quarter turns that are completed at the angle. `None` beyond all integers of 63 bits.
    fn quarter_turns(&self) -> Option<i64>;

    /// The function with its maximum at 0 (`top` = 0, the cosine) or after a quarter turn (1, the sine).
    fn wave(&self, top: i64) -> Bracket;
}

impl Turning for Angle {
    const WHOLE: f64 = 7.0;

    #[inline(always)]
    fn new(x: f64) -> Self {
        Self { x, reduced: if x.abs() <= MODERATE { Some(reduce(x, &TABLES)) } else { None } }
    }

    /// The number `q` with `q pi/2 <= x < (q + 1) pi/2`; equality only at 0.
    #[inline(always)]
    fn quarter_turns(&self) -> Option<i64> {
        match self.reduced {
            // The sign of r is right: its relative error is far below one.
            Some((r, k)) => Some(if r.hi < 0.0 { k - 1 } else { k }),
            None => turns_of_large(self.x),
        }
    }

    #[inline(always)]
    fn wave(&self, top: i64) -> Bracket {
        let x = self.x;
        if x.abs() < TINY {
            return match (top, x == 0.0) {
                (0, true) => Bracket::exact(1.0),
                (0, false) => Bracket::within(1.0),
                (_, true) => Bracket::exact(x),
                (_, false) => Bracket::within(x),
            };
        }
        if let Some((r, k)) = self.reduced {
            // sin(r + k pi/2) = cos(r + (k - 1) pi/2)
            let turn = (k - top) & 3;
            let value = kernel(r, turn % 2 == 0, &TABLES);
            if let Some(bracket) = decide(if turn == 1 || turn == 2 { -value } else { value }, ERROR) {
                return bracket;
            }
        }
        exactly(x, |s, c, _| Some(if top == 0 { c } else { s }))
    }
}

impl Angle {
    /// `tan x`.
    #[inline(always)]
    pub fn tan(&self) -> Bracket {
        let x = self.x;
        if x.abs() < TINY {
            return if x == 0.0 { Bracket::exact(x) } else { Bracket::beyond(x) };
        }
        if let Some((r, k)) = self.reduced {
            let (s, c) = (kernel(r, false, &TABLES), kernel(r, true, &TABLES));
            if let Some(bracket) = decide(if k & 1 == 0 { s.div(c) } else { -c.div(s) }, ERROR) {
                return bracket;
            }
        }
        exactly(x, |s, c, p| s.div(&c, p))
    }
}

#[cold]
fn turns_of_large(x: f64) -> Option<i64> {
    if x.abs() > 4.0e18 {
        return None;
    }
    (7..14).find_map(|step| sin_cos(&Ball::from_f64(x), 1 << step)).and_then(|(_, _, q): (_, _, Integer)| q.to_i64())
}

#[cold]
pub(crate) fn exactly(x: f64, choose: impl Fn(Ball, Ball, i64) -> Option<Ball>) -> Bracket {
    settle(|p| sin_cos(&Ball::from_f64(x), p).and_then(|(s, c, _)| choose(s, c, p)))
}
