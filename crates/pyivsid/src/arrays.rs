//! Arrays in and out.

use interval_core::rounding::slices::Bounds;
use interval_core::{Error, Interval, IntervalMatrix};
use numpy::{PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The core's refusals as the user's error, which is a `ValueError`.
pub fn refusal(error: &Error) -> PyErr {
    crate::scalar::user_error(error)
}

/// Two rows without values, for lower and upper bounds that fill them. One block of memory comes back from the
/// allocator where two would be returned to the system and faulted in again.
pub fn results(py: Python<'_>, n: usize) -> Bound<'_, PyArray2<f64>> {
    rows(py, 2, n)
}

/// Some rows without values.
pub fn rows(py: Python<'_>, count: usize, n: usize) -> Bound<'_, PyArray2<f64>> {
    // SAFETY: any bits are a double, and the operations write every entry before Python sees the arrays.
    #[expect(unsafe_code, reason = "zeroing what is overwritten costs as much as the operation")]
    unsafe {
        PyArray2::new(py, [count, n], false)
    }
}

/// The same in three dimensions.
pub fn blocks(py: Python<'_>, shape: [usize; 3]) -> Bound<'_, PyArray3<f64>> {
    // SAFETY: any bits are a double, and the filter writes every entry before Python sees the array.
    #[expect(unsafe_code, reason = "zeroing what is overwritten costs as much as the operation")]
    unsafe {
        PyArray3::new(py, shape, false)
    }
}

/// A one-dimensional array as a slice.
pub fn vector<'a>(array: &'a PyReadonlyArray1<'_, f64>) -> PyResult<&'a [f64]> {
    interval_core::rounding::check_environment().map_err(|e| refusal(&e))?;
    array.as_slice().map_err(|_| PyValueError::new_err("a contiguous array is needed"))
}

/// Intervals from two arrays of bounds; reversed infinities are the empty interval.
pub fn intervals(lo: &[f64], hi: &[f64]) -> Result<Vec<Interval>, Error> {
    Bounds::new(lo, hi)?.intervals()
}

/// Bounds of a matrix where they lie, and its number of columns. `as_slice` also accepts Fortran order, which would
/// transpose silently.
pub fn row_major<'a>(
    lo: &'a PyReadonlyArray2<'_, f64>,
    hi: &'a PyReadonlyArray2<'_, f64>,
) -> PyResult<(&'a [f64], &'a [f64], usize)> {
    interval_core::rounding::check_environment().map_err(|e| refusal(&e))?;
    if !(lo.is_c_contiguous() && hi.is_c_contiguous()) {
        return Err(PyValueError::new_err("C-contiguous arrays are needed"));
    }
    if lo.shape() != hi.shape() {
        return Err(PyValueError::new_err("the lower and the upper bounds have different shapes"));
    }
    let (Ok(l), Ok(h)) = (lo.as_slice(), hi.as_slice()) else {
        return Err(PyValueError::new_err("C-contiguous arrays are needed"));
    };
    Ok((l, h, lo.shape()[1]))
}

/// An interval matrix from two arrays in any layout. They are copied and not borrowed: of small matrices a borrow, which
/// is kept in a table, costs as much as the inverse.
pub fn copied(lo: &Bound<'_, PyArray2<f64>>, hi: &Bound<'_, PyArray2<f64>>) -> PyResult<IntervalMatrix> {
    interval_core::rounding::check_environment().map_err(|e| refusal(&e))?;
    let (rows, columns) = (lo.shape()[0], lo.shape()[1]);
    if hi.shape() != [rows, columns] {
        return Err(PyValueError::new_err("the lower and the upper bounds have different shapes"));
    }
    IntervalMatrix::new(rows, columns, numbers(lo)?, numbers(hi)?).map_err(|e| refusal(&e))
}

/// The numbers of an array, row by row.
fn numbers(array: &Bound<'_, PyArray2<f64>>) -> PyResult<Vec<f64>> {
    if array.is_c_contiguous() {
        return array.to_vec().map_err(|_| PyValueError::new_err("C-contiguous arrays are needed"));
    }
    Ok(array.to_owned_array().into_iter().collect())
}

/// An interval matrix from two arrays of bounds.
pub fn matrix(lo: &PyReadonlyArray2<'_, f64>, hi: &PyReadonlyArray2<'_, f64>) -> PyResult<IntervalMatrix> {
    let (l, h, columns) = row_major(lo, hi)?;
    IntervalMatrix::new(lo.shape()[0], columns, l.to_vec(), h.to_vec()).map_err(|e| refusal(&e))
}
