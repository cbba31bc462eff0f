//! Parameters of interval rows.

use crate::arrays::{intervals, matrix, refusal, row_major, vector};
use crate::convert;
use crate::linalg::named;
use interval_core::inverse::{Method, Options, Sweep};
use interval_core::regression::{self, FeasibleOptions, LeastSquaresMethod, Rows, feasible_rows};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Interval least squares by normal equations (eq. 14) with the named inverse.
#[pyfunction]
pub fn normal_equations<'py>(
    py: Python<'py>,
    rows: (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>),
    right: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    method: &str,
    partitions: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let a = matrix(&rows.0, &rows.1)?;
    let y = intervals(vector(&right.0)?, vector(&right.1)?).map_err(|e| refusal(&e))?;
    let (method, options) = (named::<Method>(method)?, Options::with_count(partitions, Sweep::Members));
    let result = py
        .detach(|| regression::normal_equations(&a, &y, |gram| method.inverse(gram, &options)))
        .map_err(|e| refusal(&e))?;
    convert::normal_equations(py, &result)
}

/// An enclosure of all least-squares solutions: by `qr` or `augmented`. The arrays are used where they lie.
#[pyfunction]
pub fn least_squares<'py>(
    py: Python<'py>,
    rows: (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>),
    right: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    method: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let (lower, upper, columns) = row_major(&rows.0, &rows.1)?;
    let (low, high) = (vector(&right.0)?, vector(&right.1)?);
    let method: LeastSquaresMethod = named(method)?;
    let fit = py
        .detach(|| Rows::new(columns, lower, upper, low, high).and_then(|rows| method.solve(&rows)))
        .map_err(|e| refusal(&e))?;
    convert::least_squares(py, &fit)
}

/// The proved hull of all parameters that are consistent with every row. The arrays are used where they lie.
#[pyfunction]
pub fn feasible_set<'py>(
    py: Python<'py>,
    rows: (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>),
    right: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    signs: Option<Vec<i8>>,
    outliers: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let (lower, upper, columns) = row_major(&rows.0, &rows.1)?;
    let (low, high) = (vector(&right.0)?, vector(&right.1)?);
    let options = FeasibleOptions { signs, outliers, ..FeasibleOptions::default() };
    let set = py
        .detach(|| Rows::new(columns, lower, upper, low, high).and_then(|rows| feasible_rows(&rows, &options)))
        .map_err(|e| refusal(&e))?;
    convert::feasible_set(py, &set)
}
