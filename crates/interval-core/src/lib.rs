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
//! - `std` (on): back ends that ask the processor for its vectors, threads, everything below.
//! - `alloc` (on, with `std`): decorations, text, elementary functions, slices, exact sums. Without any other feature the crate
//!   needs no other crate.
//! - `exact` (on): rationals, by `num-bigint` and `num-rational`.
//! - `linalg` (on, with `exact`): interval matrices, inverses, systems, linear programmes, regression; `nalgebra` and `faer`
//!   propose the points whose proofs follow.
//! - `parallel` (on): threads, by `rayon`. The bits are the same without.
//! - `num-traits` (on, with `exact`): neutral elements, inverse, power and fused product for generic code.
//! - `serde`: intervals as their bounds.
//!
//! # Without the standard library
//! Without `std` the crate is `no_std`, with the same bits: square roots, fused products and integers next to a number are
//! then computed in integers. `alloc` gives all of the scalar part; elementary functions need it for the integers of their
//! last resort. Without `alloc` there are [`rounding`] and the functions of [`Interval`] that need no last resort:
//! arithmetic, square root, fused product, integer and set functions, relations and measures.
//!
//! # Limits
//! - `inverse::published` and `inverse::published_hull` follow a paper literally. They are *not* enclosures, and say
//!   so.
//! - The floating-point environment has to be the default one (round to nearest, subnormals kept);
//!   [`rounding::environment_is_default`] checks it.

#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "alloc")]
extern crate alloc;

#[cfg(feature = "linalg")]
mod absolute_value;
mod accumulator;
#[cfg(feature = "linalg")]
mod approximate;
#[cfg(feature = "linalg")]
pub mod certified;
#[cfg(feature = "alloc")]
mod decimals;
mod doubles;
mod dyadic;
#[cfg(feature = "alloc")]
mod elementary;
pub mod error;
#[cfg(feature = "exact")]
pub mod exact;
#[cfg(feature = "alloc")]
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
#[cfg(feature = "alloc")]
mod parallel;
#[cfg(feature = "std")]
pub mod reach;
#[cfg(feature = "alloc")]
pub mod reductions;
#[cfg(feature = "linalg")]
pub mod regression;
#[cfg(feature = "linalg")]
pub mod regularity;
#[cfg(feature = "std")]
pub mod relaxation;
pub mod rounding;
#[cfg(feature = "linalg")]
mod scaling;
#[doc(hidden)]
pub mod software;
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
#[cfg(feature = "alloc")]
#[doc(hidden)]
pub use elementary::source as tables_source;
pub use error::Error;
pub use interval::Interval;
#[cfg(feature = "alloc")]
pub use interval::{DecoratedInterval, Decoration};
#[cfg(feature = "linalg")]
pub use matrix::IntervalMatrix;
#[cfg(feature = "linalg")]
pub use status::Status;
