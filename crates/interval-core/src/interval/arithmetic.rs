//! Arithmetic: each result is the tightest interval of doubles that contains every exact result (IEEE 1788, 10.6.1).

use super::Interval;
use crate::rounding::{add_down, add_up, div_up, mul_down, mul_up, sqrt_down, sqrt_up, sub_down, sub_up};
use core::ops::{Add, Div, Mul, Neg, Sub};

impl Add for Interval {
    type Output = Self;

    /// `[a + c, b + d]`.
    #[inline]
    fn add(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self::made(add_down(self.lo, other.lo), add_up(self.hi, other.hi))
    }
}

impl Sub for Interval {
    type Output = Self;

    /// `[a - d, b - c]`.
    #[inline]
    fn sub(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self::made(sub_down(self.lo, other.hi), sub_up(self.hi, other.lo))
    }
}

impl Neg for Interval {
    type Output = Self;

    /// `[-b, -a]`, exact.
    fn neg(self) -> Self {
        Self::made(-self.hi, -self.lo)
    }
}

/// The sign of an interval that holds more than zero.
enum Sign {
    /// `0 <= a`
    NonNegative,
    /// `b <= 0`
    NonPositive,
    /// `a < 0 < b`
    Mixed,
}

fn sign(x: Interval) -> Sign {
    if x.lo >= 0.0 {
        Sign::NonNegative
    } else if x.hi <= 0.0 {
        Sign::NonPositive
    } else {
        Sign::Mixed
    }
}

/// Product of two bounds; an infinite bound is never attained, so `0 * inf` is 0.
fn bound_down(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { mul_down(a, b) }
}

fn bound_up(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { mul_up(a, b) }
}

impl Mul for Interval {
    type Output = Self;

    /// ```text
    ///            c >= 0         d <= 0         c < 0 < d
    /// a >= 0     [ac, bd]       [bc, ad]       [bc, bd]
    /// b <= 0     [ad, bc]       [bd, ac]       [ad, ac]
    /// a < 0 < b  [ad, bd]       [bc, ac]       [min(ad, bc), max(ac, bd)]
    /// ```
    #[inline]
    fn mul(self, other: Self) -> Self {
        use Sign::{Mixed, NonNegative, NonPositive};
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        let (a, b, c, d) = (self.lo, self.hi, other.lo, other.hi);
        let ((p, q), (r, s)) = match (sign(self), sign(other)) {
            (NonNegative, NonNegative) => ((a, c), (b, d)),
            (NonNegative, NonPositive) => ((b, c), (a, d)),
            (NonNegative, Mixed) => ((b, c), (b, d)),
            (NonPositive, NonNegative) => ((a, d), (b, c)),
            (NonPositive, NonPositive) => ((b, d), (a, c)),
            (NonPositive, Mixed) => ((a, d), (a, c)),
            (Mixed, NonNegative) => ((a, d), (b, d)),
            (Mixed, NonPositive) => ((b, c), (a, c)),
            (Mixed, Mixed) => {
                return Self::made(bound_down(a, d).min(bound_down(b, c)), bound_up(a, c).max(bound_up(b, d)));
            }
        };
        Self::made(bound_down(p, q), bound_up(r, s))
    }
}

impl Div for Interval {
    type Output = Self;

    /// The hull of `{x / y : y != 0}`. A divisor of exactly zero gives the empty interval, one with zero inside gives
    /// everything, one with zero at an end a half line.
    #[inline]
    fn div(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() || (other.lo == 0.0 && other.hi == 0.0) {
            return Self::EMPTY;
        }
        if self.lo == 0.0 && self.hi == 0.0 {
            return Self::ZERO;
        }
        if other.lo < 0.0 && other.hi > 0.0 {
            return Self::ENTIRE;
        }
        if other.hi <= 0.0 {
            return (-self) / (-other);
        }
        // 0 <= c < d or 0 < c = d from here on.
        let (a, b, c, d) = (self.lo, self.hi, other.lo, other.hi);
        let lo = if a >= 0.0 { quotient_down(a, d) } else { quotient_down(a, c) };
        let hi = if b <= 0.0 { quotient_up(b, d) } else { quotient_up(b, c) };
        Self::made(lo, hi)
    }
}

/// `x / y` rounded down for a bound `x` and a bound `y >= 0`; unattained infinities and zeros are limits.
fn quotient_down(x: f64, y: f64) -> f64 {
    -quotient_up(-x, y)
}

fn quotient_up(x: f64, y: f64) -> f64 {
    if x == 0.0 || y == f64::INFINITY {
        // A finite or infinite numerator over an unbounded divisor: an infinite numerator is not attained either, and
        // the caller only asks for this quotient where 0 is the limit.
        0.0
    } else if y == 0.0 {
        if x > 0.0 { f64::INFINITY } else { f64::NEG_INFINITY }
    } else {
        div_up(x, y)
    }
}

impl Interval {
    /// `{1 / x : x != 0}`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// assert_eq!(Interval::new(2.0, 4.0)?.recip(), Interval::new(0.25, 0.5)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn recip(self) -> Self {
        Self::ONE / self
    }

    /// `{x^2}`: tighter than `x * x` where the interval holds both signs.
    #[must_use]
    pub fn square(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let (small, large) = (self.mignitude(), self.magnitude());
        Self::made(bound_down(small, small), bound_up(large, large))
    }

    /// The square root of the non-negative part; empty where there is none.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.is_empty() || self.hi < 0.0 {
            return Self::EMPTY;
        }
        Self::made(sqrt_down(self.lo.max(0.0)), sqrt_up(self.hi))
    }

    /// `{|x|}`, exact.
    #[must_use]
    pub fn abs(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::made(self.mignitude(), self.magnitude())
    }

    /// `{x |x|}`, the quadratic drag law: odd and increasing, so both ends are those of the operand.
    #[must_use]
    pub fn signed_square(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::made(
            if self.lo < 0.0 { -mul_up(self.lo, self.lo) } else { mul_down(self.lo, self.lo) },
            if self.hi < 0.0 { -mul_down(self.hi, self.hi) } else { mul_up(self.hi, self.hi) },
        )
    }

    /// `{max(x, y)}`, exact.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self::made(self.lo.max(other.lo), self.hi.max(other.hi))
    }

    /// `{min(x, y)}`, exact.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return Self::EMPTY;
        }
        Self::made(self.lo.min(other.lo), self.hi.min(other.hi))
    }
}
