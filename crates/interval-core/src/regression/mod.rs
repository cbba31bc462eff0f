//! Parameters of interval rows `A theta = y`.

mod augmented;
mod directions;
mod feasible;
mod inflation;
mod least_squares;
mod normal_equations;
mod orthant;
mod outliers;
mod prove;
mod rows;
mod scan;
mod search;
mod signs;

pub use crate::status::{FeasibleStatus, LeastSquaresStatus};
pub use augmented::{ORDER_LIMIT, augmented};
pub use feasible::{
    BoundCertificate, FeasibleOptions, FeasibleSet, OrthantOutcome, OrthantResult, feasible_rows, feasible_set,
};
pub use least_squares::{LeastSquares, LeastSquaresMethod, least_squares};
pub use normal_equations::{NormalEquations, normal_equations};
pub use orthant::DataRow;
pub use outliers::{NODE_LIMIT, Outliers};
pub use rows::Rows;
pub use signs::{ORTHANT_LIMIT, SignProof, SignRows};

use crate::error::Error;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;

fn check_rows(a: &IntervalMatrix, y: &[Interval]) -> Result<(), Error> {
    if y.len() != a.rows() {
        return Err(Error::Shape { what: "the right-hand side", given: y.len(), needed: a.rows() });
    }
    if a.columns() == 0 {
        return Err(Error::Zero { what: "the number of columns" });
    }
    if a.rows() == 0 {
        return Err(Error::Zero { what: "the number of rows" });
    }
    Ok(())
}
