//! A dual simplex method in plain floats on a working set.
//!
//! Each step takes in the half-space that the vertex violates most and drops the row of the basis that the ratio test
//! names. The inverse of the basis is updated by each exchange and computed anew after some exchanges, and always
//! before an answer. A search keeps its basis: when the working set has grown it goes on from there. Nothing here is a
//! proof.

use super::pricing::{VIOLATION, leaving, violation};
use super::program::Program;
use super::{Row, patience};

/// The result of a search on the working set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// An optimal vertex.
    Vertex,
    /// The objective is unbounded.
    Unbounded,
    /// The rows of the basis contradict this half-space of the working set.
    Contradiction(usize),
    /// The search broke down numerically.
    Failed,
}

/// Relative size below which a multiplier counts as zero: about 9000 unit roundoffs. It steers the search and proves
/// nothing.
const MULTIPLIER: f64 = 1e-12;
/// Relative size below which a ray's component counts as the remainder of an elimination: about 9000 unit roundoffs.
const NOTHING: f64 = 1e-12;
/// Half-spaces that are looked at before the next look at the whole working set, which costs more.
const CANDIDATES: usize = 24;
/// Exchanges after which the inverse is computed anew, because each one adds rounding errors.
const FRESH: usize = 20;

/// The minimum of one objective, in scaled unknowns: the vertex is `point + M ray`.
#[derive(Debug, Clone)]
pub(crate) struct Search {
    objective: Vec<f64>,
    rows: Vec<Row>,
    /// Row-major; column `i` belongs to `rows[i]`.
    inverse: Vec<f64>,
    point: Vec<f64>,
    ray: Vec<f64>,
    multipliers: Vec<f64>,
    bounded: bool,
    exchanges: usize,
}

impl Search {
    /// A search for the minimum of `objective`, given in the problem's own unknowns.
    pub(crate) fn new(program: &Program, objective: &[f64]) -> Self {
        let n = program.dimension();
        let objective = program.scaled_objective(objective);
        let rows = Row::corner(&objective);
        Self {
            objective,
            rows,
            inverse: vec![0.0; n * n],
            point: vec![0.0; n],
            ray: vec![0.0; n],
            multipliers: vec![0.0; n],
            bounded: false,
            exchanges: 0,
        }
    }

    /// Goes on until the working set is satisfied; where the basis has broken down, once more from the corner.
    pub(crate) fn run(&mut self, program: &Program) -> Outcome {
        match self.steps(program) {
            Outcome::Failed => {
                self.rows = Row::corner(&self.objective);
                self.steps(program)
            }
            outcome => outcome,
        }
    }

    fn steps(&mut self, program: &Program) -> Outcome {
        let n = self.rows.len();
        let mut alpha = vec![0.0; n];
        if self.factorise(program).is_none() {
            return Outcome::Failed;
        }
        let patience = patience(n);
        let mut candidates = Vec::new();
        for step in 0..20 * patience {
            if self.exchanges >= FRESH && self.factorise(program).is_none() {
                return Outcome::Failed;
            }
            let careful = step > patience;
            let Some(entering) = self.violated(program, &mut candidates, careful) else {
                if self.exchanges > 0 {
                    if self.factorise(program).is_none() {
                        return Outcome::Failed;
                    }
                    continue;
                }
                return self.settled();
            };
            let g = program.normal(entering);
            alpha.fill(0.0);
            for (row, &x) in self.inverse.chunks_exact(n).zip(g) {
                for (a, r) in alpha.iter_mut().zip(row) {
                    *a += r * x;
                }
            }
            let Some(position) = leaving(&self.rows, &alpha, &self.multipliers, careful) else {
                if self.exchanges > 0 {
                    if self.factorise(program).is_none() {
                        return Outcome::Failed;
                    }
                    continue;
                }
                return Outcome::Contradiction(entering);
            };
            self.exchange(program, position, entering, &alpha);
        }
        Outcome::Failed
    }

    fn settled(&self) -> Outcome {
        let size = self.multipliers.iter().fold(0.0_f64, |a, &x| a.max(x));
        let open = |(row, &m): (&Row, &f64)| row.is_at_infinity() && m > MULTIPLIER * size;
        if self.rows.iter().zip(&self.multipliers).any(open) { Outcome::Unbounded } else { Outcome::Vertex }
    }

    /// The members of the basis by their names in the problem, with the multipliers of the problem's own half-spaces.
    pub(crate) fn basis(&self, program: &Program) -> Vec<(Row, f64)> {
        let named = |(&row, &m): (&Row, &f64)| match row {
            Row::Given(index) => (Row::Given(program.names()[index]), program.unscaled_multiplier(index, m)),
            infinite @ Row::AtInfinity { .. } => (infinite, m),
        };
        self.rows.iter().zip(&self.multipliers).map(named).collect()
    }

    /// The members of the basis by their places in the working set.
    pub(crate) fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The finite part of the vertex.
    pub(crate) fn point(&self, program: &Program) -> Vec<f64> {
        program.unscaled_point(&self.point)
    }

    /// True if the vertex is finite; an objective may be, at a vertex that is not.
    pub(crate) fn is_bounded(&self) -> bool {
        self.bounded
    }

    /// The part of the vertex that is multiplied by `M`; zero where the vertex is finite.
    pub(crate) fn ray(&self, program: &Program) -> Vec<f64> {
        program.unscaled_point(&self.ray)
    }

