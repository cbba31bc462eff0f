//! Elementary functions of vectors of intervals: the double-double kernels of [`crate::elementary`], lane by lane.
//!
//! A kernel gives both bounds and the lanes in which they are certain: operands in the range of the kernel, and values
//! whose error leaves no choice of the rounding (Ziv's test). The other lanes, some in 65,000 of ordinary operands, are
//! computed by the functions of one interval. Bounds of both are the tightest, so the bits agree.

mod double_double;
mod exponential;
mod fused;
mod logarithm;
mod tables;
mod trigonometric;

pub(super) use fused::{Fused, MANTISSA, ONE_EXPONENT, SHIFT_BITS, SHIFTED_BIAS, last_index};

use super::kernel::Lanes;
use super::operations::{Bounds, BoundsMut, Unary};
use crate::error::Error;
use crate::interval::Interval;
use tables::COLUMNS;

// A macro, because a function passed as a value would be compiled without the features of the caller.
macro_rules! blocks {
    ($lanes:ty, $x:ident, $out:ident, |$a:ident, $b:ident| $fast:expr, $slow:expr) => {{
        let n = <$lanes as Lanes>::N;
        let mut start = 0;
        let operands = $x.lo.chunks_exact(n).zip($x.hi.chunks_exact(n));
        let results = $out.lo.chunks_exact_mut(n).zip($out.hi.chunks_exact_mut(n));
        for ((a, b), (low, high)) in operands.zip(results) {
            let ($a, $b) = (<$lanes as Lanes>::load(a), <$lanes as Lanes>::load(b));
            let (lo, hi, known) = $fast;
            lo.store(low);
            hi.store(high);
            let mut rest = <$lanes>::flags(<$lanes>::not(known));
            while rest != 0 {
                let k = rest.trailing_zeros() as usize;
                let result: Interval = $slow($x.get(start + k)?);
                (low[k], high[k]) = (result.lo(), result.hi());
                rest &= rest - 1;
            }
            start += n;
        }
        for k in start..$x.lo.len() {
            $out.set(k, $slow($x.get(k)?));
        }
        Ok(())
    }};
}

/// An elementary function on vectors `L`, others one by one.
#[inline(always)]
pub(super) fn unary_on<L: Fused>(op: Unary, x: Bounds<'_>, mut out: BoundsMut<'_>) -> Result<(), Error> {
    let columns = &COLUMNS;
    match op {
        Unary::Exp => blocks!(L, x, out, |a, b| exponential::exp(a, b, columns), Interval::exp),
        Unary::Ln => blocks!(L, x, out, |a, b| logarithm::ln(a, b, columns), Interval::ln),
        Unary::Sin => blocks!(L, x, out, |a, b| trigonometric::wave(a, b, 1.0, columns), Interval::sin),
        Unary::Cos => blocks!(L, x, out, |a, b| trigonometric::wave(a, b, 0.0, columns), Interval::cos),
        Unary::Tan => blocks!(L, x, out, |a, b| trigonometric::tan(a, b, columns), Interval::tan),
        _ => op.one_by_one(x, out),
    }
}
