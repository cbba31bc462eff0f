//! Elementary functions of one double, rounded down and up: both always the tightest doubles.
//!
//! Each function is evaluated in double-double arithmetic with a proved relative error, written beside the code. If
//! that error cannot tell the two neighbours apart (about once in ten thousand arguments), integer ball arithmetic with
//! sufficient bits decides. The arguments at which a transcendental function takes the value of a double are few
//! (Lindemann, Gelfond-Schneider) and handled by name, so the last resort always ends.
//!
//! All functions are total: limits stand at infinite arguments. Domains are the business of [`crate::Interval`].

#![expect(clippy::inline_always, reason = "kernels are compiled again inside functions with wider instruction sets")]

mod arctangent;
mod ball;
mod double_double;
mod exponential;
mod half_turns;
mod less_one;
mod logarithm;
mod multiprecision;
mod plus_one;
mod power;
mod reciprocal;
mod roots;
mod tables;
mod trigonometric;

use crate::doubles::{Neighbours as _, signed, unsigned};

pub(crate) use arctangent::{acos, asin, atan, atan2};
pub(crate) use ball::Ball;
pub(crate) use double_double::{Dd, two_sum};
#[cfg(avx2)]
pub(crate) use exponential::ERROR as EXP_ERROR;
pub(crate) use exponential::{cosh, exp, exp2, exp10, sinh, tanh};
pub(crate) use half_turns::{HalfTurns, acos_pi, asin_pi, atan_pi, atan2_pi};
pub(crate) use less_one::{compound_m1, exp_m1, exp2_m1, exp10_m1};
#[cfg(avx2)]
pub(crate) use logarithm::DERIVED_ERROR as LOG_ERROR;
pub(crate) use logarithm::{acosh, asinh, atanh, log, log2, log10};
pub(crate) use multiprecision::{Bracket, atan2 as ball_atan2, pi, settle};
pub(crate) use plus_one::{ln_1p, log2_1p, log10_1p};
pub(crate) use power::{log_ratio, pow, pown, root};
pub(crate) use reciprocal::{acoth, cot, coth, csc, csch, sec, sech};
pub(crate) use roots::{hypot, rootn, rsqrt};
pub use tables::source;
#[cfg(avx2)]
pub(crate) use tables::{LOG_FIRST, TABLES};
#[cfg(avx2)]
pub(crate) use trigonometric::ERROR as WAVE_ERROR;
pub(crate) use trigonometric::{Angle, Turning, exactly};

impl Bracket {
    pub(crate) const fn exact(x: f64) -> Self {
        Self { down: x, up: x }
    }

    /// True if the ends are equal or neighbours, as they are but for arguments that no attempt could settle.
    pub(crate) fn is_tight(self) -> bool {
        self.down == self.up || self.down.above() == self.up
    }

    /// The value lies strictly between `x` and the next double away from zero.
    #[inline(always)]
    fn beyond(x: f64) -> Self {
        if x > 0.0 { Self { down: x, up: x.above() } } else { Self { down: x.below(), up: x } }
    }

    /// The value lies strictly between `x` and the next double towards zero.
    #[inline(always)]
    fn within(x: f64) -> Self {
        if x > 0.0 { Self { down: x.below(), up: x } } else { Self { down: x, up: x.above() } }
    }

    pub(crate) fn neg(self) -> Self {
        Self { down: -self.up, up: -self.down }
    }

    /// Times `2^power`, where both ends stay normal.
    #[inline(always)]
    fn scale(self, power: i64) -> Self {
        let factor = power_of_two(power);
        Self { down: self.down * factor, up: self.up * factor }
    }
}

/// `2^k` for a normal result.
#[inline(always)]
fn power_of_two(k: i64) -> f64 {
    f64::from_bits(unsigned(k + 1023) << 52)
}

/// The roundings of a normal number within `|v| error` of `v`, where the error leaves no choice.
///
/// `hi` is the double nearest to `v`: if the number lies above `hi` it lies below the next double, and so downwards.
#[inline(always)]
fn decide(v: Dd, error: f64) -> Option<Bracket> {
    let margin = v.hi.abs() * error;
    if v.lo > margin {
        Some(Bracket { down: v.hi, up: v.hi.above() })
    } else if v.lo < -margin {
        Some(Bracket { down: v.hi.below(), up: v.hi })
    } else {
        None
    }
}

/// `mantissa` in [1, 2) and `exponent` of a positive finite double.
#[inline(always)]
fn split(x: f64) -> (f64, i64) {
    let (x, offset) = if x < f64::MIN_POSITIVE { (x * 18_014_398_509_481_984.0, 54) } else { (x, 0) };
    let bits = x.to_bits();
    let exponent = signed(bits >> 52) - 1023 - offset;
    (f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000), exponent)
}

/// The integer nearest to `x`, `|x| < 2^51`, as a double.
#[inline(always)]
fn nearest(x: f64) -> f64 {
    // 1.5 * 2^52: the doubles about it are the integers, so a sum with it is rounded to an integer.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    (x + SHIFT) - SHIFT
}