    /// The inverse and everything that follows from it. The value is `None` if the basis is singular or no longer dual
    /// feasible.
    fn factorise(&mut self, program: &Program) -> Option<()> {
        let n = self.rows.len();
        let width = 2 * n;
        let mut work = vec![0.0; n * width];
        for (i, &row) in self.rows.iter().enumerate() {
            let target = &mut work[i * width..i * width + n];
            match row {
                Row::Given(index) => target.copy_from_slice(program.normal(index)),
                Row::AtInfinity { column, negative } => target[column] = if negative { -1.0 } else { 1.0 },
            }
            work[i * width + n + i] = 1.0;
        }
        invert(&mut work, n)?;
        for (row, target) in work.chunks_exact(width).zip(self.inverse.chunks_exact_mut(n)) {
            target.copy_from_slice(&row[n..]);
        }
        self.exchanges = 0;
        self.multipliers.fill(0.0);
        for (row, &c) in self.inverse.chunks_exact(n).zip(&self.objective) {
            for (m, r) in self.multipliers.iter_mut().zip(row) {
                *m -= r * c;
            }
        }
        let size = self.multipliers.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        if !size.is_finite() || self.multipliers.iter().any(|&m| m < -1e-7 * size) {
            return None;
        }
        self.multipliers.iter_mut().for_each(|m| *m = m.max(0.0));
        self.locate(program);
        Some(())
    }

    fn locate(&mut self, program: &Program) {
        let n = self.rows.len();
        self.bounded = !self.rows.iter().any(|r| r.is_at_infinity());
        for (row, (x, d)) in self.inverse.chunks_exact(n).zip(self.point.iter_mut().zip(&mut self.ray)) {
            (*x, *d) = (0.0, 0.0);
            for (r, member) in row.iter().zip(&self.rows) {
                match *member {
                    Row::Given(index) => *x += r * program.right(index),
                    Row::AtInfinity { .. } => *d += r,
                }
            }
        }
        // The remainder of an elimination to zero would be a direction at order M.
        let least = NOTHING * self.ray.iter().fold(0.0_f64, |a, d| a.max(d.abs()));
        self.ray.iter_mut().filter(|d| d.abs() <= least).for_each(|d| *d = 0.0);
    }

    /// Puts a half-space in the place of a row: its normal is `sum alpha_i rows_i`, with `alpha[position] > 0`.
    fn exchange(&mut self, program: &Program, position: usize, entering: usize, alpha: &[f64]) {
        self.rows[position] = Row::Given(entering);
        let n = alpha.len();
        for row in self.inverse.chunks_exact_mut(n).chain([self.multipliers.as_mut_slice()]) {
            let share = row[position] / alpha[position];
            for (x, a) in row.iter_mut().zip(alpha) {
                *x -= a * share;
            }
            row[position] = share;
        }
        self.multipliers.iter_mut().for_each(|m| *m = m.max(0.0));
        self.exchanges += 1;
        self.locate(program);
    }

    /// A half-space that the vertex violates, `None` where all hold: the most violated one (in units of its normal, at
    /// order `M` before the finite order) of the candidates, which are chosen anew from the whole working set where
    /// none of them is violated any more; with `careful` the first one (Bland's rule, which cannot cycle).
    fn violated(&self, program: &Program, candidates: &mut Vec<usize>, careful: bool) -> Option<usize> {
        if careful {
            return (0..program.count()).find(|&index| self.amount(program, index).is_some());
        }
        let amount = |index: usize| self.amount(program, index).map(|(large, amount)| (large, amount, index));
        let more = |a: &(bool, f64, usize), b: &(bool, f64, usize)| b.0.cmp(&a.0).then(b.1.total_cmp(&a.1));
        if let Some(worst) = candidates.iter().copied().filter_map(amount).min_by(more) {
            return Some(worst.2);
        }
        let mut found: Vec<(bool, f64, usize)> = (0..program.count()).filter_map(amount).collect();
        if found.len() > CANDIDATES {
            found.select_nth_unstable_by(CANDIDATES, more);
            found.truncate(CANDIDATES);
        }
        candidates.clear();
        candidates.extend(found.iter().map(|f| f.2));
        found.into_iter().min_by(more).map(|worst| worst.2)
    }

    /// By how much a half-space that is not in the basis is violated, and whether at order `M`.
    fn amount(&self, program: &Program, index: usize) -> Option<(bool, f64)> {
        let ray = (!self.bounded).then_some(self.ray.as_slice());
        let (large, by) = violation(program.normal(index), program.right(index), &self.point, ray, VIOLATION)?;
        (!self.rows.contains(&Row::Given(index))).then_some((large, by * program.unit(index)))
    }
}

/// Gauss-Jordan elimination of `[B | I]` with partial pivoting, in place. The value is `None` if a pivot vanishes.
fn invert(work: &mut [f64], n: usize) -> Option<()> {
    let width = 2 * n;
    for p in 0..n {
        let pivot_row = (p..n).max_by(|&i, &j| work[i * width + p].abs().total_cmp(&work[j * width + p].abs()))?;
        let pivot = work[pivot_row * width + p];
        if !(pivot.abs() > 1e-200 && pivot.is_finite()) {
            return None;
        }
        if pivot_row != p {
            for j in 0..width {
                work.swap(p * width + j, pivot_row * width + j);
            }
        }
        let (above, rest) = work.split_at_mut(p * width);
        let (row, below) = rest.split_at_mut(width);
        for x in row.iter_mut() {
            *x /= pivot;
        }
        for target in above.chunks_exact_mut(width).chain(below.chunks_exact_mut(width)) {
            let factor = target[p];
            if factor != 0.0 {
                for (t, r) in target.iter_mut().zip(&*row) {
                    *t -= factor * r;
                }
            }
        }
    }
    work.iter().all(|x| x.is_finite()).then_some(())
}
