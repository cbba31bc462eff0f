//! `ivsid.Interval`: one interval as a Python object.

mod functions;
mod operators;
mod reverses;

use crate::arrays::refusal;
use interval_core::{Error, Interval as Bounds, exact, rounding};
use operators::{binary, integer};
use pyo3::basic::CompareOp;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyAny, PyDict, PyFloat, PyInt, PyString, PyTuple, PyType};
use std::hash::{DefaultHasher, Hash, Hasher};

/// One closed interval; every operation is rounded outward to the tightest result.
///
/// Args:
///     lower: the lower bound as it is, or text such as ``"[0.1, 0.2]"``, ``"[1/3]"`` or ``"3.56?1"``, which is enclosed.
///     upper: the upper bound; equal to ``lower`` where left out.
///
/// Raises:
///     `IvsidError`: NaN, reversed bounds, no finite point, or text that is no interval.
#[pyclass(frozen, module = "ivsid", name = "Interval")]
#[derive(Clone, Copy)]
pub struct Interval(pub Bounds);

/// A function of the Python module that knows arrays and everything else.
fn python_door<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    static MODULE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let module = MODULE.get_or_try_init(py, || py.import("ivsid.intervals").map(|m| m.into_any().unbind()))?;
    module.bind(py).getattr(name)
}

/// A result, unless the processor rounds otherwise than it must: then nothing is computed, since an algorithm that rests
/// on the mode can leave its tables or its loops.
#[inline]
fn guarded<T>(result: impl FnOnce() -> T) -> PyResult<T> {
    rounding::check_environment().map_err(|e| refusal(&e))?;
    Ok(result())
}

/// A number of Python's as a double, without a rounding.
fn exact_number(value: &Bound<'_, PyAny>) -> PyResult<f64> {
    if let Ok(number) = value.cast::<PyFloat>() {
        return Ok(number.value());
    }
    if let Some(exact) = value.cast::<PyInt>().ok().and_then(integer) {
        return Ok(exact.lo());
    }
    python_door(value.py(), "_bound")?.call1((value,))?.extract()
}

#[pymethods]
impl Interval {
    #[new]
    #[pyo3(signature = (lower, upper=None))]
    fn new(py: Python<'_>, lower: &Bound<'_, PyAny>, upper: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        rounding::check_environment().map_err(|e| refusal(&e))?;
        if let Ok(text) = lower.cast::<PyString>() {
            if upper.is_some() {
                return Err(sentence(py, "give either text or two bounds, not both"));
            }
            return text.to_str()?.parse().map(Self).map_err(|e| refusal(&e));
        }
        let lo = exact_number(lower)?;
        let hi = upper.map_or(Ok(lo), exact_number)?;
        Bounds::new(lo, hi).map(Self).map_err(|e| refusal(&e))
    }

    /// The interval without members.
    #[classmethod]
    fn empty_set(_cls: &Bound<'_, PyType>) -> Self {
        Self(Bounds::EMPTY)
    }

    /// The real line.
    #[classmethod]
    fn entire(_cls: &Bound<'_, PyType>) -> Self {
        Self(Bounds::ENTIRE)
    }

    /// Lower bound.
    #[getter]
    fn lower(&self) -> f64 {
        self.0.lo()
    }

    /// Upper bound.
    #[getter]
    fn upper(&self) -> f64 {
        self.0.hi()
    }

    /// A double inside, nearest to the centre.
    #[getter]
    fn midpoint(&self) -> PyResult<f64> {
        guarded(|| self.0.midpoint())
    }

    /// The smallest double r with the interval inside midpoint +- r.
    #[getter]
    fn radius(&self) -> PyResult<f64> {
        guarded(|| self.0.radius())
    }

    /// Upper - lower, rounded up.
    #[getter]
    fn width(&self) -> PyResult<f64> {
        guarded(|| self.0.width())
    }

    /// The largest absolute value.
    #[getter]
    fn magnitude(&self) -> PyResult<f64> {
        guarded(|| self.0.magnitude())
    }

    /// The smallest absolute value.
    #[getter]
    fn mignitude(&self) -> PyResult<f64> {
        guarded(|| self.0.mignitude())
    }

    /// True if nothing is inside.
    #[getter]
    fn empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True if the number is inside.
    ///
    /// Raises:
    ///     `IvsidError`: no number, or one without an exact double.
    fn contains(&self, point: &Bound<'_, PyAny>) -> PyResult<bool> {
        let point = exact_number(point)?;
        guarded(|| self.0.contains(point))
    }

    /// True if this lies in the other.
    fn subset(&self, other: &Self) -> PyResult<bool> {
        guarded(|| self.0.subset(other.0))
    }

    /// True if this lies in the inside of the other.
    fn interior(&self, other: &Self) -> PyResult<bool> {
        guarded(|| self.0.interior(other.0))
    }

    /// True if no number is in both.
    fn disjoint(&self, other: &Self) -> PyResult<bool> {
        guarded(|| self.0.disjoint(other.0))
    }

