//! Intervals as sets.

use super::Interval;

impl Interval {
    /// True if no number is inside.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    /// True if both bounds are finite and something is inside.
    #[must_use]
    pub fn is_bounded(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// True if the number `x` is inside; infinities and NaN never are.
    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        x.is_finite() && self.lo <= x && x <= self.hi
    }

    /// True if every member of this interval is in `other`.
    #[must_use]
    pub fn subset(self, other: Self) -> bool {
        self.is_empty() || (other.lo <= self.lo && self.hi <= other.hi)
    }

    /// The common members.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        let common = Self::made(self.lo.max(other.lo), self.hi.min(other.hi));
        if common.is_empty() { Self::EMPTY } else { common }
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self::made(self.lo.min(other.lo), self.hi.max(other.hi))
    }
}
