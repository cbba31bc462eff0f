//! Reverse operations by name, entry by entry: the solutions of an equation in an interval.

use crate::arrays::{intervals, refusal, vector};
use crate::convert::interval_vector;
use interval_core::{Error, Interval};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

type Row<'py> = (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>);

/// A reverse operation, with as many operands as it takes.
#[derive(Clone, Copy)]
pub enum Reverse {
    Two(fn(Interval, Interval) -> Interval),
    Three(fn(Interval, Interval, Interval) -> Interval),
}

impl Reverse {
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "sqr_rev" => Self::Two(Interval::sqr_rev),
            "abs_rev" => Self::Two(Interval::abs_rev),
            "sin_rev" => Self::Two(Interval::sin_rev),
            "cos_rev" => Self::Two(Interval::cos_rev),
            "tan_rev" => Self::Two(Interval::tan_rev),
            "cosh_rev" => Self::Two(Interval::cosh_rev),
            "mul_rev" => Self::Three(Interval::mul_rev),
            "pow_rev_base" => Self::Three(Interval::pow_rev_base),
            "pow_rev_exponent" => Self::Three(Interval::pow_rev_exponent),
            "arctan2_rev_y" => Self::Three(Interval::atan2_rev_y),
            "arctan2_rev_x" => Self::Three(Interval::atan2_rev_x),
            "mul_rev_first" => Self::Two(|b, c| b.mul_rev_to_pair(c)[0]),
            "mul_rev_second" => Self::Two(|b, c| b.mul_rev_to_pair(c)[1]),
            _ => return None,
        })
    }

    /// The result of operands whose number is the one that the operation takes, which is returned where it is another.
    pub fn of(self, operands: &[Interval]) -> Result<Interval, usize> {
        match (self, operands) {
            (Self::Two(f), &[c, x]) => Ok(f(c, x)),
            (Self::Three(f), &[b, c, x]) => Ok(f(b, c, x)),
            (Self::Two(_), _) => Err(2),
            (Self::Three(_), _) => Err(3),
        }
    }
}

fn rows(operands: &[Row<'_>]) -> PyResult<Vec<Vec<Interval>>> {
    let rows = operands
        .iter()
        .map(|(lo, hi)| intervals(vector(lo)?, vector(hi)?).map_err(|e| refusal(&e)))
        .collect::<PyResult<Vec<_>>>()?;
    let needed = rows.first().map_or(0, Vec::len);
    match rows.iter().find(|r| r.len() != needed) {
        Some(r) => Err(refusal(&Error::Shape { what: "an operand", given: r.len(), needed })),
        None => Ok(rows),
    }
}

/// A reverse operation by its name, of operands of the same length.
#[pyfunction]
pub fn reverse<'py>(py: Python<'py>, op: &str, operands: Vec<Row<'py>>) -> PyResult<Bound<'py, PyAny>> {
    let unknown = || PyValueError::new_err(format!("unknown operation '{op}'"));
    let f = Reverse::from_name(op).ok_or_else(unknown)?;
    let rows = rows(&operands)?;
    let found = py.detach(|| {
        let count = rows.first().map_or(0, Vec::len);
        (0..count).map(|i| f.of(&rows.iter().map(|r| r[i]).collect::<Vec<_>>())).collect::<Result<Vec<_>, _>>()
    });
    let found = found.map_err(|n| PyValueError::new_err(format!("'{op}' takes {n} operands")))?;
    interval_vector(py, &found)
}

/// `{t in x : t^n in c}`, entry by entry.
#[pyfunction]
pub fn power_reverse<'py>(py: Python<'py>, c: Row<'py>, x: Row<'py>, n: i32) -> PyResult<Bound<'py, PyAny>> {
    let rows = rows(&[c, x])?;
    let found = py.detach(|| rows[0].iter().zip(&rows[1]).map(|(c, &x)| c.powi_rev(x, n)).collect::<Vec<_>>());
    interval_vector(py, &found)
}
