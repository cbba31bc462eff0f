//! Sums undone: `cancelMinus` and `cancelPlus` of IEEE 1788, 10.5.6.

use super::Interval;
use crate::accumulator;
use crate::rounding::{sub_down, sub_up};
use core::cmp::Ordering;

impl Interval {
    /// The tightest interval `z` with `y + z` around `x`, for bounded `x` at least as wide as bounded `y`. It is the
    /// whole line if there is none. Widths are compared exactly.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let (x, y) = (Interval::new(1.0, 5.0)?, Interval::new(1.0, 2.0)?);
    /// assert_eq!((x + y).cancel_minus(y), x);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn cancel_minus(self, y: Self) -> Self {
        let (x_common, y_common) = (self.is_common(), y.is_common());
        if self.is_empty() && (y.is_empty() || y_common) {
            return Self::EMPTY;
        }
        if !x_common || !y_common {
            return Self::ENTIRE;
        }
        let excess = accumulator::sign_of_sum(&[self.hi, -self.lo, -y.hi, y.lo]);
        if excess == Ordering::Less {
            return Self::ENTIRE;
        }
        Self::made(sub_down(self.lo, y.lo), sub_up(self.hi, y.hi))
    }

    /// As [`cancel_minus`](Self::cancel_minus) with `-y`.
    #[must_use]
    pub fn cancel_plus(self, y: Self) -> Self {
        self.cancel_minus(-y)
    }
}
