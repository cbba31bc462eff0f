//! Exact arithmetic over the rationals: the last resort of a proof where directed rounding cannot decide, and the
//! conversion between doubles and decimals.
//!
//! Doubles are dyadic, so a matrix of doubles is an integer matrix times a power of two. The elimination is
//! fraction-free (Bareiss, *Math. Comp.* 22 (1968) 565-578).

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::cmp::Ordering;

/// The exact value of a finite double.
///
/// # Panics
/// On NaN and infinities, which no caller passes.
#[must_use]
pub fn rational(x: f64) -> BigRational {
    BigRational::from_float(x).expect("callers pass finite doubles")
}

/// The largest double not above `value`.
#[must_use]
pub fn ratio_down(value: &BigRational) -> f64 {
    let (n, d) = (value.numer(), value.denom());
    // A quotient of at least 64 bits, rounded down; cutting it to 53 rounds down again.
    let size = |x: &BigInt| i64::try_from(x.bits()).unwrap_or(i64::MAX);
    let shift = (64 + size(d) - size(n)).max(0);
    let scaled = n << shift.unsigned_abs();
    let mut quotient = &scaled / d;
    if scaled.is_negative() && &quotient * d != scaled {
        quotient -= 1;
    }
    dyadic_down(&quotient, -shift)
}

/// The smallest double not below `value`.
#[must_use]
pub fn ratio_up(value: &BigRational) -> f64 {
    // Adding zero makes -0 plain 0.
    -ratio_down(&-value) + 0.0
}

/// The order of two rationals by one product each: the comparison of the library walks a continued fraction, whose
/// length the text of a literal can choose.
pub(crate) fn compare(a: &BigRational, b: &BigRational) -> Ordering {
    (a.numer() * b.denom()).cmp(&(b.numer() * a.denom()))
}

/// `x * 2^shift`, rounded down where `shift` is negative.
pub(crate) fn shifted(x: &BigInt, shift: i64) -> BigInt {
    let by = shift.unsigned_abs();
    if shift >= 0 { x << by } else { x >> by }
}

/// The largest double not above `m * 2^exp`.
pub(crate) fn dyadic_down(m: &BigInt, exp: i64) -> f64 {
    if m.is_zero() {
        return 0.0;
    }
    let length = i64::try_from(m.bits()).unwrap_or(i64::MAX);
    let top = length + exp;
    if top > 1024 {
        return if m.is_positive() { f64::MAX } else { f64::NEG_INFINITY };
    }
    if top < -1074 {
        return if m.is_positive() { 0.0 } else { -f64::from_bits(1) };
    }
    // Position of the last bit that a double keeps at this size.
    let unit = (top - 53).max(-1074);
    let mantissa = shifted(m, exp - unit);
    let Some(integer) = mantissa.magnitude().to_u64() else { return f64::NEG_INFINITY };
    // At most 2^53: exact; the two factors keep the scaling exact in the subnormal range.
    let value = compose(integer, unit);
    if mantissa.is_negative() { -value } else { value }
}

/// `m * 2^unit` for `m <= 2^53` and a result that is a double, or infinite.
fn compose(m: u64, unit: i64) -> f64 {
    if m == 0 {
        return 0.0;
    }
    if m == 1 << 53 {
        return compose(1 << 52, unit + 1);
    }
    let shift = u64::from(m.leading_zeros()) - 11;
    let (normal, exponent) = (m << shift, unit - i64::try_from(shift).unwrap_or(0));
    let biased = exponent + 1075;
    if biased >= 2047 {
        f64::INFINITY
    } else if biased >= 1 {
        let field = u64::try_from(biased).unwrap_or(0);
        f64::from_bits((field << 52) | (normal & ((1 << 52) - 1)))
    } else {
        f64::from_bits(normal >> (1 - biased).unsigned_abs())
    }
}

/// Integers `m` and the exponent `e` with `values[i] = m[i] * 2^e` exactly; the values are finite.
pub(crate) fn integers(values: &[f64]) -> (Vec<BigInt>, i64) {
    let parts: Vec<(i64, i64)> = values.iter().map(|&x| decode(x)).collect();
    let least = parts.iter().filter(|p| p.0 != 0).map(|p| p.1).min().unwrap_or(0);
    let scaled =
        parts.iter().map(|&(m, e)| if m == 0 { BigInt::zero() } else { BigInt::from(m) << (e - least) }).collect();
    (scaled, least)
}

/// Mantissa and exponent with `x = m * 2^e`, trailing zeros removed.
pub(crate) fn decode(x: f64) -> (i64, i64) {
    let bits = x.to_bits();
    let biased = i64::try_from((bits >> 52) & 0x7ff).unwrap_or(0);
    let fraction = i64::try_from(bits & 0x000f_ffff_ffff_ffff).unwrap_or(0);
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | (1 << 52), biased - 1075) };
    if mantissa == 0 {
        return (0, 0);
    }
    let shift = mantissa.trailing_zeros();
    let magnitude = mantissa >> shift;
    (if x < 0.0 { -magnitude } else { magnitude }, exponent + i64::from(shift))
}

