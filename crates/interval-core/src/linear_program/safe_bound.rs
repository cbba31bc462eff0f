//! Proved lower bounds of `c x` over a polyhedron from unproved multipliers.
//!
//! For multipliers `l >= 0` of half-spaces `g x <= h`, every point of the polyhedron satisfies `c x >= -h l + r x` with
//! `r = c + G' l`. Neumaier and Shcherbina (*Math. Prog.* 99 (2004) 283-296) enclose `r x` over a box. The unknowns here have
//! no box, so one is proved first ([`proved_box`]); where there is none, the basis is solved over the rationals, which makes
//! `r` exactly zero ([`basis_multipliers`], [`farkas`]).

use super::{HalfSpaces, Row};
use crate::exact;
use crate::interval::Interval;
use crate::rounding::{add_up, div_up, mul_up, sub_down};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// A proposal: minimise `direction * x[column]` with these multipliers.
#[derive(Debug, Clone)]
pub(crate) struct Bound {
    /// The unknown.
    pub(crate) column: usize,
    /// 1 for a lower bound of the unknown, -1 for the negative of an upper bound.
    pub(crate) direction: f64,
    /// Basis rows with their approximate multipliers.
    pub(crate) rows: Vec<(Row, f64)>,
}

/// `r` and `-h l` of the module's inequality.
fn inequality(problem: &impl HalfSpaces, bound: &Bound) -> (Vec<Interval>, Interval) {
    let n = problem.dimension();
    let mut residual = vec![Interval::ZERO; n];
    residual[bound.column] = Interval::raw(bound.direction, bound.direction);
    let mut constant = Interval::ZERO;
    let mut g = vec![0.0; n];
    for &(row, multiplier) in &bound.rows {
        let Row::Given(index) = row else { continue };
        let h = problem.half_space(index, &mut g);
        if h == f64::INFINITY || multiplier <= 0.0 || !multiplier.is_finite() {
            continue;
        }
        let l = Interval::raw(multiplier, multiplier);
        for (r, &x) in residual.iter_mut().zip(&g) {
            *r = *r + l * Interval::raw(x, x);
        }
        constant = constant - l * Interval::raw(h, h);
    }
    (residual, constant)
}

/// A box that holds the whole polyhedron, proved without any prior bound on it.
///
/// With one proposal per end of every unknown, each (finite) point satisfies `|x_j| <= m_j + sum_k rho_jk |x_k|`, `m_j` from
/// the constants and `rho` from the residuals, both rounded up. For a scale `s > 0` put `t = max |x_j| / s_j`, taken over one
/// point, hence finite: `t <= max m_j / s_j + q t` with `q = max_j sum_k rho_jk s_k / s_j`. If `q < 1` then
/// `t <= max(m_j / s_j) / (1 - q)`, for every point alike.
pub(crate) fn proved_box(problem: &impl HalfSpaces, bounds: &[Bound]) -> Option<Vec<Interval>> {
    let n = problem.dimension();
    let mut constants = vec![0.0_f64; n];
    let mut residuals = vec![0.0_f64; n * n];
    for bound in bounds {
        let (residual, constant) = inequality(problem, bound);
        // A lower bound of -|..| on this side: the end is at least constant - rho |x|.
        constants[bound.column] = constants[bound.column].max(-constant.lo());
        for (k, r) in residual.iter().enumerate() {
            let at = bound.column * n + k;
            residuals[at] = residuals[at].max(r.magnitude());
        }
    }
    if !constants.iter().all(|m| m.is_finite()) {
        return None;
    }
    let largest = constants.iter().fold(0.0_f64, |a, &x| a.max(x));
    let scale: Vec<f64> = constants.iter().map(|&m| m.max(largest * 1e-12).max(f64::MIN_POSITIVE)).collect();
    let mut q = 0.0_f64;
    let mut start = 0.0_f64;
    for j in 0..n {
        let sum = (0..n).fold(0.0, |sum, k| add_up(sum, mul_up(residuals[j * n + k], scale[k])));
        q = q.max(div_up(sum, scale[j]));
        start = start.max(div_up(constants[j], scale[j]));
    }
    if q.is_nan() || q >= 1.0 {
        return None;
    }
    let t = div_up(start, sub_down(1.0, q));
    let reach: Vec<f64> = scale.iter().map(|&s| mul_up(s, t)).collect();
    reach.iter().all(|r| r.is_finite()).then(|| reach.iter().map(|&r| Interval::raw(-r, r)).collect())
}

