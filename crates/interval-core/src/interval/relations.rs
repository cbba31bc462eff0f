//! Relations between intervals (IEEE 1788, tables 10.3 and 10.7). Those of sets are exact.

use super::Interval;
use core::cmp::Ordering;

/// The 16 ways in which two intervals can lie (IEEE 1788, table 10.7). `-By` is the relation with the operands
/// exchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Overlap {
    /// Neither holds anything.
    BothEmpty,
    /// The first holds nothing.
    FirstEmpty,
    /// The second holds nothing.
    SecondEmpty,
    /// `b < c`
    Before,
    /// `b = c` and neither is a point
    Meets,
    /// `a < c < b < d`
    Overlaps,
    /// `a = c`, `b < d`
    Starts,
    /// `c < a`, `b < d`
    ContainedBy,
    /// `c < a`, `b = d`
    Finishes,
    /// `a = c`, `b = d`
    Equals,
    /// `a < c`, `b = d`
    FinishedBy,
    /// `a < c`, `d < b`
    Contains,
    /// `a = c`, `d < b`
    StartedBy,
    /// `c < a < d < b`
    OverlappedBy,
    /// `a = d` and neither is a point
    MetBy,
    /// `d < a`
    After,
}

/// `a < b` for lower or upper bounds, where an infinity is taken as lying strictly outside itself.
fn strictly(a: f64, b: f64) -> bool {
    a < b || (a == b && a.is_infinite())
}

/// The order of two bounds, in which -0 equals 0.
fn order(x: f64, y: f64) -> Ordering {
    if x < y {
        Ordering::Less
    } else if x > y {
        Ordering::Greater
    } else {
        Ordering::Equal
    }
}

impl Interval {
    /// True if every real number is inside.
    #[must_use]
    pub fn is_entire(self) -> bool {
        self == Self::ENTIRE
    }

    /// True if exactly one number is inside.
    #[must_use]
    pub fn is_singleton(self) -> bool {
        self.lo == self.hi
    }

    /// True if it is bounded and not empty.
    #[must_use]
    pub fn is_common(self) -> bool {
        self.lo <= self.hi && self.is_bounded()
    }

    /// True if every member is an inner point of `other`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert!(Interval::ENTIRE.interior(Interval::ENTIRE));
    /// assert!(!Interval::ONE.interior(Interval::ONE));
    /// ```
    #[must_use]
    pub fn interior(self, other: Self) -> bool {
        self.is_empty() || (strictly(other.lo, self.lo) && strictly(self.hi, other.hi))
    }

    /// True if no number is in both.
    #[must_use]
    pub fn disjoint(self, other: Self) -> bool {
        self.is_empty() || other.is_empty() || self.hi < other.lo || other.hi < self.lo
    }

    /// For every member of each there is one of the other on the right side: `a <= c` and `b <= d`.
    #[must_use]
    pub fn less(self, other: Self) -> bool {
        (self.is_empty() && other.is_empty())
            || (!self.is_empty() && !other.is_empty() && self.lo <= other.lo && self.hi <= other.hi)
    }

    /// The same with strict inequalities.
    #[must_use]
    pub fn strict_less(self, other: Self) -> bool {
        (self.is_empty() && other.is_empty())
            || (!self.is_empty() && !other.is_empty() && strictly(self.lo, other.lo) && strictly(self.hi, other.hi))
    }

    /// True if no member of `self` lies above one of `other`.
    #[must_use]
    pub fn precedes(self, other: Self) -> bool {
        self.is_empty() || other.is_empty() || self.hi <= other.lo
    }

    /// True if every member of `self` lies below every one of `other`.
    #[must_use]
    pub fn strict_precedes(self, other: Self) -> bool {
        self.is_empty() || other.is_empty() || self.hi < other.lo
    }

    /// The position of one interval against the other (IEEE 1788, `overlap`).
    ///
    /// ```
    /// # use interval_core::{Interval, interval::Overlap};
    /// let (x, y) = (Interval::new(1.0, 2.0)?, Interval::new(2.0, 3.0)?);
    /// assert_eq!(x.overlap(y), Overlap::Meets);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn overlap(self, other: Self) -> Overlap {
        use Ordering::{Equal, Greater, Less};
        let (a, b, c, d) = (self.lo, self.hi, other.lo, other.hi);
        match (self.is_empty(), other.is_empty()) {
            (true, true) => return Overlap::BothEmpty,
            (true, false) => return Overlap::FirstEmpty,
            (false, true) => return Overlap::SecondEmpty,
            (false, false) => {}
        }
        if b < c {
            return Overlap::Before;
        }
        if d < a {
            return Overlap::After;
        }
        if b == c && a < b && c < d {
            return Overlap::Meets;
        }
        if a == d && c < d && a < b {
            return Overlap::MetBy;
        }
        match (order(a, c), order(b, d)) {
            (Equal, Equal) => Overlap::Equals,
            (Equal, Less) => Overlap::Starts,
            (Equal, Greater) => Overlap::StartedBy,
            (Less, Equal) => Overlap::FinishedBy,
            (Greater, Equal) => Overlap::Finishes,
            (Less, Less) => Overlap::Overlaps,
            (Less, Greater) => Overlap::Contains,
            (Greater, Greater) => Overlap::OverlappedBy,
            (Greater, Less) => Overlap::ContainedBy,
        }
    }
}
