//! All least-squares solutions of interval rows, `{A+ y}` over all members, by a verified QR factorisation
//! (docs/theory.md, "Least squares"; Rump, *SIAM J. Matrix Anal. Appl.* 33 (2012) 130-148, whose point matrix is
//! widened to intervals here).
//!
//! With an approximate `R` of the midpoints, `S` near `R^-1`, `X = A S`, an approximate solution `u` and `r = y - A u`,
//! the solution `x` of a member has `x = u + S z` with `X'X z = X'r`, so `z = (I - X'X) z + X'r`. If `G = |I - X'X|`
//! contracts over all members, every member has full rank and `|z|` is bounded; then
//!
//! `x = u + sum_i (P a_i) r_i + S (I - X'X) z`,  `P = S S'`.
//!
//! Each row stands twice in its summand. About the midpoints `a_i = c + d`, `r_i = r_c + e - d u` the terms of first
//! order are `(P c) e + sum_j d_j (P_j r_c - (P c) u_j)`: one bound of them together, not of each factor.

use super::augmented;
use super::rows::Rows;
use super::scan::column_scale;
use crate::certified::Certified;
use crate::interval::Interval;
use crate::names::named;
use crate::parallel;
use crate::regularity::{contracted_vector, slack, times};
use crate::rounding::{add_up, div_up, mul_up};
use crate::status::LeastSquaresStatus;

/// Rows of one piece of a pass. The size is fixed, so that the result does not depend on the number of threads.
const PIECE: usize = 1 << 13;
/// Steps that sharpen the bound of `z`. Each of them keeps a bound, so any number is sound.
const SHARPENED: usize = 5;

named! {
    /// A method that encloses all least-squares solutions.
    LeastSquaresMethod, "method" {
        /// [`least_squares`](least_squares()): a verified QR factorisation.
        Qr => "qr",
        /// [`augmented`](augmented()): Rump's square system of order `m + n`.
        Augmented => "augmented",
    }
}

impl LeastSquaresMethod {
    /// Encloses every least-squares solution of every member.
    ///
    /// # Errors
    /// A changed rounding mode.
    pub fn solve(self, rows: &Rows<'_>) -> Result<LeastSquares, crate::Error> {
        match self {
            Self::Qr => least_squares(rows),
            Self::Augmented => augmented(rows),
        }
    }
}

/// An enclosure of all least-squares solutions.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquares {
    /// The proved property.
    pub status: LeastSquaresStatus,
    /// Bounds of each parameter over all members of the rows and right-hand sides.
    pub parameters: Option<Certified<Vec<Interval>>>,
    /// The reason for which there is none.
    pub reason: Option<String>,
}

impl LeastSquares {
    pub(super) const fn enclosed(parameters: Certified<Vec<Interval>>) -> Self {
        Self { status: LeastSquaresStatus::Enclosed, parameters: Some(parameters), reason: None }
    }

    pub(super) fn without(status: LeastSquaresStatus, reason: impl Into<String>) -> Self {
        Self { status, parameters: None, reason: Some(reason.into()) }
    }
}

/// Encloses every least-squares solution of every member, and proves on the way that every member has full rank.
///
/// # Errors
/// A changed rounding mode.
///
/// # Example
/// ```
/// use interval_core::regression::{LeastSquaresStatus, Rows, least_squares};
/// // a line through three points, the second of which is not on it
/// let a = [1.0, 0.0, 1.0, 1.0, 1.0, 2.0];
/// let y = [0.0, 2.0, 2.0];
/// let fit = least_squares(&Rows::new(2, &a, &a, &y, &y)?)?;
/// assert_eq!(fit.status, LeastSquaresStatus::Enclosed);
/// assert!(fit.parameters.is_some_and(|x| x[1].contains(1.0) && x[1].width() < 1e-14));
/// # Ok::<(), interval_core::Error>(())
/// ```
pub fn least_squares(rows: &Rows<'_>) -> Result<LeastSquares, crate::Error> {
    crate::rounding::check_environment()?;
    let (m, n) = (rows.count(), rows.columns());
    if m < n {
        let reason = format!("{m} rows leave {n} parameters undetermined");
        return Ok(LeastSquares::without(LeastSquaresStatus::NotApplicable, reason));
    }
    if !rows.open().is_empty() || (0..m).any(|i| !(rows.right(i).0.is_finite() && rows.right(i).1.is_finite())) {
        return Ok(LeastSquares::without(
            LeastSquaresStatus::NotApplicable,
            "a row has an infinite bound; every bound has to be finite",
        ));
    }
    let Some((s, centre)) = factorise(rows) else {
        return Ok(LeastSquares::without(
            LeastSquaresStatus::NotProved,
            "the columns of the midpoints are linearly dependent",
        ));
    };
    Ok(enclose(rows, &s, &centre).unwrap_or_else(|| {
        let reason = "I - X'X does not contract: the columns are nearly dependent, or the regressors are too uncertain";
        LeastSquares::without(LeastSquaresStatus::NotProved, reason)
    }))
}

