//! Reverse operations: the members of `x` that an operation takes into `c` (IEEE 1788, 10.5.4 and table 10.1).
//!
//! The solutions form branches whose ends are real numbers known by both their roundings. Whether a double lies on a
//! branch is then decided exactly, so each result is the tightest interval around the members.

use super::Interval;
use crate::elementary as point;
use crate::elementary::{Ball, Bracket};

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

/// The point `x`, where the irrational number in the bracket is a member of `c`.
fn solving(x: Interval, value: Bracket, c: Interval) -> Interval {
    if c.lo <= value.down && value.up <= c.hi { x } else { Interval::EMPTY }
}

/// An end of a set of solutions; a limit that no solution attains is open, and a double.
#[derive(Clone, Copy)]
pub(super) struct End {
    at: Bracket,
    open: bool,
}

/// The hull of the part of `x` between two ends.
fn clip_ends(x: Interval, from: End, to: End) -> Interval {
    if (from.open && x.hi <= from.at.up) || (to.open && x.lo >= to.at.down) {
        return Interval::EMPTY;
    }
    clip(x, from.at, to.at)
}

/// The hull of the parts of `x` on `[from, to]` and on `[-to, -from]`.
fn clip_both(x: Interval, from: Bracket, to: Bracket) -> Interval {
    clip(x, to.neg(), from.neg()).hull(clip(x, from, to))
}

fn square_root(x: f64) -> Bracket {
    Bracket { down: crate::rounding::sqrt_down(x), up: crate::rounding::sqrt_up(x) }
}

/// The branches of a periodic function on whose pieces `n` it is monotone: least and greatest solutions in `x`.
///
/// `x` is not a point. `branch(n)` are the ends of the solutions on piece `n`, which has some; `piece(t)` is the number of the piece of `t`.
fn periodic(x: Interval, piece: impl Fn(f64) -> Option<i64>, branch: impl Fn(i64) -> (Bracket, Bracket)) -> Interval {
    let part = |n: i64| {
        let (from, to) = branch(n);
        clip(x, from, to)
    };
    let end = |t: f64, step: i64| {
        // Beyond 4e18 neighbouring doubles lie many periods apart: there are solutions next to the end.
        let Some(n) = (if t.is_finite() { piece(t) } else { None }) else { return x };
        let here = part(n);
        if here.is_empty() { part(n + step) } else { here }
    };
    let (first, last) = (end(x.lo, 1), end(x.hi, -1));
    if first.is_empty() || last.is_empty() { Interval::EMPTY } else { Interval::made(first.lo, last.hi) }
}

/// `n pi + sign v` for the angle `v` that `angle` computes on balls; `v` itself where `n` is 0.
fn shifted_angle(n: i64, sign: i64, exact: Bracket, angle: impl Fn(i64) -> Option<Ball>) -> Bracket {
    if n == 0 {
        return if sign > 0 { exact } else { exact.neg() };
    }
    point::settle(|p| {
        let turns = point::pi(p + 64).mul(&Ball::integer(n));
        let v = angle(p)?;
        Some(turns.add(&if sign > 0 { v } else { v.neg() }))
    })
}

fn asin_ball(v: f64, p: i64) -> Option<Ball> {
    let (x, one) = (Ball::from_f64(v), Ball::integer(1));
    point::ball_atan2(&x, &one.sub(&x.mul(&x)).sqrt(p + 64)?, p)
}

fn acos_ball(v: f64, p: i64) -> Option<Ball> {
    let (x, one) = (Ball::from_f64(v), Ball::integer(1));
    if v == 1.0 {
        return Some(Ball::integer(0));
    }
    point::ball_atan2(&one.sub(&x.mul(&x)).sqrt(p + 64)?, &x, p)
}

