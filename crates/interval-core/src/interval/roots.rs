//! Integer roots, the reciprocal square root and the length of a vector (IEEE 1788, table 10.5). Each result is the
//! tightest interval of doubles.

use super::Interval;
use crate::elementary as point;
use crate::elementary::Bracket;

/// `x^(1/n)` of a bound `x >= 0`, in the limit.
#[inline(always)]
fn root(x: f64, n: i32) -> Bracket {
    if x == 0.0 || x == f64::INFINITY {
        let grows = (x > 1.0) == (n > 0);
        Bracket::exact(if grows { f64::INFINITY } else { 0.0 })
    } else {
        point::rootn(x, n)
    }
}

/// The same of a bound of either sign, for an odd `n > 0`.
#[inline(always)]
fn odd_root(x: f64, n: i32) -> Bracket {
    if x < 0.0 { root(-x, n).neg() } else { root(x, n) }
}

impl Interval {
    /// `{x^(1/n)}`: of all `x` for an odd `n`, of `x >= 0` for an even one, and not of 0 for a negative one. No number has
    /// a root with `n = 0`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(-27.0, 8.0)?.rootn(3), Interval::new(-3.0, 2.0)?);
    /// assert_eq!(Interval::new(-1.0, 16.0)?.rootn(4), Interval::new(0.0, 2.0)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn rootn(self, n: i32) -> Self {
        let even = n % 2 == 0;
        if self.is_empty() || n == 0 || (even && self.hi < 0.0) {
            return Self::EMPTY;
        }
        let x = if even { Self::made(self.lo.max(0.0), self.hi) } else { self };
        if n > 0 {
            return Self::made(odd_root(x.lo, n).down, odd_root(x.hi, n).up);
        }
        if x.lo == 0.0 && x.hi == 0.0 {
            return Self::EMPTY;
        }
        if x.lo < 0.0 && x.hi > 0.0 {
            return Self::ENTIRE;
        }
        // Falling on either side of 0, whose limit has the sign of the side.
        if x.hi <= 0.0 {
            return Self::made(-root(-x.hi, n).up, -root(-x.lo, n).down);
        }
        Self::made(root(x.hi, n).down, root(x.lo, n).up)
    }

    /// `{x^(1/3)}`.
    #[must_use]
    #[inline(always)]
    pub fn cbrt(self) -> Self {
        self.rootn(3)
    }

    /// `{1 / sqrt(x) : x > 0}`.
    #[must_use]
    #[inline(always)]
    pub fn rsqrt(self) -> Self {
        if self.is_empty() || self.hi <= 0.0 {
            return Self::EMPTY;
        }
        let hi = if self.lo <= 0.0 { f64::INFINITY } else { point::rsqrt(self.lo).up };
        Self::made(point::rsqrt(self.hi).down, hi)
    }

    /// `{sqrt(x^2 + y^2)}`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let length = Interval::new(-3.0, 3.0)?.hypot(Interval::point(4.0)?);
    /// assert_eq!(length, Interval::new(4.0, 5.0)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn hypot(self, y: Self) -> Self {
        if self.is_empty() || y.is_empty() {
            return Self::EMPTY;
        }
        let (x, y) = (self.abs(), y.abs());
        let hi = if x.is_bounded() && y.is_bounded() { point::hypot(x.hi, y.hi).up } else { f64::INFINITY };
        Self::made(point::hypot(x.lo, y.lo).down, hi)
    }
}
