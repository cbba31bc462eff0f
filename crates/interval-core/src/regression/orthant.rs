//! The part of a united solution set in one orthant: a polyhedron (Oettli and Prager 1964;
//! docs/theory.md, "The feasible set").
//!
//! Some member of row `i` holds at `x` exactly when `inf(A_i x) <= sup y_i` and `sup(A_i x) >= inf y_i`. If the sign of
//! `x_j` is known, `inf(A_ij x_j)` is the lower or the upper bound times `x_j`: the half-spaces have the given doubles
//! as coefficients, and nothing is rounded.

use super::rows::Rows;
use crate::linear_program::HalfSpaces;

/// Half-spaces `0 .. m` bound rows from above, `m .. 2 m` from below, `2 m .. 2 m + n` hold the signs.
#[derive(Debug, Clone)]
pub(crate) struct Orthant<'a> {
    pub(crate) rows: &'a Rows<'a>,
    /// 1 or -1; 0 for an unknown that needs no sign, whose column has zero radius.
    pub(crate) signs: Vec<i8>,
    /// Signs that are taken for the coefficients of the rows but not held.
    pub(crate) loose: Vec<bool>,
    /// Rows that count as wrong, in ascending order.
    pub(crate) dropped: Vec<usize>,
}

/// Row number, whether its lower right-hand side is meant, multiplier.
pub type DataRow = (usize, bool, f64);

impl<'a> Orthant<'a> {
    pub(crate) fn new(rows: &'a Rows<'a>, signs: Vec<i8>) -> Self {
        let loose = vec![false; signs.len()];
        Self { rows, signs, loose, dropped: Vec::new() }
    }

    /// Half-spaces of rows and of signs.
    pub(crate) fn split(&self, weights: &[(usize, f64)]) -> (Vec<DataRow>, Vec<(usize, f64)>) {
        let m = self.rows.count();
        let (data, signs): (Vec<_>, Vec<_>) = weights.iter().copied().partition(|&(index, _)| index < 2 * m);
        let data = data.into_iter().map(|(index, weight)| (index % m, index >= m, weight)).collect();
        (data, signs.into_iter().map(|(index, weight)| (index - 2 * m, weight)).collect())
    }
}

impl HalfSpaces for Orthant<'_> {
    fn dimension(&self) -> usize {
        self.rows.columns()
    }

    fn count(&self) -> usize {
        2 * self.rows.count() + self.rows.columns()
    }

    fn half_space(&self, index: usize, g: &mut [f64]) -> f64 {
        let m = self.rows.count();
        if index >= 2 * m {
            let j = index - 2 * m;
            g.fill(0.0);
            g[j] = -f64::from(self.signs[j]);
            return if self.signs[j] == 0 || self.loose[j] { f64::INFINITY } else { 0.0 };
        }
        let below = index >= m;
        let i = if below { index - m } else { index };
        if self.dropped.binary_search(&i).is_ok() {
            g.fill(0.0);
            return f64::INFINITY;
        }
        let (lower, upper) = self.rows.row(i);
        let mut meaningful = true;
        for (j, x) in g.iter_mut().enumerate() {
            let take_upper = (self.signs[j] < 0) != below;
            let bound = if take_upper { upper[j] } else { lower[j] };
            *x = if below { -bound } else { bound };
            meaningful &= bound.is_finite();
        }
        let (low, high) = self.rows.right(i);
        let h = if below { -low } else { high };
        // An infinite coefficient lets the row hold wherever its unknown is not zero: leaving it out only loosens.
        if meaningful && h.is_finite() {
            h
        } else {
            g.fill(0.0);
            f64::INFINITY
        }
    }
}
