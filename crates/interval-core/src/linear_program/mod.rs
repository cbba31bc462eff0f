//! Linear programs `min c x` over half-spaces `g x <= h` in few unknowns: a plain-float search for a basis on a working
//! set, and bounds that a proof closes around it, in directed rounding or, where that cannot decide, over the
//! rationals.

mod enclosed;
mod exact_simplex;
mod pricing;
pub(crate) mod program;
mod rational;
mod simplex;

pub(crate) use enclosed::{enclosed_bound, enclosed_farkas, enclosed_multipliers};
pub(crate) use exact_simplex::{Proved, minimum};
pub(crate) use pricing::{VIOLATION, violation};
pub(crate) use program::Program;
pub(crate) use rational::{basis_multipliers, exact_bound, farkas};
pub(crate) use simplex::{Outcome, Search};

/// A polyhedron as a list of half-spaces `g x <= h` with finite coefficients.
pub(crate) trait HalfSpaces: Sync {
    /// Number of unknowns.
    fn dimension(&self) -> usize;

    /// Number of half-spaces.
    fn count(&self) -> usize;

    /// Writes the coefficients of half-space `index` and returns its right-hand side; +inf where it says nothing.
    fn half_space(&self, index: usize, g: &mut [f64]) -> f64;
}

/// A few of the half-spaces of a problem.
pub(crate) struct Subset<'a, P> {
    pub(crate) problem: &'a P,
    pub(crate) indices: &'a [usize],
}

impl<P: HalfSpaces> HalfSpaces for Subset<'_, P> {
    fn dimension(&self) -> usize {
        self.problem.dimension()
    }

    fn count(&self) -> usize {
        self.indices.len()
    }

    fn half_space(&self, index: usize, g: &mut [f64]) -> f64 {
        self.problem.half_space(self.indices[index], g)
    }
}

/// A member of a basis: `n` half-spaces that are tight at a vertex.
///
/// Every search starts in a box at infinity, whose bounds carry a symbolic large number `M`: a vertex is `x0 + M x1`,
/// and "unbounded" is an exact statement about the basis, not a comparison with a big number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Row {
    /// Half-space of the problem.
    Given(usize),
    /// `x_j <= M` or, with `negative`, `-x_j <= M`.
    AtInfinity { column: usize, negative: bool },
}

impl Row {
    /// The corner at infinity where the objective is least.
    fn corner(objective: &[f64]) -> Vec<Self> {
        objective.iter().enumerate().map(|(column, &c)| Self::AtInfinity { column, negative: c > 0.0 }).collect()
    }

    /// Writes the coefficients and returns the finite part of the right-hand side.
    fn half_space(self, problem: &impl HalfSpaces, g: &mut [f64]) -> f64 {
        match self {
            Self::Given(index) => problem.half_space(index, g),
            Self::AtInfinity { column, negative } => {
                g.fill(0.0);
                g[column] = if negative { -1.0 } else { 1.0 };
                0.0
            }
        }
    }

    fn is_at_infinity(self) -> bool {
        matches!(self, Self::AtInfinity { .. })
    }

    /// The order of Bland's rule.
    fn order(self) -> usize {
        match self {
            Self::AtInfinity { .. } => 0,
            Self::Given(index) => index + 1,
        }
    }
}

/// Steps after which a search in `n` unknowns turns to Bland's rule.
fn patience(n: usize) -> usize {
    50 * n + 200
}
