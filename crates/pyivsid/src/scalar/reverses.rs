//! Reverse operations of one interval: the solutions of an equation in an interval.

use super::operators::operand;
use super::{Interval, guarded, python_door};
use crate::arrays::refusal;
use crate::reverses::Reverse;
use interval_core::{Interval as Bounds, rounding};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyTuple};

/// The operands as intervals, the last one the real line where it is left out; nothing if one is an array or the like.
fn all(given: &[&Bound<'_, PyAny>], last: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Vec<Bounds>>> {
    rounding::check_environment().map_err(|e| refusal(&e))?;
    let mut found = Vec::with_capacity(3);
    for one in given.iter().copied().chain(last) {
        match operand(one) {
            Some(bounds) => found.push(bounds?),
            None => return Ok(None),
        }
    }
    if last.is_none() {
        found.push(Bounds::ENTIRE);
    }
    Ok(Some(found))
}

/// A reverse operation of intervals and numbers; anything else goes to the arrays.
fn solved<'py>(
    name: &str,
    given: &[&Bound<'py, PyAny>],
    last: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = given[0].py();
    if let (Some(f), Some(operands)) = (Reverse::from_name(name), all(given, last)?)
        && let Ok(found) = f.of(&operands)
    {
        return Ok(Bound::new(py, Interval(found))?.into_any());
    }
    let words = given.iter().map(|x| x.as_any()).chain(last).collect::<Vec<_>>();
    python_door(py, "_reverse")?.call1((name, PyTuple::new(py, words)?))
}

/// Methods of this interval as the values, and of the interval that is searched.
macro_rules! of_values {
    ($($(#[doc = $doc:literal])* $name:ident;)*) => {
        #[pymethods]
        impl Interval {
            $($(#[doc = $doc])*
            #[pyo3(signature = (x=None))]
            fn $name<'py>(slf: &Bound<'py, Self>, x: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
                solved(stringify!($name), &[slf.as_any()], x)
            })*
        }
    };
}

of_values! {
    /// The members t of ``x`` (all numbers if left out) with t^2 in this interval.
    sqr_rev;
    /// The members t of ``x`` (all numbers if left out) with ``|t|`` in this interval.
    abs_rev;
    /// The members t of ``x`` (all numbers if left out) with sin t in this interval.
    sin_rev;
    /// The members t of ``x`` (all numbers if left out) with cos t in this interval.
    cos_rev;
    /// The members t of ``x`` (all numbers if left out) with tan t in this interval.
    tan_rev;
    /// The members t of ``x`` (all numbers if left out) with cosh t in this interval.
    cosh_rev;
}

/// Methods of this interval as the other operand, of the values, and of the interval that is searched.
macro_rules! of_operands {
    ($($(#[doc = $doc:literal])* $name:ident $sought:ident;)*) => {
        #[pymethods]
        impl Interval {
            $($(#[doc = $doc])*
            #[pyo3(signature = (c, $sought=None))]
            fn $name<'py>(
                slf: &Bound<'py, Self>,
                c: &Bound<'py, PyAny>,
                $sought: Option<&Bound<'py, PyAny>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                solved(stringify!($name), &[slf.as_any(), c], $sought)
            })*
        }
    };
}

of_operands! {
    /// The members t of ``x`` (all numbers if left out) with b t in ``c`` for some b of this interval.
    mul_rev x;
    /// The members t >= 0 of ``x`` (all numbers if left out) with t^y in ``c`` for some y of this interval.
    pow_rev_base x;
    /// The members t of ``x`` (all numbers if left out) with b^t in ``c`` for some b >= 0 of this interval.
    pow_rev_exponent x;
    /// The members t of ``y`` (all numbers if left out) for which the angle of (s, t) is in ``c`` for some s of this interval.
    arctan2_rev_y y;
    /// The members t of ``x`` (all numbers if left out) for which the angle of (t, s) is in ``c`` for some s of this interval.
    arctan2_rev_x x;
}

#[pymethods]
impl Interval {
    /// The members t of ``x`` (all numbers if left out) with t^n in this interval.
    #[pyo3(signature = (n, x=None))]
    fn powi_rev<'py>(
        slf: &Bound<'py, Self>,
        n: &Bound<'py, PyAny>,
        x: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if let (Ok(n), Some(operands)) = (n.extract::<i32>(), all(&[slf.as_any()], x)?) {
            let found = guarded(|| Self(operands[0].powi_rev(operands[1], n)))?;
            return Ok(Bound::new(slf.py(), found)?.into_any());
        }
        python_door(slf.py(), "_power_reverse")?.call1((slf, n, x))
    }

    /// The numbers t with b t in ``c`` for some b of this interval, as two parts: below and above a gap, the second one
    /// empty where there is none.
    fn mul_rev_to_pair<'py>(
        slf: &Bound<'py, Self>,
        c: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let b = [slf.as_any()];
        Ok((solved("mul_rev_first", &b, Some(c))?, solved("mul_rev_second", &b, Some(c))?))
    }
}
