//! A dense dual simplex method for few unknowns and many half-spaces, in plain floats.
//!
//! A basis is `n` half-spaces that are tight at a vertex. The start is a box at infinity: its bounds carry a symbolic large
//! number `M`, so a vertex is `x0 + M x1` and "unbounded" is an exact statement about the basis, not a comparison with a big
//! number. Each step takes in the most violated half-space (one scan over all of them: constraint generation with a working
//! set of exactly `n`) and drops the one that the ratio test names. Nothing here is a proof: the multipliers it returns are
//! only proposals to [`safe_bound`](super::safe_bound).

use super::HalfSpaces;
use crate::approximate::Basis;

/// A member of a basis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Row {
    /// Half-space of the problem.
    Given(usize),
    /// `x_j <= M` or, with `negative`, `-x_j <= M`.
    AtInfinity { column: usize, negative: bool },
}

/// What the search found.
#[derive(Debug, Clone)]
pub(crate) enum Answer {
    /// An optimal basis with its multipliers, or the last one before the limit of steps: proposals for a bound either way.
    Basis { rows: Vec<(Row, f64)>, vertex: Vec<f64> },
    /// The objective falls for ever along this ray.
    Unbounded { ray: Vec<f64> },
    /// These half-spaces contradict each other; the last one is violated wherever the others hold.
    Infeasible { rows: Vec<Row> },
    /// The search broke down numerically.
    Failed,
}

/// A problem with its columns scaled by powers of two to a largest coefficient near one.
pub(crate) struct Simplex<'a, P: HalfSpaces> {
    problem: &'a P,
    scale: Vec<f64>,
}

/// Relative size below which a violation is rounding.
const VIOLATION: f64 = 1e-12;
/// Relative size below which a pivot is rounding.
const PIVOT: f64 = 1e-11;
/// Relative size below which a multiplier is zero.
const MULTIPLIER: f64 = 1e-12;

impl<'a, P: HalfSpaces> Simplex<'a, P> {
    pub(crate) fn new(problem: &'a P) -> Self {
        let n = problem.dimension();
        let mut largest = vec![0.0_f64; n];
        let mut g = vec![0.0; n];
        for index in 0..problem.count() {
            if problem.half_space(index, &mut g) < f64::INFINITY {
                largest.iter_mut().zip(&g).for_each(|(l, x)| *l = l.max(x.abs()));
            }
        }
        let scale = largest.iter().map(|&l| if l > 0.0 { power_of_two_near(l).recip() } else { 1.0 }).collect();
        Self { problem, scale }
    }

    /// Searches the minimum of `c x`.
    pub(crate) fn minimise(&self, objective: &[f64]) -> Answer {
        let n = self.problem.dimension();
        let c: Vec<f64> = objective.iter().zip(&self.scale).map(|(c, s)| c * s).collect();
        let mut rows: Vec<Row> = (0..n).map(|column| Row::AtInfinity { column, negative: c[column] > 0.0 }).collect();
        let patience = 50 * n + 200;
        for step in 0..20 * patience {
            let Some(state) = self.factorise(&rows, &c) else { return Answer::Failed };
            let careful = step > patience;
            let Some(entering) = self.violated(&rows, &state, careful) else {
                return self.finish(&rows, &state, &c);
            };
            let mut g = vec![0.0; n];
            self.row(Row::Given(entering), &mut g);
            let alpha = state.basis.solve_transposed(&g);
            let Some(position) = leaving(&rows, &alpha, &state.multipliers, careful) else {
                rows.push(Row::Given(entering));
                return Answer::Infeasible { rows };
            };
            rows[position] = Row::Given(entering);
        }
        match self.factorise(&rows, &c) {
            Some(state) => self.finish(&rows, &state, &c),
            None => Answer::Failed,
        }
    }

    fn finish(&self, rows: &[Row], state: &Vertex, c: &[f64]) -> Answer {
        let size = c.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let unbounded = rows
            .iter()
            .zip(&state.multipliers)
            .any(|(row, &m)| matches!(row, Row::AtInfinity { .. }) && m > MULTIPLIER * size);
        let unscaled = |x: &[f64]| x.iter().zip(&self.scale).map(|(x, s)| x * s).collect();
        if unbounded {
            return Answer::Unbounded { ray: unscaled(&state.direction) };
        }
        let rows = rows.iter().copied().zip(state.multipliers.iter().copied()).collect();
        Answer::Basis { rows, vertex: unscaled(&state.point) }
    }

