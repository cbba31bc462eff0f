//! Reciprocals of the trigonometric and hyperbolic functions, and the inverse hyperbolic cotangent.

use super::ball::Ball;
use super::decide;
use super::double_double::{Dd, two_sum};
use super::exponential::{self, TOO_LARGE, TOO_SMALL, finish, growth, sinh_series};
use super::logarithm;
use super::multiprecision::{self, Bracket, settle};
use super::tables::TABLES;
use super::trigonometric::{self, Angle, Turning, kernel};
use crate::doubles::Neighbours as _;
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// Below this the second term of the series, at most `x^2` of the value, is smaller than the distance of a quotient `1/x`
/// that is no double from all of them, 2^-106 of it.
const TINY: f64 = f64::from_bits((1023 - 60) << 52);

/// A value between `1/x` and the next double away from zero (`larger`) or towards it, nearer to `1/x` than 2^-118 of it.
/// The argument is positive.
#[inline(always)]
fn beside_reciprocal(x: f64, larger: bool) -> Bracket {
    let q = 1.0 / x;
    if q == f64::INFINITY {
        return TOO_LARGE;
    }
    // The sign is right: the difference is a multiple of the product of both last bits, at least 2^-105.
    let r = (-q).mul_add(x, 1.0);
    if r > 0.0 {
        Bracket { down: q, up: q.above() }
    } else if r < 0.0 {
        Bracket { down: q.below(), up: q }
    } else if larger {
        Bracket::beyond(q)
    } else {
        Bracket::within(q)
    }
}

/// `1 / cos x`.
#[inline(always)]
pub(crate) fn sec(x: f64) -> Bracket {
    if x.abs() < exponential::TINY {
        return if x == 0.0 { Bracket::exact(1.0) } else { Bracket::beyond(1.0) };
    }
    if let Some((r, k)) = Angle::new(x).reduced {
        let value = kernel(r, k & 1 == 0, &TABLES);
        let turn = k & 3;
        let value = if turn == 1 || turn == 2 { -value } else { value };
        if let Some(bracket) = decide(Dd::ONE.div(value), trigonometric::ERROR) {
            return bracket;
        }
    }
    trigonometric::exactly(x, |_, c, p| Ball::integer(1).div(&c, p))
}

/// `1 / sin x`, `x != 0`.
#[inline(always)]
pub(crate) fn csc(x: f64) -> Bracket {
    let a = x.abs();
    let positive = if a < TINY {
        beside_reciprocal(a, true)
    } else {
        let found = Angle::new(a).reduced.and_then(|(r, k)| {
            let value = kernel(r, k & 1 == 1, &TABLES);
            decide(Dd::ONE.div(if k & 2 == 2 { -value } else { value }), trigonometric::ERROR)
        });
        found.unwrap_or_else(|| trigonometric::exactly(a, |s, _, p| Ball::integer(1).div(&s, p)))
    };
    if x < 0.0 { positive.neg() } else { positive }
}

/// `cos x / sin x`, `x != 0`.
#[inline(always)]
pub(crate) fn cot(x: f64) -> Bracket {
    let a = x.abs();
    let positive = if a < TINY {
        beside_reciprocal(a, false)
    } else {
        let found = Angle::new(a).reduced.and_then(|(r, k)| {
            let (s, c) = (kernel(r, false, &TABLES), kernel(r, true, &TABLES));
            decide(if k & 1 == 0 { c.div(s) } else { -s.div(c) }, trigonometric::ERROR)
        });
        found.unwrap_or_else(|| trigonometric::exactly(a, |s, c, p| c.div(&s, p)))
    };
    if x < 0.0 { positive.neg() } else { positive }
}

/// `2 / (e^a + e^-a)` with `even`, else `2 / (e^a - e^-a)`, for `a >= 2^-5`.
#[inline(always)]
fn over_growth(a: f64, even: bool) -> Option<Bracket> {
    let tables = &TABLES;
    if a > 747.0 {
        // 2 e^-747 is below 2^-1076.
        return Some(if a == f64::INFINITY { Bracket::exact(0.0) } else { TOO_SMALL });
    }
    if a >= 40.0 {
        // e^-a is below 2^-115 of e^a.
        let (m, k) = exponential::kernel(Dd::from(-a), tables);
        return finish(m, k + 1, exponential::ERROR);
    }
    let e = growth(a, tables);
    let inverse = Dd::ONE.div(e);
    decide(Dd::from(2.0).div(if even { e + inverse } else { e - inverse }), exponential::HYPERBOLIC_ERROR)
}

