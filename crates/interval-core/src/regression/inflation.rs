//! The smallest factor on all radii at which a consistent parameter exists (docs/theory.md, "The feasible set"), an
//! estimate in plain floats.
//!
//! With midpoints `c` and radii `d` of rows and right-hand sides, the factor at `x` is
//! `max_i |c_i x - y_i| / (D_i |x| + d_i)`. In one orthant it is quasi-convex. A step of Dinkelbach's iteration (1967)
//! minimises, for the factor `k` at the present point, `t` over `|c_i x - y_i| - k (D_i |x| + d_i) <= t w_i`, `w_i` the
//! present denominator. The iteration stops when `t` is no longer negative. It runs on a working set, where its factor
//! is too small. A pass over all rows names those that ask for a larger one. The orthant with the smallest factor so
//! far is looked at first.

use super::rows::Rows;
use crate::approximate::least_squares;
use crate::linear_program::{Outcome, Program, Search};
use crate::parallel;

/// A factor and where it is attained.
#[derive(Debug, Clone)]
pub(crate) struct Attained {
    pub(crate) factor: f64,
    pub(crate) point: Vec<f64>,
}

/// Steps of Dinkelbach's iteration (1967) in one orthant at most: a bound of the time. Its convergence is superlinear.
const ITERATIONS: usize = 40;
/// Passes over all rows at most: a bound of the time.
const ROUNDS: usize = 200;
/// Relative progress below which the factor, an estimate in floats, counts as settled.
const PROGRESS: f64 = 1e-9;
/// Rows of one piece of a pass. The size is fixed, so that the result does not depend on the number of threads.
const PIECE: usize = 4096;
/// The distance, relative to the size of the unknowns, to which an unbounded direction is followed.
const FAR: f64 = 1024.0 * 1024.0;
/// Rows that one pass adds at most, so that the working set stays small.
const TAKEN: usize = 12;

/// The smallest factor over these orthants, starting from these rows and without the `dropped` ones (in ascending
/// order). The value is `None` if no factor helps.
pub(crate) fn smallest(rows: &Rows<'_>, start: &[usize], signs: &[&[i8]], dropped: &[usize]) -> Option<Attained> {
    let start: Vec<usize> = start.iter().copied().filter(|i| dropped.binary_search(i).is_err()).collect();
    let mut set = Working::new(rows, &start);
    let mut found: Vec<Option<Attained>> =
        parallel::map(signs.len(), signs.len() >= 8, |k| set.smallest(signs[k], None));
    // The number of rows of the working set that each of them has seen.
    let mut seen = vec![set.count(); signs.len()];
    let key = |a: &Option<Attained>| a.as_ref().map_or(f64::INFINITY, |a| a.factor);
    let mut best: Option<Attained> = None;
    for _ in 0..ROUNDS {
        let k = (0..signs.len()).min_by(|&a, &b| key(&found[a]).total_cmp(&key(&found[b])))?;
        if seen[k] < set.count() {
            let from = found[k].take();
            found[k] = set.smallest(signs[k], from.as_ref());
            seen[k] = set.count();
            continue;
        }
        let least = found[k].as_ref().filter(|a| a.factor.is_finite())?;
        let (factor, worst) = factor_of(rows, &least.point, dropped);
        if best.as_ref().is_none_or(|b| factor < b.factor) {
            best = Some(Attained { factor, point: least.point.clone() });
        }
        let reached = best.as_ref().is_some_and(|b| b.factor <= least.factor * (1.0 + PROGRESS));
        if reached || !set.extend(rows, &worst) {
            break;
        }
    }
    best.filter(|b| b.factor.is_finite())
}

/// The factor at a point over all rows, and rows that ask for the largest ones, the largest first.
fn factor_of(rows: &Rows<'_>, point: &[f64], dropped: &[usize]) -> (f64, Vec<usize>) {
    let (m, n) = (rows.count(), rows.columns());
    let pieces = m.div_ceil(PIECE);
    let mut found: Vec<(f64, usize)> = parallel::map(pieces, pieces > 4, |piece| {
        let (start, end) = (piece * PIECE, m.min((piece + 1) * PIECE));
        let [lower, upper, low, high] = rows.slices(start, end);
        let mut worst = (0.0, start);
        for (i, (l, u)) in lower.chunks_exact(n).zip(upper.chunks_exact(n)).enumerate() {
            let (yl, yu) = (0.5 * low[i], 0.5 * high[i]);
            let (mut residual, mut radius) = (-(yl + yu), yu - yl);
            let mut size = residual.abs();
            for ((&l, &u), &x) in l.iter().zip(u).zip(point) {
                let (l, u) = (0.5 * l, 0.5 * u);
                let term = (l + u) * x;
                residual += term;
                size += term.abs();
                radius += (u - l) * x.abs();
            }
            // A residual at the level of rounding is none; unbounded rows say nothing (their radius is infinite, or
            // nothing).
            let residual = residual.abs();
            if residual > 4.0 * f64::EPSILON * size && residual < f64::INFINITY && residual > worst.0 * radius {
                let factor = residual / radius;
                if factor > worst.0 && dropped.binary_search(&(start + i)).is_err() {
                    worst = (factor, start + i);
                }
            }
        }
        worst
    });
    found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let most = found.first().map_or(0.0, |f| f.0);
    (most, found.into_iter().take(TAKEN).filter(|f| f.0 > 0.0).map(|f| f.1).collect())
}

/// Midpoints and radii of a few rows.
struct Working {
    columns: usize,
    names: Vec<usize>,
    midpoint: Vec<f64>,
    radius: Vec<f64>,
    right: Vec<f64>,
    right_radius: Vec<f64>,
    scale: Vec<f64>,
    start: Vec<f64>,
}

