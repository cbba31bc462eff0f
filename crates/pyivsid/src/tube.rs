//! Bounds of trajectories.

use crate::arrays::{intervals, refusal, row_major, vector};
use interval_core::Interval;
use interval_core::tube::members::{Choice, Member, State};
use interval_core::tube::{Cutting, Entry, Given, Inputs, Model, Node, Op, Three, Tube, follow};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

type Operation = (String, usize, usize, f64);
type Column = (usize, Option<usize>, [f64; 3]);
type Box_ = (Vec<f64>, Vec<f64>);
type Bounds<'py> = (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, f64>);
type Rows<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>);

fn box_of(given: &Box_) -> PyResult<Vec<Interval>> {
    intervals(&given.0, &given.1).map_err(|e| refusal(&e))
}

fn three(rows: &[Interval]) -> Three {
    [rows[0], rows[1], rows[2]]
}

/// Rows of a fixed number of columns.
fn table(rows: &Rows<'_>, columns: usize) -> PyResult<Vec<Interval>> {
    let (lo, hi, width) = row_major(&rows.0, &rows.1)?;
    if width != columns {
        return Err(PyValueError::new_err(format!("tables of {columns} columns are needed")));
    }
    intervals(lo, hi).map_err(|e| refusal(&e))
}

/// The equations of motion with a polytope of parameters.
#[pyclass(frozen, module = "ivsid._core")]
pub struct TubeModel {
    model: Model,
}

#[pymethods]
impl TubeModel {
    /// Operations, columns by channel, vertices by channel, their hull, and which of u, v, r are free.
    #[new]
    fn new(
        program: Vec<Operation>,
        channels: [Vec<Column>; 3],
        vertices: [Vec<Box_>; 3],
        hull: Box_,
        free: [bool; 3],
    ) -> PyResult<Self> {
        let program: Result<Vec<Op>, _> = program.iter().map(|(name, a, b, x)| Op::named(name, *a, *b, *x)).collect();
        let channels = channels
            .map(|c| c.into_iter().map(|(term, register, inertia)| Entry { term, register, inertia }).collect());
        let mut points: [Vec<Vec<Interval>>; 3] = [Vec::new(), Vec::new(), Vec::new()];
        for (into, from) in points.iter_mut().zip(&vertices) {
            *into = from.iter().map(box_of).collect::<PyResult<_>>()?;
        }
        let hull = box_of(&hull)?;
        let model = program.and_then(|p| Model::new(p, channels, points, hull, free)).map_err(|e| refusal(&e))?;
        Ok(Self { model })
    }

