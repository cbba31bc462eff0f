//! Functions near 1: exponentials less one, logarithms of one plus a number (IEEE 1788, table 10.5). Each result is the
//! tightest interval of doubles.

use super::Interval;
use super::elementary::increasing;
use crate::elementary as point;
use crate::elementary::Bracket;

/// `(1 + x)^y - 1` of corners of a box in `x >= -1`, in the limit.
fn corner(x: f64, y: f64) -> Bracket {
    if y == 0.0 || x == 0.0 {
        Bracket::exact(0.0)
    } else if x == -1.0 || x == f64::INFINITY || y.is_infinite() {
        let grows = (x > 0.0) == (y > 0.0);
        Bracket::exact(if grows { f64::INFINITY } else { -1.0 })
    } else {
        point::compound_m1(x, y)
    }
}

impl Interval {
    /// `{e^x - 1}`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let small = Interval::point(1e-20)?.exp_m1();
    /// assert_eq!((small.lo(), small.hi()), (1e-20, 1e-20_f64.next_up()));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn exp_m1(self) -> Self {
        increasing!(self, point::exp_m1)
    }

    /// `{2^x - 1}`.
    #[must_use]
    #[inline(always)]
    pub fn exp2_m1(self) -> Self {
        increasing!(self, point::exp2_m1)
    }

    /// `{10^x - 1}`.
    #[must_use]
    #[inline(always)]
    pub fn exp10_m1(self) -> Self {
        increasing!(self, point::exp10_m1)
    }

    /// The members above -1, with -1 for their limit.
    #[inline(always)]
    fn above_minus_one(self) -> Self {
        if self.hi <= -1.0 { Self::EMPTY } else { Self::made(self.lo.max(-1.0), self.hi) }
    }

    /// `{ln(1 + x) : x > -1}`.
    #[must_use]
    #[inline(always)]
    pub fn ln_1p(self) -> Self {
        increasing!(self.above_minus_one(), point::ln_1p)
    }

    /// `{log2(1 + x) : x > -1}`.
    #[must_use]
    #[inline(always)]
    pub fn log2_1p(self) -> Self {
        increasing!(self.above_minus_one(), point::log2_1p)
    }

    /// `{log10(1 + x) : x > -1}`.
    #[must_use]
    #[inline(always)]
    pub fn log10_1p(self) -> Self {
        increasing!(self.above_minus_one(), point::log10_1p)
    }

    /// `{(1 + x)^y - 1 : x > -1, or x = -1 and y > 0}`.
    ///
    /// As for [`pow`](Self::pow) the extremes stand at two corners, which the signs of `y` and of `x` single out.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let rate = Interval::point(0.5)?.compound_m1(Interval::point(2.0)?);
    /// assert_eq!(rate, Interval::point(1.25)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn compound_m1(self, exponent: Self) -> Self {
        let y = exponent;
        if self.is_empty() || y.is_empty() || self.hi < -1.0 || (self.hi == -1.0 && y.hi <= 0.0) {
            return Self::EMPTY;
        }
        if self.hi == -1.0 {
            return Self::made(-1.0, -1.0);
        }
        let (a, b, c, d) = (self.lo.max(-1.0), self.hi, y.lo, y.hi);
        let (lo, hi) = if c >= 0.0 {
            // 0^0 stands for (1 + x)^0 = 1 with x > -1 and for 0^y = 0 with y > 0.
            let low = if a == -1.0 && d > 0.0 { -1.0 } else { corner(a, if a >= 0.0 { c } else { d }).down };
            (low, corner(b, if b >= 0.0 { d } else { c }).up)
        } else if d <= 0.0 {
            (corner(b, if b >= 0.0 { c } else { d }).down, corner(a, if a >= 0.0 { d } else { c }).up)
        } else if a >= 0.0 {
            (corner(b, c).down, corner(b, d).up)
        } else if b <= 0.0 {
            (corner(a, d).down, corner(a, c).up)
        } else {
            (corner(a, d).down.min(corner(b, c).down), corner(a, c).up.max(corner(b, d).up))
        };
        Self::made(lo, hi)
    }
}
