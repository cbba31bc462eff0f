//! Bounds that multipliers prove, in directed rounding.
//!
//! For multipliers `l >= 0` of half-spaces `g x <= h` and an objective `c`, every point of their intersection has
//! `c x >= (c + G'l) x - h l`. Over a box the first term has a least value, so that any multipliers prove a bound, and a
//! near-zero residual a sharp one (Neumaier and Shcherbina, *Math. Prog.* 99 (2004) 283-296). Multipliers of the ends of
//! the box need not be named: they are in the residual.

use crate::bounds::Bounds;
use interval_core::rounding::{add_down, add_up, mul_down, mul_up, sub_down};

/// A weighted sum of half-spaces, enclosed.
pub(crate) struct Combination<const N: usize> {
    lower: [f64; N],
    upper: [f64; N],
    /// An upper bound of `h l`.
    right: f64,
}

impl<const N: usize> Combination<N> {
    /// The objective alone.
    pub(crate) fn new(objective: [f64; N]) -> Self {
        Self { lower: objective, upper: objective, right: 0.0 }
    }

    /// Adds `weight` times `g x <= h`. Weights that are not positive numbers add nothing.
    pub(crate) fn add(&mut self, weight: f64, g: &[f64; N], h: f64) {
        if weight > 0.0 && weight.is_finite() {
            for j in 0..N {
                self.lower[j] = add_down(self.lower[j], mul_down(weight, g[j]));
                self.upper[j] = add_up(self.upper[j], mul_up(weight, g[j]));
            }
            self.right = add_up(self.right, mul_up(weight, h));
        }
    }

    /// A lower bound of the objective over the points of the box that the half-spaces hold; -inf if a sum overflows.
    pub(crate) fn least(&self, region: &[Bounds; N]) -> f64 {
        if !(self.lower.iter().chain(&self.upper).all(|x| x.is_finite()) && self.right < f64::INFINITY) {
            return f64::NEG_INFINITY;
        }
        let mut sum = 0.0;
        for j in 0..N {
            sum = add_down(sum, least_product(self.lower[j], self.upper[j], region[j]));
        }
        let bound = sub_down(sum, self.right);
        if bound.is_nan() { f64::NEG_INFINITY } else { bound }
    }
}

/// The least product of a number of `[low, high]` and one of `x`, rounded down.
fn least_product(low: f64, high: f64, x: Bounds) -> f64 {
    if low == 0.0 && high == 0.0 {
        return 0.0;
    }
    let a = mul_down(low, x.lo).min(mul_down(low, x.hi));
    let b = mul_down(high, x.lo).min(mul_down(high, x.hi));
    a.min(b)
}
