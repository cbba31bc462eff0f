//! Logarithms and inverse hyperbolic functions.

use super::ball::Ball;
use super::double_double::{Dd, two_product, two_sum};
use super::multiprecision::{self, Bracket, settle};
use super::tables::{LOG_FIRST, TABLES, Tables};
use super::{decide, power_of_two, split};
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// Relative error of [`kernel`] and [`log1p`], doubled.
pub(super) const ERROR: f64 = f64::from_bits((1023 - 76) << 52);
/// Relative error of functions that add some double-double operations to these.
pub(crate) const DERIVED_ERROR: f64 = f64::from_bits((1023 - 74) << 52);
/// Below this the second term of the series, at most `x^2 / 2` of the value, is less than half the distance to the
/// neighbouring double.
const TINY: f64 = f64::from_bits((1023 - 27) << 52);
/// From here on `ln 2a` stands for the inverse hyperbolic sine and cosine: the next term, `1 / (4 a^2)`, is below 2^-86
/// of it.
const LARGE: f64 = f64::from_bits((1023 + 40) << 52);

/// `ln(1 + r)`, `|r| < 0.0126`: four terms in double-double, `r^5/5 - ...` (below 2^-27 relative) in double with four
/// roundings that count, tail `r^15/15`: 2^-77.3 relative.
#[inline(always)]
fn near_one(r: Dd, tables: &Tables) -> Dd {
    let z = r.hi;
    let tail = z.mul_add(z.mul_add(-1.0 / 14.0, 1.0 / 13.0), -1.0 / 12.0);
    let tail = z.mul_add(z.mul_add(z.mul_add(tail, 1.0 / 11.0), -1.0 / 10.0), 1.0 / 9.0);
    let tail = z.mul_add(z.mul_add(z.mul_add(z.mul_add(tail, -1.0 / 8.0), 1.0 / 7.0), -1.0 / 6.0), 1.0 / 5.0);
    let square = r.square();
    let cubic = square * r;
    let fourth = square.square();
    let high = (fourth.scale(-0.25)).add_f64(fourth.hi * z * tail);
    r + (square.scale(-0.5) + (cubic * tables.third + high))
}

/// `ln(m 2^e)`, `m.hi` in [0.7, 1.41].
///
/// `m = (1 + r) / c`: the product `m c` is exact but for the low part, so `r` is within 2^-105, and without error where
/// `c = 1`. Elsewhere `|ln c| >= 2^-7` bounds the result from below, and `e ln 2` is never cancelled by more than half:
/// 2^-77.2 relative.
#[inline(always)]
pub(super) fn kernel(m: Dd, e: i64, tables: &Tables) -> Dd {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index from 90 to 181")]
    let index = m.hi.mul_add(128.0, 0.5) as usize;
    let (c, minus_log_c) = tables.log[index - LOG_FIRST];
    let p = two_product(m.hi, c);
    let r = two_sum(p.hi - 1.0, m.lo.mul_add(c, p.lo));
    #[expect(clippy::cast_precision_loss, reason = "an exponent")]
    let scale = e as f64;
    tables.ln2.mul_f64(scale) + (minus_log_c + near_one(r, tables))
}

/// `ln x` for positive finite `x`.
#[inline(always)]
pub(super) fn of_double(x: f64, tables: &Tables) -> Dd {
    let (m, e) = split(x);
    let (m, e) = if m > 1.40625 { (0.5 * m, e + 1) } else { (m, e) };
    kernel(Dd::from(m), e, tables)
}

/// `ln(1 + r)` for `r > -1/2`, `|r| < 2^60`, with the relative error of `r` and [`ERROR`].
#[inline(always)]
pub(super) fn log1p(r: Dd, tables: &Tables) -> Dd {
    if r.hi.abs() < 0.0117 {
        return near_one(r, tables);
    }
    let x = r.add_f64(1.0);
    let (m, e) = split(x.hi);
    let e = if m > 1.40625 { e + 1 } else { e };
    kernel(x.scale(power_of_two(-e)), e, tables)
}

/// The three logarithms, told apart by the factor to the natural one.
#[derive(Clone, Copy)]
enum Base {
    E,
    Two,
    Ten,
}

#[inline(always)]
fn logarithm(x: f64, base: Base) -> Bracket {
    if x == 0.0 {
        return Bracket::exact(f64::NEG_INFINITY);
    }
    if x == f64::INFINITY {
        return Bracket::exact(x);
    }
    if x == 1.0 {
        return Bracket::exact(0.0);
    }
    let tables = &TABLES;
    let natural = of_double(x, tables);
    let value = match base {
        Base::E => natural,
        Base::Two => {
            let (m, e) = split(x);
            if m == 1.0 {
                #[expect(clippy::cast_precision_loss, reason = "an exponent")]
                return Bracket::exact(e as f64);
            }
            natural * tables.log2_e
        }
        Base::Ten => natural * tables.log10_e,
    };
    decide(value, DERIVED_ERROR).unwrap_or_else(|| exactly(x, base))
}

