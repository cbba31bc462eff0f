//! Inverse trigonometric functions, all from the angle of a point.

use super::ball::Ball;
use super::double_double::{Dd, two_sum};
use super::multiprecision::{self, Bracket, settle};
use super::tables::{TABLES, Tables};
use super::{decide, power_of_two, split};
use crate::doubles::Neighbours as _;
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// Relative error of [`angle`], doubled.
const ERROR: f64 = f64::from_bits((1023 - 76) << 52);
/// Below this the second term of the series, at most `x^2 / 2` of the value, is less than half the distance to the
/// neighbouring double.
const TINY: f64 = f64::from_bits((1023 - 27) << 52);
/// The largest difference of the coordinates' exponents, so that nothing over- or underflows. Beyond it the last resort
/// decides.
const FAR: i64 = 400;
/// From this difference on the angle to an axis is below 2^-59.
const AXIS: i64 = 60;

/// `atan t`, `0 <= t <= 1`: `u = (t - c) / (1 + c t)`, `c = j/64`, `|u| < 2^-7`; `u - u^3/3` in double-double,
/// `u^5/5 - ...` (2^-30 relative) in double with four roundings, tail `u^13/13`: 2^-79 relative.
#[inline(always)]
fn first_octant(t: Dd, tables: &Tables) -> Dd {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of at most 64")]
    let j = t.hi.mul_add(64.0, 0.5) as usize;
    let u = if j == 0 {
        t
    } else {
        #[expect(clippy::cast_precision_loss, reason = "an index of at most 64")]
        let c = j as f64 / 64.0;
        t.add_f64(-c).div(t.mul_f64(c).add_f64(1.0))
    };
    let square = u.square();
    let z = square.hi;
    let tail = z.mul_add(z.mul_add(z.mul_add(-1.0 / 11.0, 1.0 / 9.0), -1.0 / 7.0), 1.0 / 5.0);
    let rest = (-(square * u * tables.third)).add_f64(z * z * u.hi * tail);
    tables.atan[j] + (u + rest)
}

/// The angle of the point `(x, y)`, `y >= 0`, in [0, pi]: within 2^-77 relative.
#[inline(always)]
pub(super) fn angle(y: Dd, x: Dd, tables: &Tables) -> Dd {
    let across = x.with_sign(x.hi);
    let acute = if y.hi <= across.hi {
        first_octant(y.div(across), tables)
    } else {
        tables.pi.scale(0.5) - first_octant(across.div(y), tables)
    };
    if x.hi < 0.0 { tables.pi - acute } else { acute }
}

/// `atan x`.
#[inline(always)]
pub(crate) fn atan(x: f64) -> Bracket {
    let a = x.abs();
    if a < TINY {
        return if x == 0.0 { Bracket::exact(x) } else { Bracket::within(x) };
    }
    // Beyond 2^60 the reciprocal moves pi/2 by less than half the distance to its neighbours.
    let value = angle(Dd::from(a.min(power_of_two(200))), Dd::ONE, &TABLES);
    let positive = if a <= power_of_two(200) { decide(value, ERROR) } else { decide(TABLES.pi.scale(0.5), ERROR) };
    let positive = positive.unwrap_or_else(|| settle(|p| multiprecision::atan(&Ball::from_f64(a), p)));
    if x < 0.0 { positive.neg() } else { positive }
}

/// The square root of `1 - x^2`, `|x| <= 1`.
#[inline(always)]
pub(super) fn leg(x: f64) -> Dd {
    (two_sum(1.0, x) * two_sum(1.0, -x)).sqrt()
}

/// `asin x`, `|x| <= 1`.
#[inline(always)]
pub(crate) fn asin(x: f64) -> Bracket {
    let a = x.abs();
    if a < TINY {
        return if x == 0.0 { Bracket::exact(x) } else { Bracket::beyond(x) };
    }
    let positive =
        decide(angle(Dd::from(a), leg(a), &TABLES), ERROR).unwrap_or_else(|| exactly(a, multiprecision::atan2));
    if x < 0.0 { positive.neg() } else { positive }
}

/// `acos x`, `|x| <= 1`.
#[inline(always)]
pub(crate) fn acos(x: f64) -> Bracket {
    if x == 1.0 {
        return Bracket::exact(0.0);
    }
    decide(angle(leg(x), Dd::from(x), &TABLES), ERROR)
        .unwrap_or_else(|| exactly(x, |x, leg, p| multiprecision::atan2(leg, x, p)))
}

#[cold]
fn exactly(x: f64, choose: impl Fn(&Ball, &Ball, i64) -> Option<Ball>) -> Bracket {
    settle(|p| {
        let (ball, one) = (Ball::from_f64(x), Ball::integer(1));
        let leg = one.sub(&ball.mul(&ball)).sqrt(p + 64)?;
        choose(&ball, &leg, p)
    })
}

/// The angle of the point `(x, y)` in [-pi, pi], for `x` and `y` not both zero; on the negative half of the axis pi.
#[inline(always)]
pub(crate) fn atan2(y: f64, x: f64) -> Bracket {
    let tables = &TABLES;
    if y == 0.0 {
        return if x > 0.0 { Bracket::exact(0.0) } else { constant(tables.pi) };
    }
    let (rise, run) = (y.abs(), x.abs());
    let positive = if rise == f64::INFINITY || x == 0.0 {
        constant(tables.pi.scale(0.5))
    } else if run == f64::INFINITY {
        if x > 0.0 { Bracket::exact(0.0) } else { constant(tables.pi) }
    } else {
        finite(rise, x, run, tables)
    };
    if y < 0.0 { positive.neg() } else { positive }
}

#[inline(always)]
fn finite(rise: f64, x: f64, run: f64, tables: &Tables) -> Bracket {
    let ((m, e), (n, f)) = (split(rise), split(run));
    let difference = e - f;
    // Neither pi nor its half lies within 2^-56 of a double, relative to it.
    if difference > AXIS {
        return constant(tables.pi.scale(0.5));
    }
    if difference < -AXIS && x < 0.0 {
        return constant(tables.pi);
    }
    if difference.abs() < FAR {
        let y = m * power_of_two(difference);
        if let Some(bracket) = decide(angle(Dd::from(y), Dd::from(if x < 0.0 { -n } else { n }), tables), ERROR) {
            return bracket;
        }
    }
    settle(|p| multiprecision::atan2(&Ball::from_f64(rise), &Ball::from_f64(x), p))
}

/// The roundings of a constant of the tables, none of which is a double.
fn constant(value: Dd) -> Bracket {
    decide(value, ERROR).unwrap_or(Bracket { down: value.hi.below(), up: value.hi.above() })
}