/// An approximate `R^-1`, row-major, and an approximate solution, from Householder's factorisation in pieces.
fn factorise(rows: &Rows<'_>) -> Option<(Vec<f64>, Vec<f64>)> {
    let (m, n) = (rows.count(), rows.columns());
    let scale = column_scale(rows);
    let width = n + 1;
    let pieces = m.div_ceil(PIECE);
    let triangles = parallel::map(pieces, pieces > 1, |piece| {
        let [lower, upper, low, high] = rows.slices(piece * PIECE, m.min((piece + 1) * PIECE));
        let mut work = Vec::with_capacity(low.len().max(width) * width);
        for (i, (l, u)) in lower.chunks_exact(n).zip(upper.chunks_exact(n)).enumerate() {
            work.extend(l.iter().zip(u).zip(&scale).map(|((l, u), s)| (0.5 * l + 0.5 * u) * s));
            work.push(0.5 * low[i] + 0.5 * high[i]);
        }
        triangularise(&mut work, width);
        work
    });
    let mut work = triangles.concat();
    triangularise(&mut work, width);
    // S = R^-1, upper triangular, by columns; the scaled solution is S q.
    let mut s = vec![0.0; n * n];
    for j in 0..n {
        for i in (0..=j).rev() {
            let right = if i == j { 1.0 } else { 0.0 };
            let sum: f64 = (i + 1..=j).map(|k| work[i * width + k] * s[k * n + j]).sum();
            s[i * n + j] = (right - sum) / work[i * width + i];
        }
    }
    let mut centre = vec![0.0; n];
    for (i, row) in s.chunks_exact_mut(n).enumerate() {
        centre[i] = scale[i] * (0..n).map(|k| row[k] * work[k * width + n]).sum::<f64>();
        for x in row {
            *x *= scale[i];
        }
    }
    s.iter().chain(&centre).all(|x| x.is_finite()).then_some((s, centre))
}

/// Householder's reflections from the left; the triangle stays in the first `width` rows, the others are dropped.
fn triangularise(work: &mut Vec<f64>, width: usize) {
    let rows = work.len() / width;
    for p in 0..width.min(rows) {
        let length = (p..rows).map(|i| work[i * width + p] * work[i * width + p]).sum::<f64>().sqrt();
        if length == 0.0 {
            continue;
        }
        let head = work[p * width + p];
        let diagonal = if head > 0.0 { -length } else { length };
        work[p * width + p] = head - diagonal;
        let size = diagonal * (diagonal - head);
        for j in p + 1..width {
            let sum: f64 = (p..rows).map(|i| work[i * width + p] * work[i * width + j]).sum();
            let factor = sum / size;
            for i in p..rows {
                work[i * width + j] -= factor * work[i * width + p];
            }
        }
        work[p * width + p] = diagonal;
        for i in p + 1..rows {
            work[i * width + p] = 0.0;
        }
    }
    work.resize(width * width, 0.0);
}

/// Sums over rows that the enclosure is made from.
struct Sums {
    /// `X'X`, row-major.
    gram: Vec<Interval>,
    /// `X'r`.
    image: Vec<Interval>,
    /// `sum (P c) r_c`.
    middle: Vec<Interval>,
    /// Bounds of the part that the radii add to it.
    radius: Vec<f64>,
}

impl Sums {
    fn new(n: usize) -> Self {
        let zeros = |k| vec![Interval::ZERO; k];
        Self { gram: zeros(n * n), image: zeros(n), middle: zeros(n), radius: vec![0.0; n] }
    }

    fn add(&mut self, other: &Self) {
        let add = |a: &mut Vec<Interval>, b: &[Interval]| a.iter_mut().zip(b).for_each(|(a, b)| *a = *a + *b);
        add(&mut self.gram, &other.gram);
        add(&mut self.image, &other.image);
        add(&mut self.middle, &other.middle);
        for (a, b) in self.radius.iter_mut().zip(&other.radius) {
            *a = add_up(*a, *b);
        }
    }
}

fn point(x: f64) -> Interval {
    Interval::raw(x, x)
}

