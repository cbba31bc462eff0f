//! Trigonometric functions of angles in half turns, `sin(pi x)`, and their inverses, `asin(x) / pi`.
//!
//! Such an angle is reduced without error. Among the doubles only multiples of a half have a sine that is one, only
//! multiples of a quarter a tangent (Niven).

use super::arctangent::{angle, leg};
use super::ball::Ball;
use super::double_double::Dd;
use super::multiprecision::{self, Bracket, settle, sin_cos};
use super::tables::TABLES;
use super::trigonometric::{ERROR, Turning, kernel};
use super::{decide, nearest, power_of_two, split};
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// Below this an error term of a double-double may be subnormal.
const SUBNORMAL: f64 = f64::from_bits((1023 - 900) << 52);
/// From here on all doubles are even.
const EVEN: f64 = 9_007_199_254_740_992.0;
/// Relative error of [`angle`] and of a product with a constant, doubled and more.
const INVERSE_ERROR: f64 = f64::from_bits((1023 - 75) << 52);
/// Below this a term beside a half or a whole turn is less than half the distance to the neighbouring double.
const TINY: f64 = f64::from_bits((1023 - 55) << 52);
/// Below this `cos(pi r)` lies between 1 and its neighbour: `5 r^2` is below 2^-57.
const NEXT_TO_ONE: f64 = f64::from_bits((1023 - 30) << 52);
/// The difference of exponents beyond which the angle of a point stands at an axis.
const FAR: i64 = 58;

/// A finite angle in half turns: the remainder `r`, `|r| <= 1/4`, and the count of quarter turns modulo 4.
#[derive(Clone, Copy)]
pub(crate) struct HalfTurns {
    x: f64,
    r: f64,
    k: i64,
}

impl Turning for HalfTurns {
    const WHOLE: f64 = 2.0;

    #[inline(always)]
    fn new(x: f64) -> Self {
        if x.abs() >= EVEN {
            return Self { x, r: 0.0, k: 0 };
        }
        // Below 2^53: the remainder of a division by 2 is exact, and so are both differences.
        let rest = x % 2.0;
        let count = nearest(2.0 * rest);
        #[expect(clippy::cast_possible_truncation, reason = "an integer of at most 4")]
        Self { x, r: rest - 0.5 * count, k: count as i64 }
    }

    /// The number `q` with `q <= 2 x < q + 1`.
    #[inline(always)]
    fn quarter_turns(&self) -> Option<i64> {
        #[expect(clippy::cast_possible_truncation, reason = "an integer below 2^62")]
        (self.x.abs() < 2.0e18).then(|| (2.0 * self.x).floor() as i64)
    }

    #[inline(always)]
    fn wave(&self, top: i64) -> Bracket {
        // sin(r + k pi/2) = cos(r + (k - 1) pi/2)
        let turn = (self.k - top) & 3;
        let (cosine, negative) = (turn % 2 == 0, turn == 1 || turn == 2);
        if self.r == 0.0 {
            let value = f64::from(u8::from(cosine));
            return Bracket::exact(if negative { -value } else { value });
        }
        let found = if cosine && self.r.abs() < NEXT_TO_ONE {
            Some(Bracket::within(1.0))
        } else if self.r.abs() < SUBNORMAL {
            None
        } else {
            decide(kernel(TABLES.pi.mul_f64(self.r), cosine, &TABLES), ERROR)
        };
        let found = found.unwrap_or_else(|| self.exactly(|s, c, _| Some(if cosine { c } else { s })));
        if negative { found.neg() } else { found }
    }
}

impl HalfTurns {
    /// `tan(pi x)`; `None` at a pole.
    #[inline(always)]
    pub fn tan(&self) -> Option<Bracket> {
        let even = self.k & 1 == 0;
        if self.r == 0.0 {
            return even.then_some(Bracket::exact(0.0));
        }
        if self.r.abs() == 0.25 {
            return Some(Bracket::exact(if (self.r > 0.0) == even { 1.0 } else { -1.0 }));
        }
        let found = if self.r.abs() < SUBNORMAL {
            None
        } else {
            let r = TABLES.pi.mul_f64(self.r);
            let (s, c) = (kernel(r, false, &TABLES), kernel(r, true, &TABLES));
            decide(if even { s.div(c) } else { -c.div(s) }, ERROR)
        };
        Some(
            found.unwrap_or_else(|| {
                self.exactly(|s, c, p| if even { s.div(&c, p) } else { c.div(&s, p).map(Ball::neg) })
            }),
        )
    }

