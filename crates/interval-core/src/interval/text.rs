//! Text in and out (IEEE 1788, clauses 9.7 and 12.11). Reading rounds outward from the exact value of the literal;
//! writing rounds outward from the exact doubles.

use super::Interval;
use crate::decimals::{Ratio, decimal_value, decimal_with_place, from_text, natural, outward_decimal};
use crate::dyadic::decode;
use crate::error::Error;
use crate::integers::Integer;
use alloc::format;
use alloc::string::String;
use core::cmp::Ordering;
use core::fmt;
use core::str::FromStr;

/// The exact content of a literal.
pub(super) enum Literal {
    Empty,
    NotAnInterval,
    /// Bounds, `None` for an open end.
    Bounds(Option<Ratio>, Option<Ratio>),
    /// The same from a midpoint and a radius, which are never out of order.
    Around(Option<Ratio>, Option<Ratio>),
}

/// Reads an undecorated literal: `[l, u]`, `[x]`, `[empty]`, `[entire]`, `[nai]`, `m?rue`, or a plain number.
pub(super) fn literal(text: &str) -> Option<Literal> {
    let text = text.trim();
    let Some(rest) = text.strip_prefix('[') else {
        return match text.split_once('?') {
            Some((mantissa, tail)) => uncertain(mantissa, tail),
            None => from_text(text).map(|x| Literal::Bounds(Some(x.clone()), Some(x))),
        };
    };
    let inner = rest.strip_suffix(']')?.trim();
    match inner.to_ascii_lowercase().as_str() {
        "" | "empty" => return Some(Literal::Empty),
        "entire" => return Some(Literal::Bounds(None, None)),
        "nai" => return Some(Literal::NotAnInterval),
        _ => {}
    }
    let Some((lower, upper)) = inner.split_once(',') else {
        return from_text(inner).map(|x| Literal::Bounds(Some(x.clone()), Some(x)));
    };
    let (Bound::At(lower), Bound::At(upper)) = (bound(lower.trim(), "-"), bound(upper.trim(), "+")) else {
        return None;
    };
    Some(Literal::Bounds(lower, upper))
}

/// The text of a bound: a number, `None` for nothing or the infinity of its side, or something else.
enum Bound {
    At(Option<Ratio>),
    Unreadable,
}

fn bound(text: &str, side: &str) -> Bound {
    let lower = text.to_ascii_lowercase();
    // The sign of the infinity may be left out on the upper side only.
    let name =
        if side == "+" { lower.strip_prefix('+').unwrap_or(&lower) } else { lower.strip_prefix('-').unwrap_or("") };
    if text.is_empty() || matches!(name, "inf" | "infinity") {
        return Bound::At(None);
    }
    from_text(text).map_or(Bound::Unreadable, |x| Bound::At(Some(x)))
}

/// `mantissa ? radius direction e exponent`: the number within `radius` units of its last place (half of one where none
/// are given, any number for a second `?`), to both sides, up (`u`) or down (`d`).
fn uncertain(mantissa: &str, tail: &str) -> Option<Literal> {
    let (negative, digits) = match mantissa.as_bytes().first()? {
        b'-' => (true, &mantissa[1..]),
        b'+' => (false, &mantissa[1..]),
        _ => (false, mantissa),
    };
    let (head, exponent) = match tail.find(['e', 'E']) {
        Some(at) if tail.len() > at + 1 => (&tail[..at], &tail[at + 1..]),
        Some(_) => return None,
        None => (tail, ""),
    };
    let (radius, down, up) = match head.as_bytes().last() {
        Some(b'u' | b'U') => (&head[..head.len() - 1], false, true),
        Some(b'd' | b'D') => (&head[..head.len() - 1], true, false),
        _ => (head, true, true),
    };
    let (magnitude, place) = decimal_with_place(digits, exponent)?;
    let centre = if negative { -magnitude } else { magnitude };
    // In units of the last place, or in tenths of it where the radius is half a unit.
    let (centre, width, place) = match radius {
        "?" => (centre, None, place),
        "" => (&centre * &Integer::from(10_u64), Some(Integer::from(5_u64)), place - 1),
        count => (centre, Some(natural(count, 10)?), place),
    };
    let lower = if down { width.as_ref().map(|w| &centre - w) } else { Some(centre.clone()) };
    let upper = if up { width.as_ref().map(|w| &centre + w) } else { Some(centre) };
    let value = |end: Option<Integer>| end.map(|units| decimal_value(units, place));
    Some(Literal::Around(value(lower), value(upper)))
}

fn refusal(text: &str) -> Error {
    Error::Text { text: text.chars().take(80).collect() }
}

