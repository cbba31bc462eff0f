//! Elementary functions: each result is the tightest interval of doubles around the range over the operand (IEEE 1788,
//! table 9.1). Members outside the domain are left out; where none is left the result is empty.

use super::Interval;
use crate::elementary as point;
use crate::elementary::Bracket;

/// `[f(a), f(b)]` for an increasing function.
#[inline(always)]
fn increasing(x: Interval, f: impl Fn(f64) -> Bracket) -> Interval {
    if x.is_empty() { Interval::EMPTY } else { Interval::raw(f(x.lo).down, f(x.hi).up) }
}

/// Whether some integer `q` with `first < q <= last` is `residue` modulo `period`.
fn passes(first: i64, last: i64, residue: i64, period: i64) -> bool {
    (last - residue).div_euclid(period) > (first - residue).div_euclid(period)
}

impl Interval {
    pub(super) const UNIT: Self = Self { lo: -1.0, hi: 1.0 };

    /// `{e^x}`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let e = Interval::ONE.exp();
    /// assert_eq!((e.lo(), e.hi()), (2.718281828459045, 2.7182818284590455));
    /// ```
    #[must_use]
    #[inline]
    pub fn exp(self) -> Self {
        increasing(self, point::exp)
    }

    /// `{2^x}`.
    #[must_use]
    #[inline]
    pub fn exp2(self) -> Self {
        increasing(self, point::exp2)
    }

    /// `{10^x}`.
    #[must_use]
    #[inline]
    pub fn exp10(self) -> Self {
        increasing(self, point::exp10)
    }

    #[inline(always)]
    fn logarithm(self, f: impl Fn(f64) -> Bracket) -> Self {
        if self.hi <= 0.0 {
            return Self::EMPTY;
        }
        increasing(Self::raw(self.lo.max(0.0), self.hi), f)
    }

    /// `{ln x : x > 0}`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(0.0, 1.0)?.ln(), Interval::new(f64::NEG_INFINITY, 0.0)?);
    /// assert!(Interval::ZERO.ln().is_empty());
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub fn ln(self) -> Self {
        self.logarithm(point::log)
    }

    /// `{log2 x : x > 0}`.
    #[must_use]
    #[inline]
    pub fn log2(self) -> Self {
        self.logarithm(point::log2)
    }

    /// `{log10 x : x > 0}`.
    #[must_use]
    #[inline]
    pub fn log10(self) -> Self {
        self.logarithm(point::log10)
    }

