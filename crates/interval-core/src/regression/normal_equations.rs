//! Interval least squares by normal equations, `theta = (A'A)^-1 A'y` (paper eq. 7 and 14), with any inverse.
//!
//! For an inverse that encloses, the result holds every least-squares solution of every member, and with it every
//! parameter that is consistent with all rows. For the published inverse nothing is claimed; an improper entry
//! contributes the smallest and the largest product of its ends.

use super::check_rows;
use crate::certified::{Claim, Unproved};
use crate::error::Error;
use crate::interval::Interval;
use crate::inverse::{Endpoints, Outcome, Value};
use crate::matrix::IntervalMatrix;
use crate::status::Status;

/// The result of eq. 14.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalEquations {
    /// Proved only where the inverse was.
    pub status: Status,
    /// Parameter intervals, certified where the inverse is. The value is `None` if the inverse has no value.
    pub parameters: Option<Claim<Vec<Interval>>>,
    /// The number of improper entries of the inverse.
    pub improper: usize,
    /// `A'A`.
    pub gram: IntervalMatrix,
    /// The result of the inverse method for `A'A`.
    pub inverse: Outcome,
}

/// Evaluates eq. 14 with the given inverse method.
///
/// # Errors
/// Shapes that do not fit, and misuse of the inverse method.
pub fn normal_equations(
    a: &IntervalMatrix,
    y: &[Interval],
    invert: impl FnOnce(&IntervalMatrix) -> Result<Outcome, Error>,
) -> Result<NormalEquations, Error> {
    crate::rounding::check_environment()?;
    check_rows(a, y)?;
    let gram = a.gram();
    let right = a.transposed_product(y)?;
    let inverse = invert(&gram)?;
    let improper = inverse.bounds().map_or(0, |(lower, upper)| lower.iter().zip(upper).filter(|(l, u)| l > u).count());
    let parameters = inverse.value.as_ref().map(|value| match value {
        Value::Certified(value) => Claim::Certified(value.map(|value| apply((value.lo(), value.hi()), &right))),
        Value::Unproved(Unproved(Endpoints { lower, upper })) => {
            Claim::Unproved(Unproved(apply((lower, upper), &right)))
        }
    });
    Ok(NormalEquations { status: inverse.status, parameters, improper, gram, inverse })
}

fn apply((lower, upper): (&[f64], &[f64]), right: &[Interval]) -> Vec<Interval> {
    lower
        .chunks_exact(right.len())
        .zip(upper.chunks_exact(right.len()))
        .map(|(lower, upper)| {
            lower
                .iter()
                .zip(upper)
                .zip(right)
                .fold(Interval::ZERO, |sum, ((&l, &u), &y)| sum + Interval::raw(l.min(u), l.max(u)) * y)
        })
        .collect()
}
