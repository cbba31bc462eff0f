//! The smallest factor on all radii at which a consistent parameter exists (METHODS 5.3), an estimate in plain floats.
//!
//! With midpoints `c` and radii `d` of rows and right-hand sides, the factor at `x` is `max_i |c_i x - y_i| / (D_i |x| + d_i)`;
//! in one orthant it is quasi-convex. Dinkelbach's iteration: for the factor `k` at the present point minimise `t` over
//! `|c_i x - y_i| - k (D_i |x| + d_i) <= t w_i`, `w_i` the present denominator; stop when `t` is no longer negative.

use crate::approximate::least_squares;
use crate::interval::Interval;
use crate::linear_program::{Answer, HalfSpaces, Simplex};
use crate::matrix::IntervalMatrix;

/// Midpoints and radii of the rows.
pub(crate) struct Inflation {
    rows: usize,
    columns: usize,
    midpoint: Vec<f64>,
    radius: Vec<f64>,
    right: Vec<f64>,
    right_radius: Vec<f64>,
    start: Vec<f64>,
}

/// A factor and where it is attained.
#[derive(Debug, Clone)]
pub(crate) struct Attained {
    pub(crate) factor: f64,
    pub(crate) point: Vec<f64>,
}

const ITERATIONS: usize = 40;
const PROGRESS: f64 = 1e-9;

impl Inflation {
    /// Unbounded rows say nothing about the factor and are left out.
    pub(crate) fn new(a: &IntervalMatrix, y: &[Interval]) -> Self {
        let n = a.columns();
        let mut new = Self {
            rows: 0,
            columns: n,
            midpoint: Vec::new(),
            radius: Vec::new(),
            right: Vec::new(),
            right_radius: Vec::new(),
            start: Vec::new(),
        };
        for (i, value) in y.iter().enumerate() {
            let row: Vec<Interval> = (0..n).map(|j| a.get(i, j)).collect();
            if value.is_bounded() && row.iter().all(|x| x.is_bounded()) {
                new.rows += 1;
                new.midpoint.extend(row.iter().map(|x| x.midpoint()));
                new.radius.extend(row.iter().map(|x| x.radius()));
                new.right.push(value.midpoint());
                new.right_radius.push(value.radius());
            }
        }
        new.start = least_squares(&new.midpoint, &new.right, n);
        new
    }

    /// The smallest factor in one orthant; infinite where rows without radius contradict each other.
    pub(crate) fn smallest(&self, signs: &[i8]) -> Option<Attained> {
        let inside = |x: &[f64]| -> Vec<f64> {
            x.iter().zip(signs).map(|(&x, &s)| if x * f64::from(s) < 0.0 { 0.0 } else { x }).collect()
        };
        let mut best = self.at(inside(&self.start));
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

    fn weights(&self, x: &[f64]) -> Vec<f64> {
        (0..self.rows).map(|i| self.denominator(i, x)).collect()
    }

    fn denominator(&self, i: usize, x: &[f64]) -> f64 {
        let row = &self.radius[i * self.columns..(i + 1) * self.columns];
        row.iter().zip(x).fold(self.right_radius[i], |sum, (d, x)| sum + d * x.abs())
    }

    fn at(&self, point: Vec<f64>) -> Attained {
        let factor = (0..self.rows)
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

    fn step(&self, signs: &[i8], factor: f64, weights: &[f64]) -> Option<Vec<f64>> {
        let problem = Step { data: self, signs, factor, weights };
        let mut objective = vec![0.0; self.columns + 1];
        objective[self.columns] = 1.0;
        match Simplex::new(&problem).minimise(&objective) {
            Answer::Basis { mut vertex, .. } => {
                vertex.truncate(self.columns);
                vertex.iter().all(|x| x.is_finite()).then_some(vertex)
            }
            _ => None,
        }
    }
}

/// The linear program of one iteration, in `(x, t)`.
struct Step<'a> {
    data: &'a Inflation,
    signs: &'a [i8],
    factor: f64,
    weights: &'a [f64],
}

impl HalfSpaces for Step<'_> {
    fn dimension(&self) -> usize {
        self.data.columns + 1
    }

    fn count(&self) -> usize {
        2 * self.data.rows + self.data.columns
    }

    fn half_space(&self, index: usize, g: &mut [f64]) -> f64 {
        let (m, n) = (self.data.rows, self.data.columns);
        if index >= 2 * m {
            let j = index - 2 * m;
            g.fill(0.0);
            g[j] = -f64::from(self.signs[j]);
            return if self.signs[j] == 0 { f64::INFINITY } else { 0.0 };
        }
        let below = index >= m;
        let row = if below { index - m } else { index };
        for j in 0..n {
            let at = row * n + j;
            let centre = if below { -self.data.midpoint[at] } else { self.data.midpoint[at] };
            g[j] = centre - self.factor * self.data.radius[at] * f64::from(self.signs[j]);
        }
        g[n] = -self.weights[row];
        let right = if below { -self.data.right[row] } else { self.data.right[row] };
        right + self.factor * self.data.right_radius[row]
    }
}
