//! The closed-form hull of the preconditioned system for `A x = b`.

use super::column;
use crate::error::Error;
use crate::interval::Interval;
use crate::inverse::{Outcome, enclose_preconditioned};
use crate::matrix::IntervalMatrix;

/// Encloses every solution of `A x = b` for members `A`, `b`.
///
/// # Errors
/// Shapes that do not fit.
pub fn hansen_bliek_rohn(a: &IntervalMatrix, b: &[Interval]) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    Ok(enclose_preconditioned(a, Some(&column(a, b)?)))
}
