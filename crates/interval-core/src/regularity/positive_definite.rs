//! Regularity by a norm of the radii that is smaller than the least singular value of the midpoint (Rex and Rohn 1998):
//! `m'm - s I` is positive definite for an `s` of at least the squared spectral norm of the radii.

use super::{Witness, split, times};
use crate::doubles::Neighbours as _;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;
use nalgebra::DMatrix;

/// Orders above this are left to the other tests: products in interval arithmetic lose more than this test gains.
const ORDER_LIMIT: usize = 64;

pub(super) fn prove(a: &IntervalMatrix) -> Option<Witness> {
    let n = a.rows();
    if n > ORDER_LIMIT {
        return None;
    }
    let (middle, spread) = split(a);
    let (shift, vector) = squared_norm(&spread, n)?;
    let s = shifted_gram(&middle, shift, n);
    let approximation = DMatrix::from_row_slice(n, n, &s.midpoint());
    let factor = approximation.cholesky()?.l().try_inverse()?;
    // Column-major storage of the transpose: rows of the inverse factor.
    let congruence: Vec<f64> = factor.transpose().as_slice().to_vec();
    is_positive_definite(&s, &congruence).then_some(Witness::PositiveDefinite { shift, vector, congruence })
}

/// Bounds of `m'm - shift I`.
fn shifted_gram(middle: &[f64], shift: f64, n: usize) -> IntervalMatrix {
    let gram = IntervalMatrix::from_points(n, n, middle).gram();
    let shift = Interval::raw(shift, shift);
    let entries: Vec<Interval> =
        gram.entries().enumerate().map(|(at, x)| if at % (n + 1) == 0 { x - shift } else { x }).collect();
    IntervalMatrix::from_entries(n, n, &entries)
}

/// `||I - X S X'|| < 1`: `X S X'` has no eigenvalue below 0, and by Sylvester's law neither has `S`.
fn is_positive_definite(s: &IntervalMatrix, congruence: &[f64]) -> bool {
    let n = s.rows();
    let x = IntervalMatrix::from_points(n, n, congruence);
    let Ok(product) = x.multiply(s).and_then(|xs| xs.multiply(&x.transpose())) else { return false };
    let entries: Vec<Interval> =
        (product.entries().enumerate()).map(|(at, e)| if at % (n + 1) == 0 { Interval::ONE - e } else { -e }).collect();
    IntervalMatrix::from_entries(n, n, &entries).norm() < 1.0
}

/// A bound of the squared spectral norm of the non-negative `D`: `D'D w <= s w` for a `w > 0` (Collatz and Wielandt).
fn squared_norm(d: &[f64], n: usize) -> Option<(f64, Vec<f64>)> {
    let transposed: Vec<f64> = (0..n * n).map(|at| d[(at % n) * n + at / n]).collect();
    let mut w = vec![1.0; n];
    let mut least = f64::INFINITY;
    let mut best = w.clone();
    for _ in 0..12 {
        let image = times(&transposed, &times(d, &w));
        let quotients: Vec<f64> = image.iter().zip(&w).map(|(y, x)| (y / x).above()).collect();
        // An overflow would make them infinite or NaN, which a maximum passes over.
        if !(quotients.iter().all(|q| q.is_finite()) && w.iter().all(|&x| x > 0.0 && x.is_finite())) {
            break;
        }
        let bound = quotients.into_iter().fold(0.0, f64::max);
        if bound < least {
            least = bound;
            best.clone_from(&w);
        }
        let largest = image.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            break;
        }
        w = image.iter().map(|y| y / largest + 1e-9).collect();
    }
    least.is_finite().then_some((least, best))
}
