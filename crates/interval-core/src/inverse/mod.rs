//! Inverses of interval matrices: matrix in, [`Outcome`] out, one file per method.

mod batch;
mod cells;
mod cramer;
mod exact;
mod hansen_bliek_rohn;
mod krawczyk;
mod kuttler;
mod method;
mod neumaier;
mod partitioned;
mod published;
mod rows;

pub use batch::{Batch, batch, exact_batch};
pub use cells::{Answers, cell_answers, partitioned_shared};
pub use cramer::cramer;
pub(crate) use cramer::{determinant, expand_all};
pub use exact::{ACCORD_LIMIT, SIGN_LIMIT, exact, exact_by_vertices};
pub(crate) use hansen_bliek_rohn::enclose as enclose_preconditioned;
pub use hansen_bliek_rohn::hansen_bliek_rohn;
pub(crate) use krawczyk::enclose_solution;
pub use krawczyk::krawczyk;
pub use kuttler::kuttler;
pub use method::{Method, Options};
pub use neumaier::neumaier;
pub use partitioned::{DEFAULT_CELLS, partitioned};
pub use published::{
    DEFAULT_PARTITIONS, Form, Monitor, ORDER_LIMIT, Part, Sweep, Watch, published, published_hull, published_of_parts,
    published_part, published_with,
};

use crate::certified::{Certified, Claim, Unproved};
use crate::matrix::IntervalMatrix;
use crate::regularity::{SingularMember, Witness};
use crate::status::Status;

/// Two arrays of bounds, row-major, that may be reversed, by the published method.
#[derive(Debug, Clone, PartialEq)]
pub struct Endpoints {
    /// The lower bounds by the method's formula, row-major.
    pub lower: Vec<f64>,
    /// The upper bounds by the method's formula, row-major.
    pub upper: Vec<f64>,
}

impl Endpoints {
    /// True for each entry whose lower bound lies above its upper bound, row-major.
    #[must_use]
    pub fn improper(&self) -> Vec<bool> {
        self.lower.iter().zip(&self.upper).map(|(l, u)| l > u).collect()
    }

    /// True for each entry that holds the entry of an exact hull, row-major; false for one that is no enclosure.
    #[must_use]
    pub fn holds(&self, hull: &IntervalMatrix) -> Vec<bool> {
        let ends = self.lower.iter().zip(&self.upper);
        ends.zip(hull.entries()).map(|((l, u), x)| *l <= x.lo() && x.hi() <= *u).collect()
    }
}

/// The bounds that a method gives: every member's inverse (or solution) lies in certified ones, and unproved ones claim
/// nothing.
pub type Value = Claim<IntervalMatrix, Endpoints>;

/// The proof of a value.
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

/// The result of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The proved property.
    pub status: Status,
    /// The bounds.
    pub value: Option<Value>,
    /// The proof of the status.
    pub certificate: Option<Certificate>,
    /// A bound of the distance of any bound from the hull, if the method states one.
    pub gap: Option<f64>,
    /// The missing proof and its reason, in one sentence.
    pub reason: Option<String>,
}

impl Outcome {
    pub(crate) fn enclosed(value: IntervalMatrix, certificate: Certificate) -> Self {
        let value = Some(Value::Certified(Certified::proved(value)));
        Self { status: Status::Enclosed, value, certificate: Some(certificate), gap: None, reason: None }
    }

    pub(crate) fn singular(member: SingularMember) -> Self {
        let reason = "the interval matrix contains a singular matrix, so its inverse has no bound".into();
        Self::without_value(Status::Singular, Some(Certificate::Singular(member)), reason)
    }

    pub(crate) fn without_value(status: Status, certificate: Option<Certificate>, reason: String) -> Self {
        Self { status, value: None, certificate, gap: None, reason: Some(reason) }
    }

    pub(crate) fn not_applicable(reason: impl Into<String>) -> Self {
        Self::without_value(Status::NotApplicable, None, reason.into())
    }

    /// The proved enclosure.
    #[must_use]
    pub fn enclosure(&self) -> Option<&Certified<IntervalMatrix>> {
        self.value.as_ref().and_then(Value::certified)
    }

    /// Lower and upper bounds, row-major, proved or not.
    #[must_use]
    pub fn bounds(&self) -> Option<(&[f64], &[f64])> {
        match &self.value {
            Some(Value::Certified(value)) => Some((value.lo(), value.hi())),
            Some(Value::Unproved(Unproved(ends))) => Some((&ends.lower, &ends.upper)),
            None => None,
        }
    }
}

/// The reason for which every method refuses a matrix with an infinite bound.
pub(crate) const UNBOUNDED: &str = "the matrix has an infinite bound; every entry needs two finite bounds";