#[cold]
fn exactly(x: f64, base: Base) -> Bracket {
    if matches!(base, Base::Ten) {
        // Powers of ten are the only doubles with a logarithm that is a double: 10^-k is none.
        let mut power = 1.0;
        for k in 0..=22_u8 {
            if power == x {
                return Bracket::exact(f64::from(k));
            }
            power *= 10.0;
        }
    }
    settle(|p| {
        let natural = multiprecision::log(&Ball::from_f64(x), p + 16)?;
        match base {
            Base::E => Some(natural),
            Base::Two => natural.div(&multiprecision::ln2(p + 16), p),
            Base::Ten => natural.div(&multiprecision::ln10(p + 16), p),
        }
    })
}

/// `ln x`, `x >= 0`.
#[inline(always)]
pub(crate) fn log(x: f64) -> Bracket {
    logarithm(x, Base::E)
}

/// The logarithm to base 2, `x >= 0`.
#[inline(always)]
pub(crate) fn log2(x: f64) -> Bracket {
    logarithm(x, Base::Two)
}

/// The logarithm to base 10, `x >= 0`.
#[inline(always)]
pub(crate) fn log10(x: f64) -> Bracket {
    logarithm(x, Base::Ten)
}

/// `arsinh x = ln(1 + x + x^2 / (1 + sqrt(1 + x^2)))`.
#[inline(always)]
pub(crate) fn asinh(x: f64) -> Bracket {
    let a = x.abs();
    if a < TINY {
        return if x == 0.0 { Bracket::exact(x) } else { Bracket::within(x) };
    }
    if a == f64::INFINITY {
        return Bracket::exact(x);
    }
    let tables = &TABLES;
    let value = if a < LARGE {
        let square = two_product(a, a);
        let root = square.add_f64(1.0).sqrt();
        log1p(square.div(root.add_f64(1.0)).add_f64(a), tables)
    } else {
        // ln(2a) + 1/(4 a^2) - ..., the second term below 2^-86 of the first.
        of_double(a, tables) + tables.ln2
    };
    let positive = decide(value, DERIVED_ERROR).unwrap_or_else(|| asinh_exactly(a));
    if x < 0.0 { positive.neg() } else { positive }
}

#[cold]
fn asinh_exactly(x: f64) -> Bracket {
    settle(|p| {
        let x = Ball::from_f64(x);
        let root = x.mul(&x).add(&Ball::integer(1)).sqrt(p + 64)?;
        multiprecision::log(&x.add(&root), p)
    })
}

/// `arcosh x = ln(1 + t + sqrt(t (t + 2)))`, `t = x - 1 >= 0`.
#[inline(always)]
pub(crate) fn acosh(x: f64) -> Bracket {
    if x == 1.0 {
        return Bracket::exact(0.0);
    }
    if x == f64::INFINITY {
        return Bracket::exact(x);
    }
    let tables = &TABLES;
    let value = if x < LARGE {
        let t = two_sum(x, -1.0);
        log1p(t + (t * t.add_f64(2.0)).sqrt(), tables)
    } else {
        of_double(x, tables) + tables.ln2
    };
    decide(value, DERIVED_ERROR).unwrap_or_else(|| acosh_exactly(x))
}

#[cold]
fn acosh_exactly(x: f64) -> Bracket {
    settle(|p| {
        let x = Ball::from_f64(x);
        let root = x.mul(&x).sub(&Ball::integer(1)).sqrt(p + 64)?;
        multiprecision::log(&x.add(&root), p)
    })
}

/// `artanh x = ln(1 + 2x / (1 - x)) / 2`, `|x| <= 1`.
#[inline(always)]
pub(crate) fn atanh(x: f64) -> Bracket {
    let a = x.abs();
    if a < TINY {
        return if x == 0.0 { Bracket::exact(x) } else { Bracket::beyond(x) };
    }
    if a == 1.0 {
        return Bracket::exact(if x > 0.0 { f64::INFINITY } else { f64::NEG_INFINITY });
    }
    let ratio = Dd::from(2.0 * a).div(two_sum(1.0, -a));
    let positive = decide(log1p(ratio, &TABLES).scale(0.5), DERIVED_ERROR).unwrap_or_else(|| atanh_exactly(a));
    if x < 0.0 { positive.neg() } else { positive }
}

#[cold]
fn atanh_exactly(x: f64) -> Bracket {
    settle(|p| {
        let (x, one) = (Ball::from_f64(x), Ball::integer(1));
        Some(multiprecision::log(&one.add(&x).div(&one.sub(&x), p + 64)?, p)?.scale(-1))
    })
}
