//! Exponential and hyperbolic functions.

use super::ball::Ball;
use super::double_double::{Dd, two_product, two_sum};
use super::multiprecision::{self, Bracket, settle};
use super::tables::{TABLES, Tables};
use super::{decide, nearest, power_of_two};
use crate::doubles::unsigned;
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// Relative error of [`kernel`], doubled twice over.
pub(crate) const ERROR: f64 = power(-71);
/// Relative error of the hyperbolic sine and tangent: six bits may cancel at 2^-5.
pub(super) const HYPERBOLIC_ERROR: f64 = power(-64);
/// Below this the series of the hyperbolic sine is used, above it the exponentials, whose difference cancels.
pub(super) const SMALL: f64 = power(-5);
/// Below this the second term of the series, at most `x^2 / 2` of the value, is less than half the distance to the
/// neighbouring double.
pub(super) const TINY: f64 = power(-27);
/// Above this `e^x` exceeds the largest double, whose logarithm is about 709.78.
pub(super) const OVERFLOW: f64 = 709.8;
/// Below this `e^x` lies under half the smallest double: `ln 2^-1075` is about -745.13.
const UNDERFLOW: f64 = -745.2;

const fn power(k: i64) -> f64 {
    f64::from_bits(unsigned(k + 1023) << 52)
}

/// `e^x = m 2^k` with `m` in [0.99, 2.02], for `|x| < 1100`.
///
/// `x = n ln2/64 + r`, `n = 64 k + j`, `|r| < 0.0055`: `m = 2^(j/64) e^r`. The errors, relative to the result:
/// reduction `n 2^-95` < 2^-78; table 2^-103; `e^r - 1 = r + r^2/2` in double-double, the rest `r^3/6 + ...` (below
/// 2^-25) in double with at most four roundings and the low part of `r` left out: 2^-74.6; tail `r^9/9!` < 2^-86.
/// Together below 2^-73.
#[inline(always)]
pub(super) fn kernel(x: Dd, tables: &Tables) -> (Dd, i64) {
    let n = nearest(x.hi * tables.steps_per_unit);
    #[expect(clippy::cast_possible_truncation, reason = "an integer below 2^18")]
    let count = n as i64;
    #[expect(clippy::cast_possible_truncation, reason = "six bits")]
    let step = unsigned(count & 63) as usize;
    let low = two_product(n, tables.step[1]);
    // The first difference is exact: both terms are multiples of the smaller one's last bit, and nearly equal.
    let s = two_sum(n.mul_add(-tables.step[0], x.hi), -low.hi);
    let r = two_sum(s.hi, s.lo + (x.lo - low.lo));
    let z = r.hi;
    let tail = z.mul_add(z.mul_add(1.0 / 40320.0, 1.0 / 5040.0), 1.0 / 720.0);
    let tail = z.mul_add(z.mul_add(z.mul_add(tail, 1.0 / 120.0), 1.0 / 24.0), 1.0 / 6.0);
    let p = (r + r.square().scale(0.5)).add_f64(z * z * z * tail);
    let base = tables.exp2[step];
    (base + base * p, count >> 6)
}

/// Roundings of `m 2^k` from those of `m`; `None` outside the normal range.
#[inline(always)]
pub(super) fn finish(m: Dd, k: i64, error: f64) -> Option<Bracket> {
    if !(-1020..1022).contains(&k) {
        return None;
    }
    decide(m, error).map(|b| b.scale(k))
}

/// The bounds of a value above the largest double.
pub(super) const TOO_LARGE: Bracket = Bracket { down: f64::MAX, up: f64::INFINITY };
/// The bounds of a positive value below half the smallest double.
pub(super) const TOO_SMALL: Bracket = Bracket { down: 0.0, up: f64::from_bits(1) };

#[inline(always)]
fn near_one(x: f64) -> Bracket {
    if x > 0.0 { Bracket::beyond(1.0) } else { Bracket::within(1.0) }
}

