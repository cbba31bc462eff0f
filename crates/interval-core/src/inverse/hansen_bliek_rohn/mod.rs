//! The closed-form hull of the preconditioned system, column by column (Hansen 1992, Bliek 1992, Rohn 1993; in the form
//! of Neumaier, *Reliable Computing* 5 (1999) 131-136).
//!
//! With an approximate inverse `R` of the midpoint and bounds `G >= |I - R A|` over all members, `G v < v` for some
//! `v > 0` proves every member regular and `I - G` an M-matrix. Let `V = (I - G)^-1 G >= 0`, so that
//! `(I - G)^-1 = I + V`. A solution of `A x = b` solves `R A x = R b = z`, and with
//!
//! `alpha_i = sum_{k != i} G_ik V_ki / (1 + V_ii)`, `beta_i = sum_{k != i} V_ik |z_k| / (1 + V_ii)`
//!
//! it lies in `(z_i + [-beta_i, beta_i]) / ([1 - G_ii, 1 + G_ii] + [-alpha_i, alpha_i])`. These are Neumaier's `alpha`
//! and `beta` with their differences carried out by `V = G + G V`, so nothing cancels. Any upper bounds of them keep
//! the enclosure. `V` is bounded from both sides by the residual of an approximation:
//! `|V - W| <= v max_i |G + G W - W|_i / (v - G v)_i` in each column.

mod three;

use super::rows::Row;
use super::{Certificate, Outcome, UNBOUNDED};
use crate::approximate;
use crate::error::Error;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;
use crate::regularity::{Preconditioned, Witness, slack};
use crate::rounding::slices::Binary;
use crate::rounding::{add_down, add_up, div_up, sub_down};

/// Encloses the inverse column by column. The method does not apply if no `v` with `G v < v` is found.
///
/// # Errors
/// A matrix that is not square.
pub fn hansen_bliek_rohn(a: &IntervalMatrix) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    a.order()?;
    Ok(enclose(a, None))
}

/// Encloses every solution of `A X = B`, `A` square with as many rows as `B`; without `B` the inverse.
pub(crate) fn enclose(a: &IntervalMatrix, b: Option<&IntervalMatrix>) -> Outcome {
    if !(a.is_bounded() && b.is_none_or(IntervalMatrix::is_bounded)) {
        return Outcome::not_applicable(UNBOUNDED);
    }
    let n = a.rows();
    let of_three = if n == 3 && b.is_none() { three::enclose(a) } else { None };
    if let Some((lo, hi, r)) = of_three
        && let Ok(value) = IntervalMatrix::new(3, 3, lo.to_vec(), hi.to_vec())
    {
        let witness = Witness::ScaledContraction { approximate_inverse: r.to_vec(), vector: vec![1.0; 3] };
        return Outcome::enclosed(value, Certificate::Regular(witness));
    }
    let Some(preconditioned) = Preconditioned::new(a) else {
        return Outcome::not_applicable("the midpoint matrix has no usable approximate inverse");
    };
    let Some(v) = preconditioned.contracted() else {
        return Outcome::not_applicable("no v > 0 with |I - R A| v < v was found: strong regularity is not proved");
    };
    let z = match b {
        None => IntervalMatrix::from_points(n, n, &preconditioned.r),
        Some(b) => match IntervalMatrix::from_points(n, n, &preconditioned.r).multiply(b) {
            Ok(z) => z,
            Err(_) => return Outcome::not_applicable("the right-hand side does not fit the matrix"),
        },
    };
    let Some(value) = closed_form(&preconditioned, &v, &z) else {
        return Outcome::not_applicable("a bound of the closed form overflows");
    };
    let witness = Witness::ScaledContraction { approximate_inverse: preconditioned.r, vector: v };
    Outcome::enclosed(value, Certificate::Regular(witness))
}

/// The enclosure of the solutions of `R A X = Z`. The value is `None` if a bound is not finite.
pub(crate) fn closed_form(p: &Preconditioned, v: &[f64], z: &IntervalMatrix) -> Option<IntervalMatrix> {
    let (n, columns) = (p.n, z.columns());
    let tail = Tail::new(&p.g, v, n)?;
    let growth = Growth::of(n);
    let off_diagonal: Vec<f64> =
        tail.upper.iter().enumerate().map(|(at, &x)| if at % (n + 1) == 0 { 0.0 } else { x }).collect();
    let beta = approximate::product(&off_diagonal, &z.magnitude(), n, n, columns);
    let alpha = diagonal_of_product(&p.g, &off_diagonal, n);
    let (mut lo, mut hi) = (vec![0.0; n * columns], vec![0.0; n * columns]);
    let (mut x, mut y) = (Row::new(columns), Row::new(columns));
    for i in 0..n {
        let diagonal = add_down(1.0, tail.lower[i * (n + 1)]);
        let alpha = div_up(growth.above(alpha[i]), diagonal);
        let reach = add_up(p.g[i * n + i], alpha);
        let (least, most) = (sub_down(1.0, reach), add_up(1.0, reach));
        if least.is_nan() || least <= 0.0 {
            return None;
        }
        let row = i * columns..(i + 1) * columns;
        x.fill(|j| {
            let above = growth.above(beta[row.start + j]);
            (-above, above)
        });
        x.divided(diagonal, diagonal, &mut y)?;
        for (j, &beta) in beta[row.clone()].iter().enumerate() {
            if beta == 0.0 && off_diagonal_is_zero(&off_diagonal[i * n..][..n], z, j) {
                (y.lo[j], y.hi[j]) = (0.0, 0.0);
            }
        }
        y.combined(Binary::Add, (&z.lo()[row.clone()], &z.hi()[row.clone()]), &mut x)?;
        x.divided(least, most, &mut y)?;
        lo[row.clone()].copy_from_slice(&y.lo);
        hi[row].copy_from_slice(&y.hi);
    }
    let bounded = lo.iter().chain(&hi).all(|x| x.is_finite());
    bounded.then(|| IntervalMatrix::new(n, columns, lo, hi).ok()).flatten()
}