/// The Neumaier-Shcherbina bound over a box that holds the polyhedron: `direction * x[column]` is at least this.
pub(crate) fn safe_bound(problem: &impl HalfSpaces, bound: &Bound, around: &[Interval]) -> f64 {
    let (residual, constant) = inequality(problem, bound);
    residual.iter().zip(around).fold(constant, |sum, (&r, &x)| sum + r * x).lo()
}

/// The exact multipliers of the basis for an objective, without a box; `None` where the basis proves nothing. The bound is
/// `-sum l h`.
pub(crate) fn basis_multipliers(
    problem: &impl HalfSpaces,
    rows: &[Row],
    column: usize,
    direction: f64,
) -> Option<Vec<(usize, BigRational)>> {
    let n = problem.dimension();
    let (transposed, _) = basis(problem, rows, n);
    let mut objective = vec![0.0; n];
    objective[column] = -direction;
    let multipliers = exact::solve(&transposed, &objective, n)?;
    let mut found = Vec::with_capacity(n);
    for (&row, multiplier) in rows.iter().zip(multipliers) {
        match row {
            Row::Given(index) if !multiplier.is_negative() => found.push((index, multiplier)),
            Row::AtInfinity { .. } if multiplier.is_zero() => {}
            _ => return None,
        }
    }
    Some(found)
}

/// The bound that exact multipliers give: `direction * x[column]` is at least this.
pub(crate) fn exact_bound(problem: &impl HalfSpaces, multipliers: &[(usize, BigRational)]) -> BigRational {
    let mut g = vec![0.0; problem.dimension()];
    multipliers
        .iter()
        .filter(|(_, l)| !l.is_zero())
        .fold(BigRational::zero(), |sum, (index, l)| sum - l * exact::rational(problem.half_space(*index, &mut g)))
}

/// Proves over the rationals that the half-spaces contradict each other: the last one's normal is a combination of the
/// others' with coefficients `<= 0` (Farkas). Returns the half-spaces of the contradiction with their positive multipliers.
pub(crate) fn farkas(problem: &impl HalfSpaces, others: &[Row], entering: usize) -> Option<Vec<(usize, BigRational)>> {
    let n = problem.dimension();
    let (transposed, right) = basis(problem, others, n);
    let mut g = vec![0.0; n];
    let h = problem.half_space(entering, &mut g);
    let alpha = exact::solve(&transposed, &g, n)?;
    let mut gap = exact::rational(h);
    let mut multipliers = Vec::with_capacity(n + 1);
    for ((&row, a), h) in others.iter().zip(alpha).zip(&right) {
        match row {
            _ if a.is_zero() => {}
            Row::Given(index) if a.is_negative() => {
                gap -= &a * exact::rational(*h);
                multipliers.push((index, -a));
            }
            _ => return None,
        }
    }
    multipliers.push((entering, BigRational::from_integer(1.into())));
    gap.is_negative().then_some(multipliers)
}

/// The transposed basis matrix, row-major, and the right-hand sides.
fn basis(problem: &impl HalfSpaces, rows: &[Row], n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut transposed = vec![0.0; n * n];
    let mut right = vec![0.0; n];
    let mut g = vec![0.0; n];
    for (i, &row) in rows.iter().enumerate() {
        match row {
            Row::Given(index) => right[i] = problem.half_space(index, &mut g),
            Row::AtInfinity { column, negative } => {
                g.fill(0.0);
                g[column] = if negative { -1.0 } else { 1.0 };
            }
        }
        for (j, &x) in g.iter().enumerate() {
            transposed[j * n + i] = x;
        }
    }
    (transposed, right)
}
