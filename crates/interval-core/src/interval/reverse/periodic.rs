//! Reverses of periodic functions: one branch of solutions on each piece where the function is monotone.

use super::super::Interval;
use super::clip;
use crate::elementary as point;
use crate::elementary::Turning;
use crate::elementary::{Ball, Bracket};

/// The point `x`, where the irrational number in the bracket is a member of `c`.
fn solving(x: Interval, value: Bracket, c: Interval) -> Interval {
    if c.lo <= value.down && value.up <= c.hi { x } else { Interval::EMPTY }
}

/// The branches of a periodic function on whose pieces `n` it is monotone: least and greatest solutions in `x`.
///
/// `x` is not a point. `branch(n)` are the ends of the solutions on piece `n`, which has some; `piece(t)` is the number
/// of the piece of `t`.
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
}
