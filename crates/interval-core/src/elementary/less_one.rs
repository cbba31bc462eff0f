//! Exponentials less one, to the same relative error where they are small: `e^x - 1`, `2^x - 1`, `10^x - 1`,
//! `(1 + x)^y - 1`.

use super::ball::Ball;
use super::double_double::Dd;
use super::exponential::{self, TOO_LARGE, finish, kernel};
use super::multiprecision::{self, Bracket, settle};
use super::plus_one::{self, ln_1p_of};
use super::tables::{TABLES, Tables};
use super::{decide, power_of_two, split};
use crate::integers::Integer;
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// Relative error of [`of_double_double`]: 2^-68 from the cancellation of five bits at 2^-5, and more than twice that.
const ERROR: f64 = f64::from_bits((1023 - 66) << 52);
/// Below this the series is used, above it the exponential, whose difference to 1 cancels.
const SMALL: f64 = f64::from_bits((1023 - 5) << 52);
/// Below this the second term of the series, at most `x^2` of the value, is less than half the distance to the
/// neighbouring double.
const TINY: f64 = f64::from_bits((1023 - 54) << 52);
/// Below this an error term of a double-double may be subnormal.
const SUBNORMAL: f64 = f64::from_bits((1023 - 900) << 52);
/// Below this `e^v - 1` lies between -1 and its neighbour: `e^-38` is below 2^-54.
const NEXT_TO_MINUS_ONE: f64 = -38.0;

/// `e^v - 1` for `2^-900 <= |v| < 2^-5`: three terms in double-double, `v^4/24 + ...` (2^-19.6 relative) in double with
/// at most four roundings, tail `v^10/11!` relative: 2^-70.
#[inline(always)]
fn series(v: Dd, tables: &Tables) -> Dd {
    let z = v.hi;
    let tail = z.mul_add(z.mul_add(1.0 / 3_628_800.0, 1.0 / 362_880.0), 1.0 / 40_320.0);
    let tail = z.mul_add(z.mul_add(z.mul_add(z.mul_add(tail, 1.0 / 5040.0), 1.0 / 720.0), 1.0 / 120.0), 1.0 / 24.0);
    let square = v.square();
    let cubic = square * v * tables.sixth;
    v + (square.scale(0.5) + cubic.add_f64(square.hi * square.hi * tail))
}

/// `e^v - 1` for `2^-900 <= |v|`, `v` up to 1100, with what the relative error of `v` adds to [`ERROR`].
#[inline(always)]
fn of_double_double(v: Dd, error: f64, tables: &Tables) -> Option<Bracket> {
    if v.hi < NEXT_TO_MINUS_ONE {
        return Some(Bracket::within(-1.0));
    }
    if v.hi.abs() < SMALL {
        return decide(series(v, tables), ERROR + 2.0 * error);
    }
    let (m, k) = kernel(v, tables);
    // A relative error of v grows by v e^v / (e^v - 1), which is at most |v| + 1.
    let error = (v.hi.abs() + 1.0).mul_add(error, ERROR);
    if k < 1000 { decide(m.scale(power_of_two(k)).add_f64(-1.0), error) } else { finish(m, k, error) }
}

/// `2^k - 1` or `10^k - 1` where `power` is that power of an integer `k >= 0`, exactly.
fn whole(power: f64) -> Bracket {
    let less = power - 1.0;
    // From 2^53 on the predecessor of an even number is none.
    if power <= 9_007_199_254_740_992.0 { Bracket::exact(less) } else { Bracket::within(power) }
}

/// `e^x - 1`.
#[inline(always)]
pub(crate) fn exp_m1(x: f64) -> Bracket {
    if x.abs() < TINY {
        // x + x^2/2: away from zero for positive x, towards it for negative x.
        return match x.partial_cmp(&0.0) {
            Some(core::cmp::Ordering::Greater) => Bracket::beyond(x),
            Some(core::cmp::Ordering::Less) => Bracket::within(x),
            _ => Bracket::exact(x),
        };
    }
    if x > exponential::OVERFLOW {
        return if x == f64::INFINITY { Bracket::exact(x) } else { TOO_LARGE };
    }
    if x == f64::NEG_INFINITY {
        return Bracket::exact(-1.0);
    }
    of_double_double(Dd::from(x), 0.0, &TABLES)
        .unwrap_or_else(|| settle(|p| multiprecision::exp_m1(&Ball::from_f64(x), p)))
}

/// `2^x - 1`.
#[inline(always)]
pub(crate) fn exp2_m1(x: f64) -> Bracket {
    if x >= 1024.0 {
        return if x == f64::INFINITY { Bracket::exact(x) } else { TOO_LARGE };
    }
    if x < -54.0 {
        return if x == f64::NEG_INFINITY { Bracket::exact(-1.0) } else { Bracket::within(-1.0) };
    }
    if x.fract() == 0.0 {
        #[expect(clippy::cast_possible_truncation, reason = "an integer below 2^11")]
        let power = power_of_two(x as i64);
        // 1 - 2^-54 is no double, 1 - 2^-53 is.
        return if x == -54.0 { Bracket::within(-1.0) } else { whole(power) };
    }
    let tables = &TABLES;
    let found =
        if x.abs() < SUBNORMAL { None } else { of_double_double(tables.ln2.mul_f64(x), power_of_two(-100), tables) };
    found.unwrap_or_else(|| settle(|p| multiprecision::exp_m1(&Ball::from_f64(x).mul(&multiprecision::ln2(p + 64)), p)))
}

