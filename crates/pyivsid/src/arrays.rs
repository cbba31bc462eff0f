//! Arrays in and out.

use interval_core::{Error, Interval, IntervalMatrix};
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The core's refusals as the user's error, which is a `ValueError`.
pub fn refusal(error: &Error) -> PyErr {
    crate::scalar::user_error(error)
}

/// Two rows without values, for lower and upper bounds that fill them. One block of memory comes back from the allocator
/// where two would be returned to the system and faulted in again.
pub fn results(py: Python<'_>, n: usize) -> Bound<'_, PyArray2<f64>> {
    // SAFETY: any bits are a double, and the operations write every entry before Python sees the arrays.
    #[expect(unsafe_code, reason = "zeroing what is overwritten costs as much as the operation")]
    unsafe {
        PyArray2::new(py, [2, n], false)
    }
}

/// A one-dimensional array as a slice.
pub fn vector<'a>(array: &'a PyReadonlyArray1<'_, f64>) -> PyResult<&'a [f64]> {
    interval_core::rounding::check_environment().map_err(|e| refusal(&e))?;
    array.as_slice().map_err(|_| PyValueError::new_err("a contiguous array is needed"))
}

/// Intervals from two arrays of bounds; reversed infinities are the empty interval.
pub fn intervals(lo: &[f64], hi: &[f64]) -> Result<Vec<Interval>, Error> {
    if lo.len() != hi.len() {
        return Err(Error::Shape { what: "the upper bound", given: hi.len(), needed: lo.len() });
    }
    lo.iter()
        .zip(hi)
        .enumerate()
        .map(|(index, (&l, &h))| match (l, h) {
            (f64::INFINITY, f64::NEG_INFINITY) => Ok(Interval::EMPTY),
            _ => Interval::at(l, h, index),
        })
        .collect()
}

/// An interval matrix from two arrays of bounds. `as_slice` also accepts Fortran order, which would transpose silently.
pub fn matrix(lo: &PyReadonlyArray2<'_, f64>, hi: &PyReadonlyArray2<'_, f64>) -> PyResult<IntervalMatrix> {
    interval_core::rounding::check_environment().map_err(|e| refusal(&e))?;
    if !(lo.is_c_contiguous() && hi.is_c_contiguous()) {
        return Err(PyValueError::new_err("C-contiguous arrays are needed"));
    }
    if lo.shape() != hi.shape() {
        return Err(PyValueError::new_err("the lower and the upper bounds have different shapes"));
    }
    let values = |a: &PyReadonlyArray2<'_, f64>| a.as_slice().map(<[f64]>::to_vec);
    let (Ok(l), Ok(h)) = (values(lo), values(hi)) else {
        return Err(PyValueError::new_err("C-contiguous arrays are needed"));
    };
    let shape = lo.shape();
    IntervalMatrix::new(shape[0], shape[1], l, h).map_err(|e| refusal(&e))
}
