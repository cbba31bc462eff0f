//! Text of numbers, without a rounding that is not asked for: decimals, hexadecimals and fractions as ratios of integers.

use crate::dyadic::{decode, dyadic_down};
use crate::integers::Integer;
use alloc::format;
use alloc::string::{String, ToString as _};
use core::cmp::Ordering;

/// A quotient of integers with a positive denominator, not in lowest terms: nothing here needs them, and finding them
/// takes longest.
#[derive(Debug, Clone)]
pub(crate) struct Ratio {
    pub numerator: Integer,
    pub denominator: Integer,
}

impl Ratio {
    /// `numerator * 2^exponent`.
    fn scaled(numerator: Integer, exponent: i64) -> Self {
        let by = exponent.unsigned_abs();
        if exponent >= 0 {
            Self { numerator: numerator << by, denominator: Integer::from(1_u64) }
        } else {
            Self { numerator, denominator: Integer::from(1_u64) << by }
        }
    }

    /// A finite double.
    fn of_double(x: f64) -> Self {
        let (mantissa, exponent) = decode(x);
        Self::scaled(Integer::from(mantissa), exponent)
    }

    pub fn neg(self) -> Self {
        Self { numerator: -self.numerator, ..self }
    }

    /// The order of two ratios by one product each.
    pub fn compare(&self, other: &Self) -> Ordering {
        (&self.numerator * &other.denominator).cmp(&(&other.numerator * &self.denominator))
    }

    /// The largest double not above the number.
    pub fn down(&self) -> f64 {
        let (n, d) = (&self.numerator, &self.denominator);
        // A quotient of at least 64 bits, rounded down; cutting it to 53 rounds down again.
        let size = |x: &Integer| i64::try_from(x.bits()).unwrap_or(i64::MAX);
        let shift = (64 + size(d) - size(n)).max(0);
        let scaled = n << shift.unsigned_abs();
        let mut quotient = scaled.quotient(d);
        if scaled.is_negative() && &quotient * d != scaled {
            quotient = &quotient - &Integer::from(1_u64);
        }
        dyadic_down(&quotient, -shift)
    }

    /// The smallest double not below the number.
    pub fn up(&self) -> f64 {
        // Adding zero makes -0 plain 0.
        -self.clone().neg().down() + 0.0
    }
}

/// Decimal exponents beyond this are far outside the range of doubles for all permitted digits.
const DECIMAL_LIMIT: i64 = 20_000;
/// Binary exponents beyond this are far outside the range of doubles for all permitted digits.
const BINARY_LIMIT: i64 = 80_000;
/// Digits of one number at most: a bound of the time and the memory that a text may cost.
const DIGIT_LIMIT: usize = 4_000;

/// The exact value of a number such as `-12.5e-3`, `2/3` or `0x1.8p-1`. The value is `None` if the text is not one.
pub(crate) fn from_text(text: &str) -> Option<Ratio> {
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
        Ratio { numerator: n, denominator: d }
    } else if let Some(digits) = unsigned.strip_prefix("0x").or_else(|| unsigned.strip_prefix("0X")) {
        hexadecimal(digits)?
    } else {
        decimal(unsigned)?
    };
    Some(if negative { magnitude.neg() } else { magnitude })
}

pub(crate) fn natural(digits: &str, radix: u32) -> Option<Integer> {
    let allowed = !digits.is_empty() && digits.len() <= DIGIT_LIMIT && digits.chars().all(|c| c.is_digit(radix));
    if allowed { Integer::parse(digits, radix) } else { None }
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

fn decimal(text: &str) -> Option<Ratio> {
    let (mantissa, exponent) = match text.find(['e', 'E']) {
        Some(at) => (&text[..at], exponent_value(&text[at + 1..], DECIMAL_LIMIT)?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = natural(&[whole, fraction].concat(), 10)?;
    Some(decimal_value(digits, exponent - i64::try_from(fraction.len()).ok()?))
}

fn hexadecimal(text: &str) -> Option<Ratio> {
    let (mantissa, exponent) = match text.find(['p', 'P']) {
        Some(at) => (&text[..at], exponent_value(&text[at + 1..], BINARY_LIMIT)?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = natural(&[whole, fraction].concat(), 16)?;
    Some(Ratio::scaled(digits, exponent - 4 * i64::try_from(fraction.len()).ok()?))
}

/// An unsigned decimal mantissa such as `3.560` with the text of an exponent: `digits * 10^place`.
pub(crate) fn decimal_with_place(mantissa: &str, exponent: &str) -> Option<(Integer, i64)> {
    let exponent = if exponent.is_empty() { 0 } else { exponent_value(exponent, DECIMAL_LIMIT)? };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = natural(&[whole, fraction].concat(), 10)?;
    Some((digits, exponent - i64::try_from(fraction.len()).ok()?))
}

/// `digits * 10^exponent`.
pub(crate) fn decimal_value(digits: Integer, exponent: i64) -> Ratio {
    let power = Integer::from(10_u64).pow(u32::try_from(exponent.unsigned_abs()).unwrap_or(u32::MAX));
    if exponent >= 0 {
        Ratio { numerator: &digits * &power, denominator: Integer::from(1_u64) }
    } else {
        Ratio { numerator: digits, denominator: power }
    }
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
    let exact = Ratio::of_double(x);
    for precision in 0..40 {
        let Some((digits, exponent)) = nearest_decimal(x, precision) else { continue };
        let order = decimal_value(digits.clone(), exponent).compare(&exact);
        let digits = if up && order == Ordering::Less {
            &digits + &Integer::from(1_u64)
        } else if !up && order == Ordering::Greater {
            &digits - &Integer::from(1_u64)
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
fn nearest_decimal(x: f64, precision: usize) -> Option<(Integer, i64)> {
    let text = format!("{x:.precision$e}");
    let (mantissa, exponent) = text.split_once('e')?;
    let figures = mantissa.replace('.', "");
    let digits = Integer::parse(figures.trim_start_matches('-'), 10)?;
    Some((if x < 0.0 { -digits } else { digits }, exponent.parse::<i64>().ok()? - i64::try_from(precision).ok()?))
}

/// `digits * 10^exponent`, positional where that is short.
fn decimal_text(digits: &Integer, exponent: i64) -> String {
    let sign = if digits.is_negative() { "-" } else { "" };
    let mut figures = digits.abs().to_string();
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
