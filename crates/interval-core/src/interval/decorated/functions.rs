//! Operations on decorated intervals: that of the interval with the decoration that it has on the box.

use super::{DecoratedInterval, Decoration};
use crate::interval::Interval;
#[cfg(not(feature = "std"))]
use crate::software::Real as _;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// `com` on the domain, nothing outside.
fn on_domain(inside: bool) -> Decoration {
    if inside { Decoration::Com } else { Decoration::Trv }
}

/// The decoration of a step function: constant on the box it is continuous there, and at its ends too unless a step
/// lies on one of them.
fn steps(result: Interval, step_at_end: bool) -> Decoration {
    match (result.is_singleton(), step_at_end) {
        (false, _) => Decoration::Def,
        (true, true) => Decoration::Dac,
        (true, false) => Decoration::Com,
    }
}

/// The decoration of the angle of the points of a box: none at the origin, and a jump across the negative half axis.
fn turning(y: Interval, x: Interval) -> Decoration {
    if y.contains(0.0) && x.contains(0.0) {
        Decoration::Trv
    } else if y.contains(0.0) && x.lo < 0.0 {
        if y.lo < 0.0 { Decoration::Def } else { Decoration::Dac }
    } else {
        Decoration::Com
    }
}

/// Operations of one operand with their local decoration.
macro_rules! unary {
    ($($(#[$doc:meta])* $name:ident => |$x:ident, $result:ident| $local:expr;)*) => {
        impl DecoratedInterval {
            $($(#[$doc])*
            #[must_use]
            pub fn $name(self) -> Self {
                let $x = self.interval;
                let $result = $x.$name();
                Self::carry(&[self], $result, $local)
            })*
        }
    };
}

unary! {
    /// [`Interval::abs`].
    abs => |_x, _r| Decoration::Com;
    /// [`Interval::square`].
    square => |_x, _r| Decoration::Com;
    /// [`Interval::recip`].
    recip => |x, _r| on_domain(!x.contains(0.0));
    /// [`Interval::sqrt`].
    sqrt => |x, _r| on_domain(x.lo >= 0.0);
    /// [`Interval::exp`].
    exp => |_x, _r| Decoration::Com;
    /// [`Interval::exp2`].
    exp2 => |_x, _r| Decoration::Com;
    /// [`Interval::exp10`].
    exp10 => |_x, _r| Decoration::Com;
    /// [`Interval::ln`].
    ln => |x, _r| on_domain(x.lo > 0.0);
    /// [`Interval::log2`].
    log2 => |x, _r| on_domain(x.lo > 0.0);
    /// [`Interval::log10`].
    log10 => |x, _r| on_domain(x.lo > 0.0);
    /// [`Interval::sin`].
    sin => |_x, _r| Decoration::Com;
    /// [`Interval::cos`].
    cos => |_x, _r| Decoration::Com;
    /// [`Interval::tan`].
    tan => |_x, r| on_domain(!r.is_entire());
    /// [`Interval::asin`].
    asin => |x, _r| on_domain(x.subset(Interval::UNIT));
    /// [`Interval::acos`].
    acos => |x, _r| on_domain(x.subset(Interval::UNIT));
    /// [`Interval::atan`].
    atan => |_x, _r| Decoration::Com;
    /// [`Interval::sinh`].
    sinh => |_x, _r| Decoration::Com;
    /// [`Interval::cosh`].
    cosh => |_x, _r| Decoration::Com;
    /// [`Interval::tanh`].
    tanh => |_x, _r| Decoration::Com;
    /// [`Interval::asinh`].
    asinh => |_x, _r| Decoration::Com;
    /// [`Interval::acosh`].
    acosh => |x, _r| on_domain(x.lo >= 1.0);
    /// [`Interval::atanh`].
    atanh => |x, _r| on_domain(-1.0 < x.lo && x.hi < 1.0);
    /// [`Interval::exp_m1`].
    exp_m1 => |_x, _r| Decoration::Com;
    /// [`Interval::exp2_m1`].
    exp2_m1 => |_x, _r| Decoration::Com;
    /// [`Interval::exp10_m1`].
    exp10_m1 => |_x, _r| Decoration::Com;
    /// [`Interval::ln_1p`].
    ln_1p => |x, _r| on_domain(x.lo > -1.0);
    /// [`Interval::log2_1p`].
    log2_1p => |x, _r| on_domain(x.lo > -1.0);
    /// [`Interval::log10_1p`].
    log10_1p => |x, _r| on_domain(x.lo > -1.0);
    /// [`Interval::cbrt`].
    cbrt => |_x, _r| Decoration::Com;
    /// [`Interval::rsqrt`].
    rsqrt => |x, _r| on_domain(x.lo > 0.0);
    /// [`Interval::sin_pi`].
    sin_pi => |_x, _r| Decoration::Com;
    /// [`Interval::cos_pi`].
    cos_pi => |_x, _r| Decoration::Com;
    /// [`Interval::tan_pi`].
    tan_pi => |_x, r| on_domain(r.is_bounded());
    /// [`Interval::asin_pi`].
    asin_pi => |x, _r| on_domain(x.subset(Interval::UNIT));
    /// [`Interval::acos_pi`].
    acos_pi => |x, _r| on_domain(x.subset(Interval::UNIT));
    /// [`Interval::atan_pi`].
    atan_pi => |_x, _r| Decoration::Com;
    /// [`Interval::sec`].
    sec => |_x, r| on_domain(!r.is_entire());
    /// [`Interval::csc`].
    csc => |x, r| on_domain(!r.is_entire() && !x.contains(0.0));
    /// [`Interval::cot`].
    cot => |x, r| on_domain(!r.is_entire() && !x.contains(0.0));
    /// [`Interval::acot`].
    acot => |_x, _r| Decoration::Com;
    /// [`Interval::sech`].
    sech => |_x, _r| Decoration::Com;
    /// [`Interval::csch`].
    csch => |x, _r| on_domain(!x.contains(0.0));
    /// [`Interval::coth`].
    coth => |x, _r| on_domain(!x.contains(0.0));
    /// [`Interval::acoth`].
    acoth => |x, _r| on_domain(x.lo > 1.0 || x.hi < -1.0);
    /// [`Interval::sign`].
    sign => |x, r| steps(r, x.contains(0.0));
    /// [`Interval::ceil`].
    ceil => |x, r| steps(r, x.hi.fract() == 0.0);
    /// [`Interval::floor`].
    floor => |x, r| steps(r, x.lo.fract() == 0.0);
    /// [`Interval::trunc`].
    trunc => |x, r| steps(r, (x.lo > 0.0 && x.lo.fract() == 0.0) || (x.hi < 0.0 && x.hi.fract() == 0.0));
    /// [`Interval::round_ties_even`].
    round_ties_even => |x, r| steps(r, x.lo.fract().abs() == 0.5 || x.hi.fract().abs() == 0.5);
    /// [`Interval::round`].
    round => |x, r| steps(r, x.lo.fract().abs() == 0.5 || x.hi.fract().abs() == 0.5);
}

/// Operations of two operands with their local decoration.
macro_rules! binary {
    ($($(#[$doc:meta])* $name:ident => |$x:ident, $y:ident| $local:expr;)*) => {
        impl DecoratedInterval {
            $($(#[$doc])*
            #[must_use]
            pub fn $name(self, other: Self) -> Self {
                let ($x, $y) = (self.interval, other.interval);
                Self::carry(&[self, other], $x.$name($y), $local)
            })*
        }
    };
}

binary! {
    /// [`Interval::min`].
    min => |_x, _y| Decoration::Com;
    /// [`Interval::max`].
    max => |_x, _y| Decoration::Com;
    /// [`Interval::pow`].
    pow => |x, y| on_domain(x.lo > 0.0 || (x.lo == 0.0 && y.lo > 0.0));
    /// [`Interval::atan2`], `self` being y.
    atan2 => |y, x| turning(y, x);
    /// [`Interval::atan2_pi`], `self` being y.
    atan2_pi => |y, x| turning(y, x);
    /// [`Interval::hypot`].
    hypot => |_x, _y| Decoration::Com;
    /// [`Interval::compound_m1`].
    compound_m1 => |x, y| on_domain(x.lo > -1.0 || (x.lo == -1.0 && y.lo > 0.0));
    /// [`Interval::intersection`].
    intersection => |_x, _y| Decoration::Trv;
    /// [`Interval::hull`].
    hull => |_x, _y| Decoration::Trv;
    /// [`Interval::cancel_minus`].
    cancel_minus => |_x, _y| Decoration::Trv;
    /// [`Interval::cancel_plus`].
    cancel_plus => |_x, _y| Decoration::Trv;
    /// [`Interval::sqr_rev`].
    sqr_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::abs_rev`].
    abs_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::sin_rev`].
    sin_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::cos_rev`].
    cos_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::tan_rev`].
    tan_rev => |_x, _y| Decoration::Trv;
    /// [`Interval::cosh_rev`].
    cosh_rev => |_x, _y| Decoration::Trv;
}

impl DecoratedInterval {
    /// [`Interval::powi`].
    #[must_use]
    pub fn powi(self, n: i32) -> Self {
        let local = on_domain(n >= 0 || !self.interval.contains(0.0));
        Self::carry(&[self], self.interval.powi(n), local)
    }

    /// [`Interval::rootn`].
    #[must_use]
    pub fn rootn(self, n: i32) -> Self {
        let x = self.interval;
        let inside = n != 0 && (n % 2 != 0 || x.lo >= 0.0) && (n > 0 || !x.contains(0.0));
        Self::carry(&[self], x.rootn(n), on_domain(inside))
    }

    /// [`Interval::mul_add`].
    #[must_use]
    pub fn mul_add(self, y: Self, z: Self) -> Self {
        Self::carry(&[self, y, z], self.interval.mul_add(y.interval, z.interval), Decoration::Com)
    }

    /// [`Interval::powi_rev`].
    #[must_use]
    pub fn powi_rev(self, x: Self, n: i32) -> Self {
        Self::trivial(&[self, x], self.interval.powi_rev(x.interval, n))
    }

    /// [`Interval::mul_rev`].
    #[must_use]
    pub fn mul_rev(self, c: Self, x: Self) -> Self {
        Self::trivial(&[self, c, x], self.interval.mul_rev(c.interval, x.interval))
    }

    /// [`Interval::pow_rev_base`].
    #[must_use]
    pub fn pow_rev_base(self, c: Self, x: Self) -> Self {
        Self::trivial(&[self, c, x], self.interval.pow_rev_base(c.interval, x.interval))
    }

    /// [`Interval::pow_rev_exponent`].
    #[must_use]
    pub fn pow_rev_exponent(self, c: Self, x: Self) -> Self {
        Self::trivial(&[self, c, x], self.interval.pow_rev_exponent(c.interval, x.interval))
    }

    /// [`Interval::atan2_rev_y`].
    #[must_use]
    pub fn atan2_rev_y(self, c: Self, y: Self) -> Self {
        Self::trivial(&[self, c, y], self.interval.atan2_rev_y(c.interval, y.interval))
    }

    /// [`Interval::atan2_rev_x`].
    #[must_use]
    pub fn atan2_rev_x(self, c: Self, x: Self) -> Self {
        Self::trivial(&[self, c, x], self.interval.atan2_rev_x(c.interval, x.interval))
    }

    /// [`Interval::mul_rev_to_pair`]: where the divisor excludes zero the first part is a quotient and decorated as one.
    #[must_use]
    pub fn mul_rev_to_pair(self, c: Self) -> [Self; 2] {
        let [first, second] = self.interval.mul_rev_to_pair(c.interval);
        let local = on_domain(!self.interval.contains(0.0));
        [Self::carry(&[self, c], first, local), Self::trivial(&[self, c], second)]
    }
}

impl Neg for DecoratedInterval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { interval: -self.interval, ..self }
    }
}

impl Add for DecoratedInterval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::carry(&[self, other], self.interval + other.interval, Decoration::Com)
    }
}

impl Sub for DecoratedInterval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::carry(&[self, other], self.interval - other.interval, Decoration::Com)
    }
}

impl Mul for DecoratedInterval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::carry(&[self, other], self.interval * other.interval, Decoration::Com)
    }
}

impl Div for DecoratedInterval {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let local = on_domain(!other.interval.contains(0.0));
        Self::carry(&[self, other], self.interval / other.interval, local)
    }
}
