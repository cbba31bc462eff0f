//! Krawczyk's method (paper eq. 8-10, corrected: `Y` is an approximate *inverse* of the midpoint, and the new iterate
//! is intersected with the old one; Moore, Kearfott and Cloud 2009, section 7.2).
//!
//! `E = I - Y A` with `||E|| < 1` proves that every member is nonsingular, and that the solution of `A x = b` lies in
//! `x(0) = [-1, 1] ||Y b|| / (1 - ||E||)`; then `x(k + 1) = (Y b + E x(k))` intersected with `x(k)`.

use super::{Certificate, Outcome, UNBOUNDED};
use crate::approximate;
use crate::error::Error;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;
use crate::regularity::{Witness, interval_residual};
use crate::rounding::{div_up, sub_down};

/// Encloses the inverse. The method does not apply if `||E|| >= 1`.
///
/// # Errors
/// A matrix that is not square.
pub fn krawczyk(a: &IntervalMatrix) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let n = a.order()?;
    Ok(enclose_solution(a, &IntervalMatrix::identity(n)))
}

/// Iterations at most; they end before if nothing changes. Each iterate is an enclosure, so any number is sound (Moore,
/// Kearfott and Cloud 2009, section 7.2).
const ITERATIONS: usize = 60;

/// Encloses every solution of `A X = B`, `A` square with as many rows as `B`.
pub(crate) fn enclose_solution(a: &IntervalMatrix, b: &IntervalMatrix) -> Outcome {
    if !(a.is_bounded() && b.is_bounded()) {
        return Outcome::not_applicable(UNBOUNDED);
    }
    let n = a.rows();
    let Some(y) = approximate::inverse(&a.midpoint(), n) else {
        return Outcome::not_applicable("the midpoint matrix has no usable approximate inverse");
    };
    let Ok(e) = interval_residual(&y, a) else {
        return Outcome::not_applicable("the residual I - Y A overflows");
    };
    let norm = e.norm();
    if norm.is_nan() || norm >= 1.0 {
        return Outcome::not_applicable(format!("||I - Y A|| = {norm:.3} is not below 1: Krawczyk's condition fails"));
    }
    let Ok(yb) = IntervalMatrix::from_points(n, n, &y).multiply(b) else {
        return Outcome::not_applicable("the right-hand side does not fit the matrix");
    };
    let slack = sub_down(1.0, norm);
    let starts: Vec<f64> = column_norms(&yb).into_iter().map(|c| div_up(c, slack)).collect();
    if starts.iter().any(|s| !s.is_finite()) {
        return Outcome::not_applicable("the start box of the iteration overflows");
    }
    let entries: Vec<Interval> = (0..n).flat_map(|_| starts.iter().map(|&s| Interval::raw(-s, s))).collect();
    let mut x = IntervalMatrix::from_entries(n, b.columns(), &entries);
    for _ in 0..ITERATIONS {
        let Some(next) = e.multiply(&x).ok().and_then(|ex| yb.add(&ex).intersection(&x)) else {
            break;
        };
        if next == x {
            break;
        }
        x = next;
    }
    Outcome::enclosed(x, Certificate::Regular(Witness::Contraction { approximate_inverse: y, norm }))
}

/// Each column's largest magnitude.
fn column_norms(a: &IntervalMatrix) -> Vec<f64> {
    (0..a.columns()).map(|j| (0..a.rows()).map(|i| a.get(i, j).magnitude()).fold(0.0, f64::max)).collect()
}
