//! Powers with integer and with real exponents.

use super::ball::Ball;
use super::double_double::Dd;
use super::multiprecision::{self, Bracket, settle};
use super::tables::TABLES;
use super::{decide, exponential, logarithm, split};
use crate::doubles::Neighbours as _;
use crate::dyadic::decode;
use crate::integers::Integer;
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// Relative error of a product of at most 64 factors: `64 * 6 u^2` is far below it.
const PRODUCT_ERROR: f64 = f64::from_bits((1023 - 90) << 52);
/// If `|y ln x|` is below this, `x^y` lies between 1 and its neighbour.
const NEXT_TO_ONE: f64 = f64::from_bits((1023 - 55) << 52);

/// `x^n` for finite `x`, not zero for negative `n`.
#[inline(always)]
pub(crate) fn pown(x: f64, n: i32) -> Bracket {
    let a = x.abs();
    let positive = power_of_magnitude(a, n);
    if x < 0.0 && n % 2 != 0 { positive.neg() } else { positive }
}

#[inline(always)]
fn power_of_magnitude(a: f64, n: i32) -> Bracket {
    if n == 0 {
        return Bracket::exact(1.0);
    }
    if n == 1 || a == 0.0 || a == 1.0 {
        return Bracket::exact(a);
    }
    let count = n.unsigned_abs();
    if count > 64 {
        return pow(a, f64::from(n));
    }
    let (m, e) = split(a);
    let mut product = Dd::ONE;
    let mut square = Dd::from(m);
    let mut rest = count;
    loop {
        if rest % 2 == 1 {
            product = product * square;
        }
        rest /= 2;
        if rest == 0 {
            break;
        }
        square = square.square();
    }
    let value = if n < 0 { Dd::ONE.div(product) } else { product };
    let k = e * i64::from(n);
    // Few digits: every product so far was exact. The power of 2 alone has a reciprocal that is a double.
    let digits = 53 - ((m.to_bits() & ((1 << 52) - 1)) | (1 << 52)).trailing_zeros();
    if digits * count <= 53 && (n > 0 || digits == 1) && (-900..900).contains(&k) {
        return Bracket::exact(value.hi).scale(k);
    }
    // |log2 value| <= 64.
    let bracket = if (-900..900).contains(&k) { decide(value, PRODUCT_ERROR).map(|b| b.scale(k)) } else { None };
    bracket.unwrap_or_else(|| integer_exactly(a, n.into()))
}

/// `a^n`, exact where that is a double.
#[cold]
fn integer_exactly(a: f64, n: i64) -> Bracket {
    let (mantissa, exponent) = decode(a);
    if mantissa == 1 {
        // A power of two, also for negative n.
        let whole = Ball::exact(Integer::from(1_u64), exponent.saturating_mul(n).clamp(-5000, 5000));
        let (down, up) = whole.outward();
        return Bracket { down, up };
    }
    settle(|p| {
        let power = multiprecision::power(&Ball::from_f64(a), n.unsigned_abs(), p);
        if n < 0 { Ball::integer(1).div(&power, p) } else { Some(power) }
    })
}

/// `x^y` for `x > 0`, both finite.
#[inline(always)]
pub(crate) fn pow(x: f64, y: f64) -> Bracket {
    if x == 1.0 || y == 0.0 {
        return Bracket::exact(1.0);
    }
    if y == 1.0 {
        return Bracket::exact(x);
    }
    let tables = &TABLES;
    let log = logarithm::of_double(x, tables);
    let size = log.hi * y;
    if size > 710.0 {
        return Bracket { down: f64::MAX, up: f64::INFINITY };
    }
    if size < -746.0 {
        return Bracket { down: 0.0, up: f64::from_bits(1) };
    }
    if size.abs() < NEXT_TO_ONE {
        return if size > 0.0 || (size == 0.0 && (x > 1.0) == (y > 0.0)) {
            Bracket::beyond(1.0)
        } else {
            Bracket::within(1.0)
        };
    }
    let (m, k) = exponential::kernel(log.mul_f64(y), tables);
    // The error of the exponent is the relative error of the power.
    let error = size.abs().mul_add(2.0 * logarithm::ERROR, exponential::ERROR);
    exponential::finish(m, k, error).unwrap_or_else(|| real_exactly(x, y))
}