/// Fraction-free Gauss-Jordan elimination of the integer matrix `[A | B]` (`n` rows, `n + k` columns, row-major).
///
/// Returns the determinant of `A`, and `det(A) * A^-1 B` in place of `B`; `None` for the second where the determinant
/// is 0.
fn eliminate(mut m: Vec<BigInt>, n: usize, k: usize) -> (BigInt, Option<Vec<BigInt>>) {
    let width = n + k;
    let mut previous = BigInt::one();
    let mut sign = 1;
    for p in 0..n {
        let Some(pivot_row) = (p..n).find(|&i| !m[i * width + p].is_zero()) else {
            return (BigInt::zero(), None);
        };
        if pivot_row != p {
            for j in 0..width {
                m.swap(p * width + j, pivot_row * width + j);
            }
            sign = -sign;
        }
        let pivot = m[p * width + p].clone();
        for i in 0..n {
            if i == p {
                continue;
            }
            let factor = m[i * width + p].clone();
            for j in 0..width {
                let value = &pivot * &m[i * width + j] - &factor * &m[p * width + j];
                m[i * width + j] = value / &previous;
            }
        }
        previous = pivot;
    }
    // Every diagonal entry now equals the determinant of the row-permuted matrix.
    let right = (0..n).flat_map(|i| m[i * width + n..(i + 1) * width].to_vec()).collect();
    (previous * sign, Some(if sign < 0 { negated(right) } else { right }))
}

fn negated(values: Vec<BigInt>) -> Vec<BigInt> {
    values.into_iter().map(|v| -v).collect()
}

/// The sign of the determinant of an `n` by `n` matrix of finite doubles, row-major: -1, 0 or 1.
#[must_use]
pub fn determinant_sign(a: &[f64], n: usize) -> i8 {
    let (m, _) = integers(a);
    let (determinant, _) = eliminate(m, n, 0);
    if determinant.is_zero() {
        0
    } else if determinant.is_positive() {
        1
    } else {
        -1
    }
}

/// The sign of the determinant and the exact inverse, row-major, of an `n` by `n` matrix of finite doubles.
#[must_use]
pub fn inverse(a: &[f64], n: usize) -> Option<(i8, Vec<BigRational>)> {
    let (m, exponent) = integers(a);
    let mut augmented = Vec::with_capacity(2 * n * n);
    for i in 0..n {
        augmented.extend_from_slice(&m[i * n..(i + 1) * n]);
        augmented.extend((0..n).map(|j| if i == j { BigInt::one() } else { BigInt::zero() }));
    }
    let (determinant, right) = eliminate(augmented, n, n);
    let sign = if determinant.is_negative() { -1 } else { 1 };
    let entries = right?.into_iter().map(|x| scaled_ratio(x, &determinant, -exponent)).collect();
    Some((sign, entries))
}

/// The exact solution of `a x = b` for finite doubles. The value is `None` if `a` is singular.
#[must_use]
pub fn solve(a: &[f64], b: &[f64], n: usize) -> Option<Vec<BigRational>> {
    let (left, left_exponent) = integers(a);
    let (right, right_exponent) = integers(b);
    let mut augmented = Vec::with_capacity(n * (n + 1));
    for i in 0..n {
        augmented.extend_from_slice(&left[i * n..(i + 1) * n]);
        augmented.push(right[i].clone());
    }
    let (determinant, solution) = eliminate(augmented, n, 1);
    let exponent = right_exponent - left_exponent;
    Some(solution?.into_iter().map(|x| scaled_ratio(x, &determinant, exponent)).collect())
}

/// `numerator / denominator * 2^exponent`.
fn scaled_ratio(numerator: BigInt, denominator: &BigInt, exponent: i64) -> BigRational {
    if exponent >= 0 {
        BigRational::new(numerator << exponent, denominator.clone())
    } else {
        BigRational::new(numerator, denominator << -exponent)
    }
}

/// Decimal exponents beyond this are far outside the range of doubles for all permitted digits.
const DECIMAL_LIMIT: i64 = 20_000;
/// Binary exponents beyond this are far outside the range of doubles for all permitted digits.
const BINARY_LIMIT: i64 = 80_000;
/// Digits of one number at most: a bound of the time and the memory that a text may cost.
const DIGIT_LIMIT: usize = 4_000;

/// The exact value of a number such as `-12.5e-3`, `2/3` or `0x1.8p-1`. The value is `None` if the text is not one.
#[must_use]
pub fn from_text(text: &str) -> Option<BigRational> {
    let (negative, unsigned) = match text.as_bytes().first()? {
        b'-' => (true, &text[1..]),
        b'+' => (false, &text[1..]),
        _ => (false, text),
    };
    let magnitude = if let Some((numerator, denominator)) = unsigned.split_once('/') {
        let (n, d) = (natural(numerator, 10)?, natural(denominator, 10)?);
        if d.is_zero() {
            return None;
        }
        BigRational::new_raw(n, d)
    } else if let Some(digits) = unsigned.strip_prefix("0x").or_else(|| unsigned.strip_prefix("0X")) {
        hexadecimal(digits)?
    } else {
        decimal(unsigned)?
    };
    Some(if negative { -magnitude } else { magnitude })
}

