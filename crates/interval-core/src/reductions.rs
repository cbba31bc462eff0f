//! Exact sums and dot products, rounded once: the result does not depend on the order of the operands.

use crate::accumulator::{accumulate, down, nearest};
use crate::interval::Interval;

fn rounded(terms: impl Iterator<Item = (f64, f64)>) -> f64 {
    accumulate(terms).map_or_else(|special| special, |value| nearest(&value))
}

/// The sum of `x`, rounded once to nearest. NaN where a term is, or where both infinities occur.
///
/// ```
/// use interval_core::reductions::sum;
/// assert_eq!(sum(&[1e100, 1.0, -1e100]), 1.0);
/// ```
#[must_use]
pub fn sum(x: &[f64]) -> f64 {
    rounded(x.iter().map(|&v| (v, 1.0)))
}

/// The sum of the absolute values, rounded once to nearest.
#[must_use]
pub fn sum_abs(x: &[f64]) -> f64 {
    rounded(x.iter().map(|&v| (v.abs(), 1.0)))
}

/// The sum of the squares, rounded once to nearest.
#[must_use]
pub fn sum_square(x: &[f64]) -> f64 {
    rounded(x.iter().map(|&v| (v, v)))
}

/// The dot product, rounded once to nearest; the shorter operand counts.
///
/// ```
/// use interval_core::reductions::dot;
/// assert_eq!(dot(&[1e200, 3.0, -1e200], &[1e200, 4.0, 1e200]), 12.0);
/// ```
#[must_use]
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    rounded(x.iter().copied().zip(y.iter().copied()))
}

/// The tightest interval around the sum of the members of `x`: each end is rounded once.
///
/// ```
/// use interval_core::{Interval, reductions::sum_intervals};
/// let x = ["0.1".parse::<Interval>()?; 10];
/// assert!(sum_intervals(&x).contains(1.0));
/// # Ok::<(), interval_core::Error>(())
/// ```
#[must_use]
pub fn sum_intervals(x: &[Interval]) -> Interval {
    if x.iter().any(|v| v.is_empty()) {
        return Interval::EMPTY;
    }
    let lower = accumulate(x.iter().map(|v| (v.lo(), 1.0))).map_or_else(|special| special, |value| down(&value));
    let upper = accumulate(x.iter().map(|v| (-v.hi(), 1.0))).map_or_else(|special| special, |value| down(&value));
    Interval::made(lower, -upper)
}