fn atan_ball(v: f64, p: i64) -> Option<Ball> {
    point::ball_atan2(&Ball::from_f64(v), &Ball::integer(1), p)
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

    /// `{t in x : sin t in self}`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let t = Interval::ONE.sin_rev(Interval::new(0.0, 4.0)?);
    /// assert_eq!((t.lo(), t.hi()), (1.5707963267948966, 1.5707963267948968));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn sin_rev(self, x: Self) -> Self {
        let c = self.intersection(Self::UNIT);
        if c.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        if x.is_singleton() {
            return solving(x, point::Angle::new(x.lo).wave(1), c);
        }
        // Piece n is [n pi - pi/2, n pi + pi/2], where the sine rises for even n.
        let end = |n, sign, v: f64| shifted_angle(n, sign, point::asin(v), |p| asin_ball(v, p));
        periodic(
            x,
            |t| point::Angle::new(t).quarter_turns().map(|q| (q + 1).div_euclid(2)),
            |n| if n % 2 == 0 { (end(n, 1, c.lo), end(n, 1, c.hi)) } else { (end(n, -1, c.hi), end(n, -1, c.lo)) },
        )
    }

    /// `{t in x : cos t in self}`.
    #[must_use]
    pub fn cos_rev(self, x: Self) -> Self {
        let c = self.intersection(Self::UNIT);
        if c.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        if x.is_singleton() {
            return solving(x, point::Angle::new(x.lo).wave(0), c);
        }
        // Piece n is [n pi, (n + 1) pi], where the cosine falls for even n.
        let end = |n, sign, v: f64| shifted_angle(n, sign, point::acos(v), |p| acos_ball(v, p));
        periodic(
            x,
            |t| point::Angle::new(t).quarter_turns().map(|q| q.div_euclid(2)),
            |n| {
                if n % 2 == 0 {
                    (end(n, 1, c.hi), end(n, 1, c.lo))
                } else {
                    (end(n + 1, -1, c.lo), end(n + 1, -1, c.hi))
                }
            },
        )
    }

    /// `{t in x : tan t in self}`.
    #[must_use]
    pub fn tan_rev(self, x: Self) -> Self {
        if self.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        if x.is_singleton() {
            return solving(x, point::Angle::new(x.lo).tan(), self);
        }
        // Piece n is (n pi - pi/2, n pi + pi/2); an infinite bound stands for its open end.
        let end = |n, v: f64| {
            if v.is_finite() {
                return shifted_angle(n, 1, point::atan(v), |p| atan_ball(v, p));
            }
            let half = if v > 0.0 { 2 * n + 1 } else { 2 * n - 1 };
            point::settle(|p| Some(point::pi(p + 64).mul(&Ball::integer(half)).scale(-1)))
        };
        periodic(
            x,
            |t| point::Angle::new(t).quarter_turns().map(|q| (q + 1).div_euclid(2)),
            |n| (end(n, self.lo), end(n, self.hi)),
        )
    }

    /// `{t in x : cosh t in self}`.
    #[must_use]
    pub fn cosh_rev(self, x: Self) -> Self {
        if self.is_empty() || self.hi < 1.0 {
            return Self::EMPTY;
        }
        clip_both(x, point::acosh(self.lo.max(1.0)), point::acosh(self.hi))
    }

    /// `{t in x : b t in c for some b in self}`: the division that undoes a product.
    #[must_use]
    pub fn mul_rev(self, c: Self, x: Self) -> Self {
        let b = self;
        if b.is_empty() || c.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        let sign = |t: f64| sign_about(t, 0.0, f64::INFINITY);
        let division = Division {
            w: [sign(c.lo), sign(c.hi)],
            y: [sign(b.lo), sign(b.hi)],
            bottom: f64::NEG_INFINITY,
            centre: 0.0,
            top: f64::INFINITY,
            quotient: |i: usize, j: usize| {
                let (p, q) = ([c.lo, c.hi][i], [b.lo, b.hi][j]);
                Bracket { down: crate::rounding::div_down(p, q), up: crate::rounding::div_up(p, q) }
            },
        };
        division.clip(x)
    }

    /// `{t : b t in c for some b in self}` as at most two intervals, the lower one first.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let (b, c) = (Interval::new(-1.0, 1.0)?, Interval::new(1.0, 2.0)?);
    /// let [below, above] = b.mul_rev_to_pair(c);
    /// assert_eq!((below.hi(), above.lo()), (-1.0, 1.0));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn mul_rev_to_pair(self, c: Self) -> [Self; 2] {
        if self.is_empty() || c.is_empty() {
            return [Self::EMPTY; 2];
        }
        let b = self;
        if !b.contains(0.0) {
            return [c / b, Self::EMPTY];
        }
        if c.contains(0.0) {
            return [Self::ENTIRE, Self::EMPTY];
        }
        // The two halves of b apart; the one that is only zero has no quotient.
        let left = c / Self::made(b.lo, 0.0);
        let right = c / Self::made(0.0, b.hi);
        let mut parts = if c.lo > 0.0 { [left, right] } else { [right, left] };
        if parts[0].is_empty() {
            parts.swap(0, 1);
        }
        parts
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

/// `{s : y s in w for some y}` for `w`, `y` given by their ends: where a quotient of ends bounds it and where nothing does.
///
/// The ends are ordered pairs; `quotient(i, j)` brackets what stands for `w_i / y_j` on the caller's scale, where
/// `bottom` and `top` stand for the infinite quotients and `centre` for 0.
pub(super) struct Division<F: Fn(usize, usize) -> Bracket> {
    /// Signs of the ends, -2 and 2 for infinite ones.
    pub w: [i8; 2],
    pub y: [i8; 2],
    pub bottom: f64,
    pub centre: f64,
    pub top: f64,
    pub quotient: F,
}

