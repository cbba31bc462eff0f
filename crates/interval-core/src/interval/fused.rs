//! `x y + z` with one rounding an end.

use super::Interval;
use crate::rounding::{fma_down, fma_up};

impl Interval {
    /// `{x y + z}`, rounded once: never wider than a product and a sum.
    ///
    /// ```
    /// # use interval_core::Interval;
    /// let tenth: Interval = "0.1".parse()?;
    /// assert!(tenth.mul_add(tenth, -tenth).subset(tenth * tenth - tenth));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn mul_add(self, y: Self, z: Self) -> Self {
        if self.is_empty() || y.is_empty() || z.is_empty() {
            return Self::EMPTY;
        }
        let corners = [(self.lo, y.lo), (self.lo, y.hi), (self.hi, y.lo), (self.hi, y.hi)];
        let lo = corners.iter().map(|&(p, q)| down(p, q, z.lo)).fold(f64::INFINITY, f64::min);
        let hi = corners.iter().map(|&(p, q)| up(p, q, z.hi)).fold(f64::NEG_INFINITY, f64::max);
        Self::made(lo, hi)
    }
}

/// `p q + c` rounded down for a lower bound `c`: an infinite bound is never attained, so `0 inf` is 0, and where a
/// corner is +inf another is the least.
fn down(p: f64, q: f64, c: f64) -> f64 {
    if c == f64::NEG_INFINITY || p == 0.0 || q == 0.0 { c } else { fma_down(p, q, c) }
}

fn up(p: f64, q: f64, c: f64) -> f64 {
    if c == f64::INFINITY || p == 0.0 || q == 0.0 { c } else { fma_up(p, q, c) }
}
