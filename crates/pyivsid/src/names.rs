//! The names of methods and of statuses, in the core's order, as constants of the module.

use interval_core::inverse::{DEFAULT_CELLS, DEFAULT_PARTITIONS, Method, Sweep};
use interval_core::regression::{FeasibleStatus, LeastSquaresMethod, LeastSquaresStatus};
use interval_core::regularity::Verdict;
use interval_core::{Status, systems};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let add = |key: &str, names: Vec<&str>| module.add(key, PyTuple::new(module.py(), names)?);
    add("INVERSE_METHODS", names(Method::ALL, Method::name))?;
    add("SOLVE_METHODS", names(systems::Method::ALL, systems::Method::name))?;
    add("LEAST_SQUARES_METHODS", names(LeastSquaresMethod::ALL, LeastSquaresMethod::name))?;
    add("SWEEPS", names(Sweep::ALL, Sweep::name))?;
    add("STATUSES", names(Status::ALL, Status::name))?;
    add("VERDICTS", names(Verdict::ALL, Verdict::name))?;
    add("FEASIBLE_STATUSES", names(FeasibleStatus::ALL, FeasibleStatus::name))?;
    add("LEAST_SQUARES_STATUSES", names(LeastSquaresStatus::ALL, LeastSquaresStatus::name))?;
    module.add("DEFAULT_PARTITIONS", DEFAULT_PARTITIONS)?;
    module.add("DEFAULT_CELLS", DEFAULT_CELLS)
}

fn names<T: Copy>(all: &[T], name: fn(T) -> &'static str) -> Vec<&'static str> {
    all.iter().copied().map(name).collect()
}
