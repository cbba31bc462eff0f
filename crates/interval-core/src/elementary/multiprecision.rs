//! Elementary functions on balls with a stated number of bits. The radius holds every truncation.
//!
//! Each function reduces its argument to where a Taylor series needs few terms, and adds a bound of the series' tail.
//! A result may carry fewer correct bits than asked where the argument cancels; [`settle`] then asks for more.

use super::ball::Ball;
use crate::integers::Integer;

/// Directed roundings of one real number: the largest double not above it and the smallest not below it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bracket {
    pub down: f64,
    pub up: f64,
}

/// Evaluates with more and more bits until both roundings are known.
///
/// An exact result is a ball without radius and settles at once; the callers handle the arguments at which a
/// transcendental function takes a double's value, so that the loop ends (Lindemann). Should it ever not, the result
/// still encloses.
pub(crate) fn settle(evaluate: impl Fn(i64) -> Option<Ball>) -> Bracket {
    let mut best = Bracket { down: f64::NEG_INFINITY, up: f64::INFINITY };
    for step in 0..9 {
        let Some(ball) = evaluate(128 << step) else { continue };
        if let Some((down, up)) = ball.bracket() {
            return Bracket { down, up };
        }
        let (down, up) = ball.outward();
        best = Bracket { down: best.down.max(down), up: best.up.min(up) };
    }
    best
}

/// A ball of radius one unit of the last of `precision` bits times `scale`.
fn unit(exponent: i64) -> Ball {
    Ball { mid: Integer::ZERO, rad: Integer::from(1_u64), exp: exponent }
}

/// `sum 1 / ((2k + 1) n^(2k + 1))`, alternating for the arctangent of `1/n`, plain for its hyperbolic sister.
fn inverse_series(n: u64, alternating: bool, precision: i64) -> Ball {
    let guard = precision + 16;
    let mut power = (Integer::from(1_u64) << guard.unsigned_abs()).divided(n);
    let mut sum = Integer::ZERO;
    let mut k = 0_u64;
    while !power.is_zero() {
        let term = power.divided(2 * k + 1);
        if alternating && k % 2 == 1 {
            sum = &sum - &term;
        } else {
            sum = &sum + &term;
        }
        power = power.divided(n * n);
        k += 1;
    }
    // Two truncations a term, and a tail below one unit.
    Ball { mid: sum, rad: Integer::from(2 * k + 2), exp: -guard }
}

/// Bits of the pi that is kept: enough to reduce every double.
const KEPT: i64 = 1536;

/// Pi.
pub(crate) fn pi(precision: i64) -> Ball {
    if precision > KEPT {
        return machin(precision);
    }
    #[cfg(feature = "std")]
    let kept = {
        static PI: std::sync::LazyLock<Ball> = std::sync::LazyLock::new(|| machin(KEPT + 16));
        PI.clone()
    };
    #[cfg(not(feature = "std"))]
    let kept = machin(KEPT + 16);
    kept.shorten(precision + 16)
}

/// Pi by two series (Machin 1706).
fn machin(precision: i64) -> Ball {
    let (a, b) = (inverse_series(5, true, precision + 8), inverse_series(239, true, precision + 8));
    a.scale(4).sub(&b.scale(2))
}

/// The natural logarithm of 2.
pub(crate) fn ln2(precision: i64) -> Ball {
    inverse_series(3, false, precision + 4).scale(1)
}

/// The natural logarithm of 10.
pub(crate) fn ln10(precision: i64) -> Ball {
    // 10 = 2^3 * 5/4 and ln(5/4) = 2 artanh(1/9).
    ln2(precision + 8).mul(&Ball::integer(3)).add(&inverse_series(9, false, precision + 8).scale(1))
}

/// `x - k c`, for the integer `k` nearest to `x / c`, and `k`.
fn reduce(x: &Ball, constant: impl Fn(i64) -> Ball, precision: i64) -> Option<(Ball, Integer)> {
    let size = i64::try_from(x.mid.bits()).ok()? + x.exp;
    let bits = precision + size.max(0) + 16;
    let c = constant(bits);
    let k = x.div(&c, size.max(0) + 64)?.nearby_integer();
    Some((x.sub(&c.mul(&Ball::exact(k.clone(), 0))), k))
}

