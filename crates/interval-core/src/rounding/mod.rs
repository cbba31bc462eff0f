//! The only code that knows how floats round.
//!
//! Directed results come from round-to-nearest and error-free transformations: the nearest result is computed, the sign
//! of its error is found exactly, and the neighbour is taken only where the error calls for it. The rounding mode of the
//! processor is never touched.

mod scalar;
pub mod slices;

pub use scalar::{
    add_down, add_up, div_down, div_up, fma_down, fma_up, mul_down, mul_up, sqrt_down, sqrt_up, sub_down, sub_up,
};

use crate::error::Error;
use std::hint::black_box;

/// Whether the processor rounds to nearest and keeps subnormal numbers: the premise of every bound in this crate.
///
/// # Example
/// ```
/// assert!(interval_core::rounding::environment_is_default());
/// ```
#[must_use]
#[inline]
pub fn environment_is_default() -> bool {
    let half_ulp_above = black_box(f64::EPSILON) / 2.0;
    let half_ulp_below = half_ulp_above / 2.0;
    let nearest = black_box(1.0) + half_ulp_above == 1.0 && black_box(1.0) - half_ulp_below == 1.0;
    let half_normal = black_box(f64::MIN_POSITIVE) * 0.5;
    let results_kept = half_normal != 0.0;
    let operands_kept = black_box(f64::from_bits(1)) + black_box(0.0) != 0.0;
    nearest && results_kept && operands_kept
}

/// Refuses to go on where the floating-point environment is not the default one; a few nanoseconds.
///
/// # Errors
/// [`Error::Environment`].
#[inline]
pub fn check_environment() -> Result<(), Error> {
    if environment_is_default() { Ok(()) } else { Err(Error::Environment) }
}
