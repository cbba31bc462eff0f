//! Decorated intervals: an interval with a proved property of the function that produced it (IEEE 1788, clause 11).

mod functions;

use super::text::{Literal, literal};
use super::{Interval, Overlap};
use crate::error::Error;
use core::fmt;
use core::str::FromStr;

/// The property that is proved of a function on the box of its arguments, weakest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Decoration {
    /// Not an interval.
    Ill,
    /// Nothing.
    Trv,
    /// Defined everywhere on the box.
    Def,
    /// Defined, and its restriction to the box is continuous.
    Dac,
    /// Defined, continuous at every point of the box, which is bounded, with a bounded result.
    Com,
}

impl Decoration {
    const NAMES: [(&'static str, Self); 5] =
        [("ill", Self::Ill), ("trv", Self::Trv), ("def", Self::Def), ("dac", Self::Dac), ("com", Self::Com)];

    /// The standard's name: `ill`, `trv`, `def`, `dac` or `com`.
    ///
    /// ```
    /// assert_eq!(interval_core::Decoration::Dac.name(), "dac");
    /// ```
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|&&(_, d)| d == self).map_or("ill", |&(name, _)| name)
    }
}

impl FromStr for Decoration {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let name = text.to_ascii_lowercase();
        let found = Self::NAMES.iter().find(|&&(known, _)| known == name);
        found.map(|&(_, d)| d).ok_or_else(|| Error::Text { text: text.chars().take(80).collect() })
    }
}

/// An interval and its decoration.
///
/// Invariant: an empty interval carries at most `trv`, an unbounded one at most `dac`; `ill` goes with the empty
/// interval and is [`NAI`](Self::NAI), "not an interval", which every operation hands on.
///
/// # Example
/// ```
/// use interval_core::{Decoration, DecoratedInterval, Interval};
/// let x = DecoratedInterval::from(Interval::new(-1.0, 4.0)?);
/// assert_eq!(x.sqrt().decoration(), Decoration::Trv); // the root is not defined on all of x
/// assert_eq!((x * x).decoration(), Decoration::Com);
/// # Ok::<(), interval_core::Error>(())
/// ```
#[derive(Clone, Copy, PartialEq)]
pub struct DecoratedInterval {
    interval: Interval,
    decoration: Decoration,
}

impl From<Interval> for DecoratedInterval {
    /// The strongest decoration that an interval can carry (`newDec`).
    fn from(interval: Interval) -> Self {
        Self::new(interval, Decoration::Com)
    }
}

/// The decoration of the operands of an operation.
fn weakest(operands: &[DecoratedInterval]) -> Decoration {
    operands.iter().map(|x| x.decoration).min().unwrap_or(Decoration::Com)
}

impl DecoratedInterval {
    /// Not an interval: the result of bad input, which every further operation keeps.
    pub const NAI: Self = Self { interval: Interval::EMPTY, decoration: Decoration::Ill };

    /// `interval` with `decoration`, weakened to one that it can carry (`setDec`); `ill` gives [`NAI`](Self::NAI).
    #[must_use]
    pub fn new(interval: Interval, decoration: Decoration) -> Self {
        let most = if interval.is_empty() {
            Decoration::Trv
        } else if interval.is_bounded() {
            Decoration::Com
        } else {
            Decoration::Dac
        };
        if decoration == Decoration::Ill {
            return Self::NAI;
        }
        Self { interval, decoration: decoration.min(most) }
    }

    /// The interval without its decoration; `None` for [`NAI`](Self::NAI).
    #[must_use]
    pub fn interval(self) -> Option<Interval> {
        if self.is_nai() { None } else { Some(self.interval) }
    }

    /// The decoration.
    #[must_use]
    pub fn decoration(self) -> Decoration {
        self.decoration
    }

    /// True if it is [`NAI`](Self::NAI).
    #[must_use]
    pub fn is_nai(self) -> bool {
        self.decoration == Decoration::Ill
    }

    /// The result of an operation that has `local` on its operands.
    fn carry(operands: &[Self], result: Interval, local: Decoration) -> Self {
        let inherited = weakest(operands);
        if inherited == Decoration::Ill { Self::NAI } else { Self::new(result, inherited.min(local)) }
    }

    /// The same for operations that carry no information about a function: sets, cancellation, reverses.
    fn trivial(operands: &[Self], result: Interval) -> Self {
        Self::carry(operands, result, Decoration::Trv)
    }

    /// The position of one against the other; `None` if one is [`NAI`](Self::NAI).
    #[must_use]
    pub fn overlap(self, other: Self) -> Option<Overlap> {
        Some(self.interval()?.overlap(other.interval()?))
    }

    /// Reads a decorated literal, `[1, 2]_dac`, as [`Interval::from_literal`] reads a bare one.
    ///
    /// # Errors
    /// Text that is no decorated literal, or a decoration that the interval cannot carry.
    pub fn from_literal(text: &str) -> Result<(Self, bool), Error> {
        let refusal = || Error::Text { text: text.chars().take(80).collect() };
        let trimmed = text.trim();
        let (bare, suffix) = match trimmed.rsplit_once('_') {
            Some((bare, name)) => (bare, Some(name.parse::<Decoration>()?)),
            None => (trimmed, None),
        };
        if matches!(literal(bare), Some(Literal::NotAnInterval)) {
            return if suffix.is_none() { Ok((Self::NAI, false)) } else { Err(refusal()) };
        }
        let (interval, doubtful) = Interval::from_literal(bare)?;
        let Some(asked) = suffix else { return Ok((interval.into(), doubtful)) };
        // An interval that only its rounding made unbounded may still say com: it is weakened, not refused.
        let bounded_text =
            matches!(literal(bare), Some(Literal::Bounds(Some(_), Some(_)) | Literal::Around(Some(_), Some(_))));
        let carried = Self::new(interval, asked);
        let weakened = carried.decoration < asked && !(bounded_text && asked == Decoration::Com);
        if asked == Decoration::Ill || weakened { Err(refusal()) } else { Ok((carried, doubtful)) }
    }
}

impl FromStr for DecoratedInterval {
    type Err = Error;

    /// Reads `[1, 2]_com`; without a suffix the strongest decoration. The order of the bounds is judged exactly.
    ///
    /// ```
    /// use interval_core::{DecoratedInterval, Decoration};
    /// let x: DecoratedInterval = "[1, inf]_def".parse()?;
    /// assert_eq!(x.decoration(), Decoration::Def);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    fn from_str(text: &str) -> Result<Self, Error> {
        let (value, _) = Self::from_literal(text)?;
        let bare = text.trim().rsplit_once('_').map_or(text, |(bare, _)| bare);
        if !value.is_nai() {
            bare.parse::<Interval>()?;
        }
        Ok(value)
    }
}

impl fmt::Display for DecoratedInterval {
    /// `[lower, upper]_dec`, rounded outward.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_nai() { f.write_str("[nai]") } else { write!(f, "{}_{}", self.interval, self.decoration.name()) }
    }
}

impl fmt::Debug for DecoratedInterval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
