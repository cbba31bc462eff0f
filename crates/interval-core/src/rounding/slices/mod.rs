//! Interval operations on slices: one door, several back ends, the same bits from each.
//!
//! Results are the tightest intervals, which are unique, and a zero is always +0: so whichever back end the processor
//! allows, and however a slice is cut, the bits are those of the operators of [`Interval`](crate::Interval).
//!
//! - *portable*: error-free transformations in the vector registers that every processor of the architecture has: SSE2
//!   with products by Dekker's splitting. Elsewhere it uses small arrays that the compiler maps to them (NEON has a
//!   fused product).
//! - *AVX2 + FMA*: the same transformations with intrinsics.
//! - *AVX-512*: the instructions round downward and upward themselves. Compilers before Rust 1.89 have no stable
//!   intrinsics for it (`build.rs` asks); AVX2 takes its place there.
//!
//! Blocks with operands on which a transformation is not exact (infinities, empty intervals, results near the ends of
//! the range) are redone one interval at a time.

#![expect(clippy::inline_always, reason = "kernels are compiled inside functions with wider instruction sets")]

#[cfg(avx2)]
mod avx2;
#[cfg(avx512)]
#[clippy::msrv = "1.89"]
mod avx512;
#[cfg(avx512)]
#[clippy::msrv = "1.89"]
mod avx512_lanes;
mod door;
#[cfg(avx2)]
mod elementary;
mod kernel;
mod operations;
mod portable;
#[cfg(feature = "linalg")]
mod product;
#[cfg(target_arch = "x86_64")]
mod sse2;

pub use door::{Backend, binary, binary_with, unary, unary_with};
#[doc(hidden)]
pub use door::{binary_on_arrays, unary_on_arrays};
pub use operations::{Binary, Bounds, BoundsMut, Unary};
#[cfg(feature = "linalg")]
pub(crate) use product::Packed;
