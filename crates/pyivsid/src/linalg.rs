//! Interval matrices.

use crate::arrays::{intervals, matrix, refusal, vector};
use crate::convert;
use interval_core::inverse::{self as methods, Form, Monitor, Outcome, Sweep};
use interval_core::regularity::{self as regular, Regularity};
use interval_core::rounding::slices::Backend;
use interval_core::{Error, Interval, IntervalMatrix, systems};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// From a matrix to what a method says of its inverse.
pub type Method = Box<dyn Fn(&IntervalMatrix) -> Result<Outcome, Error> + Send + Sync>;

/// Members that a sweep inverts without looking at signals in between: some milliseconds.
const SHORT: u64 = 20_000_000;

/// An inverse method by name. `partitions` is the number of sub-matrices of the published sweeps and of cells of the rigorous
/// partition.
pub fn inverse_method(name: &str, partitions: u64, sweep: &str) -> PyResult<Method> {
    let sweep = match sweep {
        "members" => Sweep::Members,
        "extrema" => Sweep::Extrema,
        _ => return Err(PyValueError::new_err(format!("unknown sweep '{sweep}'"))),
    };
    let published = move |form: Form| -> Method {
        Box::new(move |a| methods::published_with(a, partitions, (form, sweep), Backend::chosen(), &Monitor::default()))
    };
    Ok(match name {
        "published" => published(Form::Literal),
        "published-hull" => published(Form::Hull),
        "krawczyk" => Box::new(methods::krawczyk),
        "cramer" => Box::new(methods::cramer),
        "kuttler" => Box::new(methods::kuttler),
        "neumaier" => Box::new(methods::neumaier),
        "hansen-bliek-rohn" => Box::new(methods::hansen_bliek_rohn),
        "exact" => Box::new(methods::exact),
        "partitioned" => {
            let cells = usize::try_from(partitions).unwrap_or(usize::MAX);
            Box::new(move |a| methods::partitioned(a, cells))
        }
        _ => return Err(PyValueError::new_err(format!("unknown inverse method '{name}'"))),
    })
}

/// The inverse of a square interval matrix. Long sweeps report to `progress(done, partitions)` and end when a signal comes.
#[pyfunction]
#[pyo3(signature = (lo, hi, method, partitions, sweep, progress=None))]
pub fn inverse<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray2<'py, f64>,
    hi: PyReadonlyArray2<'py, f64>,
    method: &str,
    partitions: u64,
    sweep: &str,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let a = matrix(&lo, &hi)?;
    let invert = inverse_method(method, partitions, sweep)?;
    let form = match method {
        "published" => Some(Form::Literal),
        "published-hull" => Some(Form::Hull),
        _ => None,
    };
    let cube = (a.rows() as u64).saturating_pow(3);
    let outcome = match form {
        Some(form) if sweep == "members" && partitions.saturating_mul(cube) > SHORT => {
            watched(py, &a, partitions, form, progress.as_ref())?
        }
        _ => py.detach(|| invert(&a)).map_err(|e| refusal(&e))?,
    };
    convert::outcome(py, &outcome, a.rows())
}

/// How often signals are looked for and progress is told.
const GLANCE: Duration = Duration::from_millis(50);

/// A sweep on a thread of its own; this one looks for signals.
fn watched(
    py: Python<'_>,
    a: &IntervalMatrix,
    partitions: u64,
    form: Form,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Outcome> {
    let monitor = Monitor::default();
    let answer = (Mutex::new(None), Condvar::new());
    std::thread::scope(|scope| {
        let (shared, (slot, ready)) = (&monitor, &answer);
        scope.spawn(move || {
            let outcome = methods::published_with(a, partitions, (form, Sweep::Members), Backend::chosen(), shared);
            *locked(slot) = Some(outcome);
            ready.notify_one();
        });
        loop {
            let found = py.detach(|| {
                let waited = ready.wait_timeout_while(locked(slot), GLANCE, |found| found.is_none());
                waited.unwrap_or_else(PoisonError::into_inner).0.take()
            });
            if let Some(outcome) = found {
                return outcome.map_err(|e| refusal(&e));
            }
            let asked = py.check_signals().and_then(|()| match progress {
                Some(callback) => callback.call1((shared.done(), partitions)).map(|_| ()),
                None => Ok(()),
            });
            if let Err(interruption) = asked {
                shared.stop();
                return Err(interruption);
            }
        }
    })
}

/// The content; a thread that panicked while it held the lock leaves it as it was.
fn locked<T>(slot: &Mutex<T>) -> MutexGuard<'_, T> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The inverses of a batch of shape (k, n, n): a status name for each, and the bounds, NaN without a value.
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
    let shape = [lo.shape()[0], n, n];
    let invert = inverse_method(method, partitions, sweep)?;
    let batch = py
        .detach(|| match method {
            "exact" => methods::exact_batch(shape[1], l, h),
            _ => methods::batch(shape[1], l, h, invert),
        })
        .map_err(|e| refusal(&e))?;
    let status = PyArray1::from_iter(py, batch.status.iter().map(|s| convert::status_code(*s)));
    let lower = PyArray1::from_vec(py, batch.lower).reshape(shape)?;
    let upper = PyArray1::from_vec(py, batch.upper).reshape(shape)?;
    Ok((status, (lower, upper).into_pyobject(py)?.into_any()))
}

type Solver = fn(&IntervalMatrix, &[Interval]) -> Result<Outcome, Error>;

/// A method for systems by name.
fn solve_method(method: &str) -> PyResult<Solver> {
    Ok(match method {
        "krawczyk" => systems::krawczyk,
        "cramer" => systems::cramer,
        "hansen-bliek-rohn" => systems::hansen_bliek_rohn,
        "gauss-seidel" => systems::gauss_seidel,
        "exact" => systems::exact,
        _ => return Err(PyValueError::new_err(format!("unknown method '{method}'"))),
    })
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
    let solver = solve_method(method)?;
    let batch = py.detach(|| systems::batch(n, (l, h), &b, solver)).map_err(|e| refusal(&e))?;
    let status = PyArray1::from_iter(py, batch.status.iter().map(|s| convert::status_code(*s)));
    let shape = (batch.status.len(), n);
    Ok((status, convert::bounds(py, &batch.lower, &batch.upper, shape)?))
}

/// The verdicts on a batch of matrices: 0 regular, 1 singular, 2 not proved.
#[pyfunction]
pub fn regularity_batch<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray3<'py, f64>,
    hi: PyReadonlyArray3<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<u8>>> {
    let (l, h, n) = stack(&lo, &hi)?;
    let verdicts = py.detach(|| regular::regularity_batch(n, l, h)).map_err(|e| refusal(&e))?;
    let code = |verdict: &Regularity| match verdict {
        Regularity::Regular(_) => 0_u8,
        Regularity::Singular(_) => 1,
        Regularity::NotProved => 2,
    };
    Ok(PyArray1::from_iter(py, verdicts.iter().map(code)))
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
    let solver = solve_method(method)?;
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
    let n = a.rows();
    Ok(match py.detach(|| regular::regularity(&a)).map_err(|e| refusal(&e))? {
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