pub(crate) fn natural(digits: &str, radix: u32) -> Option<BigInt> {
    let allowed = !digits.is_empty() && digits.len() <= DIGIT_LIMIT && digits.chars().all(|c| c.is_digit(radix));
    if allowed { BigInt::parse_bytes(digits.as_bytes(), radix) } else { None }
}

/// An exponent such as `+12`, cut off where it decides alone.
fn exponent_value(text: &str, limit: i64) -> Option<i64> {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|c| c.is_ascii_digit()) {
        return None;
    }
    let magnitude = digits.parse::<i64>().unwrap_or(i64::MAX).min(limit);
    Some(if text.starts_with('-') { -magnitude } else { magnitude })
}

fn decimal(text: &str) -> Option<BigRational> {
    let (mantissa, exponent) = match text.find(['e', 'E']) {
        Some(at) => (&text[..at], exponent_value(&text[at + 1..], DECIMAL_LIMIT)?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = natural(&[whole, fraction].concat(), 10)?;
    Some(decimal_value(digits, exponent - i64::try_from(fraction.len()).ok()?))
}

fn hexadecimal(text: &str) -> Option<BigRational> {
    let (mantissa, exponent) = match text.find(['p', 'P']) {
        Some(at) => (&text[..at], exponent_value(&text[at + 1..], BINARY_LIMIT)?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = natural(&[whole, fraction].concat(), 16)?;
    Some(scaled_ratio(digits, &BigInt::one(), exponent - 4 * i64::try_from(fraction.len()).ok()?))
}

/// An unsigned decimal mantissa such as `3.560` with the text of an exponent: `digits * 10^place`.
pub(crate) fn decimal_with_place(mantissa: &str, exponent: &str) -> Option<(BigInt, i64)> {
    let exponent = if exponent.is_empty() { 0 } else { exponent_value(exponent, DECIMAL_LIMIT)? };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = natural(&[whole, fraction].concat(), 10)?;
    Some((digits, exponent - i64::try_from(fraction.len()).ok()?))
}

/// Not in lowest terms: nothing here needs them, and finding them takes longest.
pub(crate) fn decimal_value(digits: BigInt, exponent: i64) -> BigRational {
    let power = BigInt::from(10).pow(u32::try_from(exponent.unsigned_abs()).unwrap_or(u32::MAX));
    if exponent >= 0 { BigRational::from_integer(digits * power) } else { BigRational::new_raw(digits, power) }
}

/// The shortest decimal that reads back as `x` and lies on the outer side of it: not above `x`, or with `up` not below.
#[must_use]
pub fn outward_decimal(x: f64, up: bool) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return if x.is_nan() {
            "nan"
        } else if x > 0.0 {
            "inf"
        } else {
            "-inf"
        }
        .into();
    }
    let exact = rational(x);
    for precision in 0..40 {
        let Some((digits, exponent)) = nearest_decimal(x, precision) else { continue };
        let order = compare(&decimal_value(digits.clone(), exponent), &exact);
        let digits = if up && order == Ordering::Less {
            digits + 1
        } else if !up && order == Ordering::Greater {
            digits - 1
        } else {
            digits
        };
        let candidate = decimal_text(&digits, exponent);
        if candidate.parse::<f64>() == Ok(x) {
            return candidate;
        }
    }
    // 40 digits are far more than the 17 that single out a double.
    format!("{x:e}")
}

/// `x` rounded to `precision` digits after the first one: integer digits and a power of ten.
fn nearest_decimal(x: f64, precision: usize) -> Option<(BigInt, i64)> {
    let text = format!("{x:.precision$e}");
    let (mantissa, exponent) = text.split_once('e')?;
    let digits = mantissa.replace('.', "").parse().ok()?;
    Some((digits, exponent.parse::<i64>().ok()? - i64::try_from(precision).ok()?))
}

/// `digits * 10^exponent`, positional where that is short.
fn decimal_text(digits: &BigInt, exponent: i64) -> String {
    let sign = if digits.is_negative() { "-" } else { "" };
    let mut figures = digits.magnitude().to_string();
    let mut exponent = exponent;
    while figures.len() > 1 && figures.ends_with('0') {
        figures.pop();
        exponent += 1;
    }
    let count = i64::try_from(figures.len()).unwrap_or(i64::MAX);
    let point = count + exponent;
    if (1..=16).contains(&point) {
        if exponent >= 0 {
            let zeros = "0".repeat(usize::try_from(exponent).unwrap_or(0));
            format!("{sign}{figures}{zeros}")
        } else {
            let (whole, fraction) = figures.split_at(usize::try_from(point).unwrap_or(0));
            format!("{sign}{whole}.{fraction}")
        }
    } else if (-4..=0).contains(&point) {
        let zeros = "0".repeat(usize::try_from(-point).unwrap_or(0));
        format!("{sign}0.{zeros}{figures}")
    } else {
        let (first, rest) = figures.split_at(1);
        let dot = if rest.is_empty() { "" } else { "." };
        format!("{sign}{first}{dot}{rest}e{}", point - 1)
    }
}
