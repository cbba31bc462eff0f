//! Results of the core as plain Python objects.

use interval_core::inverse::{Certificate, Outcome, Value};
use interval_core::regression::{BoundCertificate, FeasibleSet, LeastSquares, NormalEquations, OrthantOutcome};
use interval_core::regularity::{Cell, Regularity, SingularMember, Witness};
use interval_core::{Interval, IntervalMatrix};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Two arrays of bounds of the given shape.
pub fn bounds<'py>(
    py: Python<'py>,
    lower: &[f64],
    upper: &[f64],
    shape: (usize, usize),
) -> PyResult<Bound<'py, PyAny>> {
    let lower = PyArray1::from_slice(py, lower).reshape([shape.0, shape.1])?;
    let upper = PyArray1::from_slice(py, upper).reshape([shape.0, shape.1])?;
    Ok((lower, upper).into_pyobject(py)?.into_any())
}

pub fn interval_matrix<'py>(py: Python<'py>, a: &IntervalMatrix) -> PyResult<Bound<'py, PyAny>> {
    bounds(py, a.lo(), a.hi(), (a.rows(), a.columns()))
}

/// Lower and upper bounds as two one-dimensional arrays.
pub fn interval_vector<'py>(py: Python<'py>, x: &[Interval]) -> PyResult<Bound<'py, PyAny>> {
    let lower = PyArray1::from_iter(py, x.iter().map(|v| v.lo()));
    let upper = PyArray1::from_iter(py, x.iter().map(|v| v.hi()));
    Ok((lower, upper).into_pyobject(py)?.into_any())
}

fn witness<'py>(py: Python<'py>, witness: &Witness, n: usize) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    match witness {
        Witness::Contraction { approximate_inverse, norm } => {
            found.set_item("kind", "contraction")?;
            found.set_item("approximate_inverse", PyArray1::from_slice(py, approximate_inverse).reshape([n, n])?)?;
            found.set_item("norm", norm)?;
        }
        Witness::ScaledContraction { approximate_inverse, vector } => {
            found.set_item("kind", "scaled_contraction")?;
            found.set_item("approximate_inverse", PyArray1::from_slice(py, approximate_inverse).reshape([n, n])?)?;
            found.set_item("vector", PyArray1::from_slice(py, vector))?;
        }
        Witness::PositiveDefinite { shift, vector, congruence } => {
            found.set_item("kind", "positive_definite")?;
            found.set_item("shift", shift)?;
            found.set_item("vector", PyArray1::from_slice(py, vector))?;
            found.set_item("congruence", PyArray1::from_slice(py, congruence).reshape([n, n])?)?;
        }
        Witness::Cells(tree) => {
            found.set_item("kind", "cells")?;
            found.set_item("tree", cell(py, tree, n)?)?;
        }
        Witness::NonnegativeInverses => found.set_item("kind", "nonnegative_inverses")?,
        Witness::VertexDeterminants { sign } => {
            found.set_item("kind", "vertex_determinants")?;
            found.set_item("sign", sign)?;
        }
    }
    Ok(found)
}

/// `("regular", R, v)`, or `("halved", entry, value, below, above)`.
fn cell<'py>(py: Python<'py>, tree: &Cell, n: usize) -> PyResult<Bound<'py, PyAny>> {
    Ok(match tree {
        Cell::Regular { approximate_inverse, vector } => {
            let r = PyArray1::from_slice(py, approximate_inverse).reshape([n, n])?;
            ("regular", r, PyArray1::from_slice(py, vector)).into_pyobject(py)?.into_any()
        }
        Cell::Halved { entry, value, halves } => {
            let (below, above) = (cell(py, &halves[0], n)?, cell(py, &halves[1], n)?);
            ("halved", entry, value, below, above).into_pyobject(py)?.into_any()
        }
    })
}

fn singular<'py>(py: Python<'py>, member: &SingularMember, n: usize) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    let square = |m: &[f64]| PyArray1::from_slice(py, m).reshape([n, n]);
    match member {
        SingularMember::Member(m) => {
            found.set_item("kind", "singular_member")?;
            found.set_item("member", square(m)?)?;
        }
        SingularMember::NullVector(x) => {
            found.set_item("kind", "null_vector")?;
            found.set_item("vector", PyArray1::from_slice(py, x))?;
        }
        SingularMember::OppositeSigns(a, b) => {
            found.set_item("kind", "opposite_determinants")?;
            found.set_item("members", (square(a)?, square(b)?))?;
        }
    }
    Ok(found)
}

pub fn certificate<'py>(py: Python<'py>, certificate: &Certificate, n: usize) -> PyResult<Bound<'py, PyDict>> {
    match certificate {
        Certificate::Regular(w) => witness(py, w, n),
        Certificate::Singular(m) => singular(py, m, n),
        Certificate::Determinant { lo, hi } => {
            let found = PyDict::new(py);
            found.set_item("kind", "determinant")?;
            found.set_item("determinant", (lo, hi))?;
            Ok(found)
        }
    }
}

