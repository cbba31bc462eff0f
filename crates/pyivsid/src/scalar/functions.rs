//! Functions of one interval, as a table.

use super::{Interval, guarded};
use pyo3::prelude::*;

/// Methods of one operand, by name.
macro_rules! functions {
    ($($(#[doc = $doc:literal])* $name:ident $core:ident;)*) => {
        #[pymethods]
        impl Interval {
            $($(#[doc = $doc])*
            fn $name(&self) -> PyResult<Self> {
                guarded(self.0.$core())
            })*
        }
    };
}

functions! {
    /// The square root of the members that are not negative.
    sqrt sqrt;
    /// The squares of the members.
    square square;
    /// ``x |x|``, the quadratic drag law.
    signed_square signed_square;
    /// The reciprocals of the members other than 0.
    reciprocal recip;
    /// The exponentials.
    exp exp;
    /// Powers of 2.
    exp2 exp2;
    /// Powers of 10.
    exp10 exp10;
    /// Natural logarithms of the positive members.
    log ln;
    /// Logarithms to base 2 of the positive members.
    log2 log2;
    /// Logarithms to base 10 of the positive members.
    log10 log10;
    /// Sines, of radians.
    sin sin;
    /// Cosines, of radians.
    cos cos;
    /// Tangents, of radians.
    tan tan;
    /// Arc sines of the members in [-1, 1].
    arcsin asin;
    /// Arc cosines of the members in [-1, 1].
    arccos acos;
    /// Arc tangents.
    arctan atan;
    /// Hyperbolic sines.
    sinh sinh;
    /// Hyperbolic cosines.
    cosh cosh;
    /// Hyperbolic tangents.
    tanh tanh;
    /// Inverse hyperbolic sines.
    arcsinh asinh;
    /// Inverse hyperbolic cosines of the members from 1 on.
    arccosh acosh;
    /// Inverse hyperbolic tangents of the members in (-1, 1).
    arctanh atanh;
}
