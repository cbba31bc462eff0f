//! Decorated intervals: an interval with what is known of the function that produced it (IEEE 1788, clause 11).

use super::text::{Literal, literal};
use super::{Interval, Overlap};
use crate::error::Error;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::str::FromStr;

/// What is proved of a function on the box that it was evaluated on, weakest first.
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
/// Invariant: an empty interval carries at most `trv`, an unbounded one at most `dac`; `ill` goes with the empty interval
/// and is [`NAI`](Self::NAI), "not an interval", which every operation hands on.
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
    /// Not an interval: what bad input gives, for ever.
    pub const NAI: Self = Self { interval: Interval::EMPTY, decoration: Decoration::Ill };

    /// `interval` with `decoration`, weakened to what it can carry (`setDec`); `ill` gives [`NAI`](Self::NAI).
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

    /// Whether it is [`NAI`](Self::NAI).
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

    /// How the two lie; `None` where one is [`NAI`](Self::NAI).
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

/// `com` on the domain, nothing outside.
fn on_domain(inside: bool) -> Decoration {
    if inside { Decoration::Com } else { Decoration::Trv }
}

/// The decoration of a step function: constant on the box it is continuous there, and at its ends too unless a step lies on
/// one of them.
fn steps(result: Interval, step_at_end: bool) -> Decoration {
    match (result.is_singleton(), step_at_end) {
        (false, _) => Decoration::Def,
        (true, true) => Decoration::Dac,
        (true, false) => Decoration::Com,
    }
}

