//! Powers: integer exponents on the whole line, real exponents on `x > 0` (and 0 to a positive power), integer roots.

use super::Interval;
use crate::elementary as point;
use crate::elementary::Bracket;

/// `x^n` of a bound, `n > 0`: infinite bounds are limits.
#[inline(always)]
fn bound(x: f64, n: i32) -> Bracket {
    if x.is_infinite() { Bracket::exact(if n % 2 == 0 { f64::INFINITY } else { x }) } else { point::pown(x, n) }
}

/// `x^n` of a bound that is not zero, `n < 0`.
#[inline(always)]
fn reciprocal_bound(x: f64, n: i32) -> Bracket {
    if x.is_infinite() { Bracket::exact(0.0) } else { point::pown(x, n) }
}

/// `x^y` of corners of a box in `x >= 0`, in the limit.
#[inline(always)]
fn corner(x: f64, y: f64) -> Bracket {
    if y == 0.0 || x == 1.0 {
        Bracket::exact(1.0)
    } else if x == 0.0 || x == f64::INFINITY || y.is_infinite() {
        let grows = (x > 1.0) == (y > 0.0);
        Bracket::exact(if grows { f64::INFINITY } else { 0.0 })
    } else {
        point::pow(x, y)
    }
}

impl Interval {
    /// `{x^n}` for an integer `n`; with negative `n` zero has no power.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(-1.0, 2.0)?.powi(2), Interval::new(0.0, 4.0)?);
    /// assert_eq!(Interval::new(-1.0, 2.0)?.powi(-1), Interval::ENTIRE);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn powi(self, n: i32) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        if n == 0 {
            return Self::ONE;
        }
        if n == 2 {
            return self.square();
        }
        if n > 0 {
            let x = if n % 2 == 0 { self.abs() } else { self };
            return Self::made(bound(x.lo, n).down, bound(x.hi, n).up);
        }
        if self.lo == 0.0 && self.hi == 0.0 {
            return Self::EMPTY;
        }
        let x = if n % 2 == 0 { self.abs() } else { self };
        if x.lo < 0.0 && x.hi > 0.0 {
            return Self::ENTIRE;
        }
        let lo = if x.hi == 0.0 { f64::NEG_INFINITY } else { reciprocal_bound(x.hi, n).down };
        let hi = if x.lo == 0.0 { f64::INFINITY } else { reciprocal_bound(x.lo, n).up };
        Self::made(lo, hi)
    }

    /// `{x^y : x > 0, or x = 0 and y > 0}`.
    ///
    /// For fixed `y` a power is monotone in `x` and for fixed `x` in `y`, so the extremes stand at two corners, which
    /// the signs of `y` and of `x - 1` single out.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let x = Interval::new(4.0, 9.0)?;
    /// assert_eq!(x.pow(Interval::point(0.5)?), Interval::new(2.0, 3.0)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn pow(self, exponent: Self) -> Self {
        let y = exponent;
        if self.is_empty() || y.is_empty() || self.hi < 0.0 || (self.hi == 0.0 && y.hi <= 0.0) {
            return Self::EMPTY;
        }
        if self.hi == 0.0 {
            return Self::ZERO;
        }
        let (a, b, c, d) = (self.lo.max(0.0), self.hi, y.lo, y.hi);
        let (lo, hi) = if c >= 0.0 {
            // 0^0 stands for x^0 = 1 with x > 0 and for 0^y = 0 with y > 0.
            let low = if a == 0.0 && d > 0.0 { 0.0 } else { corner(a, if a >= 1.0 { c } else { d }).down };
            (low, corner(b, if b >= 1.0 { d } else { c }).up)
        } else if d <= 0.0 {
            (corner(b, if b >= 1.0 { c } else { d }).down, corner(a, if a >= 1.0 { d } else { c }).up)
        } else if a >= 1.0 {
            (corner(b, c).down, corner(b, d).up)
        } else if b <= 1.0 {
            (corner(a, d).down, corner(a, c).up)
        } else {
            (corner(a, d).down.min(corner(b, c).down), corner(a, c).up.max(corner(b, d).up))
        };
        Self::made(lo, hi)
    }
}