    #[cold]
    fn exactly(&self, choose: impl Fn(Ball, Ball, i64) -> Option<Ball>) -> Bracket {
        settle(|p| {
            let angle = Ball::from_f64(self.r).mul(&multiprecision::pi(p + 16));
            sin_cos(&angle, p).and_then(|(s, c, _)| choose(s, c, p))
        })
    }
}

/// The inverse of an angle by its ball, in half turns.
#[cold]
fn exactly(evaluate: impl Fn(i64) -> Option<Ball>) -> Bracket {
    settle(|p| evaluate(p + 16)?.div(&multiprecision::pi(p + 16), p))
}

/// The leg beside `x` in the unit circle.
fn ball_leg(x: &Ball, p: i64) -> Option<Ball> {
    Ball::integer(1).sub(&x.mul(x)).sqrt(p + 64)
}

/// `asin(x) / pi`, `|x| <= 1`.
#[inline(always)]
pub(crate) fn asin_pi(x: f64) -> Bracket {
    let a = x.abs();
    if a == 0.0 || a == 1.0 {
        return Bracket::exact(0.5 * x);
    }
    let found =
        if a < SUBNORMAL { None } else { decide(angle(Dd::from(a), leg(a), &TABLES) * TABLES.per_pi, INVERSE_ERROR) };
    let found = found.unwrap_or_else(|| {
        exactly(|p| {
            let ball = Ball::from_f64(a);
            multiprecision::atan2(&ball, &ball_leg(&ball, p)?, p)
        })
    });
    if x < 0.0 { found.neg() } else { found }
}

/// `acos(x) / pi`, `|x| <= 1`.
#[inline(always)]
pub(crate) fn acos_pi(x: f64) -> Bracket {
    if x.abs() == 1.0 || x == 0.0 {
        return Bracket::exact(0.5 - 0.5 * x);
    }
    if x.abs() < TINY {
        return if x > 0.0 { Bracket::within(0.5) } else { Bracket::beyond(0.5) };
    }
    decide(angle(leg(x), Dd::from(x), &TABLES) * TABLES.per_pi, INVERSE_ERROR).unwrap_or_else(|| {
        exactly(|p| {
            let ball = Ball::from_f64(x);
            multiprecision::atan2(&ball_leg(&ball, p)?, &ball, p)
        })
    })
}

/// `atan(x) / pi`.
#[inline(always)]
pub(crate) fn atan_pi(x: f64) -> Bracket {
    atan2_pi(x, 1.0)
}

/// The angle of the point `(x, y)` in half turns, in [-1, 1], for `x` and `y` not both zero; on the negative half of the
/// axis 1.
#[inline(always)]
pub(crate) fn atan2_pi(y: f64, x: f64) -> Bracket {
    if y == 0.0 {
        return Bracket::exact(if x > 0.0 { 0.0 } else { 1.0 });
    }
    let (rise, run) = (y.abs(), x.abs());
    let positive = if rise == f64::INFINITY || x == 0.0 {
        Bracket::exact(0.5)
    } else if run == f64::INFINITY {
        Bracket::exact(if x > 0.0 { 0.0 } else { 1.0 })
    } else if rise == run {
        Bracket::exact(if x > 0.0 { 0.25 } else { 0.75 })
    } else {
        finite(rise, x, run)
    };
    if y < 0.0 { positive.neg() } else { positive }
}

#[inline(always)]
fn finite(rise: f64, x: f64, run: f64) -> Bracket {
    let ((m, e), (n, f)) = (split(rise), split(run));
    let difference = e - f;
    if difference > FAR {
        return if x > 0.0 { Bracket::within(0.5) } else { Bracket::beyond(0.5) };
    }
    if difference < -FAR && x < 0.0 {
        return Bracket::within(1.0);
    }
    if difference > -800 {
        let y = Dd::from(m * power_of_two(difference));
        let value = angle(y, Dd::from(if x < 0.0 { -n } else { n }), &TABLES) * TABLES.per_pi;
        if let Some(bracket) = decide(value, INVERSE_ERROR) {
            return bracket;
        }
    }
    exactly(|p| multiprecision::atan2(&Ball::from_f64(rise), &Ball::from_f64(x), p))
}