impl<F: Fn(usize, usize) -> Bracket> Division<F> {
    fn end(&self, i: usize, j: usize) -> End {
        let (w, y) = (self.w[i], self.y[j]);
        if w == 0 {
            End { at: Bracket::exact(self.centre), open: false }
        } else if y.abs() == 2 {
            End { at: Bracket::exact(self.centre), open: true }
        } else if w.abs() == 2 {
            End { at: Bracket::exact(if (w > 0) == (y > 0) { self.top } else { self.bottom }), open: true }
        } else {
            End { at: (self.quotient)(i, j), open: false }
        }
    }

    /// The part of `x` in the solutions.
    pub fn clip(&self, x: Interval) -> Interval {
        let (w, y) = (self.w, self.y);
        let [bottom, top] = [self.bottom, self.top].map(|x| End { at: Bracket::exact(x), open: true });
        let w_has_zero = w[0] <= 0 && w[1] >= 0;
        if y[0] <= 0 && y[1] >= 0 {
            if w_has_zero {
                return clip_ends(x, bottom, top);
            }
            let near = usize::from(w[0] <= 0);
            let mut found = Interval::EMPTY;
            // The quotients by the positive and by the negative half of y run from one end to infinity.
            for j in [0, 1] {
                if y[j] != 0 {
                    let end = self.end(near, j);
                    let upwards = (w[near] > 0) == (y[j] > 0);
                    found = found.hull(if upwards { clip_ends(x, end, top) } else { clip_ends(x, bottom, end) });
                }
            }
            return found;
        }
        let (from, to) = if y[0] > 0 {
            (self.end(0, usize::from(w[0] >= 0)), self.end(1, usize::from(w[1] < 0)))
        } else {
            (self.end(1, usize::from(w[1] >= 0)), self.end(0, usize::from(w[0] < 0)))
        };
        clip_ends(x, from, to)
    }
}

fn sign_about(x: f64, centre: f64, low: f64) -> i8 {
    if x.is_infinite() || x == low {
        if x > centre { 2 } else { -2 }
    } else if x > centre {
        1
    } else if x < centre {
        -1
    } else {
        0
    }
}

/// Sign of the logarithm of a bound in `[0, inf]`.
fn log_sign(x: f64) -> i8 {
    sign_about(x, 1.0, 0.0)
}

impl Interval {
    /// `{t in x : t^y in c for some y in self}`: reverse power for the base.
    ///
    /// On logarithms it is a division: `y ln t` in `ln c`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let t = Interval::point(2.0)?.pow_rev_base(Interval::new(4.0, 9.0)?, Interval::ENTIRE);
    /// assert_eq!(t, Interval::new(2.0, 3.0)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn pow_rev_base(self, c: Self, x: Self) -> Self {
        let (y, c, x) =
            (self, c.intersection(Self::made(0.0, f64::INFINITY)), x.intersection(Self::made(0.0, f64::INFINITY)));
        if y.is_empty() || c.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        // 0^y = 0 for y > 0.
        let zero = if x.lo == 0.0 && c.lo == 0.0 && y.hi > 0.0 { Self::ZERO } else { Self::EMPTY };
        if c.hi == 0.0 || x.hi == 0.0 {
            return zero;
        }
        let division = Division {
            w: [log_sign(c.lo), log_sign(c.hi)],
            y: [sign_about(y.lo, 0.0, f64::NEG_INFINITY), sign_about(y.hi, 0.0, f64::INFINITY)],
            bottom: 0.0,
            centre: 1.0,
            top: f64::INFINITY,
            quotient: |i: usize, j: usize| point::root([c.lo, c.hi][i], [y.lo, y.hi][j]),
        };
        zero.hull(division.clip(x))
    }

    /// `{t in x : b^t in c for some b in self}`: reverse power for the exponent.
    ///
    /// On logarithms it is a division: `t ln b` in `ln c`.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let t = Interval::point(2.0)?.pow_rev_exponent(Interval::new(8.0, 32.0)?, Interval::ENTIRE);
    /// assert_eq!(t, Interval::new(3.0, 5.0)?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn pow_rev_exponent(self, c: Self, x: Self) -> Self {
        let half_line = Self::made(0.0, f64::INFINITY);
        let (b, c) = (self.intersection(half_line), c.intersection(half_line));
        if b.is_empty() || c.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        // 0^t = 0 for t > 0.
        let zero_base = if b.lo == 0.0 && c.lo == 0.0 && x.hi > 0.0 { x.intersection(half_line) } else { Self::EMPTY };
        if b.hi == 0.0 || c.hi == 0.0 {
            return zero_base;
        }
        let division = Division {
            w: [log_sign(c.lo), log_sign(c.hi)],
            y: [log_sign(b.lo), log_sign(b.hi)],
            bottom: f64::NEG_INFINITY,
            centre: 0.0,
            top: f64::INFINITY,
            quotient: |i: usize, j: usize| point::log_ratio([c.lo, c.hi][i], [b.lo, b.hi][j]),
        };
        zero_base.hull(division.clip(x))
    }
}
