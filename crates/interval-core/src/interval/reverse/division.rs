//! Reverses that are divisions: of a product, and on logarithms of a power.

use super::super::Interval;
use super::clip;
use crate::elementary as point;
use crate::elementary::Bracket;
use crate::rounding::{div_down, div_up};

/// An end of a set of solutions; a limit that no solution attains is open, and a double.
#[derive(Clone, Copy)]
struct End {
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

/// `{s : y s in w for some y}` for `w`, `y` given by their ends: where a quotient of ends bounds it and where nothing
/// does.
///
/// The ends are ordered pairs; `quotient(i, j)` brackets the value of `w_i / y_j` on the caller's scale, where `bottom`
/// and `top` stand for the infinite quotients and `centre` for 0.
struct Division<F: Fn(usize, usize) -> Bracket> {
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
                Bracket { down: div_down(p, q), up: div_up(p, q) }
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
