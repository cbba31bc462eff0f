//! Filters of the diagnosis: recursions that share a denominator's order, and a causal whitening; and thrusts of many
//! demands.
//!
//! Plain floats, and no bound: nothing here is guaranteed. The result of a signal depends neither on the other signals
//! nor on the number of threads nor on the width of the processor's vectors: each sum has one order.

mod recursion;
mod thrust;
mod whitening;

pub use recursion::respond;
pub use thrust::{Curve, Error, Line, thrust};
pub use whitening::{Group, Layout, whiten};

/// Processors that this process may use.
#[must_use]
pub fn processors() -> usize {
    static FOUND: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
    *FOUND.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from))
}
