//! Integer functions, all exact.

use super::Interval;
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

impl Interval {
    fn ends(self, f: impl Fn(f64) -> f64) -> Self {
        // Adding zero makes -0 plain 0.
        if self.is_empty() { Self::EMPTY } else { Self::raw(f(self.lo) + 0.0, f(self.hi) + 0.0) }
    }

    /// `{the sign of x}`: from -1, 0 and 1.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(0.0, 3.0)?.sign(), Interval::new(0.0, 1.0)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn sign(self) -> Self {
        self.ends(|x| if x == 0.0 { 0.0 } else { x.signum() })
    }

    /// The least integers not below the members.
    #[must_use]
    pub fn ceil(self) -> Self {
        self.ends(f64::ceil)
    }

    /// The greatest integers not above the members.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(-1.5, 2.5)?.floor(), Interval::new(-2.0, 2.0)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn floor(self) -> Self {
        self.ends(f64::floor)
    }

    /// The members without their fractions.
    #[must_use]
    pub fn trunc(self) -> Self {
        self.ends(f64::trunc)
    }

    /// The nearest integers, ties to the even one.
    #[must_use]
    pub fn round_ties_even(self) -> Self {
        self.ends(f64::round_ties_even)
    }

    /// The nearest integers, ties away from zero.
    #[must_use]
    pub fn round(self) -> Self {
        self.ends(f64::round)
    }
}
