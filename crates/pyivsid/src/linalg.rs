//! Interval matrices.

use crate::arrays::{copied, intervals, matrix, refusal, vector};
use crate::convert;
use crate::found::Found;
use interval_core::inverse::{
    Answers, Batch, Form, Method, Options, Part, cell_answers as answers_of, partitioned_shared as shared,
    published_of_parts, published_part,
};
use interval_core::{regularity as verdicts, systems};
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ops::ControlFlow;
use std::str::FromStr;

/// A method, a sweep, ... by its name.
pub fn named<T: FromStr<Err = interval_core::Error>>(name: &str) -> PyResult<T> {
    name.parse().map_err(|e| refusal(&e))
}

/// The options of an inverse method.
fn options(partitions: u64, sweep: &str) -> PyResult<Options> {
    Ok(Options::with_count(partitions, named(sweep)?))
}

/// The number of partitions or cells that a method takes by default.
#[pyfunction]
pub fn default_count(method: &str) -> PyResult<u64> {
    Ok(named::<Method>(method)?.default_count())
}

/// The largest order whose rigorous inverse is found without leaving the interpreter: it takes some microseconds.
const SMALL: usize = 3;

/// The inverse of a square interval matrix. Long sweeps report to `progress(done, partitions)` and end when a signal
/// comes.
#[pyfunction]
#[pyo3(signature = (lo, hi, method, partitions, sweep, progress=None))]
pub fn inverse(
    py: Python<'_>,
    lo: &Bound<'_, PyArray2<f64>>,
    hi: &Bound<'_, PyArray2<f64>>,
    method: &str,
    partitions: u64,
    sweep: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let a = copied(lo, hi)?;
    let (method, options) = (named::<Method>(method)?, options(partitions, sweep)?);
    let counts = matches!(method, Method::Published | Method::PublishedHull | Method::Partitioned);
    if a.rows() <= SMALL && !counts {
        let outcome = method.inverse(&a, &options).map_err(|e| refusal(&e))?;
        return Ok(Found::new(outcome, a.rows()));
    }
    let mut interruption = None;
    let outcome = py.detach(|| {
        let mut watch = |done: u64| {
            let asked = Python::attach(|py| {
                py.check_signals()?;
                progress.as_ref().map_or(Ok(()), |callback| callback.call1(py, (done, partitions)).map(|_| ()))
            });
            asked.map_or_else(
                |error| {
                    interruption = Some(error);
                    ControlFlow::Break(())
                },
                ControlFlow::Continue,
            )
        };
        method.inverse_watched(&a, &options, Some(&mut watch))
    });
    match interruption {
        Some(error) => Err(error),
        None => Ok(Found::new(outcome.map_err(|e| refusal(&e))?, a.rows())),
    }
}

/// The form of a published method.
fn form(method: &str) -> PyResult<Form> {
    match named::<Method>(method)? {
        Method::Published => Ok(Form::Literal),
        Method::PublishedHull => Ok(Form::Hull),
        _ => Err(PyValueError::new_err("a published method is needed")),
    }
}

/// The extremes of the partitions from `first` up to `last` of a published method, shape (4, n, n); None at a singular
/// member, or where the method does not apply.
#[pyfunction]
pub fn inverse_part<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray2<'py, f64>,
    hi: PyReadonlyArray2<'py, f64>,
    method: &str,
    partitions: u64,
    range: (u64, u64),
) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
    let (a, form) = (matrix(&lo, &hi)?, form(method)?);
    let n = a.rows();
    let found = py.detach(|| published_part(&a, partitions, form, range.0..range.1)).map_err(|e| refusal(&e))?;
    found.map(|part| PyArray1::from_vec(py, part.0.concat()).reshape([4, n, n])).transpose()
}

/// The outcome of a published method from the parts of all partitions, None for a singular one.
#[pyfunction]
pub fn inverse_of_parts<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray2<'py, f64>,
    hi: PyReadonlyArray2<'py, f64>,
    method: &str,
    partitions: u64,
    parts: Vec<Option<PyReadonlyArray3<'py, f64>>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (a, form) = (matrix(&lo, &hi)?, form(method)?);
    let size = a.rows() * a.rows();
    let mut read = Vec::with_capacity(parts.len());
    for part in &parts {
        read.push(match part {
            None => None,
            Some(array) => {
                let numbers = array.as_slice()?;
                if numbers.len() != 4 * size {
                    return Err(PyValueError::new_err("parts of shape (4, n, n) are needed"));
                }
                Some(Part(std::array::from_fn(|k| numbers[k * size..(k + 1) * size].to_vec())))
            }
        });
    }
    let outcome = published_of_parts(&a, partitions, form, read).map_err(|e| refusal(&e))?;
    convert::outcome(py, &outcome, a.rows())
}

/// Codes of cells, and their numbers.
type Answered<'py> = (Bound<'py, PyArray1<u8>>, Bound<'py, PyArray1<f64>>);

/// Answers of cells of the rigorous partition, bounds of shape (k, n, n): codes, and numbers of shape (4 k n n,).
#[pyfunction]
pub fn cell_answers<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray3<'py, f64>,
    hi: PyReadonlyArray3<'py, f64>,
) -> PyResult<Answered<'py>> {
    let (l, h, n) = stack(&lo, &hi)?;
    let found = py.detach(|| answers_of(n, l, h)).map_err(|e| refusal(&e))?;
    Ok((PyArray1::from_vec(py, found.codes), PyArray1::from_vec(py, found.numbers)))
}