/// The sum of `x^first`, then each term the last times `x^2 / divisor(k)`, `k = 1, 2, ...`, until it is negligible.
/// The terms fall at least by half, so the tail is below the last one.
fn series(first: Ball, factor: &Ball, divisor: impl Fn(u64) -> u64, precision: i64) -> Ball {
    let mut term = first;
    let mut sum = term.clone();
    for k in 1.. {
        term = term.mul(factor).div_integer(divisor(k)).shorten(precision);
        sum = sum.add(&term).shorten(precision + 16);
        let size = i64::try_from(term.mid.bits().max(term.rad.bits())).unwrap_or(0) + term.exp;
        let whole = i64::try_from(sum.mid.bits()).unwrap_or(0) + sum.exp;
        if term.mid.is_zero() || size < whole - precision {
            return sum.add(&unit(size + 1));
        }
    }
    sum
}

/// `e^x`.
pub(crate) fn exp(x: &Ball, precision: i64) -> Option<Ball> {
    let guard = precision + 32;
    let (r, k) = reduce(x, ln2, guard)?;
    let halvings = 8;
    let r = r.shorten(guard + 64).scale(-halvings);
    let mut y = series(Ball::integer(1), &r, |k| k, guard);
    for _ in 0..halvings {
        y = y.mul(&y).shorten(guard);
    }
    Some(y.scale(k.to_i64()?))
}

/// `ln x` for `x > 0`.
pub(crate) fn log(x: &Ball, precision: i64) -> Option<Ball> {
    if x.sign() <= 0 {
        return None;
    }
    let guard = precision + 32;
    let size = i64::try_from(x.mid.bits()).ok()? + x.exp;
    let m = x.clone().scale(-size);
    // m in [1/2, 1): doubled where it is below 0.7, so that ln m never cancels k ln 2.
    let (m, k) = if m.approximate() < 0.7 { (m.scale(1), size - 1) } else { (m, size) };
    let one = Ball::integer(1);
    let z = m.sub(&one).div(&m.add(&one), guard + 16)?;
    // ln m = 2 artanh z, |z| < 0.18.
    let result = artanh(&z, guard)?.scale(1);
    Some(if k == 0 { result } else { result.add(&ln2(guard + 16).mul(&Ball::integer(k))) }.shorten(guard))
}

/// The inverse hyperbolic tangent of `|z| < 0.6`: the powers are summed with their divisors apart.
pub(crate) fn artanh(z: &Ball, guard: i64) -> Option<Ball> {
    let square = z.mul(z).shorten(guard + 16);
    let mut power = z.clone();
    let mut sum = z.clone();
    if z.mid.is_zero() && z.is_exact() {
        return Some(sum);
    }
    for n in 1.. {
        power = power.mul(&square).shorten(guard + 16);
        sum = sum.add(&power.div_integer(2 * n + 1)).shorten(guard + 32);
        let size = i64::try_from(power.mid.bits().max(power.rad.bits())).ok()? + power.exp;
        let whole = i64::try_from(sum.mid.bits()).ok()? + sum.exp;
        if power.mid.is_zero() || size < whole - guard {
            // The powers fall by more than half, so the tail is below the last one.
            return Some(sum.add(&unit(size + 1)));
        }
    }
    None
}

/// `e^x - 1`, without cancellation near 0.
pub(crate) fn exp_m1(x: &Ball, precision: i64) -> Option<Ball> {
    if x.approximate().abs() > 0.25 {
        return Some(exp(x, precision + 8)?.sub(&Ball::integer(1)));
    }
    let x = x.clone().shorten(precision + 96);
    Some(if x.mid.is_zero() && x.is_exact() { x } else { series(x.clone(), &x, |k| k + 1, precision + 32) })
}

/// `ln(1 + x)` for `x > -1`, without cancellation near 0.
pub(crate) fn ln_1p(x: &Ball, precision: i64) -> Option<Ball> {
    let one = Ball::integer(1);
    if x.approximate().abs() > 0.25 {
        return log(&x.add(&one), precision);
    }
    // ln(1 + x) = 2 artanh(x / (2 + x))
    let z = x.div(&x.add(&one.scale(1)), precision + 96)?;
    Some(artanh(&z, precision + 32)?.scale(1))
}

