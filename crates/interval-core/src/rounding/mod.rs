//! The only code that knows how floats round.
//!
//! Directed results come from round-to-nearest and error-free transformations: the nearest result is computed, the sign
//! of its error is found exactly, and the neighbour is taken only where the error calls for it. The rounding mode of
//! the processor is never touched.

mod environment;
#[cfg(target_os = "none")]
mod fused_sign;
mod scalar;
#[cfg(not(target_os = "none"))]
pub mod slices;

#[cfg(not(target_os = "none"))]
pub use environment::check_environment;
pub use environment::environment_is_default;
pub use scalar::{add_down, add_up, div_down, div_up, mul_down, mul_up, sub_down, sub_up};
#[cfg(not(target_os = "none"))]
pub use scalar::{fma_down, fma_up, sqrt_down, sqrt_up};