    /// Range of the sine or cosine `f`, which has its maxima where a number of quarter turns `q = top` modulo 4 is
    /// completed, and its minima two later.
    #[inline(always)]
    fn wave(self, f: impl Fn(f64) -> Bracket, top: i64) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        if !self.is_bounded() || self.hi - self.lo > 7.0 {
            return Self::UNIT;
        }
        if self.lo == self.hi {
            let value = f(self.lo);
            return Self::raw(value.down, value.up);
        }
        let (Some(first), Some(last)) = (point::quarter_turns(self.lo), point::quarter_turns(self.hi)) else {
            return Self::UNIT;
        };
        let (low, high) = (passes(first, last, top + 2, 4), passes(first, last, top, 4));
        if low && high {
            return Self::UNIT;
        }
        let (a, b) = (f(self.lo), f(self.hi));
        Self::raw(if low { -1.0 } else { a.down.min(b.down) }, if high { 1.0 } else { a.up.max(b.up) })
    }

    /// `{sin x}`, x in radians.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(1.0, 2.0)?.sin().hi(), 1.0);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub fn sin(self) -> Self {
        self.wave(point::sin, 1)
    }

    /// `{cos x}`, x in radians.
    #[must_use]
    #[inline]
    pub fn cos(self) -> Self {
        self.wave(point::cos, 0)
    }

    /// `{tan x}`, x in radians; everything where a pole lies inside.
    #[must_use]
    #[inline]
    pub fn tan(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        if !self.is_bounded() {
            return Self::ENTIRE;
        }
        if self.lo != self.hi {
            let (Some(first), Some(last)) = (point::quarter_turns(self.lo), point::quarter_turns(self.hi)) else {
                return Self::ENTIRE;
            };
            if passes(first, last, 1, 2) {
                return Self::ENTIRE;
            }
        }
        increasing(self, point::tan)
    }

    /// `{asin x : -1 <= x <= 1}`.
    #[must_use]
    #[inline]
    pub fn asin(self) -> Self {
        increasing(self.intersection(Self::UNIT), point::asin)
    }

    /// `{acos x : -1 <= x <= 1}`.
    #[must_use]
    #[inline]
    pub fn acos(self) -> Self {
        let x = self.intersection(Self::UNIT);
        if x.is_empty() { Self::EMPTY } else { Self::raw(point::acos(x.hi).down, point::acos(x.lo).up) }
    }

    /// `{atan x}`.
    #[must_use]
    #[inline]
    pub fn atan(self) -> Self {
        increasing(self, point::atan)
    }

    /// `{atan2(y, x) : (x, y) != (0, 0)}` with `self` as `y`: the angle of the point (x, y) in (-pi, pi].
    ///
    /// A box that meets the negative half of the x axis from below gives the whole turn.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let east_to_north = Interval::new(0.0, 1.0)?.atan2(Interval::new(0.0, 1.0)?);
    /// assert_eq!((east_to_north.lo(), east_to_north.hi()), (0.0, 1.5707963267948968));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline]
    pub fn atan2(self, x: Self) -> Self {
        let y = self;
        if y.is_empty() || x.is_empty() || (y == Self::ZERO && x == Self::ZERO) {
            return Self::EMPTY;
        }
        if y.lo < 0.0 && y.hi >= 0.0 && x.lo < 0.0 {
            let turn = point::atan2(0.0, -1.0).up;
            return Self::raw(-turn, turn);
        }
        if y.lo < 0.0 && y.hi <= 0.0 {
            return -Self::upper_half(-y, x);
        }
        if y.lo >= 0.0 {
            return Self::upper_half(y, x);
        }
        // The right half plane: the steepest directions are at the smallest x.
        Self::raw(point::atan2(y.lo, x.lo).down, point::atan2(y.hi, x.lo).up)
    }

    /// Angles of a box with `y >= 0`, which fall as `x` grows.
    #[inline(always)]
    fn upper_half(y: Self, x: Self) -> Self {
        let least = if x.hi > 0.0 {
            point::atan2(y.lo, x.hi).down
        } else {
            // Where the box ends on the y axis or left of it the least angle is at its top; (0, 0) itself has none.
            point::atan2(y.hi, if y.hi == 0.0 { -1.0 } else { x.hi }).down
        };
        let greatest = if x.lo < 0.0 {
            point::atan2(y.lo, x.lo).up
        } else if y.hi == 0.0 {
            0.0
        } else {
            point::atan2(y.hi, x.lo).up
        };
        Self::raw(least, greatest)
    }

    /// `{sinh x}`.
    #[must_use]
    #[inline]
    pub fn sinh(self) -> Self {
        increasing(self, point::sinh)
    }

    /// `{cosh x}`.
    #[must_use]
    #[inline]
    pub fn cosh(self) -> Self {
        increasing(self.abs(), point::cosh)
    }

    /// `{tanh x}`.
    #[must_use]
    #[inline]
    pub fn tanh(self) -> Self {
        increasing(self, point::tanh)
    }

    /// `{arsinh x}`.
    #[must_use]
    #[inline]
    pub fn asinh(self) -> Self {
        increasing(self, point::asinh)
    }

    /// `{arcosh x : x >= 1}`.
    #[must_use]
    #[inline]
    pub fn acosh(self) -> Self {
        if self.hi < 1.0 {
            return Self::EMPTY;
        }
        increasing(Self::raw(self.lo.max(1.0), self.hi), point::acosh)
    }

    /// `{artanh x : -1 < x < 1}`.
    #[must_use]
    #[inline]
    pub fn atanh(self) -> Self {
        if self.hi <= -1.0 || self.lo >= 1.0 {
            return Self::EMPTY;
        }
        increasing(self.intersection(Self::UNIT), point::atanh)
    }
}
