//! Elementary functions: each result is the tightest interval of doubles around the range over the operand (IEEE 1788,
//! table 9.1). Members outside the domain are left out; where none is left the result is empty.

use super::Interval;
use crate::elementary as point;
use crate::elementary::{Angle, Turning};

/// `[f(a), f(b)]` for an increasing function. A macro, because a function passed as a value would be compiled without
/// the features of the slice kernels that this is inlined into.
macro_rules! increasing {
    ($x:expr, $f:path) => {{
        let x = $x;
        if x.is_empty() { Interval::EMPTY } else { Interval::made($f(x.lo).down, $f(x.hi).up) }
    }};
}
pub(super) use increasing;

/// Angles of the points (x, y) of a box, the half turn being `$turn`.
macro_rules! angles {
    ($y:expr, $x:expr, $f:path, $turn:expr) => {{
        let (y, x): (Interval, Interval) = ($y, $x);
        if y.is_empty() || x.is_empty() || (y == Interval::ZERO && x == Interval::ZERO) {
            Interval::EMPTY
        } else if y.lo < 0.0 && y.hi >= 0.0 && x.lo < 0.0 {
            let turn: f64 = $turn;
            Interval::made(-turn, turn)
        } else if y.lo < 0.0 && y.hi > 0.0 {
            // The right half plane: the steepest directions are at the smallest x.
            Interval::made($f(y.lo, x.lo).down, $f(y.hi, x.lo).up)
        } else {
            // The upper half plane, in which the angle falls as x grows.
            let below = y.lo < 0.0;
            let y = if below { -y } else { y };
            let least = if x.hi > 0.0 {
                $f(y.lo, x.hi).down
            } else {
                // If the box ends on the y axis or left of it, the least angle is at its top; (0, 0) itself has none.
                $f(y.hi, if y.hi == 0.0 { -1.0 } else { x.hi }).down
            };
            let greatest = if x.lo < 0.0 {
                $f(y.lo, x.lo).up
            } else if y.hi == 0.0 {
                0.0
            } else {
                $f(y.hi, x.lo).up
            };
            let found = Interval::made(least, greatest);
            if below { -found } else { found }
        }
    }};
}
pub(super) use angles;