/// Operations of one operand with their local decoration.
macro_rules! unary {
    ($($(#[$doc:meta])* $name:ident => |$x:ident, $result:ident| $local:expr;)*) => {
        impl DecoratedInterval {
            $($(#[$doc])*
            #[must_use]
            pub fn $name(self) -> Self {
                let $x = self.interval;
                let $result = $x.$name();
                Self::carry(&[self], $result, $local)
            })*
        }
    };
}

unary! {
    /// [`Interval::abs`].
    abs => |_x, _r| Decoration::Com;
    /// [`Interval::square`].
    square => |_x, _r| Decoration::Com;
    /// [`Interval::recip`].
    recip => |x, _r| on_domain(!x.contains(0.0));
    /// [`Interval::sqrt`].
    sqrt => |x, _r| on_domain(x.lo >= 0.0);
    /// [`Interval::exp`].
    exp => |_x, _r| Decoration::Com;
    /// [`Interval::exp2`].
    exp2 => |_x, _r| Decoration::Com;
    /// [`Interval::exp10`].
    exp10 => |_x, _r| Decoration::Com;
    /// [`Interval::ln`].
    ln => |x, _r| on_domain(x.lo > 0.0);
    /// [`Interval::log2`].
    log2 => |x, _r| on_domain(x.lo > 0.0);
    /// [`Interval::log10`].
    log10 => |x, _r| on_domain(x.lo > 0.0);
    /// [`Interval::sin`].
    sin => |_x, _r| Decoration::Com;
    /// [`Interval::cos`].
    cos => |_x, _r| Decoration::Com;
    /// [`Interval::tan`].
    tan => |_x, r| on_domain(!r.is_entire());
    /// [`Interval::asin`].
    asin => |x, _r| on_domain(x.subset(Interval::UNIT));
    /// [`Interval::acos`].
    acos => |x, _r| on_domain(x.subset(Interval::UNIT));
    /// [`Interval::atan`].
    atan => |_x, _r| Decoration::Com;
    /// [`Interval::sinh`].
    sinh => |_x, _r| Decoration::Com;
    /// [`Interval::cosh`].
    cosh => |_x, _r| Decoration::Com;
    /// [`Interval::tanh`].
    tanh => |_x, _r| Decoration::Com;
    /// [`Interval::asinh`].
    asinh => |_x, _r| Decoration::Com;
    /// [`Interval::acosh`].
    acosh => |x, _r| on_domain(x.lo >= 1.0);
    /// [`Interval::atanh`].
    atanh => |x, _r| on_domain(-1.0 < x.lo && x.hi < 1.0);
    /// [`Interval::sign`].
    sign => |x, r| steps(r, x.contains(0.0));
    /// [`Interval::ceil`].
    ceil => |x, r| steps(r, x.hi.fract() == 0.0);
    /// [`Interval::floor`].
    floor => |x, r| steps(r, x.lo.fract() == 0.0);
    /// [`Interval::trunc`].
    trunc => |x, r| steps(r, (x.lo > 0.0 && x.lo.fract() == 0.0) || (x.hi < 0.0 && x.hi.fract() == 0.0));
    /// [`Interval::round_ties_even`].
    round_ties_even => |x, r| steps(r, x.lo.fract().abs() == 0.5 || x.hi.fract().abs() == 0.5);
    /// [`Interval::round`].
    round => |x, r| steps(r, x.lo.fract().abs() == 0.5 || x.hi.fract().abs() == 0.5);
}

/// Operations of two operands with their local decoration.
macro_rules! binary {
    ($($(#[$doc:meta])* $name:ident => |$x:ident, $y:ident| $local:expr;)*) => {
        impl DecoratedInterval {
            $($(#[$doc])*
            #[must_use]
            pub fn $name(self, other: Self) -> Self {
                let ($x, $y) = (self.interval, other.interval);
                Self::carry(&[self, other], $x.$name($y), $local)
            })*
        }
    };
}

binary! {
    /// [`Interval::min`].
    min => |_x, _y| Decoration::Com;
    /// [`Interval::max`].
    max => |_x, _y| Decoration::Com;
    /// [`Interval::pow`].
    pow => |x, y| on_domain(x.lo > 0.0 || (x.lo == 0.0 && y.lo > 0.0));
    /// [`Interval::atan2`], `self` being y.
    atan2 => |y, x| if y.contains(0.0) && x.contains(0.0) {
        Decoration::Trv
    } else if y.contains(0.0) && x.lo < 0.0 {
        if y.lo < 0.0 { Decoration::Def } else { Decoration::Dac }
    } else {
        Decoration::Com
    };
    /// [`Interval::intersection`].
    intersection => |_x, _y| Decoration::Trv;
    /// [`Interval::hull`].
    hull => |_x, _y| Decoration::Trv;
    /// [`Interval::cancel_minus`].
    cancel_minus => |_x, _y| Decoration::Trv;
    /// [`Interval::cancel_plus`].
    cancel_plus => |_x, _y| Decoration::Trv;
    /// [`Interval::sqr_rev`].
    sqr_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::abs_rev`].
    abs_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::sin_rev`].
    sin_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::cos_rev`].
    cos_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::tan_rev`].
    tan_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::cosh_rev`].
    cosh_rev => |_x, _y| Decoration::Trv;
}

impl DecoratedInterval {
    /// [`Interval::powi`].
    #[must_use]
    pub fn powi(self, n: i32) -> Self {
        let local = on_domain(n >= 0 || !self.interval.contains(0.0));
        Self::carry(&[self], self.interval.powi(n), local)
    }

    /// [`Interval::mul_add`].
    #[must_use]
    pub fn mul_add(self, y: Self, z: Self) -> Self {
        Self::carry(&[self, y, z], self.interval.mul_add(y.interval, z.interval), Decoration::Com)
    }

    /// [`Interval::powi_rev`].
    #[must_use]
    pub fn powi_rev(self, x: Self, n: i32) -> Self {
        Self::trivial(&[self, x], self.interval.powi_rev(x.interval, n))
    }

    /// [`Interval::mul_rev`].
    #[must_use]
    pub fn mul_rev(self, c: Self, x: Self) -> Self {
        Self::trivial(&[self, c, x], self.interval.mul_rev(c.interval, x.interval))
    }

    /// [`Interval::pow_rev_base`].
    #[must_use]
    pub fn pow_rev_base(self, c: Self, x: Self) -> Self {
        Self::trivial(&[self, c, x], self.interval.pow_rev_base(c.interval, x.interval))
    }

    /// [`Interval::pow_rev_exponent`].
    #[must_use]
    pub fn pow_rev_exponent(self, c: Self, x: Self) -> Self {
        Self::trivial(&[self, c, x], self.interval.pow_rev_exponent(c.interval, x.interval))
    }

    /// [`Interval::mul_rev_to_pair`]: where the divisor excludes zero the first part is a quotient and decorated as one.
    #[must_use]
    pub fn mul_rev_to_pair(self, c: Self) -> [Self; 2] {
        let [first, second] = self.interval.mul_rev_to_pair(c.interval);
        let local = on_domain(!self.interval.contains(0.0));
        [Self::carry(&[self, c], first, local), Self::trivial(&[self, c], second)]
    }
}

impl Neg for DecoratedInterval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { interval: -self.interval, ..self }
    }
}

impl Add for DecoratedInterval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::carry(&[self, other], self.interval + other.interval, Decoration::Com)
    }
}

impl Sub for DecoratedInterval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::carry(&[self, other], self.interval - other.interval, Decoration::Com)
    }
}

impl Mul for DecoratedInterval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::carry(&[self, other], self.interval * other.interval, Decoration::Com)
    }
}

impl Div for DecoratedInterval {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let local = on_domain(!other.interval.contains(0.0));
        Self::carry(&[self, other], self.interval / other.interval, local)
    }
}
