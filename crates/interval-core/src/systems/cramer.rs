//! Interval Cramer's rule for `A x = b` (paper, section IV.B, steps 1-3).

use super::column;
use crate::error::Error;
use crate::interval::Interval;
use crate::inverse::{Certificate, Outcome, determinant, expand_all};
use crate::matrix::IntervalMatrix;

/// Encloses every solution of `A x = b`: the determinant with column `i` replaced by `b`, over the determinant.
///
/// # Errors
/// Shapes that do not fit.
pub fn cramer(a: &IntervalMatrix, b: &[Interval]) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let right = column(a, b)?;
    let det = match determinant(a) {
        Ok(det) => det,
        Err(refusal) => return Ok(Outcome::not_applicable(refusal)),
    };
    let n = a.rows();
    let x: Vec<Interval> = (0..n)
        .map(|i| {
            let entries: Vec<Interval> =
                (0..n * n).map(|at| if at % n == i { right.get(at / n, 0) } else { a.get(at / n, at % n) }).collect();
            expand_all(&IntervalMatrix::from_entries(n, n, &entries)) / det
        })
        .collect();
    let value = IntervalMatrix::from_entries(n, 1, &x);
    if !value.is_bounded() {
        return Ok(Outcome::not_applicable("a ratio of determinants has no finite bound"));
    }
    Ok(Outcome::enclosed(value, Certificate::Determinant { lo: det.lo(), hi: det.hi() }))
}
