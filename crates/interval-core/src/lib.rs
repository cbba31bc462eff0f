//! Interval arithmetic, interval matrices and bounded-error regression with outward rounding.
//!
//! # Promises
//! - Every operation on [`Interval`] returns a set that contains the exact result for every choice of members of its
//!   operands. It is the *tightest* such interval of doubles, for
//!   elementary functions too.
//! - Every function that returns the status `Status::Enclosed` has *proved* its bounds in directed
//!   rounding or exact integer arithmetic; an approximation in plain floats is only ever the starting point of a proof.
//! - A proof that fails is a value (`Status::NotProved`), never a warning.
//! - Results do not depend on the number of threads.
//!
//! # Features
//! - Without features the crate needs no other: intervals, decorations, text, all functions of IEEE 1788, slices, exact sums.
//! - `exact` (on): rationals, by `num-bigint` and `num-rational`.
//! - `linalg` (on, with `exact`): interval matrices, inverses, systems, linear programmes, regression; `nalgebra` and `faer`
//!   propose the points whose proofs follow.
//! - `parallel` (on): threads, by `rayon`. The bits are the same without.
//! - `serde`: intervals as their bounds.
//!
//! # Limits
//! - `inverse::published` and `inverse::published_hull` follow a paper literally. They are *not* enclosures, and say
//!   so.
//! - The floating-point environment has to be the default one (round to nearest, subnormals kept);
//!   [`rounding::environment_is_default`] checks it.

#[cfg(feature = "linalg")]
mod absolute_value;
mod accumulator;
#[cfg(feature = "linalg")]
mod approximate;
#[cfg(feature = "linalg")]
pub mod certified;
mod decimals;
mod dyadic;
mod elementary;
pub mod error;
#[cfg(feature = "exact")]
pub mod exact;
mod integers;
pub mod interval;
#[cfg(feature = "linalg")]
pub mod inverse;
#[cfg(feature = "linalg")]
mod lanes;
#[cfg(feature = "linalg")]
pub mod linear_program;
#[cfg(feature = "linalg")]
pub mod matrix;
mod names;
mod parallel;
pub mod reach;
pub mod reductions;
#[cfg(feature = "linalg")]
pub mod regression;
#[cfg(feature = "linalg")]
pub mod regularity;
pub mod relaxation;
pub mod rounding;
#[cfg(feature = "linalg")]
mod scaling;
#[cfg(feature = "linalg")]
pub mod status;
#[cfg(feature = "linalg")]
pub mod systems;
#[cfg(feature = "linalg")]
pub mod tube;
#[cfg(feature = "linalg")]
mod verify;
#[cfg(feature = "linalg")]
mod witness;

#[cfg(feature = "linalg")]
pub use certified::{Certified, Claim, Unproved};
pub use error::Error;
pub use interval::{DecoratedInterval, Decoration, Interval};
#[cfg(feature = "linalg")]
pub use matrix::IntervalMatrix;
#[cfg(feature = "linalg")]
pub use status::Status;
