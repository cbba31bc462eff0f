//! The answer of a method for one matrix: its arrays, strings and dictionaries are made when they are asked for.

use crate::convert;
use interval_core::inverse::{Outcome, Value};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The answer of a method for one matrix.
#[pyclass(frozen, module = "ivsid._core")]
pub struct Found {
    outcome: Outcome,
    order: usize,
}

impl Found {
    pub fn new(outcome: Outcome, order: usize) -> Self {
        Self { outcome, order }
    }
}

#[pymethods]
impl Found {
    #[getter]
    fn status(&self) -> &'static str {
        self.outcome.status.name()
    }

    /// New arrays at each call.
    #[getter]
    fn value<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        convert::value(py, &self.outcome, self.order)
    }

    #[getter]
    fn proved(&self) -> bool {
        matches!(self.outcome.value, Some(Value::Certified(_)))
    }

    #[getter]
    fn gap(&self) -> Option<f64> {
        self.outcome.gap
    }

    #[getter]
    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let certificate = self.outcome.certificate.as_ref();
        certificate.map(|c| convert::certificate(py, c, self.order)).transpose()
    }

    #[getter]
    fn reason(&self) -> Option<&str> {
        self.outcome.reason.as_deref()
    }
}