    /// Bounds of u, v, r, psi, x, y at the samples, shape (m, 6), and the certificate of each part of a step.
    #[expect(clippy::too_many_arguments, reason = "the inputs of a tube")]
    #[pyo3(signature = (start, h, force, given, parts, cutting, certify))]
    fn follow<'py>(
        &self,
        py: Python<'py>,
        start: Box_,
        h: Bounds<'py>,
        force: Rows<'py>,
        given: Option<Rows<'py>>,
        parts: u32,
        cutting: Option<(usize, usize, f64)>,
        certify: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let start = box_of(&start)?;
        if start.len() != 6 {
            return Err(PyValueError::new_err("a start has six intervals"));
        }
        let node = Node { nu: three(&start[..3]), pose: three(&start[3..]) };
        let h = intervals(vector(&h.0)?, vector(&h.1)?).map_err(|e| refusal(&e))?;
        let force = table(&force, 3)?;
        let columns: [Vec<Interval>; 3] = std::array::from_fn(|i| force.iter().skip(i).step_by(3).copied().collect());
        let given: Vec<Given> = match &given {
            None => Vec::new(),
            Some(rows) => table(rows, 6)?
                .chunks_exact(6)
                .map(|row| Given { nu: three(&row[..3]), rates: three(&row[3..]) })
                .collect(),
        };
        let force = [columns[0].as_slice(), columns[1].as_slice(), columns[2].as_slice()];
        let inputs = Inputs { h: &h, force, given: &given };
        let cutting = cutting.map(|(most, every, narrowest)| Cutting { most, every, narrowest });
        let tube =
            py.detach(|| follow(&self.model, node, &inputs, parts, cutting, certify)).map_err(|e| refusal(&e))?;
        record(py, &tube)
    }

    /// Trajectories of one member, shape (m, 6): under held errors, under those that switch once, and under those that push a
    /// component to each target.
    ///
    /// `switched` holds steps and the signs from there on.
    /// `towards` holds targets: a sample and weights of the six components.
    #[expect(clippy::too_many_arguments, reason = "the surroundings of a member")]
    #[pyo3(signature = (theta, start, h, centre, errors, given, signs, switched, towards))]
    fn members<'py>(
        &self,
        py: Python<'py>,
        theta: Vec<f64>,
        start: Vec<(f64, f64)>,
        h: PyReadonlyArray1<'py, f64>,
        centre: PyReadonlyArray2<'py, f64>,
        errors: Vec<PyReadonlyArray2<'py, f64>>,
        given: Option<PyReadonlyArray2<'py, f64>>,
        signs: (Vec<f64>, [f64; 6]),
        switched: Vec<(usize, Vec<f64>)>,
        towards: Vec<(usize, State)>,
    ) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        let h = vector(&h)?;
        let rows = |array: &PyReadonlyArray2<'py, f64>| -> PyResult<Vec<[f64; 3]>> {
            let slice = array.as_slice()?;
            Ok(slice.chunks_exact(3).map(|r| [r[0], r[1], r[2]]).collect())
        };
        let centre = rows(&centre)?;
        let errors = errors.iter().map(rows).collect::<PyResult<Vec<_>>>()?;
        let given: Vec<[f64; 6]> = match &given {
            None => Vec::new(),
            Some(array) => array.as_slice()?.chunks_exact(6).map(|r| [r[0], r[1], r[2], r[3], r[4], r[5]]).collect(),
        };
        let start: [(f64, f64); 6] =
            start.try_into().map_err(|_| PyValueError::new_err("a start has six intervals"))?;
        if centre.len() != h.len()
            || errors.iter().any(|e| e.len() != h.len())
            || signs.0.len() != errors.len()
            || switched.iter().any(|(_, s)| s.len() != errors.len())
            || theta.len() != self.model.hull().len()
        {
            return Err(PyValueError::new_err("arrays whose lengths fit each other are needed"));
        }
        let member = Member { theta: &theta, h, centre: &centre, errors: &errors, given: &given, start };
        let plain = Choice { errors: signs.0.iter().map(|&s| vec![s; h.len()]).collect(), start: signs.1 };
        let runs = py.detach(|| {
            let mut runs = vec![member.run(&self.model, &plain)];
            for (from, after) in &switched {
                let mut choice = plain.clone();
                for (sign, &x) in choice.errors.iter_mut().zip(after) {
                    sign.iter_mut().skip(*from).for_each(|s| *s = x);
                }
                runs.push(member.run(&self.model, &choice));
            }
            for &(target, weights) in &towards {
                // The second pass is about the trajectory of the first.
                let mut choice = plain.clone();
                for _ in 0..2 {
                    choice = member.towards(&self.model, &choice, target, weights);
                }
                runs.push(member.run(&self.model, &choice));
            }
            runs
        });
        runs.into_iter()
            .map(|states| PyArray1::from_slice(py, states.as_flattened()).reshape([states.len(), 6]))
            .collect()
    }
}

fn record<'py>(py: Python<'py>, tube: &Tube) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    let ends = |end: fn(Interval) -> f64| {
        let all: Vec<f64> = tube.nodes.iter().flat_map(|n| n.nu.into_iter().chain(n.pose)).map(end).collect();
        PyArray1::from_slice(py, &all).reshape([tube.nodes.len(), 6])
    };
    found.set_item("lower", ends(Interval::lo)?)?;
    found.set_item("upper", ends(Interval::hi)?)?;
    let steps: Vec<(usize, usize, u32)> = tube.parts.iter().map(|p| (p.step, p.cell, p.parts)).collect();
    found.set_item("steps", steps)?;
    let boxes = |end: fn(Interval) -> f64| {
        let all: Vec<f64> =
            tube.parts.iter().flat_map(|p| p.start.into_iter().chain(p.rates).chain(p.end)).map(end).collect();
        PyArray1::from_slice(py, &all).reshape([tube.parts.len(), 9])
    };
    found.set_item("parts_lower", boxes(Interval::lo)?)?;
    found.set_item("parts_upper", boxes(Interval::hi)?)?;
    Ok(found)
}
