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
//! # Without a system
//! On a target without an operating system (`target_os = "none"`) the crate is `no_std` and holds [`rounding`]: directed
//! sums, products and quotients, to the same bits. The other modules need the standard library.
//!
//! # Limits
//! - `inverse::published` and `inverse::published_hull` follow a paper literally. They are *not* enclosures, and say
//!   so.
//! - The floating-point environment has to be the default one (round to nearest, subnormals kept);
//!   [`rounding::environment_is_default`] checks it.

#![cfg_attr(target_os = "none", no_std)]

#[cfg(feature = "linalg")]
mod absolute_value;
#[cfg(not(target_os = "none"))]
mod accumulator;
#[cfg(feature = "linalg")]
mod approximate;
#[cfg(feature = "linalg")]
pub mod certified;
#[cfg(not(target_os = "none"))]
mod decimals;
#[cfg(not(target_os = "none"))]
mod dyadic;
#[cfg(not(target_os = "none"))]
mod elementary;
#[cfg(not(target_os = "none"))]
pub mod error;
#[cfg(feature = "exact")]
pub mod exact;
#[cfg(not(target_os = "none"))]
mod integers;
#[cfg(not(target_os = "none"))]
pub mod interval;
#[cfg(feature = "linalg")]
pub mod inverse;
#[cfg(feature = "linalg")]
mod lanes;
#[cfg(feature = "linalg")]
pub mod linear_program;
#[cfg(feature = "linalg")]
pub mod matrix;
#[cfg(not(target_os = "none"))]
mod names;
#[cfg(not(target_os = "none"))]
mod parallel;
#[cfg(not(target_os = "none"))]
pub mod reach;
#[cfg(not(target_os = "none"))]
pub mod reductions;
#[cfg(feature = "linalg")]
pub mod regression;
#[cfg(feature = "linalg")]
pub mod regularity;
#[cfg(not(target_os = "none"))]
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
#[cfg(not(target_os = "none"))]
pub use error::Error;
#[cfg(not(target_os = "none"))]
pub use interval::{DecoratedInterval, Decoration, Interval};
#[cfg(feature = "linalg")]
pub use matrix::IntervalMatrix;
#[cfg(feature = "linalg")]
pub use status::Status;
