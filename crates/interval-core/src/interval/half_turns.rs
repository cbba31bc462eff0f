//! Trigonometric functions of angles in half turns and their inverses (IEEE 1788, table 10.5). Each result is the tightest
//! interval of doubles; multiples of a quarter are exact.

use super::Interval;
use super::elementary::{angles, increasing, passes};
use crate::elementary as point;
use crate::elementary::{HalfTurns, Turning};

impl Interval {
    /// `{sin(pi x)}`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(0.5, 1.0)?.sin_pi(), Interval::new(0.0, 1.0)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn sin_pi(self) -> Self {
        self.wave::<HalfTurns>(1)
    }

    /// `{cos(pi x)}`.
    #[must_use]
    #[inline(always)]
    pub fn cos_pi(self) -> Self {
        self.wave::<HalfTurns>(0)
    }

    /// `{tan(pi x)}` of the `x` that are no odd multiple of a half; everything where such a pole lies inside.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(0.25, 0.5)?.tan_pi(), Interval::new(1.0, f64::INFINITY)?);
    /// assert!(Interval::point(0.5)?.tan_pi().is_empty());
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn tan_pi(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        if !self.is_bounded() || self.hi - self.lo > 1.0 {
            return Self::ENTIRE;
        }
        let (a, b) = (HalfTurns::new(self.lo), HalfTurns::new(self.hi));
        let (low, high) = (a.tan(), b.tan());
        if self.lo == self.hi {
            return low.map_or(Self::EMPTY, |value| Self::made(value.down, value.up));
        }
        let (Some(first), Some(last)) = (a.quarter_turns(), b.quarter_turns()) else {
            return Self::ENTIRE;
        };
        // A pole at an end is a limit from one side.
        let last = if high.is_none() { last - 1 } else { last };
        if passes(first, last, 1, 2) {
            return Self::ENTIRE;
        }
        Self::made(low.map_or(f64::NEG_INFINITY, |v| v.down), high.map_or(f64::INFINITY, |v| v.up))
    }

    /// `{asin(x) / pi : -1 <= x <= 1}`.
    #[must_use]
    #[inline(always)]
    pub fn asin_pi(self) -> Self {
        increasing!(self.intersection(Self::UNIT), point::asin_pi)
    }

    /// `{acos(x) / pi : -1 <= x <= 1}`.
    #[must_use]
    #[inline(always)]
    pub fn acos_pi(self) -> Self {
        let x = self.intersection(Self::UNIT);
        if x.is_empty() { Self::EMPTY } else { Self::made(point::acos_pi(x.hi).down, point::acos_pi(x.lo).up) }
    }

    /// `{atan(x) / pi}`.
    #[must_use]
    #[inline(always)]
    pub fn atan_pi(self) -> Self {
        increasing!(self, point::atan_pi)
    }

    /// `{atan2(y, x) / pi : (x, y) != (0, 0)}` with `self` as `y`, in (-1, 1]; see [`atan2`](Self::atan2).
    #[must_use]
    #[inline(always)]
    pub fn atan2_pi(self, x: Self) -> Self {
        angles!(self, x, point::atan2_pi, 1.0)
    }
}