/// `10^x - 1`.
#[inline(always)]
pub(crate) fn exp10_m1(x: f64) -> Bracket {
    if x > 308.3 {
        return if x == f64::INFINITY { Bracket::exact(x) } else { TOO_LARGE };
    }
    if x < -17.0 {
        return if x == f64::NEG_INFINITY { Bracket::exact(-1.0) } else { Bracket::within(-1.0) };
    }
    if x.fract() == 0.0 && (0.0..=22.0).contains(&x) {
        // 5^22 < 2^53: every partial product is exact.
        #[expect(clippy::cast_possible_truncation, reason = "an integer of at most 22")]
        return whole((0..x as i64).fold(1.0, |product, _| product * 10.0));
    }
    let tables = &TABLES;
    let found =
        if x.abs() < SUBNORMAL { None } else { of_double_double(tables.ln10.mul_f64(x), power_of_two(-100), tables) };
    found
        .unwrap_or_else(|| settle(|p| multiprecision::exp_m1(&Ball::from_f64(x).mul(&multiprecision::ln10(p + 64)), p)))
}

/// `(1 + x)^y - 1` for finite `x > -1` and finite `y`.
pub(crate) fn compound_m1(x: f64, y: f64) -> Bracket {
    if x == 0.0 || y == 0.0 {
        return Bracket::exact(0.0);
    }
    if y == 1.0 {
        return Bracket::exact(x);
    }
    let tables = &TABLES;
    let log = ln_1p_of(x, tables);
    // In plain doubles first: the double-double product is not a number where it overflows.
    let size = log.hi * y;
    if size > 710.0 {
        return TOO_LARGE;
    }
    if size < NEXT_TO_MINUS_ONE {
        return Bracket::within(-1.0);
    }
    let found = if size.abs() < SUBNORMAL || x.abs() < SUBNORMAL {
        None
    } else {
        of_double_double(log.mul_f64(y), plus_one::ERROR, tables)
    };
    found.unwrap_or_else(|| compound_exactly(x, y))
}

#[cold]
fn compound_exactly(x: f64, y: f64) -> Bracket {
    if let Some(ball) = compound_of_a_root(x, y).and_then(|value| value.bracket()) {
        return Bracket { down: ball.0, up: ball.1 };
    }
    settle(|p| {
        let log = multiprecision::ln_1p(&Ball::from_f64(x), p + 64)?;
        multiprecision::exp_m1(&log.mul(&Ball::from_f64(y)).shorten(p + 64), p)
    })
}

/// `(1 + x)^y - 1` where it is a dyadic number: `y = n / 2^j` and `1 + x` the `2^j`-th power of one, a power of two where
/// `n < 0`. All other values are irrational, or no dyadic numbers, and so no doubles.
fn compound_of_a_root(x: f64, y: f64) -> Option<Ball> {
    let base = Ball::from_f64(x).add(&Ball::integer(1));
    let zeros = i64::try_from(base.mid.trailing_zeros()?).ok()?;
    let (mut m, mut e) = (&base.mid >> zeros.unsigned_abs(), base.exp + zeros);
    let (numerator, exponent) = crate::dyadic::decode(y);
    let mut n = numerator;
    for _ in 0..(-exponent).max(0) {
        let root = m.sqrt();
        if &root * &root != m || e % 2 != 0 || (m.is_one() && e == 0) {
            return None;
        }
        (m, e) = (root, e / 2);
    }
    for _ in 0..exponent.max(0) {
        n = n.checked_mul(2)?;
    }
    if n < 0 && !m.is_one() {
        return None;
    }
    let count = n.unsigned_abs();
    // More bits than any double's value less one needs: it is odd, and its digits are not few.
    if i64::try_from(m.bits()).ok()?.checked_mul(i64::try_from(count).ok()?)? > MOST_BITS {
        return None;
    }
    let power = if m.is_one() { Integer::from(1_u64) } else { m.pow(u32::try_from(count).ok()?) };
    Some(Ball::exact(power, e.checked_mul(n)?).sub(&Ball::integer(1)))
}

/// Bits of an odd power from which on its value less one is no double: it has more than 53 bits whatever cancels.
const MOST_BITS: i64 = 1 << 18;

/// `x` is a power of two less one.
pub(super) fn logarithm_of_two(x: f64) -> Option<f64> {
    let sum = super::two_sum(1.0, x);
    let (m, e) = split(sum.hi);
    #[expect(clippy::cast_precision_loss, reason = "an exponent")]
    (sum.lo == 0.0 && m == 1.0).then_some(e as f64)
}