/// `e^x`.
#[inline(always)]
pub(crate) fn exp(x: f64) -> Bracket {
    if x.abs() < power(-54) {
        return if x == 0.0 { Bracket::exact(1.0) } else { near_one(x) };
    }
    if x > OVERFLOW {
        return if x == f64::INFINITY { Bracket::exact(x) } else { TOO_LARGE };
    }
    if x < UNDERFLOW {
        return if x == f64::NEG_INFINITY { Bracket::exact(0.0) } else { TOO_SMALL };
    }
    let (m, k) = kernel(Dd::from(x), &TABLES);
    finish(m, k, ERROR).unwrap_or_else(|| exp_exactly(x))
}

#[cold]
fn exp_exactly(x: f64) -> Bracket {
    settle(|p| multiprecision::exp(&Ball::from_f64(x), p))
}

/// `2^x`.
#[inline(always)]
pub(crate) fn exp2(x: f64) -> Bracket {
    if x >= 1024.0 {
        return if x == f64::INFINITY { Bracket::exact(x) } else { TOO_LARGE };
    }
    if x < -1074.0 {
        return if x == f64::NEG_INFINITY { Bracket::exact(0.0) } else { TOO_SMALL };
    }
    if x.abs() < power(-54) {
        return if x == 0.0 { Bracket::exact(1.0) } else { near_one(x) };
    }
    let whole = nearest(x);
    if whole == x {
        #[expect(clippy::cast_possible_truncation, reason = "an integer below 2^11")]
        let k = x as i64;
        return Bracket::exact(if k >= -1022 { power_of_two(k) } else { power_of_two(k + 200) * power_of_two(-200) });
    }
    let tables = &TABLES;
    let (m, k) = kernel(tables.ln2.mul_f64(x - whole), tables);
    #[expect(clippy::cast_possible_truncation, reason = "an integer below 2^11")]
    let k = k + whole as i64;
    finish(m, k, ERROR).unwrap_or_else(|| exp2_exactly(x))
}

#[cold]
fn exp2_exactly(x: f64) -> Bracket {
    settle(|p| multiprecision::exp(&Ball::from_f64(x).mul(&multiprecision::ln2(p + 64)), p))
}

/// `10^x`.
#[inline(always)]
pub(crate) fn exp10(x: f64) -> Bracket {
    if x.abs() < power(-55) {
        return if x == 0.0 { Bracket::exact(1.0) } else { near_one(x) };
    }
    if x > 308.3 {
        return if x == f64::INFINITY { Bracket::exact(x) } else { TOO_LARGE };
    }
    if x < -324.0 {
        return if x == f64::NEG_INFINITY { Bracket::exact(0.0) } else { TOO_SMALL };
    }
    let whole = nearest(x);
    if whole == x && (0.0..=22.0).contains(&x) {
        // 5^22 < 2^53: every partial product is exact.
        #[expect(clippy::cast_possible_truncation, reason = "an integer of at most 22")]
        return Bracket::exact((0..x as i64).fold(1.0, |product, _| product * 10.0));
    }
    let tables = &TABLES;
    let (m, k) = kernel(tables.ln10.mul_f64(x), tables);
    finish(m, k, ERROR).unwrap_or_else(|| exp10_exactly(x))
}

#[cold]
fn exp10_exactly(x: f64) -> Bracket {
    settle(|p| multiprecision::exp(&Ball::from_f64(x).mul(&multiprecision::ln10(p + 64)), p))
}

/// `sinh x` for 2^-27 < x < 2^-5: `x + x^3/6` in double-double, the rest below 2^-26 relative in double: 2^-76.
#[inline(always)]
pub(super) fn sinh_series(x: f64, tables: &Tables) -> Dd {
    let square = two_product(x, x);
    let z = square.hi;
    let tail = z.mul_add(z.mul_add(z.mul_add(1.0 / 39_916_800.0, 1.0 / 362_880.0), 1.0 / 5040.0), 1.0 / 120.0);
    let cubic = square.mul_f64(x) * tables.sixth;
    cubic.add_f64(z * z * x * tail).add_f64(x)
}