/// The rigorous partition; `ask(lower, upper)` gives the answers of cells, as `cell_answers` does.
#[pyfunction]
pub fn partitioned_shared<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray2<'py, f64>,
    hi: PyReadonlyArray2<'py, f64>,
    cells: u64,
    ask: Py<PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let a = matrix(&lo, &hi)?;
    let cells = usize::try_from(cells).unwrap_or(usize::MAX);
    let mut failure = None;
    let outcome = py.detach(|| {
        let mut answer = |n: usize, lower: Vec<f64>, upper: Vec<f64>| {
            Python::attach(|py| asked(py, &ask, n, lower, upper)).map_err(|error| failure = Some(error)).ok()
        };
        shared(&a, cells, &mut answer)
    });
    match failure {
        Some(error) => Err(error),
        None => convert::outcome(py, &outcome.map_err(|e| refusal(&e))?, a.rows()),
    }
}

/// The answers that a Python function gives for cells.
fn asked(py: Python<'_>, ask: &Py<PyAny>, n: usize, lower: Vec<f64>, upper: Vec<f64>) -> PyResult<Answers> {
    let shape = [lower.len() / (n * n), n, n];
    let lower = PyArray1::from_vec(py, lower).reshape(shape)?;
    let upper = PyArray1::from_vec(py, upper).reshape(shape)?;
    let found = ask.call1(py, (lower, upper))?;
    let (codes, numbers) = found.extract::<(PyReadonlyArray1<'_, u8>, PyReadonlyArray1<'_, f64>)>(py)?;
    Ok(Answers { codes: codes.as_slice()?.to_vec(), numbers: numbers.as_slice()?.to_vec() })
}

/// The inverses of a batch of shape (k, n, n): a status code for each, and the bounds, NaN without a value.
#[pyfunction]
pub fn inverse_batch<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray3<'py, f64>,
    hi: PyReadonlyArray3<'py, f64>,
    method: &str,
    partitions: u64,
    sweep: &str,
) -> PyResult<(Bound<'py, PyArray1<u8>>, Bound<'py, PyAny>)> {
    let (l, h, n) = stack(&lo, &hi)?;
    let (method, options) = (named::<Method>(method)?, options(partitions, sweep)?);
    let batch = py.detach(|| method.inverse_batch(n, l, h, &options)).map_err(|e| refusal(&e))?;
    let status = codes(py, &batch);
    let shape = [lo.shape()[0], n, n];
    let lower = PyArray1::from_vec(py, batch.lower).reshape(shape)?;
    let upper = PyArray1::from_vec(py, batch.upper).reshape(shape)?;
    Ok((status, (lower, upper).into_pyobject(py)?.into_any()))
}

/// The statuses of a batch as positions in the tuple of their names.
fn codes<'py>(py: Python<'py>, batch: &Batch) -> Bound<'py, PyArray1<u8>> {
    PyArray1::from_iter(py, batch.status.iter().map(|s| s.code()))
}

/// The bounds of a batch of shape (k, n, n), and `n`.
fn stack<'a>(
    lo: &'a PyReadonlyArray3<'_, f64>,
    hi: &'a PyReadonlyArray3<'_, f64>,
) -> PyResult<(&'a [f64], &'a [f64], usize)> {
    interval_core::rounding::check_environment().map_err(|e| refusal(&e))?;
    let shape = lo.shape();
    if !(lo.is_c_contiguous() && hi.is_c_contiguous()) || shape != hi.shape() || shape[1] != shape[2] {
        return Err(PyValueError::new_err("two C-contiguous arrays of shape (k, n, n) are needed"));
    }
    Ok((lo.as_slice()?, hi.as_slice()?, shape[1]))
}

/// The solutions of a batch of systems, right-hand sides one after the other: status codes, and bounds of shape (k, n).
#[pyfunction]
pub fn solve_batch<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray3<'py, f64>,
    hi: PyReadonlyArray3<'py, f64>,
    right: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    method: &str,
) -> PyResult<(Bound<'py, PyArray1<u8>>, Bound<'py, PyAny>)> {
    let (l, h, n) = stack(&lo, &hi)?;
    let b = intervals(vector(&right.0)?, vector(&right.1)?).map_err(|e| refusal(&e))?;
    let method: systems::Method = named(method)?;
    let batch = py.detach(|| method.solve_batch(n, (l, h), &b)).map_err(|e| refusal(&e))?;
    let status = codes(py, &batch);
    let shape = (batch.status.len(), n);
    Ok((status, convert::bounds(py, &batch.lower, &batch.upper, shape)?))
}

/// The verdicts on a batch of matrices as positions in the tuple of their names.
#[pyfunction]
pub fn regularity_batch<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray3<'py, f64>,
    hi: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<u8>>> {
    let (l, h, n) = stack(&lo, &hi)?;
    let found = py.detach(|| verdicts::regularity_batch(n, l, h)).map_err(|e| refusal(&e))?;
    Ok(PyArray1::from_iter(py, found.iter().map(|r| r.verdict().code())))
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
    let method: systems::Method = named(method)?;
    let outcome = py.detach(|| method.solve(&a, &b)).map_err(|e| refusal(&e))?;
    convert::outcome(py, &outcome, a.rows())
}

/// The regularity of a square interval matrix: the verdict and its certificate.
#[pyfunction]
pub fn regularity<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray2<'py, f64>,
    hi: PyReadonlyArray2<'py, f64>,
) -> PyResult<(&'static str, Option<Bound<'py, PyDict>>)> {
    let a = matrix(&lo, &hi)?;
    let found = py.detach(|| verdicts::regularity(&a)).map_err(|e| refusal(&e))?;
    Ok((found.verdict().name(), convert::regularity(py, &found, a.rows())?))
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