    /// Scaled coefficients of a row; returns the finite part of its right-hand side.
    fn row(&self, row: Row, g: &mut [f64]) -> f64 {
        match row {
            Row::Given(index) => {
                let h = self.problem.half_space(index, g);
                g.iter_mut().zip(&self.scale).for_each(|(x, s)| *x *= s);
                h
            }
            Row::AtInfinity { column, negative } => {
                g.fill(0.0);
                g[column] = if negative { -1.0 } else { 1.0 };
                0.0
            }
        }
    }

    fn factorise(&self, rows: &[Row], c: &[f64]) -> Option<Vertex> {
        let n = rows.len();
        let mut matrix = vec![0.0; n * n];
        let mut right = vec![0.0; n];
        let mut at_infinity = vec![0.0; n];
        for (i, &row) in rows.iter().enumerate() {
            right[i] = self.row(row, &mut matrix[i * n..(i + 1) * n]);
            at_infinity[i] = if matches!(row, Row::AtInfinity { .. }) { 1.0 } else { 0.0 };
        }
        let basis = Basis::new(&matrix, n)?;
        let point = basis.solve(&right);
        let direction = basis.solve(&at_infinity);
        let multipliers = basis.solve_transposed(c).into_iter().map(|x| (-x).max(0.0)).collect();
        let bounded = !at_infinity.contains(&1.0);
        Some(Vertex { basis, point, direction, multipliers, bounded })
    }

    /// The half-space that the vertex violates most (in units of its normal), at order `M` before the finite order; with
    /// `careful` the first one violated (Bland's rule, which cannot cycle).
    fn violated(&self, rows: &[Row], vertex: &Vertex, careful: bool) -> Option<usize> {
        let mut g = vec![0.0; rows.len()];
        let mut worst: Option<(bool, f64, usize)> = None;
        for index in 0..self.problem.count() {
            let h = self.row(Row::Given(index), &mut g);
            if h == f64::INFINITY {
                continue;
            }
            let mut norm = 0.0;
            let (mut finite, mut finite_size) = (-h, h.abs());
            let (mut large, mut large_size) = (0.0, 0.0);
            for (j, &x) in g.iter().enumerate() {
                norm += x * x;
                let term = x * vertex.point[j];
                finite += term;
                finite_size += term.abs();
                if !vertex.bounded {
                    let term = x * vertex.direction[j];
                    large += term;
                    large_size += term.abs();
                }
            }
            let at_large = large > VIOLATION * large_size;
            let at_finite = large.abs() <= VIOLATION * large_size && finite > VIOLATION * finite_size;
            if !(at_large || at_finite) || rows.contains(&Row::Given(index)) {
                continue;
            }
            if careful {
                return Some(index);
            }
            let amount = if at_large { large } else { finite } / norm.sqrt().max(f64::MIN_POSITIVE);
            if worst.is_none_or(|(order, most, _)| (at_large, amount) > (order, most)) {
                worst = Some((at_large, amount, index));
            }
        }
        worst.map(|(_, _, index)| index)
    }
}

/// A basis with what follows from it, in scaled unknowns: the vertex is `point + M direction`.
struct Vertex {
    basis: Basis,
    point: Vec<f64>,
    direction: Vec<f64>,
    multipliers: Vec<f64>,
    bounded: bool,
}

/// The position that keeps the multipliers non-negative (smallest ratio; ties: rows at infinity, then the largest pivot, or
/// with `careful` the smallest index); `None` where no multiplier falls, which proves infeasibility up to rounding.
fn leaving(rows: &[Row], alpha: &[f64], multipliers: &[f64], careful: bool) -> Option<usize> {
    let size = alpha.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let mut best: Option<(f64, usize)> = None;
    for (i, (&a, &m)) in alpha.iter().zip(multipliers).enumerate() {
        if a <= PIVOT * size {
            continue;
        }
        let ratio = m / a;
        let better = best.is_none_or(|(least, k)| {
            ratio < least
                || (ratio == least
                    && if careful {
                        order(rows[i]) < order(rows[k])
                    } else {
                        (order(rows[i]) == 0, a) > (order(rows[k]) == 0, alpha[k])
                    })
        });
        if better {
            best = Some((ratio, i));
        }
    }
    best.map(|(_, i)| i)
}

fn order(row: Row) -> usize {
    match row {
        Row::AtInfinity { .. } => 0,
        Row::Given(index) => index + 1,
    }
}

/// The power of two at or below a positive number, kept away from the ends of the range.
fn power_of_two_near(x: f64) -> f64 {
    f64::from_bits(x.clamp(1e-280, 1e280).to_bits() & 0x7ff0_0000_0000_0000)
}
