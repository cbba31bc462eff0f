//! Numbers that describe an interval. `width`, `radius` and `magnitude` are rounded up, `mignitude` is exact.

use super::Interval;
use crate::names::named;
use crate::rounding::sub_up;

named! {
    /// A number that describes an interval.
    Measure, "measure" {
        /// [`Interval::midpoint`].
        Midpoint => "midpoint",
        /// [`Interval::radius`].
        Radius => "radius",
        /// [`Interval::width`].
        Width => "width",
        /// [`Interval::magnitude`].
        Magnitude => "magnitude",
        /// [`Interval::mignitude`].
        Mignitude => "mignitude",
    }
}

impl Measure {
    /// The number for one interval.
    #[must_use]
    pub fn of(self, x: Interval) -> f64 {
        match self {
            Self::Midpoint => x.midpoint(),
            Self::Radius => x.radius(),
            Self::Width => x.width(),
            Self::Magnitude => x.magnitude(),
            Self::Mignitude => x.mignitude(),
        }
    }
}

impl Interval {
    /// A finite double inside the interval, the nearest to its centre (0 for the whole line, the largest double of a
    /// half line's finite side). It is NaN for the empty interval.
    #[must_use]
    pub fn midpoint(self) -> f64 {
        if self.is_empty() {
            f64::NAN
        } else if self.lo == f64::NEG_INFINITY {
            if self.hi == f64::INFINITY { 0.0 } else { f64::MIN }
        } else if self.hi == f64::INFINITY {
            f64::MAX
        } else {
            let sum = self.lo + self.hi;
            if sum.is_finite() { 0.5 * sum } else { 0.5 * self.lo + 0.5 * self.hi }
        }
    }

    /// The smallest double `r` with the interval inside `[m - r, m + r]` for `m` = [`midpoint`](Self::midpoint); NaN
    /// for the empty interval.
    #[must_use]
    pub fn radius(self) -> f64 {
        if self.is_empty() {
            return f64::NAN;
        }
        let m = self.midpoint();
        sub_up(self.hi, m).max(sub_up(m, self.lo))
    }

    /// `hi - lo` rounded up; NaN for the empty interval.
    #[must_use]
    pub fn width(self) -> f64 {
        if self.is_empty() { f64::NAN } else { sub_up(self.hi, self.lo) }
    }

    /// The largest absolute value; NaN for the empty interval.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        if self.is_empty() { f64::NAN } else { self.lo.abs().max(self.hi.abs()) }
    }

    /// The smallest absolute value; NaN for the empty interval.
    #[must_use]
    pub fn mignitude(self) -> f64 {
        if self.is_empty() {
            f64::NAN
        } else if self.contains(0.0) {
            0.0
        } else {
            self.lo.abs().min(self.hi.abs())
        }
    }
}
