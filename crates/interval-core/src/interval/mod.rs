//! Closed intervals of doubles: IEEE 1788-2015, one file a family of operations.
//!
//! # Names of the standard
//!
//! | IEEE 1788 | here |
//! |---|---|
//! | neg, add, sub, mul, div | operators |
//! | recip, sqr, sqrt, fma, pown, pow | [`recip`](Interval::recip), [`square`](Interval::square), [`sqrt`](Interval::sqrt), [`mul_add`](Interval::mul_add), [`powi`](Interval::powi), [`pow`](Interval::pow) |
//! | exp, exp2, exp10, log, log2, log10 | [`exp`](Interval::exp), [`exp2`](Interval::exp2), [`exp10`](Interval::exp10), [`ln`](Interval::ln), [`log2`](Interval::log2), [`log10`](Interval::log10) |
//! | sin, cos, tan, asin, acos, atan, atan2 and the hyperbolic functions | the same names |
//! | expm1, exp2m1, exp10m1, logp1, log2p1, log10p1, compoundm1 | [`exp_m1`](Interval::exp_m1), [`exp2_m1`](Interval::exp2_m1), [`exp10_m1`](Interval::exp10_m1), [`ln_1p`](Interval::ln_1p), [`log2_1p`](Interval::log2_1p), [`log10_1p`](Interval::log10_1p), [`compound_m1`](Interval::compound_m1) |
//! | rootn, rSqrt, hypot, and cbrt | [`rootn`](Interval::rootn), [`rsqrt`](Interval::rsqrt), [`hypot`](Interval::hypot), [`cbrt`](Interval::cbrt) |
//! | sinPi, cosPi, tanPi, asinPi, acosPi, atanPi, atan2Pi | [`sin_pi`](Interval::sin_pi) and so on |
//! | sec, csc, cot, acot, sech, csch, coth, acoth | the same names |
//! | sign, ceil, floor, trunc, roundTiesToEven, roundTiesToAway | [`sign`](Interval::sign), [`ceil`](Interval::ceil), [`floor`](Interval::floor), [`trunc`](Interval::trunc), [`round_ties_even`](Interval::round_ties_even), [`round`](Interval::round) |
//! | abs, min, max, intersection, convexHull | [`abs`](Interval::abs), [`min`](Interval::min), [`max`](Interval::max), [`intersection`](Interval::intersection), [`hull`](Interval::hull) |
//! | inf, sup, mid, rad, wid, mag, mig | [`lo`](Interval::lo), [`hi`](Interval::hi), [`midpoint`](Interval::midpoint), [`radius`](Interval::radius), [`width`](Interval::width), [`magnitude`](Interval::magnitude), [`mignitude`](Interval::mignitude) |
//! | equal, subset, interior, disjoint, less, precedes, strictLess, strictPrecedes, overlap | `==` and the names in snake case |
//! | cancelMinus, cancelPlus | [`cancel_minus`](Interval::cancel_minus), [`cancel_plus`](Interval::cancel_plus) |
//! | sqrRev, absRev, pownRev, sinRev, cosRev, tanRev, coshRev, mulRev, mulRevToPair | the names in snake case, [`powi_rev`](Interval::powi_rev) for pownRev |
//! | powRev1, powRev2 | [`pow_rev_base`](Interval::pow_rev_base), [`pow_rev_exponent`](Interval::pow_rev_exponent) |
//! | numsToInterval, textToInterval, intervalToExact | [`new`](Interval::new), [`from_literal`](Interval::from_literal), [`to_exact`](Interval::to_exact) |
//! | newDec, setDec, decorationPart, intervalPart, isNaI | [`DecoratedInterval`] |
//!
//! All results are the tightest intervals of doubles.

#![expect(clippy::inline_always, reason = "operations are compiled again inside functions with wider instruction sets")]

mod arithmetic;
mod assigning;
mod cancel;
#[cfg(feature = "alloc")]
mod decorated;
#[cfg(feature = "alloc")]
mod elementary;
mod fused;
#[cfg(feature = "alloc")]
mod half_turns;
mod integer;
#[cfg(feature = "alloc")]
mod less_one;
mod measures;
#[cfg(feature = "num-traits")]
mod number_traits;
#[cfg(feature = "alloc")]
mod power;
#[cfg(feature = "alloc")]
mod reciprocal;
mod relations;
#[cfg(feature = "alloc")]
mod reverse;
#[cfg(feature = "alloc")]
mod roots;
#[cfg(feature = "serde")]
mod serialize;
mod sets;
#[cfg(feature = "alloc")]
mod text;

#[cfg(feature = "alloc")]
pub use decorated::{DecoratedInterval, Decoration};
pub use measures::Measure;
pub use relations::Overlap;

use crate::error::Error;
use core::fmt;

/// A closed interval of real numbers with double bounds, possibly unbounded, possibly empty.
///
/// Invariant: either `lo <= hi`, `lo < +inf` and `hi > -inf`, or the interval is [`Interval::EMPTY`]. No bound is NaN.
///
/// # Example
/// ```
/// use interval_core::Interval;
/// let x = Interval::new(1.0, 2.0)?;
/// let y = "[0.1, 0.2]".parse::<Interval>()?;
/// assert!((x * y).contains(0.3));
/// # Ok::<(), interval_core::Error>(())
/// ```
#[derive(Clone, Copy, PartialEq)]
pub struct Interval {
    lo: f64,
    hi: f64,
}

impl Interval {
    /// No number at all; the reversed infinities make hull and intersection plain minima and maxima.
    pub const EMPTY: Self = Self { lo: f64::INFINITY, hi: f64::NEG_INFINITY };
    /// Every real number.
    pub const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// The number 0.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };
    /// The number 1.
    pub const ONE: Self = Self { lo: 1.0, hi: 1.0 };

    /// The interval from `lo` to `hi`.
    ///
    /// # Errors
    /// NaN, reversed bounds, and bounds without a finite number between them are refused.
    pub fn new(lo: f64, hi: f64) -> Result<Self, Error> {
        Self::at(lo, hi, 0)
    }

    /// The same for the entry `index` of an array, which a refusal names.
    ///
    /// # Errors
    /// As [`Interval::new`].
    pub fn at(lo: f64, hi: f64, index: usize) -> Result<Self, Error> {
        if lo.is_nan() || hi.is_nan() {
            Err(Error::NotANumber { index })
        } else if lo > hi {
            Err(Error::ReversedBounds { index })
        } else if lo == f64::INFINITY || hi == f64::NEG_INFINITY {
            Err(Error::NoFinitePoint { index })
        } else {
            Ok(Self { lo, hi })
        }
    }

    /// The interval of one number.
    ///
    /// # Errors
    /// NaN and infinities are refused.
    pub fn point(x: f64) -> Result<Self, Error> {
        Self::new(x, x)
    }

    /// The caller has established the invariant.
    pub(crate) const fn raw(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// The same for a computed result, in which no zero is negative: then equal intervals have equal bits.
    #[inline(always)]
    pub(crate) const fn made(lo: f64, hi: f64) -> Self {
        Self { lo: lo + 0.0, hi: hi + 0.0 }
    }

    /// The lower bound; +inf for the empty interval.
    #[must_use]
    pub const fn lo(self) -> f64 {
        self.lo
    }

    /// The upper bound; -inf for the empty interval.
    #[must_use]
    pub const fn hi(self) -> f64 {
        self.hi
    }
}

impl fmt::Debug for Interval {
    #[cfg(feature = "alloc")]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }

    /// The bounds as doubles are written.
    #[cfg(not(feature = "alloc"))]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{:?}, {:?}]", self.lo, self.hi)
    }
}
