//! Entrywise operations on arrays of bounds, and text.

use crate::arrays::{intervals, refusal, results, vector};
use crate::convert::interval_vector;
use interval_core::interval::Measure;
use interval_core::rounding::slices::{self, Binary, Bounds, BoundsMut, Unary};
use interval_core::{Error, Interval, reductions, relaxation, rounding};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// True if the floating-point environment is the one that the bounds rely on.
#[pyfunction]
pub fn environment_is_default() -> bool {
    rounding::environment_is_default()
}

/// Refuses NaN, reversed bounds, and intervals without a finite point.
#[pyfunction]
pub fn check_bounds(py: Python<'_>, lo: PyReadonlyArray1<'_, f64>, hi: PyReadonlyArray1<'_, f64>) -> PyResult<()> {
    let (lo, hi) = (vector(&lo)?, vector(&hi)?);
    py.detach(|| intervals_at(lo, hi)).map_err(|e| refusal(&e))
}

/// Only checks; unlike `intervals`, an empty entry is refused.
fn intervals_at(lo: &[f64], hi: &[f64]) -> Result<(), Error> {
    if lo.len() != hi.len() {
        return Err(Error::Shape { what: "the upper bound", given: hi.len(), needed: lo.len() });
    }
    lo.iter().zip(hi).enumerate().try_for_each(|(index, (&l, &h))| Interval::at(l, h, index).map(|_| ()))
}

fn unknown(op: &str) -> PyErr {
    PyValueError::new_err(format!("unknown operation '{op}'"))
}

/// An operation of one operand by its name in the core: a row of lower and one of upper bounds. Empty results have
/// reversed infinite bounds.
#[pyfunction]
pub fn unary<'py>(
    py: Python<'py>,
    op: &str,
    lo: PyReadonlyArray1<'py, f64>,
    hi: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let op = Unary::from_name(op).ok_or_else(|| unknown(op))?;
    let x = Bounds::new(vector(&lo)?, vector(&hi)?).map_err(|e| refusal(&e))?;
    let found = results(py, lo.len());
    {
        let mut both = found.readwrite();
        let (lo, hi) = both.as_slice_mut()?.split_at_mut(x.len());
        py.detach(|| slices::unary(op, x, BoundsMut { lo, hi })).map_err(|e| refusal(&e))?;
    }
    Ok(found)
}

/// An operation of two operands of the same length by its name in the core.
#[pyfunction]
pub fn binary<'py>(
    py: Python<'py>,
    op: &str,
    a: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    b: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let op = Binary::from_name(op).ok_or_else(|| unknown(op))?;
    let x = Bounds::new(vector(&a.0)?, vector(&a.1)?).map_err(|e| refusal(&e))?;
    let y = Bounds::new(vector(&b.0)?, vector(&b.1)?).map_err(|e| refusal(&e))?;
    let found = results(py, x.len());
    {
        let mut both = found.readwrite();
        let (lo, hi) = both.as_slice_mut()?.split_at_mut(x.len());
        py.detach(|| slices::binary(op, x, y, BoundsMut { lo, hi })).map_err(|e| refusal(&e))?;
    }
    Ok(found)
}

/// A function of an interval and an integer, entry by entry.
fn with_integer<'py>(
    py: Python<'py>,
    bounds: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    n: i32,
    f: fn(Interval, i32) -> Interval,
) -> PyResult<Bound<'py, PyAny>> {
    let (lo, hi) = (vector(&bounds.0)?, vector(&bounds.1)?);
    let result = py.detach(|| intervals(lo, hi).map(|x| x.into_iter().map(|v| f(v, n)).collect::<Vec<_>>()));
    interval_vector(py, &result.map_err(|e| refusal(&e))?)
}

/// `{x^n}` for an integer `n`.
#[pyfunction]
pub fn power<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray1<'py, f64>,
    hi: PyReadonlyArray1<'py, f64>,
    n: i32,
) -> PyResult<Bound<'py, PyAny>> {
    with_integer(py, (lo, hi), n, Interval::powi)
}

/// `{x^(1/n)}` for an integer `n`.
#[pyfunction]
pub fn root<'py>(
    py: Python<'py>,
    lo: PyReadonlyArray1<'py, f64>,
    hi: PyReadonlyArray1<'py, f64>,
    n: i32,
) -> PyResult<Bound<'py, PyAny>> {
    with_integer(py, (lo, hi), n, Interval::rootn)
}

/// The tightest interval around the sum of all intervals: each end rounded once.
#[pyfunction]
pub fn exact_sum(py: Python<'_>, lo: PyReadonlyArray1<'_, f64>, hi: PyReadonlyArray1<'_, f64>) -> PyResult<(f64, f64)> {
    let (lo, hi) = (vector(&lo)?, vector(&hi)?);
    let sum = py.detach(|| intervals(lo, hi).map(|x| reductions::sum_intervals(&x))).map_err(|e| refusal(&e))?;
    Ok((sum.lo(), sum.hi()))
}

/// Bounds of a quantity that follows held goals behind a first-order lag; see `interval_core::relaxation`.
#[pyfunction]
pub fn follow<'py>(
    py: Python<'py>,
    start: (f64, f64),
    goal: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    decay: PyReadonlyArray1<'py, f64>,
    slack: PyReadonlyArray1<'py, f64>,
    whole: PyReadonlyArray1<'py, bool>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (low, high, decay, slack) = (vector(&goal.0)?, vector(&goal.1)?, vector(&decay)?, vector(&slack)?);
    let whole = whole.as_slice()?;
    let found = results(py, low.len());
    {
        let mut both = found.readwrite();
        let (lo, hi) = both.as_slice_mut()?.split_at_mut(low.len());
        lo.copy_from_slice(low);
        if high.len() != low.len() {
            return Err(refusal(&Error::Shape { what: "the upper bound", given: high.len(), needed: low.len() }));
        }
        hi.copy_from_slice(high);
        py.detach(|| relaxation::follow(start, decay, slack, whole, lo, hi)).map_err(|e| refusal(&e))?;
    }
    Ok(found)
}

/// The back end in use: portable, avx2 or avx512.
#[pyfunction]
pub fn backend() -> &'static str {
    slices::Backend::chosen().name()
}

/// `op` is one of midpoint, radius, width, magnitude, mignitude.
#[pyfunction]
pub fn measure<'py>(
    py: Python<'py>,
    op: &str,
    lo: PyReadonlyArray1<'py, f64>,
    hi: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let op: Measure = op.parse().map_err(|e| refusal(&e))?;
    let (lo, hi) = (vector(&lo)?, vector(&hi)?);
    let result = py.detach(|| intervals(lo, hi).map(|x| x.into_iter().map(|x| op.of(x)).collect::<Vec<_>>()));
    Ok(PyArray1::from_vec(py, result.map_err(|e| refusal(&e))?))
}

/// `[lower, upper]`, rounded outward.
#[pyfunction]
pub fn format_interval(lo: f64, hi: f64) -> PyResult<String> {
    interval_core::rounding::check_environment().map_err(|e| refusal(&e))?;
    Interval::new(lo, hi).map(|x| x.to_string()).map_err(|e| refusal(&e))
}

/// The shortest decimal that reads back as `x` and lies on its outer side.
#[pyfunction]
pub fn outward_decimal(x: f64, up: bool) -> PyResult<String> {
    interval_core::rounding::check_environment().map_err(|e| refusal(&e))?;
    Ok(interval_core::exact::outward_decimal(x, up))
}