/// `sin x`, `cos x`, and the number `q` of the quarter turn below `x`: `q pi/2 <= x < (q + 1) pi/2`.
pub(crate) fn sin_cos(x: &Ball, precision: i64) -> Option<(Ball, Ball, Integer)> {
    let guard = precision + 32;
    let half_pi = |bits: i64| pi(bits + 2).scale(-1);
    let (r, k) = reduce(x, half_pi, guard)?;
    let r = r.shorten(guard + 64);
    let square = r.mul(&r).neg().shorten(guard + 16);
    let (sin, cos) = if r.mid.is_zero() && r.is_exact() {
        (r.clone(), Ball::integer(1))
    } else {
        (
            series(r.clone(), &square, |k| 2 * k * (2 * k + 1), guard),
            series(Ball::integer(1), &square, |k| (2 * k - 1) * (2 * k), guard),
        )
    };
    let below = match r.sign() {
        1 => k.clone(),
        -1 => &k - &Integer::from(1_u64),
        _ if r.is_exact() => k.clone(),
        _ => return None,
    };
    let (sin, cos) = match k.modulo(4) {
        0 => (sin, cos),
        1 => (cos, sin.neg()),
        2 => (sin.neg(), cos.neg()),
        _ => (cos.neg(), sin),
    };
    Some((sin, cos, below))
}

/// The arctangent.
pub(crate) fn atan(x: &Ball, precision: i64) -> Option<Ball> {
    let guard = precision + 32;
    if x.mid.is_zero() && x.is_exact() {
        return Some(x.clone());
    }
    let one = Ball::integer(1);
    let large = x.approximate().abs() > 1.0;
    let mut t = if large { one.div(x, guard)? } else { x.clone() };
    for _ in 0..3 {
        let root = one.add(&t.mul(&t)).shorten(guard + 16).sqrt(guard + 16)?;
        t = t.div(&one.add(&root), guard + 16)?.shorten(guard + 32);
    }
    let square = t.mul(&t).neg().shorten(guard + 16);
    let mut power = t.clone();
    let mut sum = t;
    for n in 1.. {
        power = power.mul(&square).shorten(guard + 16);
        sum = sum.add(&power.div_integer(2 * n + 1)).shorten(guard + 32);
        let size = i64::try_from(power.mid.bits().max(power.rad.bits())).ok()? + power.exp;
        let whole = i64::try_from(sum.mid.bits()).ok()? + sum.exp;
        if power.mid.is_zero() || size < whole - guard {
            sum = sum.add(&unit(size + 1));
            break;
        }
    }
    let angle = sum.scale(3);
    if !large {
        return Some(angle);
    }
    let quarter = pi(guard + 16).scale(-1);
    Some(if x.mid.is_negative() { quarter.neg() } else { quarter }.sub(&angle))
}

/// The angle of the point `(x, y)`, for `x` and `y` not both zero.
pub(crate) fn atan2(y: &Ball, x: &Ball, precision: i64) -> Option<Ball> {
    let guard = precision + 8;
    let half_turn = pi(guard + 16);
    let half_turn = if y.sign() < 0 { half_turn.neg() } else { half_turn };
    if x.sign() == 0 {
        debug_assert!(x.mid.is_zero() && x.is_exact(), "the callers' coordinates have a sign");
        return Some(half_turn.scale(-1));
    }
    let angle = atan(&y.div(x, guard + 64)?, guard)?;
    Some(if x.sign() > 0 { angle } else { angle.add(&half_turn) })
}

/// `x^n` by squaring; exact as long as it fits `precision` bits.
pub(crate) fn power(x: &Ball, n: u64, precision: i64) -> Ball {
    let guard = precision + 80;
    let mut result = Ball::integer(1);
    let mut square = x.clone();
    let mut rest = n;
    while rest > 0 {
        if rest % 2 == 1 {
            result = result.mul(&square).shorten(guard);
        }
        rest /= 2;
        if rest > 0 {
            square = square.mul(&square).shorten(guard);
        }
    }
    result
}
