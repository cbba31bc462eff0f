//! Logarithms of one plus a number, to the same relative error where it is small.

use super::ball::Ball;
use super::double_double::{Dd, two_sum};
use super::less_one::logarithm_of_two;
use super::logarithm;
use super::multiprecision::{self, Bracket, settle};
use super::tables::{TABLES, Tables};
use super::{decide, power_of_two, split};

/// Relative error of [`ln_1p_of`] and of a product with a constant, doubled and more.
pub(super) const ERROR: f64 = f64::from_bits((1023 - 74) << 52);
/// Below this the second term of the series, at most `x` of the value, is less than half the distance to the
/// neighbouring double.
const TINY: f64 = f64::from_bits((1023 - 54) << 52);
/// Below this an error term of a double-double may be subnormal.
const SUBNORMAL: f64 = f64::from_bits((1023 - 900) << 52);

/// `ln(1 + x)` for finite `x > -1`.
#[inline(always)]
pub(super) fn ln_1p_of(x: f64, tables: &Tables) -> Dd {
    if x <= -0.5 {
        // The sum is exact (Sterbenz).
        logarithm::of_double(1.0 + x, tables)
    } else if x < power_of_two(59) {
        logarithm::log1p(Dd::from(x), tables)
    } else {
        // The next term, 1 / (2 x^2), is below 2^-119.
        logarithm::of_double(x, tables).add_f64(1.0 / x)
    }
}

/// The value at the ends of the domain, and where it is 0.
#[inline(always)]
fn at_an_end(x: f64) -> Option<Bracket> {
    if x == -1.0 {
        Some(Bracket::exact(f64::NEG_INFINITY))
    } else if x == 0.0 || x == f64::INFINITY {
        Some(Bracket::exact(x))
    } else {
        None
    }
}

/// `ln(1 + x)`, `x >= -1`.
#[inline(always)]
pub(crate) fn ln_1p(x: f64) -> Bracket {
    if let Some(end) = at_an_end(x) {
        return end;
    }
    if x.abs() < TINY {
        // x - x^2/2: towards zero for positive x, away from it for negative x.
        return if x > 0.0 { Bracket::within(x) } else { Bracket::beyond(x) };
    }
    decide(ln_1p_of(x, &TABLES), ERROR).unwrap_or_else(|| settle(|p| multiprecision::ln_1p(&Ball::from_f64(x), p)))
}

/// The logarithm of `1 + x` to base 2, `x >= -1`.
#[inline(always)]
pub(crate) fn log2_1p(x: f64) -> Bracket {
    if let Some(end) = at_an_end(x) {
        return end;
    }
    if let Some(exact) = logarithm_of_two(x) {
        return Bracket::exact(exact);
    }
    if x >= power_of_two(60) {
        let (m, e) = split(x);
        if m == 1.0 {
            // e + 1 / (x ln 2)
            #[expect(clippy::cast_precision_loss, reason = "an exponent")]
            return Bracket::beyond(e as f64);
        }
    }
    let tables = &TABLES;
    let found = if x.abs() < SUBNORMAL { None } else { decide(ln_1p_of(x, tables) * tables.log2_e, ERROR) };
    found.unwrap_or_else(|| {
        settle(|p| multiprecision::ln_1p(&Ball::from_f64(x), p + 16)?.div(&multiprecision::ln2(p + 16), p))
    })
}

/// The logarithm of `1 + x` to base 10, `x >= -1`.
#[inline(always)]
pub(crate) fn log10_1p(x: f64) -> Bracket {
    if let Some(end) = at_an_end(x) {
        return end;
    }
    let tables = &TABLES;
    let found = if x.abs() < SUBNORMAL { None } else { decide(ln_1p_of(x, tables) * tables.log10_e, ERROR) };
    found.unwrap_or_else(|| {
        if let Some(exact) = logarithm_of_ten(x) {
            return Bracket::exact(exact);
        }
        settle(|p| multiprecision::ln_1p(&Ball::from_f64(x), p + 16)?.div(&multiprecision::ln10(p + 16), p))
    })
}

/// `x` is a power of ten less one: `10^15 - 1` is the last that is a double, and `10^-k - 1` is none.
fn logarithm_of_ten(x: f64) -> Option<f64> {
    let sum = two_sum(1.0, x);
    let mut power = 1.0;
    (0..=15_u8).find_map(|k| {
        let found = sum.lo == 0.0 && sum.hi == power;
        power *= 10.0;
        found.then(|| f64::from(k))
    })
}
