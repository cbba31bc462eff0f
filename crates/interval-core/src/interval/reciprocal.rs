//! Reciprocals of the trigonometric and hyperbolic functions, and the inverse cotangents. Each result is the tightest
//! interval of doubles; the numbers at which a function has a pole are left out.

use super::Interval;
use super::elementary::passes;
use crate::elementary as point;
use crate::elementary::{Angle, Bracket, Turning};

/// Counts of quarter turns `first` and `last`, such that those completed after `x.lo` and before `x.hi` are
/// `first + 1..=last`: 0, the only multiple of pi that is a double, is not completed at an upper end. `None` where all are.
fn quarters_inside(x: Interval) -> Option<(i64, i64)> {
    if !x.is_bounded() || x.hi - x.lo > 7.0 {
        return None;
    }
    let (first, last) = (Angle::new(x.lo).quarter_turns()?, Angle::new(x.hi).quarter_turns()?);
    Some((first, if x.hi == 0.0 { last - 1 } else { last }))
}

/// The range of an odd function that falls on either side of its only pole, at 0.
macro_rules! falling_beside_pole {
    ($x:expr, $f:path) => {{
        let x: Interval = $x;
        if x.is_empty() || (x.lo == 0.0 && x.hi == 0.0) {
            Interval::EMPTY
        } else if x.lo < 0.0 && x.hi > 0.0 {
            Interval::ENTIRE
        } else {
            let lo = if x.hi == 0.0 { f64::NEG_INFINITY } else { $f(x.hi).down };
            Interval::made(lo, if x.lo == 0.0 { f64::INFINITY } else { $f(x.lo).up })
        }
    }};
}

impl Interval {
    /// `{1 / cos x}`, x in radians; everything where a pole lies inside.
    #[must_use]
    #[inline(always)]
    pub fn sec(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        if self.lo == self.hi {
            let value = point::sec(self.lo);
            return Self::made(value.down, value.up);
        }
        match quarters_inside(self) {
            Some((first, last)) if !passes(first, last, 1, 2) => {
                let (a, b) = (point::sec(self.lo), point::sec(self.hi));
                // 0 is completed at an upper end, too.
                let bottom = passes(first, last, 0, 4) || self.hi == 0.0;
                let lo = if bottom { 1.0 } else { a.down.min(b.down) };
                Self::made(lo, if passes(first, last, 2, 4) { -1.0 } else { a.up.max(b.up) })
            }
            _ => Self::ENTIRE,
        }
    }

    /// `{1 / sin x : x != 0}`, x in radians; everything where a pole lies inside.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(0.0, 2.0)?.csc(), Interval::new(1.0, f64::INFINITY)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn csc(self) -> Self {
        if self.is_empty() || self == Self::ZERO {
            return Self::EMPTY;
        }
        if self.lo == self.hi {
            let value = point::csc(self.lo);
            return Self::made(value.down, value.up);
        }
        let Some((first, last)) = quarters_inside(self) else { return Self::ENTIRE };
        if passes(first, last, 0, 2) {
            return Self::ENTIRE;
        }
        let end = |x: f64, pole: f64| if x == 0.0 { Bracket::exact(pole) } else { point::csc(x) };
        let (a, b) = (end(self.lo, f64::INFINITY), end(self.hi, f64::NEG_INFINITY));
        let lo = if passes(first, last, 1, 4) { 1.0 } else { a.down.min(b.down) };
        Self::made(lo, if passes(first, last, 3, 4) { -1.0 } else { a.up.max(b.up) })
    }

    /// `{cos x / sin x : x != 0}`, x in radians; everything where a pole lies inside.
    #[must_use]
    #[inline(always)]
    pub fn cot(self) -> Self {
        if self.is_empty() || self == Self::ZERO {
            return Self::EMPTY;
        }
        if self.lo == self.hi {
            let value = point::cot(self.lo);
            return Self::made(value.down, value.up);
        }
        match quarters_inside(self) {
            Some((first, last)) if !passes(first, last, 0, 2) => {
                let lo = if self.hi == 0.0 { f64::NEG_INFINITY } else { point::cot(self.hi).down };
                Self::made(lo, if self.lo == 0.0 { f64::INFINITY } else { point::cot(self.lo).up })
            }
            _ => Self::ENTIRE,
        }
    }

    /// `{arccot x}` in (0, pi): the angle of the point (x, 1).
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::ZERO.acot(), Interval::point(1.0)?.asin());
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn acot(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::made(point::atan2(1.0, self.hi).down, point::atan2(1.0, self.lo).up)
    }

    /// `{1 / cosh x}`.
    #[must_use]
    #[inline(always)]
    pub fn sech(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let x = self.abs();
        Self::made(point::sech(x.hi).down, point::sech(x.lo).up)
    }

    /// `{1 / sinh x : x != 0}`.
    #[must_use]
    #[inline(always)]
    pub fn csch(self) -> Self {
        falling_beside_pole!(self, point::csch)
    }

    /// `{cosh x / sinh x : x != 0}`.
    #[must_use]
    #[inline(always)]
    pub fn coth(self) -> Self {
        falling_beside_pole!(self, point::coth)
    }

    /// `{arcoth x : |x| > 1}`.
    #[must_use]
    #[inline(always)]
    pub fn acoth(self) -> Self {
        let (left, right) = (self.lo < -1.0, self.hi > 1.0);
        match (left, right) {
            _ if self.is_empty() => Self::EMPTY,
            (false, false) => Self::EMPTY,
            (true, true) => Self::ENTIRE,
            (false, true) => Self::made(point::acoth(self.hi).down, point::acoth(self.lo.max(1.0)).up),
            (true, false) => Self::made(point::acoth(self.hi.min(-1.0)).down, point::acoth(self.lo).up),
        }
    }
}
