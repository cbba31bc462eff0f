//! Reverses of the angle of a point: one half plane at a time, in which both are linear.
//!
//! For `y > 0` and an angle in `(0, pi)` the equation is `x = y cot(angle)`, and the cotangent falls. So `y` lies between
//! quotients of the ends of `x` by cotangents, and `x` between products. The lower half plane mirrors the upper one, and
//! the axis has the angles 0 and pi alone. A product with the tangent of a double is no double but for 0 (Lindemann).

use super::super::Interval;
use super::clip;
use crate::elementary as point;
use crate::elementary::{Ball, Bracket};
use core::f64::consts::{FRAC_PI_2, PI};

const ZERO: Bracket = Bracket { down: 0.0, up: 0.0 };

/// `x tan(angle)`.
fn rise(x: f64, angle: f64) -> Bracket {
    point::exactly(angle, |sin, cos, p| Some(Ball::from_f64(x).mul(&sin.div(&cos, p)?)))
}

/// `y cot(angle)`; 0 and the infinities stay what they are, but for their sign.
fn run(y: f64, angle: f64) -> Bracket {
    if y == 0.0 {
        return ZERO;
    }
    if y.is_infinite() {
        return Bracket::exact(if angle <= FRAC_PI_2 { y } else { -y });
    }
    point::exactly(angle, |sin, cos, p| Some(Ball::from_f64(y).mul(&cos.div(&sin, p)?)))
}

/// True if pi, which no double is, lies between the bounds.
fn holds_pi(c: Interval) -> bool {
    c.lo <= PI && c.hi > PI
}

/// True if some angle lies in `(0, pi)`.
fn looks_up(c: Interval) -> bool {
    c.hi > 0.0 && c.lo <= PI
}

/// `{t in y : t > 0, atan2(t, s) in c for some s in x}`.
fn upper_y(x: Interval, c: Interval, y: Interval) -> Interval {
    if x.is_empty() || y.is_empty() || !looks_up(c) || y.hi <= 0.0 {
        return Interval::EMPTY;
    }
    let (mut from, mut to) = (ZERO, Bracket::exact(f64::INFINITY));
    if c.hi <= FRAC_PI_2 {
        if x.hi <= 0.0 {
            return Interval::EMPTY;
        }
        if x.hi.is_finite() {
            to = rise(x.hi, c.hi);
        }
    } else if c.hi <= PI && x.hi < 0.0 {
        from = rise(x.hi, c.hi);
    }
    if c.lo > FRAC_PI_2 {
        if x.lo >= 0.0 {
            return Interval::EMPTY;
        }
        if x.lo.is_finite() {
            to = rise(x.lo, c.lo);
        }
    } else if c.lo > 0.0 && x.lo > 0.0 {
        from = rise(x.lo, c.lo);
    }
    clip(y, from, to)
}

/// `{t in x : atan2(s, t) in c for some s > 0 in y}`.
fn upper_x(y: Interval, c: Interval, x: Interval) -> Interval {
    if x.is_empty() || y.is_empty() || !looks_up(c) || y.hi <= 0.0 {
        return Interval::EMPTY;
    }
    let least = y.lo.max(0.0);
    let from = if c.hi > PI {
        Bracket::exact(f64::NEG_INFINITY)
    } else {
        run(if c.hi <= FRAC_PI_2 { least } else { y.hi }, c.hi)
    };
    let to = if c.lo <= 0.0 {
        Bracket::exact(f64::INFINITY)
    } else {
        run(if c.lo <= FRAC_PI_2 { y.hi } else { least }, c.lo)
    };
    // From the least y of 0, which does not count itself, x keeps the sign of the cotangent.
    let right = least == 0.0 && c.hi <= FRAC_PI_2 && x.hi <= 0.0;
    let left = least == 0.0 && c.lo > FRAC_PI_2 && x.lo >= 0.0;
    if right || left { Interval::EMPTY } else { clip(x, from, to) }
}

impl Interval {
    /// `{t in y : atan2(t, s) in c for some s in self}`: the reverse in the first argument.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let (x, angle) = (Interval::new(1.0, 2.0)?, Interval::new(0.0, 0.5)?);
    /// let y = x.atan2_rev_y(angle, Interval::ENTIRE);
    /// assert_eq!((y.lo(), y.hi()), (0.0, 1.0926049796875813));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn atan2_rev_y(self, c: Self, y: Self) -> Self {
        if self.is_empty() || c.is_empty() {
            return Self::EMPTY;
        }
        let level = y.contains(0.0) && ((self.hi > 0.0 && c.contains(0.0)) || (self.lo < 0.0 && holds_pi(c)));
        let axis = if level { Self::ZERO } else { Self::EMPTY };
        upper_y(self, c, y).hull(-upper_y(self, -c, -y)).hull(axis)
    }

    /// `{t in x : atan2(s, t) in c for some s in self}`: the reverse in the second argument.
    #[must_use]
    pub fn atan2_rev_x(self, c: Self, x: Self) -> Self {
        if self.is_empty() || c.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        let mut found = upper_x(self, c, x).hull(upper_x(-self, -c, x));
        if self.contains(0.0) && c.contains(0.0) && x.hi > 0.0 {
            found = found.hull(Self::made(x.lo.max(0.0), x.hi));
        }
        if self.contains(0.0) && holds_pi(c) && x.lo < 0.0 {
            found = found.hull(Self::made(x.lo, x.hi.min(0.0)));
        }
        found
    }
}
