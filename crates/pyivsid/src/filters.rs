//! Filters of many signals at once; no bounds.

use filter_core::{Curve, Error, Group, Layout, Line};
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

const MISFIT: &str = "contiguous arrays whose shapes fit each other are needed";

fn misfit() -> PyErr {
    PyValueError::new_err(MISFIT)
}

/// Answers of recursive filters at rest: inputs of shape (n,), numerators (rows, inputs, taps), denominators (rows,
/// taps) -> (rows, n).
#[pyfunction]
pub fn respond<'py>(
    py: Python<'py>,
    inputs: Vec<PyReadonlyArray1<'py, f64>>,
    numerators: PyReadonlyArray3<'py, f64>,
    denominators: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (rows, taps) = (denominators.shape()[0], denominators.shape()[1]);
    let n = inputs.first().map_or(0, |x| x.len());
    if !(1..=4).contains(&taps)
        || numerators.shape() != [rows, inputs.len(), taps]
        || inputs.iter().any(|x| x.len() != n)
    {
        return Err(misfit());
    }
    let x = inputs.iter().map(PyReadonlyArray1::as_slice).collect::<Result<Vec<_>, _>>().map_err(|_| misfit())?;
    let b = numerators.as_slice().map_err(|_| misfit())?;
    let a = denominators.as_slice().map_err(|_| misfit())?;
    let found = crate::arrays::rows(py, rows, n);
    {
        let mut out = found.readwrite();
        let out = out.as_slice_mut()?;
        py.detach(|| filter_core::respond(&x, b, a, taps, n, out));
    }
    Ok(found)
}

/// Columns of shape (rows, n) through a causal filter of groups of rows, in blocks -> (columns, blocks, rows length),
/// and their lengths.
#[pyfunction]
pub fn whiten<'py>(
    py: Python<'py>,
    columns: Vec<PyReadonlyArray2<'py, f64>>,
    groups: Vec<Vec<usize>>,
    taps: Vec<PyReadonlyArray3<'py, f64>>,
    length: usize,
    weight: Option<PyReadonlyArray1<'py, f64>>,
    unit: bool,
) -> PyResult<(Bound<'py, PyArray3<f64>>, Vec<f64>)> {
    let Some(first) = columns.first() else {
        return Err(misfit());
    };
    let (rows, n) = (first.shape()[0], first.shape()[1]);
    let fits = |(g, t): (&Vec<usize>, &PyReadonlyArray3<'py, f64>)| {
        !g.is_empty() && t.shape()[0] > 0 && t.shape()[1..] == [g.len(), g.len()] && g.iter().all(|&r| r < rows)
    };
    if length == 0
        || groups.len() != taps.len()
        || !groups.iter().zip(&taps).all(fits)
        || columns.iter().any(|c| c.shape() != [rows, n] || !c.is_c_contiguous())
        || taps.iter().any(|t| !t.is_c_contiguous())
        || weight.as_ref().is_some_and(|w| w.len() != n)
    {
        return Err(misfit());
    }
    let x = columns.iter().map(PyReadonlyArray2::as_slice).collect::<Result<Vec<_>, _>>().map_err(|_| misfit())?;
    let taps = taps.iter().map(PyReadonlyArray3::as_slice).collect::<Result<Vec<_>, _>>().map_err(|_| misfit())?;
    let weight = weight.as_ref().map(PyReadonlyArray1::as_slice).transpose().map_err(|_| misfit())?;
    let groups: Vec<Group> = groups.iter().zip(&taps).map(|(rows, taps)| Group { rows, taps }).collect();
    let layout = Layout { rows, n, length, weight, unit };
    let found = crate::arrays::blocks(py, [columns.len(), n / length, rows * length]);
    let lengths = {
        let mut out = found.readwrite();
        let out = out.as_slice_mut()?;
        py.detach(|| filter_core::whiten(&x, &groups, layout, filter_core::processors(), out))
    };
    Ok((found, lengths))
}

/// An error of a thrust: absolute and relative bound, knots and values by demand, knots and values of the hysteresis,
/// if any.
type Errors = (f64, f64, Vec<f64>, Vec<f64>, Option<(Vec<f64>, Vec<f64>)>);

/// Thrusts at demands from the neutral in the order of time, by a curve of knots and cubics, with an error of the curve
/// if one is given.
#[pyfunction]
pub fn thrust<'py>(
    py: Python<'py>,
    demand: PyReadonlyArray1<'py, f64>,
    neutral: f64,
    knots: Vec<f64>,
    pieces: Vec<[f64; 4]>,
    error: Option<Errors>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let line = |k: &Vec<f64>, v: &Vec<f64>| !k.is_empty() && k.len() == v.len();
    let fits = |(_, _, k, v, b): &Errors| line(k, v) && b.as_ref().is_none_or(|(k, v)| line(k, v));
    if knots.len() < 2 || pieces.len() + 1 != knots.len() || !error.as_ref().is_none_or(fits) {
        return Err(misfit());
    }
    let curve = Curve { neutral, knots: &knots, pieces: &pieces };
    let error = error.as_ref().map(|(absolute, relative, k, v, b)| Error {
        absolute: *absolute,
        relative: *relative,
        curve: Line { knots: k, values: v },
        branch: b.as_ref().map(|(k, v)| Line { knots: k, values: v }),
    });
    let d = demand.as_slice().map_err(|_| misfit())?;
    let found = PyArray1::zeros(py, [d.len()], false);
    {
        let mut out = found.readwrite();
        let out = out.as_slice_mut()?;
        py.detach(|| filter_core::thrust(d, curve, error, filter_core::processors(), out));
    }
    Ok(found)
}
