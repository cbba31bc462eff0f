//! Linear programs `min c x` over many half-spaces `g x <= h` in few unknowns: a plain-float search for a basis, and safe
//! bounds that a proof closes around it.

mod safe_bound;
mod simplex;

pub(crate) use safe_bound::{Bound, exact_bound, farkas, proved_box, safe_bound};
pub(crate) use simplex::{Answer, Row, Simplex};

/// A polyhedron as a list of half-spaces `g x <= h` with finite coefficients.
pub(crate) trait HalfSpaces: Sync {
    /// Number of unknowns.
    fn dimension(&self) -> usize;

    /// Number of half-spaces.
    fn count(&self) -> usize;

    /// Writes the coefficients of half-space `index` and returns its right-hand side; +inf where it says nothing.
    fn half_space(&self, index: usize, g: &mut [f64]) -> f64;
}