/// `e^x`, `x < 41`, as one double-double.
#[inline(always)]
pub(super) fn growth(x: f64, tables: &Tables) -> Dd {
    let (m, k) = kernel(Dd::from(x), tables);
    m.scale(power_of_two(k))
}

/// `e^a / 2` for `a >= 40`, which is `sinh a` and `cosh a`: `e^-a` is below 2^-115 of `e^a`.
#[inline(always)]
fn half_growth(a: f64, tables: &Tables) -> Option<Bracket> {
    if a < 709.0 {
        let (m, k) = kernel(Dd::from(a), tables);
        finish(m, k - 1, ERROR)
    } else if a > 711.0 {
        Some(if a == f64::INFINITY { Bracket::exact(a) } else { TOO_LARGE })
    } else {
        None
    }
}

/// `sinh x`.
#[inline(always)]
pub(crate) fn sinh(x: f64) -> Bracket {
    let a = x.abs();
    if a < TINY {
        return if x == 0.0 { Bracket::exact(x) } else { Bracket::beyond(x) };
    }
    let tables = &TABLES;
    let positive = if a < SMALL {
        decide(sinh_series(a, tables), HYPERBOLIC_ERROR)
    } else if a < 40.0 {
        let e = growth(a, tables);
        decide((e - Dd::ONE.div(e)).scale(0.5), HYPERBOLIC_ERROR)
    } else {
        half_growth(a, tables)
    };
    let positive = positive.unwrap_or_else(|| hyperbolic_exactly(a, false));
    if x < 0.0 { positive.neg() } else { positive }
}

/// `cosh x`.
#[inline(always)]
pub(crate) fn cosh(x: f64) -> Bracket {
    let a = x.abs();
    if a < TINY {
        return if x == 0.0 { Bracket::exact(1.0) } else { Bracket::beyond(1.0) };
    }
    let tables = &TABLES;
    let found = if a < 40.0 {
        let e = growth(a, tables);
        decide((e + Dd::ONE.div(e)).scale(0.5), 4.0 * ERROR)
    } else {
        half_growth(a, tables)
    };
    found.unwrap_or_else(|| hyperbolic_exactly(a, true))
}

/// `(e^x + e^-x) / 2` with `even`, else `(e^x - e^-x) / 2`.
#[cold]
fn hyperbolic_exactly(x: f64, even: bool) -> Bracket {
    settle(|p| {
        let e = multiprecision::exp(&Ball::from_f64(x), p)?;
        let inverse = Ball::integer(1).div(&e, p)?;
        Some(if even { e.add(&inverse) } else { e.sub(&inverse) }.scale(-1))
    })
}

/// `tanh x`.
#[inline(always)]
pub(crate) fn tanh(x: f64) -> Bracket {
    let a = x.abs();
    if a < TINY {
        return if x == 0.0 { Bracket::exact(x) } else { Bracket::within(x) };
    }
    let tables = &TABLES;
    let positive = if a < SMALL {
        let s = sinh_series(a, tables);
        decide(s.div((s.square() + Dd::ONE).sqrt()), HYPERBOLIC_ERROR)
    } else if a < 19.5 {
        let e = growth(2.0 * a, tables);
        decide((e - Dd::ONE).div(e + Dd::ONE), HYPERBOLIC_ERROR)
    } else {
        // 1 - tanh a < 2 e^-39 < 2^-55.
        Some(if a == f64::INFINITY { Bracket::exact(1.0) } else { Bracket::within(1.0) })
    };
    let positive = positive.unwrap_or_else(|| tanh_exactly(a));
    if x < 0.0 { positive.neg() } else { positive }
}

#[cold]
fn tanh_exactly(x: f64) -> Bracket {
    settle(|p| {
        let e = multiprecision::exp(&Ball::from_f64(2.0 * x), p)?;
        let one = Ball::integer(1);
        e.sub(&one).div(&e.add(&one), p)
    })
}
