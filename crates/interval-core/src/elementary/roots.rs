//! Integer roots, the reciprocal square root and the length of a vector.

use super::ball::Ball;
use super::double_double::{Dd, two_product};
use super::multiprecision::{Bracket, settle};
use super::{decide, power, power_of_two, split};

/// Relative error of a quotient by a square root, doubled and more: 24 u^2.
const ERROR: f64 = f64::from_bits((1023 - 98) << 52);
/// The quotient of the coordinates from which on the smaller one adds less than half the distance to the neighbour.
const FAR: i64 = 28;

/// `x^(1/n)` for finite `x > 0` and `n != 0`.
#[inline(always)]
pub(crate) fn rootn(x: f64, n: i32) -> Bracket {
    power::root(x, f64::from(n))
}

/// `1 / sqrt(x)` for `x > 0`.
#[inline(always)]
pub(crate) fn rsqrt(x: f64) -> Bracket {
    if x == f64::INFINITY {
        return Bracket::exact(0.0);
    }
    let (m, e) = split(x);
    let (m, half) = if e % 2 == 0 { (m, e / 2) } else { (2.0 * m, (e - 1) / 2) };
    if m == 1.0 {
        return Bracket::exact(power_of_two(-half));
    }
    // 1 / d^2 is a double for no other double d, so the last resort ends.
    decide(Dd::ONE.div(Dd::from(m).sqrt()), ERROR).map_or_else(
        || settle(|p| Ball::integer(1).div(&Ball::from_f64(x).sqrt(p + 16)?, p)),
        |bracket| bracket.scale(-half),
    )
}

/// `sqrt(x^2 + y^2)` for finite arguments.
#[inline(always)]
pub(crate) fn hypot(x: f64, y: f64) -> Bracket {
    let (a, b) = if x.abs() >= y.abs() { (x.abs(), y.abs()) } else { (y.abs(), x.abs()) };
    if b == 0.0 {
        return Bracket::exact(a);
    }
    let ((m, e), (n, f)) = (split(a), split(b));
    if e - f > FAR {
        // a + b^2 / (2 a)
        return Bracket::beyond(a);
    }
    let n = n * power_of_two(f - e);
    let length = (two_product(m, m) + two_product(n, n)).sqrt();
    if (-1000..1000).contains(&e) {
        if let Some(bracket) = decide(length, ERROR) {
            return bracket.scale(e);
        }
    }
    // A root of an integer is an integer or irrational, so this ends.
    settle(|p| {
        let (a, b) = (Ball::from_f64(a), Ball::from_f64(b));
        a.mul(&a).add(&b.mul(&b)).sqrt(p)
    })
}
