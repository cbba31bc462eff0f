//! Unevaluated sums of two doubles: about 106 bits, for the values that a rounding is decided on.
//!
//! With u = 2^-53 and fused products the relative errors are at most 4 u^2 for a sum, 5 u^2 for a product, 16 u^2
//! for a quotient and 4 u^2 for a square root, barring underflow (Joldes, Muller, Popescu, *ACM TOMS* 44 (2017), 15).
//! Every function here is called with operands that keep the error terms above 2^-1022.

#[cfg(not(feature = "std"))]
use crate::software::Real as _;
use core::ops::{Add, Mul, Neg, Sub};

/// `hi + lo`, with `hi` the double nearest to the sum.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DoubleDouble {
    pub hi: f64,
    pub lo: f64,
}

pub(crate) use DoubleDouble as Dd;

/// `a + b` exactly, for `|a| >= |b|` or `a = 0`.
#[inline(always)]
pub(crate) fn fast_two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    Dd { hi, lo: b - (hi - a) }
}

/// `a + b` exactly.
#[inline(always)]
pub(crate) fn two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    let b_part = hi - a;
    let a_part = hi - b_part;
    Dd { hi, lo: (a - a_part) + (b - b_part) }
}

/// `a b` exactly.
#[inline(always)]
pub(crate) fn two_product(a: f64, b: f64) -> Dd {
    let hi = a * b;
    Dd { hi, lo: a.mul_add(b, -hi) }
}

impl Dd {
    pub const ONE: Self = Self { hi: 1.0, lo: 0.0 };

    #[inline(always)]
    pub const fn from(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }

    /// Times a power of two.
    #[inline(always)]
    pub fn scale(self, power: f64) -> Self {
        Self { hi: self.hi * power, lo: self.lo * power }
    }

    #[inline(always)]
    pub fn add_f64(self, b: f64) -> Self {
        let s = two_sum(self.hi, b);
        fast_two_sum(s.hi, self.lo + s.lo)
    }

    #[inline(always)]
    pub fn mul_f64(self, b: f64) -> Self {
        let p = two_product(self.hi, b);
        fast_two_sum(p.hi, self.lo.mul_add(b, p.lo))
    }

    #[inline(always)]
    pub fn square(self) -> Self {
        self * self
    }

    #[inline(always)]
    pub fn div(self, b: Self) -> Self {
        let q = self.hi / b.hi;
        let r = self - b.mul_f64(q);
        fast_two_sum(q, r.hi / b.hi)
    }

    #[inline(always)]
    pub fn sqrt(self) -> Self {
        if self.hi == 0.0 {
            return self;
        }
        let root = self.hi.sqrt();
        let residual = (-root).mul_add(root, self.hi) + self.lo;
        fast_two_sum(root, residual / (2.0 * root))
    }

    /// The same with the sign of `s`, for a non-negative number.
    #[inline(always)]
    pub fn with_sign(self, s: f64) -> Self {
        if s < 0.0 { -self } else { self }
    }
}

impl Neg for Dd {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for Dd {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        let s = two_sum(self.hi, b.hi);
        let t = two_sum(self.lo, b.lo);
        let v = fast_two_sum(s.hi, s.lo + t.hi);
        fast_two_sum(v.hi, t.lo + v.lo)
    }
}

impl Sub for Dd {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for Dd {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        let p = two_product(self.hi, b.hi);
        let cross = self.hi.mul_add(b.lo, self.lo * b.hi);
        fast_two_sum(p.hi, p.lo + cross)
    }
}
