//! Interval matrices.

use crate::arrays::{intervals, matrix, refusal, vector};
use crate::convert;
use interval_core::inverse::{self as methods, Outcome};
use interval_core::regularity::{self as regular, Regularity};
use interval_core::{Error, IntervalMatrix, systems};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// From a matrix to what a method says of its inverse.
pub type Method = Box<dyn Fn(&IntervalMatrix) -> Result<Outcome, Error> + Send + Sync>;

/// An inverse method by name.
pub fn inverse_method(name: &str, partitions: u64) -> PyResult<Method> {
    Ok(match name {
        "published" => Box::new(move |a| methods::published(a, partitions)),
        "published-hull" => Box::new(move |a| methods::published_hull(a, partitions)),
        "krawczyk" => Box::new(methods::krawczyk),
        "cramer" => Box::new(methods::cramer),
        "kuttler" => Box::new(methods::kuttler),
        "hansen-bliek-rohn" => Box::new(methods::hansen_bliek_rohn),
        "exact" => Box::new(methods::exact),
        _ => return Err(PyValueError::new_err(format!("unknown inverse method '{name}'"))),
    })
}

/// The inverse of a square interval matrix.
#[pyfunction]
pub fn inverse<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray2<'py, f64>,
    hi: PyReadonlyArray2<'py, f64>,
    method: &str,
    partitions: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let a = matrix(&lo, &hi)?;
    let invert = inverse_method(method, partitions)?;
    let outcome = py.detach(|| invert(&a)).map_err(|e| refusal(&e))?;
    convert::outcome(py, &outcome, a.rows())
}

/// The solutions of a square interval system.
#[pyfunction]
pub fn solve<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray2<'py, f64>,
    hi: PyReadonlyArray2<'py, f64>,
    right: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    method: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let a = matrix(&lo, &hi)?;
    let b = intervals(vector(&right.0)?, vector(&right.1)?).map_err(|e| refusal(&e))?;
    let solver = match method {
        "krawczyk" => systems::krawczyk,
        "cramer" => systems::cramer,
        "hansen-bliek-rohn" => systems::hansen_bliek_rohn,
        _ => return Err(PyValueError::new_err(format!("unknown method '{method}'"))),
    };
    let outcome = py.detach(|| solver(&a, &b)).map_err(|e| refusal(&e))?;
    convert::outcome(py, &outcome, a.rows())
}

/// Whether every member of a square interval matrix is nonsingular: the verdict and its certificate.
#[pyfunction]
pub fn regularity<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray2<'py, f64>,
    hi: PyReadonlyArray2<'py, f64>,
) -> PyResult<(&'static str, Option<Bound<'py, PyDict>>)> {
    let a = matrix(&lo, &hi)?;
    let n = a.order().map_err(|e| refusal(&e))?;
    if !a.is_bounded() {
        return Ok(("not_proved", None));
    }
    Ok(match py.detach(|| regular::regularity(&a)) {
        Regularity::Regular(witness) => ("regular", Some(convert::witness(py, &witness, n)?)),
        Regularity::Singular(member) => ("singular", Some(convert::singular(py, &member, n)?)),
        Regularity::NotProved => ("not_proved", None),
    })
}

/// The product of two interval matrices.
#[pyfunction]
pub fn matmul<'py>(
    py: Python<'py>,
    a: (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>),
    b: (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>),
) -> PyResult<Bound<'py, PyAny>> {
    let (x, y) = (matrix(&a.0, &a.1)?, matrix(&b.0, &b.1)?);
    let product = py.detach(|| x.multiply(&y)).map_err(|e| refusal(&e))?;
    convert::interval_matrix(py, &product)
}

/// `A'A` with squares on the diagonal.
#[pyfunction]
pub fn gram<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray2<'py, f64>,
    hi: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let a = matrix(&lo, &hi)?;
    let product = py.detach(|| a.gram());
    convert::interval_matrix(py, &product)
}

/// The maximum row sum of magnitudes.
#[pyfunction]
pub fn norm(py: Python<'_>, lo: PyReadonlyArray2<'_, f64>, hi: PyReadonlyArray2<'_, f64>) -> PyResult<f64> {
    let a = matrix(&lo, &hi)?;
    Ok(py.detach(|| a.norm()))
}