    /// The common members.
    fn intersection<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "intersection", Bounds::intersection, false)
    }

    /// The smallest interval that holds both.
    fn hull<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "hull", Bounds::hull, false)
    }

    /// The angle of the point (other, self) in (-pi, pi], in radians.
    fn arctan2<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "atan2", Bounds::atan2, false)
    }

    /// The same in half turns, in (-1, 1].
    fn arctan2pi<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "atan2_pi", Bounds::atan2_pi, false)
    }

    /// The lengths of the vectors (self, other).
    fn hypot<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, other, "hypot", Bounds::hypot, false)
    }

    /// ``(1 + self)^exponent - 1``, of the members above -1.
    fn compoundm1<'py>(slf: &Bound<'py, Self>, exponent: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        binary(slf, exponent, "compound_m1", Bounds::compound_m1, false)
    }

    /// The n-th roots: of all members for an odd ``n``, of those from 0 on for an even one, and not of 0 for a negative one.
    fn rootn(&self, n: i32) -> PyResult<Self> {
        guarded(|| Self(self.0.rootn(n)))
    }

    /// ``self * y + z`` with one rounding.
    fn fma(&self, y: &Self, z: &Self) -> PyResult<Self> {
        guarded(|| Self(self.0.mul_add(y.0, z.0)))
    }

    /// Hexadecimal bounds, without any rounding: text that reads back as the same interval.
    #[expect(clippy::wrong_self_convention, reason = "Python passes a reference")]
    fn to_exact(&self) -> PyResult<String> {
        guarded(|| self.0.to_exact())
    }

    fn __neg__(&self) -> PyResult<Self> {
        guarded(|| Self(-self.0))
    }

    fn __pos__(&self) -> Self {
        *self
    }

    fn __abs__(&self) -> PyResult<Self> {
        guarded(|| Self(self.0.abs()))
    }

    fn __contains__(&self, point: &Bound<'_, PyAny>) -> PyResult<bool> {
        self.contains(point)
    }

    fn __richcmp__<'py>(
        slf: &Bound<'py, Self>,
        other: &Bound<'py, PyAny>,
        op: CompareOp,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Ok(other) = other.cast::<Self>() else { return Ok(py.NotImplemented().into_bound(py)) };
        let equal = guarded(|| slf.get().0 == other.get().0)?;
        Ok(match op {
            CompareOp::Eq => equal.into_pyobject(py)?.to_owned().into_any(),
            CompareOp::Ne => (!equal).into_pyobject(py)?.to_owned().into_any(),
            _ => py.NotImplemented().into_bound(py),
        })
    }

    fn __hash__(&self) -> u64 {
        // Equal intervals may differ in the sign of a zero. Bits tell a zero in every mode of the processor.
        let mut hasher = DefaultHasher::new();
        let bits = |x: f64| if x.to_bits() << 1 == 0 { 0 } else { x.to_bits() };
        [self.0.lo(), self.0.hi()].map(bits).hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let py = slf.py();
        let x = slf.get().0;
        let arguments =
            if x.is_empty() { ("[empty]",).into_pyobject(py)? } else { (x.lo(), x.hi()).into_pyobject(py)? };
        (slf.get_type(), arguments).into_pyobject(py)
    }

    fn __repr__(&self) -> PyResult<String> {
        if self.0.is_empty() {
            return Ok("Interval(\"[empty]\")".into());
        }
        // The decimals are outward, and as float literals they read back as the same doubles.
        let end = |x: f64, up| {
            if x.is_infinite() { format!("float(\"{x}\")") } else { exact::outward_decimal(x, up) }
        };
        guarded(|| format!("Interval({}, {})", end(self.0.lo(), false), end(self.0.hi(), true)))
    }

    fn __str__(&self) -> PyResult<String> {
        guarded(|| self.0.to_string())
    }

    /// The interval in a notebook, as the tables of arrays show it.
    fn _repr_html_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python_door(py, "_html")?.call1((self.0.lo(), self.0.hi()))
    }

    /// Arrays beside an interval, and `NumPy`'s functions of one, are the array class's business.
    #[pyo3(signature = (ufunc, method, *inputs, **options))]
    #[expect(clippy::unused_self, reason = "the operands are in the inputs")]
    fn __array_ufunc__<'py>(
        &self,
        py: Python<'py>,
        ufunc: &Bound<'py, PyAny>,
        method: &str,
        inputs: &Bound<'py, PyTuple>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        python_door(py, "_ufunc")?.call1((ufunc, method, inputs, options))
    }
}

/// The user's error with this text.
pub fn sentence(py: Python<'_>, text: &str) -> PyErr {
    static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let class = CLASS.get_or_try_init(py, || py.import("ivsid.errors")?.getattr("IvsidError").map(Bound::unbind));
    match class.and_then(|class| class.bind(py).call1((text,))) {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// A refusal of the core as the user's error.
pub fn user_error(error: &Error) -> PyErr {
    Python::attach(|py| sentence(py, &error.to_string()))
}
