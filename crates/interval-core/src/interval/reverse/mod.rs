//! Reverse operations: the members of `x` that an operation takes into `c` (IEEE 1788, 10.5.4 and table 10.1).
//!
//! The solutions form branches whose ends are real numbers known by both their roundings. The question whether a double
//! lies on a branch is then decided exactly, so each result is the tightest interval around the members.

mod angle;
mod division;
mod periodic;

use super::Interval;
use crate::elementary as point;
use crate::elementary::Bracket;

/// The part of `x` between two real numbers.
fn clip(x: Interval, from: Bracket, to: Bracket) -> Interval {
    // Beside a tight bracket a double lies on one side of the number; in a wide one it may be on either.
    let before = if from.is_tight() { x.hi < from.up } else { x.hi < from.down };
    let behind = if to.is_tight() { x.lo > to.down } else { x.lo > to.up };
    if x.is_empty() || before || behind {
        return Interval::EMPTY;
    }
    Interval::made(x.lo.max(from.down), x.hi.min(to.up))
}

/// The hull of the parts of `x` on `[from, to]` and on `[-to, -from]`.
fn clip_both(x: Interval, from: Bracket, to: Bracket) -> Interval {
    clip(x, to.neg(), from.neg()).hull(clip(x, from, to))
}

fn square_root(x: f64) -> Bracket {
    Bracket { down: crate::rounding::sqrt_down(x), up: crate::rounding::sqrt_up(x) }
}

impl Interval {
    /// `{t in x : t^2 in self}`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let c = Interval::new(4.0, 9.0)?;
    /// assert_eq!(c.sqr_rev(Interval::new(0.0, 10.0)?), Interval::new(2.0, 3.0)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn sqr_rev(self, x: Self) -> Self {
        if self.is_empty() || self.hi < 0.0 {
            return Self::EMPTY;
        }
        clip_both(x, square_root(self.lo.max(0.0)), square_root(self.hi))
    }

    /// `{t in x : |t| in self}`.
    #[must_use]
    pub fn abs_rev(self, x: Self) -> Self {
        if self.is_empty() || self.hi < 0.0 {
            return Self::EMPTY;
        }
        clip_both(x, Bracket::exact(self.lo.max(0.0)), Bracket::exact(self.hi))
    }

    /// `{t in x : t^n in self}`.
    #[must_use]
    pub fn powi_rev(self, x: Self, n: i32) -> Self {
        if self.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        if n == 0 {
            return if self.contains(1.0) { x } else { Self::EMPTY };
        }
        let positive = Self::made(self.lo.max(0.0), self.hi);
        let right = if positive.lo > positive.hi { Self::EMPTY } else { positive_roots(positive, n, x) };
        let left = if n % 2 == 0 {
            if positive.lo > positive.hi { Self::EMPTY } else { -positive_roots(positive, n, -x) }
        } else {
            let negative = -Self::made(self.lo, self.hi.min(0.0));
            if negative.lo > negative.hi { Self::EMPTY } else { -positive_roots(negative, n, -x) }
        };
        left.hull(right)
    }

    /// `{t in x : cosh t in self}`.
    #[must_use]
    pub fn cosh_rev(self, x: Self) -> Self {
        if self.is_empty() || self.hi < 1.0 {
            return Self::EMPTY;
        }
        clip_both(x, point::acosh(self.lo.max(1.0)), point::acosh(self.hi))
    }
}

/// `{t in x : t >= 0, t^n in c}` for `c >= 0`; zero only for positive `n`.
fn positive_roots(c: Interval, n: i32, x: Interval) -> Interval {
    let root = |v: f64| -> Bracket {
        if v == 0.0 || v == f64::INFINITY {
            Bracket::exact(if n > 0 { v } else { 1.0 / v.abs() })
        } else {
            point::root(v, f64::from(n))
        }
    };
    if n > 0 {
        return clip(x, root(c.lo), root(c.hi));
    }
    if c.hi == 0.0 || x.hi <= 0.0 {
        // t^n is never zero, and zero has no negative power.
        return Interval::EMPTY;
    }
    clip(x, root(c.hi), root(c.lo))
}
