//! The methods for square systems by name: the one place that knows all of them.

use super::{batch, cramer, exact, gauss_seidel, hansen_bliek_rohn, krawczyk};
use crate::error::Error;
use crate::interval::Interval;
use crate::inverse::{Batch, Outcome};
use crate::matrix::IntervalMatrix;
use crate::names::named;

named! {
    /// A method for a square interval system.
    Method, "method" {
        /// [`hansen_bliek_rohn`](super::hansen_bliek_rohn()): the hull of the preconditioned system in closed form.
        HansenBliekRohn => "hansen-bliek-rohn",
        /// [`exact`](super::exact()): the hull of the solution set.
        Exact => "exact",
        /// [`krawczyk`](super::krawczyk()): paper eq. 8-10, corrected.
        Krawczyk => "krawczyk",
        /// [`gauss_seidel`](super::gauss_seidel()): the interval Gauss-Seidel iteration.
        GaussSeidel => "gauss-seidel",
        /// [`cramer`](super::cramer()): Nirmala and Ganesan.
        Cramer => "cramer",
    }
}

impl Method {
    /// Every solution of `A x = b` for members `A`, `b`.
    ///
    /// # Errors
    /// Shapes that do not fit.
    pub fn solve(self, a: &IntervalMatrix, b: &[Interval]) -> Result<Outcome, Error> {
        match self {
            Self::HansenBliekRohn => hansen_bliek_rohn(a, b),
            Self::Exact => exact(a, b),
            Self::Krawczyk => krawczyk(a, b),
            Self::GaussSeidel => gauss_seidel(a, b),
            Self::Cramer => cramer(a, b),
        }
    }

    /// The solutions of systems of order `n` whose matrices (row-major) and right-hand sides follow each other, on all
    /// threads.
    ///
    /// # Errors
    /// Lengths that are not whole systems, and bad bounds.
    pub fn solve_batch(self, n: usize, bounds: (&[f64], &[f64]), b: &[Interval]) -> Result<Batch, Error> {
        batch(n, bounds, b, |a, b| self.solve(a, b))
    }
}