/// True if some integer `q` with `first < q <= last` is `residue` modulo `period`.
pub(super) fn passes(first: i64, last: i64, residue: i64, period: i64) -> bool {
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
    #[inline(always)]
    pub fn exp(self) -> Self {
        increasing!(self, point::exp)
    }

    /// `{2^x}`.
    #[must_use]
    #[inline(always)]
    pub fn exp2(self) -> Self {
        increasing!(self, point::exp2)
    }

    /// `{10^x}`.
    #[must_use]
    #[inline(always)]
    pub fn exp10(self) -> Self {
        increasing!(self, point::exp10)
    }

    /// The members that have a logarithm, with 0 for their limit.
    #[inline(always)]
    fn positive_part(self) -> Self {
        if self.hi <= 0.0 { Self::EMPTY } else { Self::made(self.lo.max(0.0), self.hi) }
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
    #[inline(always)]
    pub fn ln(self) -> Self {
        increasing!(self.positive_part(), point::log)
    }

    /// `{log2 x : x > 0}`.
    #[must_use]
    #[inline(always)]
    pub fn log2(self) -> Self {
        increasing!(self.positive_part(), point::log2)
    }

    /// `{log10 x : x > 0}`.
    #[must_use]
    #[inline(always)]
    pub fn log10(self) -> Self {
        increasing!(self.positive_part(), point::log10)
    }

    /// Range of the sine or cosine, which has its maxima where a number of quarter turns `q = top` modulo 4 is
    /// completed, and its minima two later.
    #[inline(always)]
    pub(super) fn wave<A: Turning>(self, top: i64) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        if !self.is_bounded() || self.hi - self.lo > A::WHOLE {
            return Self::UNIT;
        }
        let a = A::new(self.lo);
        if self.lo == self.hi {
            let value = a.wave(top);
            return Self::made(value.down, value.up);
        }
        let b = A::new(self.hi);
        let (Some(first), Some(last)) = (a.quarter_turns(), b.quarter_turns()) else {
            return Self::UNIT;
        };
        let (low, high) = (passes(first, last, top + 2, 4), passes(first, last, top, 4));
        if low && high {
            return Self::UNIT;
        }
        let (a, b) = (a.wave(top), b.wave(top));
        Self::made(if low { -1.0 } else { a.down.min(b.down) }, if high { 1.0 } else { a.up.max(b.up) })
    }

    /// `{sin x}`, x in radians.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(1.0, 2.0)?.sin().hi(), 1.0);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    #[inline(always)]
    pub fn sin(self) -> Self {
        self.wave::<Angle>(1)
    }

    /// `{cos x}`, x in radians.
    #[must_use]
    #[inline(always)]
    pub fn cos(self) -> Self {
        self.wave::<Angle>(0)
    }

    /// `{tan x}`, x in radians; everything where a pole lies inside.
    #[must_use]
    #[inline(always)]
    pub fn tan(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        if !self.is_bounded() {
            return Self::ENTIRE;
        }
        let a = Angle::new(self.lo);
        if self.lo == self.hi {
            let value = a.tan();
            return Self::made(value.down, value.up);
        }
        let b = Angle::new(self.hi);
        match (a.quarter_turns(), b.quarter_turns()) {
            (Some(first), Some(last)) if !passes(first, last, 1, 2) => Self::made(a.tan().down, b.tan().up),
            _ => Self::ENTIRE,
        }
    }

    /// `{asin x : -1 <= x <= 1}`.
    #[must_use]
    #[inline(always)]
    pub fn asin(self) -> Self {
        increasing!(self.intersection(Self::UNIT), point::asin)
    }

    /// `{acos x : -1 <= x <= 1}`.
    #[must_use]
    #[inline(always)]
    pub fn acos(self) -> Self {
        let x = self.intersection(Self::UNIT);
        if x.is_empty() { Self::EMPTY } else { Self::made(point::acos(x.hi).down, point::acos(x.lo).up) }
    }

    /// `{atan x}`.
    #[must_use]
    #[inline(always)]
    pub fn atan(self) -> Self {
        increasing!(self, point::atan)
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
    #[inline(always)]
    pub fn atan2(self, x: Self) -> Self {
        angles!(self, x, point::atan2, point::atan2(0.0, -1.0).up)
    }

    /// `{sinh x}`.
    #[must_use]
    #[inline(always)]
    pub fn sinh(self) -> Self {
        increasing!(self, point::sinh)
    }

    /// `{cosh x}`.
    #[must_use]
    #[inline(always)]
    pub fn cosh(self) -> Self {
        increasing!(self.abs(), point::cosh)
    }

    /// `{tanh x}`.
    #[must_use]
    #[inline(always)]
    pub fn tanh(self) -> Self {
        increasing!(self, point::tanh)
    }

    /// `{arsinh x}`.
    #[must_use]
    #[inline(always)]
    pub fn asinh(self) -> Self {
        increasing!(self, point::asinh)
    }

    /// `{arcosh x : x >= 1}`.
    #[must_use]
    #[inline(always)]
    pub fn acosh(self) -> Self {
        if self.hi < 1.0 {
            return Self::EMPTY;
        }
        increasing!(Self::made(self.lo.max(1.0), self.hi), point::acosh)
    }

    /// `{artanh x : -1 < x < 1}`.
    #[must_use]
    #[inline(always)]
    pub fn atanh(self) -> Self {
        if self.hi <= -1.0 || self.lo >= 1.0 {
            return Self::EMPTY;
        }
        increasing!(self.intersection(Self::UNIT), point::atanh)
    }
}
