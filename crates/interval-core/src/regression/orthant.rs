//! The part of a united solution set in one orthant: a polyhedron (Oettli and Prager 1964; METHODS 4.3).
//!
//! Some member of row `i` holds at `x` exactly when `inf(A_i x) <= sup y_i` and `sup(A_i x) >= inf y_i`. Where the sign of
//! `x_j` is known, `inf(A_ij x_j)` is the lower or the upper bound times `x_j`: the half-spaces have the given doubles as
//! coefficients, and nothing is rounded.

use crate::interval::Interval;
use crate::linear_program::HalfSpaces;
use crate::matrix::IntervalMatrix;

/// Half-spaces `0 .. m` bound rows from above, `m .. 2 m` from below, `2 m .. 2 m + n` hold the signs.
pub(crate) struct Orthant<'a> {
    a: &'a IntervalMatrix,
    y: &'a [Interval],
    signs: &'a [i8],
}

impl<'a> Orthant<'a> {
    /// `signs` holds 1 or -1, or 0 for a free unknown, whose column has zero radius.
    pub(crate) fn new(a: &'a IntervalMatrix, y: &'a [Interval], signs: &'a [i8]) -> Self {
        Self { a, y, signs }
    }

    /// The sign of each unknown, 0 where it needs none.
    pub(crate) fn signs(&self) -> &[i8] {
        self.signs
    }
}

impl HalfSpaces for Orthant<'_> {
    fn dimension(&self) -> usize {
        self.a.columns()
    }

    fn count(&self) -> usize {
        2 * self.a.rows() + self.a.columns()
    }

    fn half_space(&self, index: usize, g: &mut [f64]) -> f64 {
        let (m, n) = (self.a.rows(), self.a.columns());
        if index >= 2 * m {
            let j = index - 2 * m;
            g.fill(0.0);
            g[j] = -f64::from(self.signs[j]);
            return if self.signs[j] == 0 { f64::INFINITY } else { 0.0 };
        }
        let below = index >= m;
        let row = if below { index - m } else { index };
        let mut meaningful = true;
        for (j, x) in g.iter_mut().enumerate() {
            let take_upper = (self.signs[j] < 0) != below;
            let at = row * n + j;
            let bound = if take_upper { self.a.hi()[at] } else { self.a.lo()[at] };
            *x = if below { -bound } else { bound };
            meaningful &= bound.is_finite();
        }
        let h = if below { -self.y[row].lo() } else { self.y[row].hi() };
        // An infinite coefficient lets the row hold wherever its unknown is not zero: leaving it out only loosens.
        if meaningful && h.is_finite() {
            h
        } else {
            g.fill(0.0);
            f64::INFINITY
        }
    }
}
