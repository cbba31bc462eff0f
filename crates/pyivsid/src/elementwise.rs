//! Entrywise operations on arrays of bounds, and text.

use crate::arrays::{intervals, refusal, vector};
use crate::convert::interval_vector;
use interval_core::{Error, Interval, rounding};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Whether the floating-point environment is the one that the bounds rely on.
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

/// `op` is one of neg, abs, square, sqrt, `signed_square`. Empty results have reversed infinite bounds.
#[pyfunction]
pub fn unary<'py>(
    py: Python<'py>,
    op: &str,
    lo: PyReadonlyArray1<'py, f64>,
    hi: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let f: fn(Interval) -> Interval = match op {
        "neg" => |x| -x,
        "abs" => Interval::abs,
        "square" => Interval::square,
        "sqrt" => Interval::sqrt,
        "signed_square" => Interval::signed_square,
        _ => return Err(PyValueError::new_err(format!("unknown operation '{op}'"))),
    };
    let (lo, hi) = (vector(&lo)?, vector(&hi)?);
    let result = py.detach(|| intervals(lo, hi).map(|x| x.into_iter().map(f).collect::<Vec<_>>()));
    interval_vector(py, &result.map_err(|e| refusal(&e))?)
}

/// `op` is one of add, sub, mul, div, min, max, hull, intersection. Empty results have reversed infinite bounds.
#[pyfunction]
pub fn binary<'py>(
    py: Python<'py>,
    op: &str,
    a: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
    b: (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>),
) -> PyResult<Bound<'py, PyAny>> {
    let f: fn(Interval, Interval) -> Interval = match op {
        "add" => |x, y| x + y,
        "sub" => |x, y| x - y,
        "mul" => |x, y| x * y,
        "div" => |x, y| x / y,
        "min" => Interval::min,
        "max" => Interval::max,
        "hull" => Interval::hull,
        "intersection" => Interval::intersection,
        _ => return Err(PyValueError::new_err(format!("unknown operation '{op}'"))),
    };
    let (alo, ahi, blo, bhi) = (vector(&a.0)?, vector(&a.1)?, vector(&b.0)?, vector(&b.1)?);
    let result = py.detach(|| {
        let (x, y) = (intervals(alo, ahi)?, intervals(blo, bhi)?);
        if x.len() != y.len() {
            return Err(Error::Shape { what: "the second operand", given: y.len(), needed: x.len() });
        }
        Ok(x.into_iter().zip(y).map(|(x, y)| f(x, y)).collect::<Vec<_>>())
    });
    interval_vector(py, &result.map_err(|e| refusal(&e))?)
}

/// `op` is one of midpoint, radius, width, magnitude, mignitude.
#[pyfunction]
pub fn measure<'py>(
    py: Python<'py>,
    op: &str,
    lo: PyReadonlyArray1<'py, f64>,
    hi: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let f: fn(Interval) -> f64 = match op {
        "midpoint" => Interval::midpoint,
        "radius" => Interval::radius,
        "width" => Interval::width,
        "magnitude" => Interval::magnitude,
        "mignitude" => Interval::mignitude,
        _ => return Err(PyValueError::new_err(format!("unknown measure '{op}'"))),
    };
    let (lo, hi) = (vector(&lo)?, vector(&hi)?);
    let result = py.detach(|| intervals(lo, hi).map(|x| x.into_iter().map(f).collect::<Vec<_>>()));
    Ok(PyArray1::from_vec(py, result.map_err(|e| refusal(&e))?))
}

/// The tightest bounds of an interval literal.
#[pyfunction]
pub fn parse_interval(text: &str) -> PyResult<(f64, f64)> {
    let x: Interval = text.parse().map_err(|e| refusal(&e))?;
    Ok((x.lo(), x.hi()))
}

/// `[lower, upper]`, rounded outward.
#[pyfunction]
pub fn format_interval(lo: f64, hi: f64) -> PyResult<String> {
    Interval::new(lo, hi).map(|x| x.to_string()).map_err(|e| refusal(&e))
}

/// The shortest decimal that reads back as `x` and lies on its outer side.
#[pyfunction]
pub fn outward_decimal(x: f64, up: bool) -> String {
    interval_core::exact::outward_decimal(x, up)
}
