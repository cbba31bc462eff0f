//! Inverses of interval matrices: matrix in, [`Outcome`] out, one file per method.

mod cramer;
mod exact_hull;
mod hansen_bliek_rohn;
mod krawczyk;
mod kuttler;
mod published;

pub use cramer::cramer;
pub(crate) use cramer::{determinant, expand_all};
pub use exact_hull::exact;
pub(crate) use hansen_bliek_rohn::enclose_solution as enclose_preconditioned;
pub use hansen_bliek_rohn::hansen_bliek_rohn;
pub(crate) use krawczyk::enclose_solution;
pub use krawczyk::krawczyk;
pub use kuttler::kuttler;
pub use published::{published, published_hull};

use crate::matrix::IntervalMatrix;
use crate::regularity::{SingularMember, Witness};
use crate::status::Status;

/// Two arrays of bounds, row-major, that may be reversed: what the published method gives. No claim is attached.
#[derive(Debug, Clone, PartialEq)]
pub struct Endpoints {
    /// What the method calls the lower bounds.
    pub lower: Vec<f64>,
    /// What the method calls the upper bounds.
    pub upper: Vec<f64>,
}

impl Endpoints {
    /// Which entries have their lower bound above their upper bound.
    #[must_use]
    pub fn improper(&self) -> Vec<bool> {
        self.lower.iter().zip(&self.upper).map(|(l, u)| l > u).collect()
    }
}

/// Why a value holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Certificate {
    /// The matrix is regular by this witness.
    Regular(Witness),
    /// The interval determinant does not contain 0.
    Determinant {
        /// Lower bound of the determinant.
        lo: f64,
        /// Upper bound of the determinant.
        hi: f64,
    },
    /// The matrix is singular.
    Singular(SingularMember),
}

/// What a method answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// What was proved.
    pub status: Status,
    /// The bounds; only with [`Status::Enclosed`] do they enclose.
    pub value: Option<Endpoints>,
    /// Why the status holds.
    pub certificate: Option<Certificate>,
    /// Why nothing was proved, in one sentence.
    pub reason: Option<String>,
}

impl Outcome {
    pub(crate) fn enclosed(value: &IntervalMatrix, certificate: Certificate) -> Self {
        let value = Endpoints { lower: value.lo().to_vec(), upper: value.hi().to_vec() };
        Self { status: Status::Enclosed, value: Some(value), certificate: Some(certificate), reason: None }
    }

    pub(crate) fn without_value(status: Status, certificate: Option<Certificate>, reason: String) -> Self {
        Self { status, value: None, certificate, reason: Some(reason) }
    }

    pub(crate) fn not_applicable(reason: impl Into<String>) -> Self {
        Self::without_value(Status::NotApplicable, None, reason.into())
    }
}

/// Why a matrix with an infinite bound is refused by every method.
pub(crate) const UNBOUNDED: &str = "the matrix has an infinite bound; every entry needs two finite bounds";