fn dot(a: impl Iterator<Item = (Interval, Interval)>) -> Interval {
    a.fold(Interval::ZERO, |sum, (x, y)| sum + x * y)
}

fn enclose(rows: &Rows<'_>, s: &[f64], centre: &[f64]) -> Option<LeastSquares> {
    let (m, n) = (rows.count(), rows.columns());
    let p: Vec<Interval> =
        (0..n * n).map(|at| dot((0..n).map(|k| (point(s[at / n * n + k]), point(s[at % n * n + k]))))).collect();
    let pieces = m.div_ceil(PIECE);
    let parts = parallel::map(pieces, pieces > 1, |piece| {
        let mut sums = Sums::new(n);
        for i in piece * PIECE..m.min((piece + 1) * PIECE) {
            row(rows, i, s, centre, &p, &mut sums);
        }
        sums
    });
    let mut sums = Sums::new(n);
    for part in &parts {
        sums.add(part);
    }
    let one = |at: usize| if at % (n + 1) == 0 { Interval::ONE } else { Interval::ZERO };
    let g: Vec<f64> = sums.gram.iter().enumerate().map(|(at, &x)| (one(at) - x).magnitude()).collect();
    if !g.iter().all(|x| x.is_finite()) {
        return None;
    }
    let vector = contracted_vector(&g, n)?;
    let rest = slack(&g, &vector)?;
    let image: Vec<f64> = sums.image.iter().map(|x| x.magnitude()).collect();
    let factor = image.iter().zip(&rest).map(|(&y, &r)| div_up(y, r)).fold(0.0, f64::max);
    let mut z: Vec<f64> = vector.iter().map(|&v| mul_up(factor, v)).collect();
    for _ in 0..SHARPENED {
        let grown = times(&g, &z);
        for ((z, g), y) in z.iter_mut().zip(grown).zip(&image) {
            *z = z.min(add_up(g, *y));
        }
    }
    let left = times(&g, &z);
    let parameters: Vec<Interval> = (0..n)
        .map(|k| {
            let beyond = (0..n).fold(sums.radius[k], |sum, l| add_up(sum, mul_up(s[k * n + l].abs(), left[l])));
            point(centre[k]) + sums.middle[k] + Interval::raw(-beyond, beyond)
        })
        .collect();
    let bounded = parameters.iter().all(|x| x.is_bounded());
    bounded.then(|| LeastSquares::enclosed(Certified::proved(parameters)))
}

/// The contribution of row `i` to the sums.
fn row(rows: &Rows<'_>, i: usize, s: &[f64], centre: &[f64], p: &[Interval], sums: &mut Sums) {
    let n = centre.len();
    let ((lower, upper), (low, high)) = (rows.row(i), rows.right(i));
    let a: Vec<Interval> = lower.iter().zip(upper).map(|(&l, &u)| Interval::raw(l, u)).collect();
    let y = Interval::raw(low, high);
    let x: Vec<Interval> = (0..n).map(|l| dot((0..n).map(|j| (a[j], point(s[j * n + l]))))).collect();
    let full = (0..n).fold(y, |sum, j| sum - a[j] * point(centre[j]));
    for k in 0..n {
        sums.image[k] = sums.image[k] + x[k] * full;
        for l in 0..n {
            let product = if k == l { x[k].square() } else { x[k] * x[l] };
            sums.gram[k * n + l] = sums.gram[k * n + l] + product;
        }
    }
    let c: Vec<f64> = a.iter().map(|x| x.midpoint()).collect();
    let d: Vec<f64> = a.iter().map(|x| x.radius()).collect();
    let (y, e) = (y.midpoint(), y.radius());
    let residual = (0..n).fold(point(y), |sum, j| sum - point(c[j]) * point(centre[j]));
    // The radius of the residual.
    let spread = (0..n).fold(e, |sum, j| add_up(sum, mul_up(d[j], centre[j].abs())));
    for k in 0..n {
        let line = &p[k * n..(k + 1) * n];
        let weight = dot(line.iter().copied().zip(c.iter().map(|&c| point(c))));
        sums.middle[k] = sums.middle[k] + weight * residual;
        let mut radius = mul_up(weight.magnitude(), e);
        let mut own = 0.0;
        for j in 0..n {
            let slope = line[j] * residual - weight * point(centre[j]);
            radius = add_up(radius, mul_up(slope.magnitude(), d[j]));
            own = add_up(own, mul_up(line[j].magnitude(), d[j]));
        }
        sums.radius[k] = add_up(sums.radius[k], add_up(radius, mul_up(own, spread)));
    }
}
