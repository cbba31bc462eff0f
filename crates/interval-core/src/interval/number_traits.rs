//! `num-traits`: those whose laws intervals keep, so that generic sums, products and nalgebra's matrices take them.
//!
//! [`Zero`] and [`One`] are neutral to the bit, [`Inv`], [`Pow`] and [`MulAdd`] are the tightest functions of the same names.
//! Traits of ordered fields (`Num`, `Real`, `Float`, `Signed`) are left out: they promise a total order, a remainder, or
//! `x - x = 0`, which no interval keeps. With the assigning operators, the traits of `simba` for closed operations follow by
//! themselves.

use super::Interval;
use num_traits::{Inv, MulAdd, MulAddAssign, One, Pow, Zero};

impl Zero for Interval {
    fn zero() -> Self {
        Self::ZERO
    }

    /// True for the interval of the number 0 alone.
    fn is_zero(&self) -> bool {
        *self == Self::ZERO
    }
}

impl One for Interval {
    fn one() -> Self {
        Self::ONE
    }
}

impl Inv for Interval {
    type Output = Self;

    fn inv(self) -> Self {
        self.recip()
    }
}

impl Pow<i32> for Interval {
    type Output = Self;

    fn pow(self, n: i32) -> Self {
        self.powi(n)
    }
}

impl Pow<Interval> for Interval {
    type Output = Self;

    fn pow(self, y: Self) -> Self {
        Self::pow(self, y)
    }
}

impl MulAdd for Interval {
    type Output = Self;

    fn mul_add(self, a: Self, b: Self) -> Self {
        Self::mul_add(self, a, b)
    }
}

impl MulAddAssign for Interval {
    fn mul_add_assign(&mut self, a: Self, b: Self) {
        *self = Self::mul_add(*self, a, b);
    }
}