/// `x^y`, exact where that is a double: for `y = n 2^-k` only where `x` is a `2^k`-th power.
#[cold]
fn real_exactly(x: f64, y: f64) -> Bracket {
    let (n, shift) = decode(y);
    if shift >= 0 {
        // Larger exponents give no double but 0 and 1: the mantissa of x^y has at least |y| bits.
        if y.abs() < 1_048_576.0 {
            return integer_exactly(x, n << shift);
        }
    } else if let Some(root) = exact_root(x, -shift) {
        return integer_exactly_of(root, n);
    }
    settle(|p| multiprecision::exp(&multiprecision::log(&Ball::from_f64(x), p + 64)?.mul(&Ball::from_f64(y)), p))
}

/// As [`integer_exactly`] for a small exact base.
fn integer_exactly_of(root: f64, n: i64) -> Bracket {
    if n.unsigned_abs() < 1 << 20 {
        integer_exactly(root, n)
    } else {
        // |n ln root| <= 746, so only a base within 2^-10 of 1 comes here.
        let n = Ball::integer(n);
        settle(|p| multiprecision::exp(&multiprecision::log(&Ball::from_f64(root), p + 64)?.mul(&n), p))
    }
}

/// The `2^k`-th root of `x` where it is a double.
fn exact_root(x: f64, k: i64) -> Option<f64> {
    let (mantissa, exponent) = decode(x);
    let (mut m, mut e) = (mantissa.unsigned_abs(), exponent);
    for _ in 0..k {
        let root = m.isqrt();
        if root * root != m || e % 2 != 0 {
            return None;
        }
        m = root;
        e /= 2;
        if m == 1 && e == 0 {
            return None;
        }
    }
    let root = Ball::exact(Integer::from(m), e);
    Some(root.outward().0)
}

/// `v^(1/y)` for finite positive `v` and finite `y`, not zero.
pub(crate) fn root(v: f64, y: f64) -> Bracket {
    if v == 1.0 || y == 1.0 {
        return Bracket::exact(v);
    }
    let tables = &TABLES;
    let log = logarithm::of_double(v, tables);
    // In plain doubles first: the double-double quotient is not a number where it overflows.
    let size = log.hi / y;
    if size > 710.0 {
        return Bracket { down: f64::MAX, up: f64::INFINITY };
    }
    if size < -746.0 {
        return Bracket { down: 0.0, up: f64::from_bits(1) };
    }
    if size.abs() < NEXT_TO_ONE {
        return if (v > 1.0) == (y > 0.0) { Bracket::beyond(1.0) } else { Bracket::within(1.0) };
    }
    let (m, k) = exponential::kernel(log.div(Dd::from(y)), tables);
    let error = size.abs().mul_add(2.0 * logarithm::ERROR, exponential::ERROR);
    exponential::finish(m, k, error).unwrap_or_else(|| {
        exactly_or(
            |p| {
                multiprecision::exp(
                    &multiprecision::log(&Ball::from_f64(v), p + 64)?.div(&Ball::from_f64(y), p + 64)?,
                    p,
                )
            },
            |candidate| candidate > 0.0 && pow(candidate, y) == Bracket::exact(v),
        )
    })
}

/// `ln v / ln b` for finite positive arguments other than `b = 1`.
pub(crate) fn log_ratio(v: f64, b: f64) -> Bracket {
    if v == 1.0 || v == b {
        return Bracket::exact(if v == b { 1.0 } else { 0.0 });
    }
    let tables = &TABLES;
    let ratio = logarithm::of_double(v, tables).div(logarithm::of_double(b, tables));
    decide(ratio, 8.0 * logarithm::ERROR).unwrap_or_else(|| {
        exactly_or(
            |p| multiprecision::log(&Ball::from_f64(v), p)?.div(&multiprecision::log(&Ball::from_f64(b), p)?, p),
            |candidate| pow(b, candidate) == Bracket::exact(v),
        )
    })
}

/// The roundings of the value that `evaluate` computes, or the double that `is_exact` confirms it to be.
#[cold]
fn exactly_or(evaluate: impl Fn(i64) -> Option<Ball>, is_exact: impl Fn(f64) -> bool) -> Bracket {
    if let Some(ball) = evaluate(192) {
        if let Some((down, up)) = ball.bracket() {
            return Bracket { down, up };
        }
        let near = ball.approximate();
        if let Some(exact) = [near, near.above(), near.below()].into_iter().find(|&x| x.is_finite() && is_exact(x)) {
            return Bracket::exact(exact);
        }
    }
    settle(evaluate)
}