#[cold]
fn over_growth_exactly(a: f64, even: bool) -> Bracket {
    settle(|p| {
        let e = multiprecision::exp(&Ball::from_f64(a), p + 8)?;
        let inverse = Ball::integer(1).div(&e, p + 8)?;
        Ball::integer(2).div(&if even { e.add(&inverse) } else { e.sub(&inverse) }, p)
    })
}

/// `1 / cosh x`.
#[inline(always)]
pub(crate) fn sech(x: f64) -> Bracket {
    let a = x.abs();
    if a < exponential::TINY {
        return if x == 0.0 { Bracket::exact(1.0) } else { Bracket::within(1.0) };
    }
    over_growth(a, true).unwrap_or_else(|| over_growth_exactly(a, true))
}

/// `1 / sinh x`, `x != 0`.
#[inline(always)]
pub(crate) fn csch(x: f64) -> Bracket {
    let a = x.abs();
    let found = if a < TINY {
        Some(beside_reciprocal(a, false))
    } else if a < exponential::SMALL {
        decide(Dd::ONE.div(sinh_series(a, &TABLES)), exponential::HYPERBOLIC_ERROR)
    } else {
        over_growth(a, false)
    };
    let positive = found.unwrap_or_else(|| over_growth_exactly(a, false));
    if x < 0.0 { positive.neg() } else { positive }
}

/// `cosh x / sinh x`, `x != 0`.
#[inline(always)]
pub(crate) fn coth(x: f64) -> Bracket {
    let (a, tables) = (x.abs(), &TABLES);
    let found = if a < TINY {
        Some(beside_reciprocal(a, true))
    } else if a < exponential::SMALL {
        let s = sinh_series(a, tables);
        decide((s.square() + Dd::ONE).sqrt().div(s), exponential::HYPERBOLIC_ERROR)
    } else if a < 19.5 {
        let e = growth(2.0 * a, tables);
        decide((e + Dd::ONE).div(e - Dd::ONE), exponential::HYPERBOLIC_ERROR)
    } else {
        // coth a - 1 < 3 e^-39 < 2^-54.
        Some(if a == f64::INFINITY { Bracket::exact(1.0) } else { Bracket::beyond(1.0) })
    };
    let positive = found.unwrap_or_else(|| coth_exactly(a));
    if x < 0.0 { positive.neg() } else { positive }
}

#[cold]
fn coth_exactly(a: f64) -> Bracket {
    settle(|p| {
        let e = multiprecision::exp(&Ball::from_f64(2.0 * a), p + 8)?;
        let one = Ball::integer(1);
        e.add(&one).div(&e.sub(&one), p)
    })
}

/// `arcoth x = ln(1 + 2 / (x - 1)) / 2`, `|x| >= 1`.
#[inline(always)]
pub(crate) fn acoth(x: f64) -> Bracket {
    let a = x.abs();
    let positive = if a == 1.0 || a == f64::INFINITY {
        Bracket::exact(if a == 1.0 { f64::INFINITY } else { 0.0 })
    } else if a > 1.0 / TINY {
        beside_reciprocal(a, true)
    } else {
        let ratio = Dd::from(2.0).div(two_sum(a, -1.0));
        decide(logarithm::log1p(ratio, &TABLES).scale(0.5), logarithm::DERIVED_ERROR)
            .unwrap_or_else(|| acoth_exactly(a))
    };
    if x < 0.0 { positive.neg() } else { positive }
}

#[cold]
fn acoth_exactly(a: f64) -> Bracket {
    settle(|p| {
        let (ball, one) = (Ball::from_f64(a), Ball::integer(1));
        if a > 2.0 {
            return multiprecision::artanh(&one.div(&ball, p + 64)?, p + 16);
        }
        Some(multiprecision::log(&ball.add(&one).div(&ball.sub(&one), p + 64)?, p + 16)?.scale(-1))
    })
}
