//! Bounds of a number, and misuse as a value.

use core::fmt;

/// The numbers from `lo` to `hi`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The lower bound.
    pub lo: f64,
    /// The upper bound.
    pub hi: f64,
}

impl Bounds {
    /// Every number.
    pub const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// The number 0.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    /// The numbers from `lo` to `hi`; an infinite bound is an open end.
    #[must_use]
    pub const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// A reading with the accuracy of its sensor, rounded outward.
    #[must_use]
    pub fn reading(value: f64, accuracy: f64) -> Self {
        use interval_core::rounding::{add_up, sub_down};
        Self { lo: sub_down(value, accuracy), hi: add_up(value, accuracy) }
    }

    /// `hi - lo`, rounded to nearest.
    #[must_use]
    pub fn width(self) -> f64 {
        self.hi - self.lo
    }

    /// True if `x` lies between the bounds.
    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// True for bounds that a row may have: neither NaN nor reversed, and with a finite number between them.
    #[must_use]
    pub(crate) fn is_good(self) -> bool {
        self.lo <= self.hi && self.lo < f64::INFINITY && self.hi > f64::NEG_INFINITY
    }
}

impl From<interval_core::Interval> for Bounds {
    fn from(x: interval_core::Interval) -> Self {
        Self { lo: x.lo(), hi: x.hi() }
    }
}

/// Misuse by a caller; the follower is as it was before the call.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// A bound of a row is NaN, reversed or without a finite number.
    Row {
        /// Position in the row; the number of parameters for the right-hand side.
        entry: usize,
    },
    /// A bound of the start is infinite, reversed, or larger than [`crate::START_LIMIT`].
    Start {
        /// The parameter.
        column: usize,
    },
    /// A rate is negative, NaN or infinite.
    Rate {
        /// The parameter.
        column: usize,
    },
    /// A time is NaN, infinite, or earlier than the time before it.
    Time,
    /// The length of a window is not positive.
    Window,
    /// The processor rounds otherwise than to nearest, or flushes subnormal numbers to zero.
    Environment,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Row { entry } => {
                write!(f, "entry {entry} of the row is NaN, reversed or without a finite number; give lo <= hi")
            }
            Self::Start { column } => write!(
                f,
                "the start of parameter {column} is not two ordered numbers of at most 1e100; give wide bounds that hold"
            ),
            Self::Rate { column } => {
                write!(f, "the rate of parameter {column} is no number from 0 up; give 0 for a constant")
            }
            Self::Time => {
                write!(f, "the time is no number, or earlier than that of the row before; give rows in their order")
            }
            Self::Window => write!(f, "the window is no positive number of seconds; give its length"),
            Self::Environment => {
                write!(
                    f,
                    "the processor does not round to nearest or flushes subnormal numbers; restore its default mode"
                )
            }
        }
    }
}

impl core::error::Error for Refusal {}
