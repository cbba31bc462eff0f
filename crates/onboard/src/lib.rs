//! Recursive set-membership identification on board: rows `sum [a_j] x_j` in `[y]` come one by one, and the proved
//! bounds of every parameter narrow.
//!
//! # Promises
//! - At every moment [`Follower::bounds`] holds every parameter within the start that all rows so far allow. Each bound is
//!   proved in directed rounding before it is shown.
//! - [`State::Empty`] is proved: multipliers of kept rows contradict one another, or two proved ends have passed.
//! - Nothing is allocated, memory is that of the value, and a row takes a bounded number of steps.
//! - The crate is `no_std`, and so is all that it needs without the feature `std` (on), by which directed products ask for the
//!   fused operation of the standard library.
//!
//! # Example
//! ```
//! use onboard::{Bounds, Follower, State};
//! // Mass and drag of a hull in surge: m u' + d u|u| = X. Nine parameters would take 304 rows in 64 kB.
//! let mut follower = Follower::<2, 40>::new([Bounds::new(0.0, 1e4), Bounds::new(0.0, 1e4)])?;
//! for k in 0..500 {
//!     let (rate, speed) = (0.3 * f64::sin(0.1 * f64::from(k)), f64::cos(0.07 * f64::from(k)));
//!     let force = 100.0 * rate + 40.0 * speed * speed.abs();
//!     let state = follower.sample(0.1 * f64::from(k), &[rate, speed * speed.abs()], &[0.01, 0.02], force, 1.0)?;
//!     assert_eq!(state, State::Bounded);
//! }
//! let [mass, drag] = *follower.bounds();
//! assert!(mass.contains(100.0) && mass.width() < 20.0);
//! assert!(drag.contains(40.0) && drag.width() < 8.0);
//! # Ok::<(), onboard::Refusal>(())
//! ```

#![no_std]

mod bounds;
mod change;
mod follower;
mod half_space;
mod narrowing;
mod proof;
mod store;
mod vertex;

pub use bounds::{Bounds, Refusal};
pub use change::{Change, Windows};
pub use follower::{Contradiction, Follower, START_LIMIT, State};
