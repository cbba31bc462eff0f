//! The only code that knows how floats round.
//!
//! Directed results come from round-to-nearest and error-free transformations: the nearest result is computed, the sign
//! of its error is found exactly, and the neighbour is taken only where the error calls for it. The rounding mode of
//! the processor is never touched.

mod environment;
mod scalar;
#[cfg(feature = "alloc")]
pub mod slices;

pub use environment::check_environment;
pub use environment::environment_is_default;
pub use scalar::{
    add_down, add_up, div_down, div_up, fma_down, fma_up, mul_down, mul_up, sqrt_down, sqrt_up, sub_down, sub_up,
};
