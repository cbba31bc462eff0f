//! Operators: two intervals at once, anything else by a detour.

use super::{Interval, guarded, python_door};
use crate::arrays::refusal;
use interval_core::{Interval as Bounds, rounding};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyFloat, PyInt};

/// Largest integer up to which every integer is a double.
const EXACT: i64 = 1 << 53;

/// An operand that is an interval, a float or an exactly representable integer.
#[inline]
pub(super) fn operand(value: &Bound<'_, PyAny>) -> Option<PyResult<Bounds>> {
    if let Ok(interval) = value.cast::<Interval>() {
        return Some(Ok(interval.get().0));
    }
    if let Ok(number) = value.cast::<PyFloat>() {
        let x = number.value();
        return Some(Bounds::point(x).map_err(|e| refusal(&e)));
    }
    if let Ok(number) = value.cast::<PyInt>() {
        return integer(number).map(Ok);
    }
    None
}

pub(super) fn integer(number: &Bound<'_, PyInt>) -> Option<Bounds> {
    let n: i64 = number.extract().ok()?;
    if !(-EXACT..=EXACT).contains(&n) {
        return None;
    }
    #[expect(clippy::cast_precision_loss, reason = "at most 2^53")]
    Bounds::point(n as f64).ok()
}

type Operation = fn(Bounds, Bounds) -> Bounds;

/// `a op b`, or with `reverse` `b op a`; anything but numbers goes to the arrays.
#[inline]
pub(super) fn binary<'py>(
    a: &Bound<'py, Interval>,
    b: &Bound<'py, PyAny>,
    name: &str,
    op: Operation,
    reverse: bool,
) -> PyResult<Bound<'py, PyAny>> {
    if rounding::environment_is_default()
        && let Ok(other) = b.cast::<Interval>()
    {
        // Two intervals are never reversed: the left one answers.
        return Ok(Bound::new(a.py(), Interval(op(a.get().0, other.get().0)))?.into_any());
    }
    mixed(a, b, name, op, reverse)
}

/// An interval and something else.
#[cold]
fn mixed<'py>(
    a: &Bound<'py, Interval>,
    b: &Bound<'py, PyAny>,
    name: &str,
    op: Operation,
    reverse: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let py = a.py();
    rounding::check_environment().map_err(|e| refusal(&e))?;
    let Some(other) = operand(b) else {
        let (left, right) = if reverse { (b, a.as_any()) } else { (a.as_any(), b) };
        return python_door(py, "_operate")?.call1((name, left, right));
    };
    let (x, y) = (a.get().0, other?);
    let result = if reverse { op(y, x) } else { op(x, y) };
    Ok(Bound::new(py, Interval(result))?.into_any())
}

#[pymethods]
impl Interval {
    fn __add__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "add", |x, y| x + y, false)
    }

    fn __radd__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "add", |x, y| x + y, true)
    }

    fn __sub__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "sub", |x, y| x - y, false)
    }

    fn __rsub__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "sub", |x, y| x - y, true)
    }

    fn __mul__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "mul", |x, y| x * y, false)
    }

    fn __rmul__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "mul", |x, y| x * y, true)
    }

    fn __truediv__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "div", |x, y| x / y, false)
    }

    fn __rtruediv__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "div", |x, y| x / y, true)
    }

    fn __pow__<'py>(
        slf: &Bound<'py, Self>,
        exponent: &Bound<'py, PyAny>,
        modulus: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if modulus.is_some() {
            return Err(PyTypeError::new_err("intervals have no modular powers"));
        }
        if let Ok(number) = exponent.cast::<PyInt>() {
            // Larger integers are the arrays' business: a real power would lose the members below zero.
            let Ok(n) = number.extract::<i32>() else {
                return python_door(slf.py(), "_operate")?.call1(("pow", slf, exponent));
            };
            return Ok(Bound::new(slf.py(), guarded(|| Interval(slf.get().0.powi(n)))?)?.into_any());
        }
        binary(slf, exponent, "pow", Bounds::pow, false)
    }

    fn __rpow__<'py>(
        slf: &Bound<'py, Self>,
        base: &Bound<'py, PyAny>,
        modulus: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if modulus.is_some() {
            return Err(PyTypeError::new_err("intervals have no modular powers"));
        }
        binary(slf, base, "pow", Bounds::pow, true)
    }
}
