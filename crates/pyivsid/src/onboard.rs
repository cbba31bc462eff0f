//! Bounds of parameters from rows that come one by one.

use crate::arrays::{row_major, vector};
use crate::scalar::sentence;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use onboard::{Bounds, Change, Contradiction, Follower as Constant, Refusal, State, Windows};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Half-spaces that a follower keeps: 64 kB for nine parameters.
const ROWS: usize = 304;

type Pair<T> = (T, T);
/// Time and begin of a proof [s], its number of half-spaces, and the parameter whose bounds do not meet.
type Proof = (f64, f64, usize, Option<usize>);

/// Followers of any number of parameters.
trait Following: Send + Sync {
    fn row(&mut self, time: f64, lower: &[f64], upper: &[f64], right: Bounds) -> Result<Option<Proof>, Refusal>;
    fn bounds(&self) -> Vec<Bounds>;
}

fn row<const N: usize>(lower: &[f64], upper: &[f64]) -> [Bounds; N] {
    std::array::from_fn(|j| Bounds::new(lower[j], upper[j]))
}

fn proof(found: &Contradiction) -> Proof {
    (found.time, found.oldest, found.rows, found.column)
}

impl<const N: usize> Following for Constant<N, ROWS> {
    fn row(&mut self, time: f64, lower: &[f64], upper: &[f64], right: Bounds) -> Result<Option<Proof>, Refusal> {
        Ok(match Self::row(self, time, &row(lower, upper), right)? {
            State::Bounded => None,
            State::Empty(found) => Some(proof(&found)),
        })
    }

    fn bounds(&self) -> Vec<Bounds> {
        Self::bounds(self).to_vec()
    }
}

impl<const N: usize> Following for Windows<N, ROWS> {
    fn row(&mut self, time: f64, lower: &[f64], upper: &[f64], right: Bounds) -> Result<Option<Proof>, Refusal> {
        let of = |c: Change| (c.time, c.window, c.contradiction.map_or(0, |found| found.rows), c.column);
        Ok(Self::row(self, time, &row(lower, upper), right)?.map(of))
    }

    fn bounds(&self) -> Vec<Bounds> {
        self.together().to_vec()
    }
}

fn made<const N: usize>(start: &[Bounds], rates: &[f64], window: Option<f64>) -> Result<Box<dyn Following>, Refusal> {
    let start: [Bounds; N] = std::array::from_fn(|j| start[j]);
    Ok(match window {
        Some(window) => Box::new(Windows::<N, ROWS>::new(start, window)?),
        None => Box::new(Constant::<N, ROWS>::drifting(start, std::array::from_fn(|j| rates[j]))?),
    })
}

/// Bounds of parameters from rows one by one, in bounded memory.
#[pyclass(module = "ivsid._core")]
pub struct Follower {
    inner: Box<dyn Following>,
    columns: usize,
}

fn refused(error: Refusal) -> PyErr {
    Python::attach(|py| sentence(py, &error.to_string()))
}

#[pymethods]
impl Follower {
    /// Bounds at the start, rates [1/s], and the length of windows that are compared [s].
    #[new]
    fn new(
        start: Pair<PyReadonlyArray1<'_, f64>>,
        rates: PyReadonlyArray1<'_, f64>,
        window: Option<f64>,
    ) -> PyResult<Self> {
        let (lower, upper, rates) = (vector(&start.0)?, vector(&start.1)?, vector(&rates)?);
        let n = lower.len();
        if upper.len() != n || rates.len() != n {
            return Err(PyValueError::new_err("bounds and rates of one length are needed"));
        }
        let start: Vec<Bounds> = lower.iter().zip(upper).map(|(&l, &u)| Bounds::new(l, u)).collect();
        macro_rules! by_number {
            ($($count:literal),*) => {
                match n {
                    $($count => made::<$count>(&start, rates, window),)*
                    _ => return Err(PyValueError::new_err("1 to 16 parameters that share rows can be followed")),
                }
            };
        }
        let inner = by_number!(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16).map_err(refused)?;
        Ok(Self { inner, columns: n })
    }

    /// Takes rows in their order, up to a proof that none or no constant parameters explain them: the number of rows
    /// taken, and the proof.
    fn take(
        &mut self,
        py: Python<'_>,
        time: PyReadonlyArray1<'_, f64>,
        rows: Pair<PyReadonlyArray2<'_, f64>>,
        right: Pair<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<(usize, Option<Proof>)> {
        let (lower, upper, columns) = row_major(&rows.0, &rows.1)?;
        let (time, low, high) = (vector(&time)?, vector(&right.0)?, vector(&right.1)?);
        let m = time.len();
        if columns != self.columns || low.len() != m || high.len() != m || lower.len() != m * columns {
            return Err(PyValueError::new_err("rows of one number and of the follower's columns are needed"));
        }
        py.detach(|| {
            for i in 0..m {
                let at = i * columns..(i + 1) * columns;
                let found = self.inner.row(time[i], &lower[at.clone()], &upper[at], Bounds::new(low[i], high[i]))?;
                if found.is_some() {
                    return Ok((i + 1, found));
                }
            }
            Ok((m, None))
        })
        .map_err(refused)
    }

    /// The proved bounds of every parameter after the last row.
    fn bounds<'py>(&self, py: Python<'py>) -> Pair<Bound<'py, PyArray1<f64>>> {
        let (lower, upper): (Vec<f64>, Vec<f64>) = self.inner.bounds().iter().map(|x| (x.lo, x.hi)).unzip();
        (PyArray1::from_vec(py, lower), PyArray1::from_vec(py, upper))
    }
}
