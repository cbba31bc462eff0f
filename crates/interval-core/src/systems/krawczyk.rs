//! Krawczyk's method for `A x = b` (paper eq. 8-10, corrected).

use super::column;
use crate::error::Error;
use crate::interval::Interval;
use crate::inverse::{Outcome, enclose_solution};
use crate::matrix::IntervalMatrix;

/// Encloses every solution of `A x = b` for members `A`, `b`.
///
/// # Errors
/// Shapes that do not fit.
pub fn krawczyk(a: &IntervalMatrix, b: &[Interval]) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    Ok(enclose_solution(a, &column(a, b)?))
}