/// The diagonal of `A B`, each sum in the order of the inner index.
fn diagonal_of_product(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    // Columns side by side, so that what the cache fetches of a row of `B` is used at once.
    const SIDE: usize = 8;
    let mut sums = vec![0.0; n];
    for (block, sums) in sums.chunks_mut(SIDE).enumerate() {
        for k in 0..n {
            for (offset, sum) in sums.iter_mut().enumerate() {
                let i = block * SIDE + offset;
                *sum += a[i * n + k] * b[k * n + i];
            }
        }
    }
    sums
}

/// True if each product in a row of `V` with column `j` of `Z` has a factor of zero.
fn off_diagonal_is_zero(row: &[f64], z: &IntervalMatrix, j: usize) -> bool {
    row.iter().enumerate().all(|(k, &x)| x == 0.0 || z.get(k, j) == Interval::ZERO)
}

/// Bounds of `V = (I - G)^-1 G` for a `G >= 0` with `G v < v`.
pub(crate) struct Tail {
    /// Upper bounds, row-major.
    pub upper: Vec<f64>,
    /// Lower bounds, row-major.
    pub lower: Vec<f64>,
}

impl Tail {
    pub(crate) fn new(g: &[f64], v: &[f64], n: usize) -> Option<Self> {
        let rest = slack(g, v)?;
        let growth = Growth::of(n);
        let comparison: Vec<f64> =
            g.iter().enumerate().map(|(at, x)| if at % (n + 1) == 0 { 1.0 - x } else { -x }).collect();
        let sum = approximate::inverse(&comparison, n)?;
        // Rounding leaves negative entries where there are zeros.
        let w: Vec<f64> = approximate::product(g, &sum, n, n, n).into_iter().map(|x| x.max(0.0)).collect();
        let image = approximate::product(g, &w, n, n, n);
        // The maxima below pass over NaN.
        if !w.iter().chain(&image).chain(g).all(|x| x.is_finite()) {
            return None;
        }
        let (mut above, mut below) = (vec![0.0_f64; n], vec![0.0_f64; n]);
        let (mut x, mut y) = (Row::new(n), Row::new(n));
        for i in 0..n {
            let row = i * n..(i + 1) * n;
            let (g, image, w) = (&g[row.clone()], &image[row.clone()], &w[row]);
            // G + G W - W, whose upper end is the excess and whose lower end is the lack below zero.
            x.fill(|j| (growth.below(image[j]), growth.above(image[j])));
            x.combined(Binary::Add, (g, g), &mut y)?;
            y.combined(Binary::Sub, (w, w), &mut x)?;
            x.stretch_to_zero();
            x.divided(rest[i], rest[i], &mut y)?;
            for j in 0..n {
                above[j] = above[j].max(y.hi[j]);
                below[j] = below[j].max(-y.lo[j]);
            }
        }
        let zero = unreachable(g, n);
        let (mut upper, mut lower) = (vec![0.0; n * n], vec![0.0; n * n]);
        for i in 0..n {
            let row = i * n..(i + 1) * n;
            let w = &w[row.clone()];
            x.fill(|j| (-below[j], above[j]));
            x.multiplied(v[i], &mut y)?;
            y.combined(Binary::Add, (w, w), &mut x)?;
            for (j, at) in row.enumerate() {
                if !zero.as_ref().is_some_and(|z| z[at]) {
                    (lower[at], upper[at]) = (x.lo[j].max(g[at]), x.hi[j]);
                }
            }
        }
        upper.iter().all(|x| x.is_finite()).then_some(Self { upper, lower })
    }
}

/// The entries of `G + G^2 + ...` that are zero because no path of positive entries leads there; `None` if `G` has no
/// zero.
fn unreachable(g: &[f64], n: usize) -> Option<Vec<bool>> {
    if g.iter().all(|&x| x > 0.0) {
        return None;
    }
    let mut reached: Vec<bool> = g.iter().map(|&x| x > 0.0).collect();
    for k in 0..n {
        for i in 0..n {
            if reached[i * n + k] {
                for j in 0..n {
                    reached[i * n + j] |= reached[k * n + j];
                }
            }
        }
    }
    Some(reached.into_iter().map(|r| !r).collect())
}

/// Bounds of a sum of `n` non-negative products from its value in floats, in any order of summation.
#[derive(Clone, Copy)]
pub(crate) struct Growth {
    relative: f64,
    absolute: f64,
}

impl Growth {
    pub(crate) fn of(n: usize) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "an order, far below 2^53")]
        let terms = n as f64;
        // n u of the sum, the multiplication and addition below, the rounding of the factor, and higher orders.
        Self { relative: (terms + 5.0) * (f64::EPSILON / 2.0), absolute: 4.0 * (terms + 4.0) * f64::from_bits(1) }
    }

    pub(crate) fn above(self, sum: f64) -> f64 {
        sum * (1.0 + self.relative) + self.absolute
    }

    pub(crate) fn below(self, sum: f64) -> f64 {
        (sum * (1.0 - self.relative) - self.absolute).max(0.0)
    }
}
