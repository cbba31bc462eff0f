//! Interval arithmetic, interval matrices and bounded-error regression with outward rounding.
//!
//! # Promises
//! - Every operation on [`Interval`] returns a set that contains the exact result for every choice of members of its
//!   operands. It is the *tightest* such interval of doubles, for
//!   elementary functions too.
//! - Every function that returns the status [`Status::Enclosed`](status::Status) has *proved* its bounds in directed
//!   rounding or exact integer arithmetic; an approximation in plain floats is only ever the starting point of a proof.
//! - A proof that fails is a value ([`Status::NotProved`](status::Status)), never a warning.
//! - Results do not depend on the number of threads.
//!
//! # Limits
//! - `inverse::published` and `inverse::published_hull` follow a paper literally. They are *not* enclosures, and say
//!   so.
//! - The floating-point environment has to be the default one (round to nearest, subnormals kept);
//!   [`rounding::environment_is_default`] checks it.

mod absolute_value;
mod accumulator;
mod approximate;
pub mod certified;
mod elementary;
pub mod error;
pub mod exact;
pub mod interval;
pub mod inverse;
mod lanes;
pub mod linear_program;
pub mod matrix;
mod names;
mod parallel;
pub mod reductions;
pub mod regression;
pub mod regularity;
pub mod relaxation;
pub mod rounding;
mod scaling;
pub mod status;
pub mod systems;
mod verify;
mod witness;

pub use certified::{Certified, Claim, Unproved};
pub use error::Error;
pub use interval::{DecoratedInterval, Decoration, Interval};
pub use matrix::IntervalMatrix;
pub use status::Status;