/// True if both numbers lie far outside the range of doubles, on the same side, so that their exponents may have been
/// cut and their order is not known.
fn out_of_sight(a: &Ratio, b: &Ratio) -> bool {
    // Less than the size of any number whose exponent may have been cut, and far outside the range of doubles.
    const BITS: u64 = 30_000;
    let huge = |x: &Ratio| x.numerator.bits() > x.denominator.bits() + BITS;
    let tiny = |x: &Ratio| x.denominator.bits() > x.numerator.bits() + BITS;
    (huge(a) && huge(b)) || (tiny(a) && tiny(b))
}

fn round_outward(lower: Option<&Ratio>, upper: Option<&Ratio>) -> Interval {
    Interval::made(lower.map_or(f64::NEG_INFINITY, Ratio::down), upper.map_or(f64::INFINITY, Ratio::up))
}

impl Interval {
    /// The standard's `textToInterval`: as [`FromStr`], but bounds in the wrong order are accepted where their
    /// roundings overlap. The flag says that the order could not be told from doubles (the signal
    /// `PossiblyUndefinedOperation`).
    ///
    /// # Errors
    /// Text that is no literal, and bounds that are reversed beyond rounding.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let (x, doubtful) = Interval::from_literal("[1.0000000000000002, 1.0000000000000001]")?;
    /// assert!(doubtful && x.contains(1.0));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    pub fn from_literal(text: &str) -> Result<(Self, bool), Error> {
        match literal(text).ok_or_else(|| refusal(text))? {
            Literal::Empty => Ok((Self::EMPTY, false)),
            Literal::NotAnInterval => Err(refusal(text)),
            Literal::Bounds(Some(l), Some(u)) => {
                let order = l.compare(&u);
                let (lower, upper) = if order == Ordering::Greater { (u, l) } else { (l, u) };
                let doubtful = order != Ordering::Equal && lower.up() > upper.down();
                if order == Ordering::Greater && !doubtful && !out_of_sight(&lower, &upper) {
                    return Err(Error::ReversedBounds { index: 0 });
                }
                Ok((round_outward(Some(&lower), Some(&upper)), doubtful))
            }
            Literal::Bounds(l, u) | Literal::Around(l, u) => Ok((round_outward(l.as_ref(), u.as_ref()), false)),
        }
    }

    /// Hexadecimal bounds, without rounding: reads back as the same doubles (the standard's `intervalToExact`).
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(-0.75, 2.0)?.to_exact(), "[-0x3p-2, 0x1p1]");
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn to_exact(self) -> String {
        if self.is_empty() {
            return "[empty]".into();
        }
        format!("[{}, {}]", hexadecimal(self.lo), hexadecimal(self.hi))
    }
}

fn hexadecimal(x: f64) -> String {
    if x.is_infinite() {
        return if x > 0.0 { "inf" } else { "-inf" }.into();
    }
    let (mantissa, exponent) = decode(x);
    let sign = if mantissa < 0 { "-" } else { "" };
    format!("{sign}0x{:x}p{exponent}", mantissa.unsigned_abs())
}

impl FromStr for Interval {
    type Err = Error;

    /// Reads every undecorated literal of the standard, and a plain number: `[0.1, 0.2]`, `[1/3]`, `[-inf, 0x1.8p3]`,
    /// `[1,]`, `3.56?1`, `-10?2ue3`, `[empty]`, `[entire]`, `0.1`. The order of the bounds is judged
    /// exactly, from 10^-9000 to 10^9000.
    ///
    /// ```
    /// let third: interval_core::Interval = "[1/3]".parse()?;
    /// assert_eq!(third.lo().next_up(), third.hi());
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    fn from_str(text: &str) -> Result<Self, Error> {
        match literal(text).ok_or_else(|| refusal(text))? {
            Literal::Empty => Ok(Self::EMPTY),
            Literal::NotAnInterval => Err(refusal(text)),
            Literal::Bounds(Some(l), Some(u)) if l.compare(&u) == Ordering::Greater => {
                // Either order encloses.
                if out_of_sight(&l, &u) {
                    Ok(round_outward(Some(&u), Some(&l)))
                } else {
                    Err(Error::ReversedBounds { index: 0 })
                }
            }
            Literal::Bounds(l, u) | Literal::Around(l, u) => Ok(round_outward(l.as_ref(), u.as_ref())),
        }
    }
}

impl fmt::Display for Interval {
    /// `[lower, upper]` in decimals, rounded outward, with just the digits that read back as the same doubles.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("[empty]");
        }
        write!(f, "[{}, {}]", outward_decimal(self.lo, false), outward_decimal(self.hi, true))
    }
}