/// The certificate of the verdict.
pub fn regularity<'py>(py: Python<'py>, found: &Regularity, n: usize) -> PyResult<Option<Bound<'py, PyDict>>> {
    match found {
        Regularity::Regular(w) => witness(py, w, n).map(Some),
        Regularity::Singular(member) => singular(py, member, n).map(Some),
        Regularity::NotProved => Ok(None),
    }
}

/// The bounds, of `n` rows and as many columns as they fill.
pub fn value<'py>(py: Python<'py>, outcome: &Outcome, n: usize) -> PyResult<Option<Bound<'py, PyAny>>> {
    outcome.bounds().map(|(lower, upper)| bounds(py, lower, upper, (n, lower.len() / n))).transpose()
}

pub fn outcome<'py>(py: Python<'py>, outcome: &Outcome, n: usize) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("status", outcome.status.name())?;
    found.set_item("value", value(py, outcome, n)?)?;
    found.set_item("proved", matches!(outcome.value, Some(Value::Certified(_))))?;
    found.set_item("gap", outcome.gap)?;
    found.set_item(
        "certificate",
        match &outcome.certificate {
            Some(c) => Some(certificate(py, c, n)?),
            None => None,
        },
    )?;
    found.set_item("reason", &outcome.reason)?;
    Ok(found)
}

pub fn normal_equations<'py>(py: Python<'py>, result: &NormalEquations) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("status", result.status.name())?;
    found.set_item(
        "parameters",
        match &result.parameters {
            Some(p) => Some(interval_vector(py, p.either())?),
            None => None,
        },
    )?;
    found.set_item("proved", result.parameters.as_ref().is_some_and(|p| p.certified().is_some()))?;
    found.set_item("improper", result.improper)?;
    found.set_item("gram", interval_matrix(py, &result.gram)?)?;
    found.set_item("inverse", outcome(py, &result.inverse, result.gram.rows())?)?;
    Ok(found)
}

pub fn least_squares<'py>(py: Python<'py>, fit: &LeastSquares) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("status", fit.status.name())?;
    found.set_item("parameters", fit.parameters.as_ref().map(|p| interval_vector(py, p)).transpose()?)?;
    found.set_item("reason", &fit.reason)?;
    Ok(found)
}

fn bound_certificate<'py>(py: Python<'py>, c: &BoundCertificate) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    found.set_item("column", c.column)?;
    found.set_item("end", if c.upper { "upper" } else { "lower" })?;
    found.set_item("bound", c.bound)?;
    found.set_item("rows", &c.rows)?;
    found.set_item("signs", &c.signs)?;
    Ok(found)
}

pub fn feasible_set<'py>(py: Python<'py>, set: &FeasibleSet) -> PyResult<Bound<'py, PyDict>> {
    let orthants = PyList::empty(py);
    for orthant in &set.orthants {
        let entry = PyDict::new(py);
        entry.set_item("signs", &orthant.signs)?;
        entry.set_item("dropped", &orthant.dropped)?;
        match &*orthant.outcome {
            OrthantOutcome::Empty { rows } => {
                entry.set_item("empty", true)?;
                entry.set_item("rows", rows)?;
            }
            OrthantOutcome::Bounded(certificates) => {
                entry.set_item("empty", false)?;
                let list = certificates.iter().map(|c| bound_certificate(py, c)).collect::<PyResult<Vec<_>>>()?;
                entry.set_item("bounds", list)?;
            }
        }
        orthants.append(entry)?;
    }
    let proofs = PyList::empty(py);
    for proof in &set.sign_proofs {
        let entry = PyDict::new(py);
        entry.set_item("decided", &proof.decided)?;
        entry.set_item("home", &proof.home)?;
        let columns = proof.columns.iter().map(|c| (c.column, &c.rows, &c.signs)).collect::<Vec<_>>();
        entry.set_item("columns", columns)?;
        entry.set_item("vector", &proof.vector)?;
        entry.set_item("reach", &proof.reach)?;
        entry.set_item("branch", proof.branch)?;
        proofs.append(entry)?;
    }
    let found = PyDict::new(py);
    found.set_item("status", set.status.name())?;
    found.set_item("sign_proofs", proofs)?;
    found.set_item("fewest_outliers", set.outliers.as_ref().and_then(|o| o.fewest))?;
    found.set_item("outliers", set.outliers.as_ref().map(|o| &o.sets))?;
    found.set_item("parameters", interval_vector(py, &set.parameters)?)?;
    found.set_item("inflation", set.inflation)?;
    found.set_item("centre", set.centre.as_ref().map(|c| PyArray1::from_slice(py, c)))?;
    found.set_item("directions", &set.directions)?;
    found.set_item("orthants", orthants)?;
    found.set_item("reason", &set.reason)?;
    Ok(found)
}
