//! Closed intervals of doubles.

#![expect(clippy::inline_always, reason = "operations are compiled again inside functions with wider instruction sets")]

mod arithmetic;
mod cancel;
mod decorated;
mod elementary;
mod fused;
mod integer;
mod measures;
mod power;
mod relations;
mod reverse;
#[cfg(feature = "serde")]
mod serialize;
mod sets;
mod text;

pub use decorated::{DecoratedInterval, Decoration};
pub use relations::Overlap;

use crate::error::Error;
use std::fmt;

/// A closed interval of real numbers with double bounds, possibly unbounded, possibly empty.
///
/// Invariant: either `lo <= hi`, `lo < +inf` and `hi > -inf`, or the interval is [`Interval::EMPTY`]. No bound is NaN.
///
/// # Example
/// ```
/// use interval_core::Interval;
/// let x = Interval::new(1.0, 2.0)?;
/// let y = "[0.1, 0.2]".parse::<Interval>()?;
/// assert!((x * y).contains(0.3));
/// # Ok::<(), interval_core::Error>(())
/// ```
#[derive(Clone, Copy, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// No number at all; the reversed infinities make hull and intersection plain minima and maxima.
    pub const EMPTY: Self = Self { lo: f64::INFINITY, hi: f64::NEG_INFINITY };
    /// Every real number.
    pub const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// The number 0.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };
    /// The number 1.
    pub const ONE: Self = Self { lo: 1.0, hi: 1.0 };

    /// The interval from `lo` to `hi`.
    ///
    /// # Errors
    /// NaN, reversed bounds, and bounds without a finite number between them are refused.
    pub fn new(lo: f64, hi: f64) -> Result<Self, Error> {
        Self::at(lo, hi, 0)
    }

    /// The same for the entry `index` of an array, which a refusal names.
    ///
    /// # Errors
    /// As [`Interval::new`].
    pub fn at(lo: f64, hi: f64, index: usize) -> Result<Self, Error> {
        if lo.is_nan() || hi.is_nan() {
            Err(Error::NotANumber { index })
        } else if lo > hi {
            Err(Error::ReversedBounds { index })
        } else if lo == f64::INFINITY || hi == f64::NEG_INFINITY {
            Err(Error::NoFinitePoint { index })
        } else {
            Ok(Self { lo, hi })
        }
    }

    /// The interval of one number.
    ///
    /// # Errors
    /// NaN and infinities are refused.
    pub fn point(x: f64) -> Result<Self, Error> {
        Self::new(x, x)
    }

    /// The caller has established the invariant.
    pub(crate) const fn raw(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// The same for a computed result, in which no zero is negative: then equal intervals have equal bits.
    #[inline(always)]
    pub(crate) const fn made(lo: f64, hi: f64) -> Self {
        Self { lo: lo + 0.0, hi: hi + 0.0 }
    }

    /// The lower bound; +inf for the empty interval.
    #[must_use]
    pub const fn lo(self) -> f64 {
        self.lo
    }

    /// The upper bound; -inf for the empty interval.
    #[must_use]
    pub const fn hi(self) -> f64 {
        self.hi
    }
}

impl fmt::Debug for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
