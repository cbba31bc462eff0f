//! Operators that assign, and sums and products of iterators, term by term. [`crate::reductions`] has sums that are rounded
//! once.

use super::Interval;
use core::iter::{Product, Sum};
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Sub, SubAssign};

macro_rules! assigning {
    ($($trait:ident $method:ident $operator:path;)*) => {$(
        impl $trait for Interval {
            #[inline]
            fn $method(&mut self, other: Self) {
                *self = $operator(*self, other);
            }
        }
    )*};
}

assigning! {
    AddAssign add_assign Add::add;
    SubAssign sub_assign Sub::sub;
    MulAssign mul_assign Mul::mul;
    DivAssign div_assign Div::div;
}

impl Sum for Interval {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::ZERO, Add::add)
    }
}

impl Product for Interval {
    fn product<I: Iterator<Item = Self>>(factors: I) -> Self {
        factors.fold(Self::ONE, Mul::mul)
    }
}
