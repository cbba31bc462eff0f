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
                guarded(|| Self(self.0.$core()))
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
    /// Exponentials less 1.
    expm1 exp_m1;
    /// Powers of 2 less 1.
    exp2m1 exp2_m1;
    /// Powers of 10 less 1.
    exp10m1 exp10_m1;
    /// Natural logarithms of 1 plus the members above -1.
    log1p ln_1p;
    /// Logarithms to base 2 of 1 plus the members above -1.
    log2p1 log2_1p;
    /// Logarithms to base 10 of 1 plus the members above -1.
    log10p1 log10_1p;
    /// Cube roots.
    cbrt cbrt;
    /// Reciprocals of the square roots of the positive members.
    rsqrt rsqrt;
    /// Sines, of half turns.
    sinpi sin_pi;
    /// Cosines, of half turns.
    cospi cos_pi;
    /// Tangents, of half turns.
    tanpi tan_pi;
    /// Arc sines in half turns of the members in [-1, 1].
    arcsinpi asin_pi;
    /// Arc cosines in half turns of the members in [-1, 1].
    arccospi acos_pi;
    /// Arc tangents in half turns.
    arctanpi atan_pi;
    /// Reciprocals of the cosines, of radians.
    sec sec;
    /// Reciprocals of the sines, of radians.
    csc csc;
    /// Cotangents, of radians.
    cot cot;
    /// Arc cotangents in (0, pi).
    arccot acot;
    /// Reciprocals of the hyperbolic cosines.
    sech sech;
    /// Reciprocals of the hyperbolic sines of the members other than 0.
    csch csch;
    /// Hyperbolic cotangents of the members other than 0.
    coth coth;
    /// Inverse hyperbolic cotangents of the members outside [-1, 1].
    arccoth acoth;
}