impl Working {
    fn new(rows: &Rows<'_>, start: &[usize]) -> Self {
        let mut new = Self {
            columns: rows.columns(),
            names: Vec::new(),
            midpoint: Vec::new(),
            radius: Vec::new(),
            right: Vec::new(),
            right_radius: Vec::new(),
            scale: super::scan::column_scale(rows),
            start: Vec::new(),
        };
        new.extend(rows, start);
        new.start = least_squares(&new.midpoint, &new.right, new.columns);
        new
    }

    fn count(&self) -> usize {
        self.names.len()
    }

    /// Takes in rows that are bounded and new; whether there was one.
    fn extend(&mut self, rows: &Rows<'_>, indices: &[usize]) -> bool {
        let before = self.names.len();
        for &i in indices {
            let ((lower, upper), (low, high)) = (rows.row(i), rows.right(i));
            let bounded = lower.iter().chain(upper).chain([&low, &high]).all(|x| x.is_finite());
            if !bounded || self.names.contains(&i) {
                continue;
            }
            self.names.push(i);
            self.midpoint.extend(lower.iter().zip(upper).map(|(l, u)| 0.5 * l + 0.5 * u));
            self.radius.extend(lower.iter().zip(upper).map(|(l, u)| 0.5 * u - 0.5 * l));
            self.right.push(0.5 * low + 0.5 * high);
            self.right_radius.push(0.5 * high - 0.5 * low);
        }
        self.names.len() > before
    }

    /// The smallest factor in one orthant; infinite where rows without radius contradict each other.
    fn smallest(&self, signs: &[i8], from: Option<&Attained>) -> Option<Attained> {
        let inside = |x: &[f64]| -> Vec<f64> {
            x.iter().zip(signs).map(|(&x, &s)| if x * f64::from(s) < 0.0 { 0.0 } else { x }).collect()
        };
        let mut best = self.at(inside(from.map_or(&self.start, |a| &a.point)));
        if !best.factor.is_finite() {
            let weights = self.weights(&best.point);
            best = self.at(inside(&self.step(signs, 0.0, &weights)?));
        }
        for _ in 0..ITERATIONS {
            if !best.factor.is_finite() || best.factor == 0.0 {
                break;
            }
            let weights = self.weights(&best.point);
            let Some(point) = self.step(signs, best.factor, &weights) else { break };
            let next = self.at(inside(&point));
            let settled = next.factor >= best.factor * (1.0 - PROGRESS);
            if next.factor < best.factor {
                best = next;
            }
            if settled {
                break;
            }
        }
        Some(best)
    }

    /// Magnitudes that no unknown of these rows has reason to reach.
    fn far(&self) -> Vec<f64> {
        let most = self.right.iter().fold(0.0_f64, |a, y| a.max(y.abs()));
        self.scale.iter().zip(&self.start).map(|(s, x)| FAR * (most * s).max(x.abs()).max(f64::MIN_POSITIVE)).collect()
    }

    fn weights(&self, x: &[f64]) -> Vec<f64> {
        (0..self.count()).map(|i| self.denominator(i, x)).collect()
    }

    fn denominator(&self, i: usize, x: &[f64]) -> f64 {
        let row = &self.radius[i * self.columns..(i + 1) * self.columns];
        row.iter().zip(x).fold(self.right_radius[i], |sum, (d, x)| sum + d * x.abs())
    }

    fn at(&self, point: Vec<f64>) -> Attained {
        let factor = (0..self.count())
            .map(|i| {
                let row = &self.midpoint[i * self.columns..(i + 1) * self.columns];
                let residual = row.iter().zip(&point).fold(-self.right[i], |sum, (c, x)| sum + c * x).abs();
                let size = row.iter().zip(&point).fold(self.right[i].abs(), |sum, (c, x)| sum + (c * x).abs());
                // A residual at the level of rounding is none.
                if residual <= 4.0 * f64::EPSILON * size { 0.0 } else { residual / self.denominator(i, &point) }
            })
            .fold(0.0, f64::max);
        Attained { factor, point }
    }

    /// The linear program of one iteration, in `(x, t)`.
    fn step(&self, signs: &[i8], factor: f64, weights: &[f64]) -> Option<Vec<f64>> {
        let n = self.columns;
        let mut scale = self.scale.clone();
        let largest = weights.iter().fold(0.0_f64, |a, &x| a.max(x));
        scale.push(crate::linear_program::program::power_of_two_near(largest).recip());
        let mut program = Program::new(scale);
        let mut g = vec![0.0; n + 1];
        for (j, &s) in signs.iter().enumerate().filter(|(_, s)| **s != 0) {
            g.fill(0.0);
            g[j] = -f64::from(s);
            program.push(j, &g, 0.0);
        }
        for i in 0..self.count() {
            for side in [1.0, -1.0] {
                for j in 0..n {
                    let at = i * n + j;
                    g[j] = side * self.midpoint[at] - factor * self.radius[at] * f64::from(signs[j]);
                }
                g[n] = -weights[i];
                program.push(n + i, &g, side * self.right[i] + factor * self.right_radius[i]);
            }
        }
        g.fill(0.0);
        g[n] = 1.0;
        let mut search = Search::new(&program, &g);
        let mut outcome = search.run(&program);
        if outcome == Outcome::Unbounded {
            // The factor falls along a ray: far out it is as good as at infinity.
            for (j, &far) in self.far().iter().enumerate() {
                for side in [1.0, -1.0] {
                    g.fill(0.0);
                    g[j] = side;
                    program.push(n + self.count() + j, &g, far);
                }
            }
            outcome = search.run(&program);
        }
        let mut vertex = search.point(&program);
        vertex.truncate(n);
        (outcome == Outcome::Vertex && vertex.iter().all(|x| x.is_finite())).then_some(vertex)
    }
}
