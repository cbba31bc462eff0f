//! Sine, cosine and tangent.

use super::ball::Ball;
use super::decide;
use super::double_double::{Dd, two_product, two_sum};
use super::multiprecision::{Bracket, settle, sin_cos};
use super::nearest;
use super::tables::{TABLES, Tables};
use num_bigint::BigInt;
use num_traits::ToPrimitive;

/// Relative error of sine and cosine and, with a quotient more, of the tangent, doubled and more.
const ERROR: f64 = f64::from_bits((1023 - 68) << 52);
const TINY: f64 = f64::from_bits((1023 - 27) << 52);
/// Up to here a count of quarter turns fits 27 bits.
const MODERATE: f64 = 134_217_728.0;

/// `x = k pi/2 + r`, `|r| < 0.7855`, for `|x| <= 2^27`.
///
/// Both products of the first two parts are exact, and each sum has a relative error of 2 u^2; the constant's error,
/// `k 2^-160`, stands against `|r| > 2^-62` (no double is nearer to a multiple of pi/2): 2^-71 relative.
#[inline(always)]
fn reduce(x: f64, tables: &Tables) -> (Dd, i64) {
    let k = nearest(x * tables.quarters_per_radian);
    let [a, b, c] = tables.half_pi;
    let (p, q) = (two_product(k, a), two_product(k, b));
    let r = two_sum(x, -p.hi).add_f64(-p.lo).add_f64(-q.hi).add_f64(-q.lo).add_f64(-(k * c));
    #[expect(clippy::cast_possible_truncation, reason = "an integer below 2^28")]
    let count = k as i64;
    (r, count)
}

/// `sin r` and `cos r`, `|r| < 0.7855`: `r = c + h`, `c = j/64`, `|h| < 2^-7`.
///
/// `h^5/120` (2^-42) and `h^4/24` (2^-32.6) with what follows are evaluated in double: 2^-84 absolute, against a sine of
/// at least 2^-7 where `j > 0`, and below `h^4` relative where `j = 0`: 2^-76 relative.
#[inline(always)]
fn kernel(r: Dd, tables: &Tables) -> (Dd, Dd) {
    let a = r.with_sign(r.hi);
    let j = nearest(a.hi * 64.0);
    let h = a.add_f64(-j / 64.0);
    let square = h.square();
    let z = square.hi;
    let sin_tail = z.mul_add(z.mul_add(1.0 / 362_880.0, -1.0 / 5040.0), 1.0 / 120.0);
    let cos_tail = z.mul_add(z.mul_add(1.0 / 40_320.0, -1.0 / 720.0), 1.0 / 24.0);
    let sin_h = h + (-(square * h * tables.sixth)).add_f64(z * z * h.hi * sin_tail);
    let cos_less_one = square.scale(-0.5).add_f64(z * z * cos_tail);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of at most 51")]
    let (s, c) = tables.sin_cos[j as usize];
    let sin = s + (c * sin_h + s * cos_less_one);
    let cos = c + (c * cos_less_one - s * sin_h);
    (sin.with_sign(r.hi), cos)
}

/// `sin x` and `cos x` for `|x| <= 2^27`.
#[inline(always)]
fn both(x: f64, tables: &Tables) -> (Dd, Dd) {
    let (r, k) = reduce(x, tables);
    let (s, c) = kernel(r, tables);
    match k & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// The number `q` with `q pi/2 <= x < (q + 1) pi/2`; equality only at 0. `None` beyond all integers of 63 bits.
pub(crate) fn quarter_turns(x: f64) -> Option<i64> {
    if x.abs() <= MODERATE {
        // The sign of r is right: its relative error is far below one.
        let (r, k) = reduce(x, &TABLES);
        return Some(if r.hi < 0.0 { k - 1 } else { k });
    }
    if x.abs() > 4.0e18 {
        return None;
    }
    (7..14).find_map(|step| sin_cos(&Ball::from_f64(x), 1 << step)).and_then(|(_, _, q): (_, _, BigInt)| q.to_i64())
}

/// `sin x` for finite `x`.
#[inline(always)]
pub(crate) fn sin(x: f64) -> Bracket {
    if x.abs() < TINY {
        return if x == 0.0 { Bracket::exact(x) } else { Bracket::within(x) };
    }
    let found = if x.abs() <= MODERATE { decide(both(x, &TABLES).0, ERROR) } else { None };
    found.unwrap_or_else(|| exactly(x, |s, _, _| Some(s)))
}

/// `cos x` for finite `x`.
#[inline(always)]
pub(crate) fn cos(x: f64) -> Bracket {
    if x.abs() < TINY {
        return if x == 0.0 { Bracket::exact(1.0) } else { Bracket::within(1.0) };
    }
    let found = if x.abs() <= MODERATE { decide(both(x, &TABLES).1, ERROR) } else { None };
    found.unwrap_or_else(|| exactly(x, |_, c, _| Some(c)))
}

/// `tan x` for finite `x`.
#[inline(always)]
pub(crate) fn tan(x: f64) -> Bracket {
    if x.abs() < TINY {
        return if x == 0.0 { Bracket::exact(x) } else { Bracket::beyond(x) };
    }
    let found = if x.abs() <= MODERATE {
        let (s, c) = both(x, &TABLES);
        decide(s.div(c), ERROR)
    } else {
        None
    };
    found.unwrap_or_else(|| exactly(x, |s, c, p| s.div(&c, p)))
}

#[cold]
fn exactly(x: f64, choose: impl Fn(Ball, Ball, i64) -> Option<Ball>) -> Bracket {
    settle(|p| sin_cos(&Ball::from_f64(x), p).and_then(|(s, c, _)| choose(s, c, p)))
}
