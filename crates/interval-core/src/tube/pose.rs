//! Heading and position after a step: integrals of velocities whose ranges are known.
//!
//! **Theorem (Taylor's formula of first order in time).** If `q' = k(t)` and `k' in K'` almost everywhere over the step,
//! then `q(H) - q(0)` lies in `H k(0) + [0, H^2 / 2] (least and largest of K', hulled with 0 at neither end)`, that is
//! in `H K + (H^2 / 2) K'` with `K` the range of `k(0)`. The heading has `k = r`. The position has
//! `k = u cos psi - v sin psi` and `u sin psi + v cos psi`, whose rates follow from the accelerations and from `psi' = r`.

use super::enclosure::Enclosure;
use super::model::Three;
use crate::interval::Interval;

/// Heading [rad] and position [m] north and east after a step.
pub fn advance(pose: &Three, start: &Three, step: &Enclosure, h: Interval) -> Three {
    let [u, v, r] = *start;
    let [du, dv, dr] = step.rates;
    let square = h.square() * Interval::raw(0.5, 0.5);
    let span = Interval::raw(0.0, h.hi());
    let psi = pose[0] + (h * r + square * dr);
    let (c, s) = (pose[0].cos(), pose[0].sin());
    // Over the step the heading runs through this range.
    let over = pose[0] + span * step.nu[2];
    let (co, so) = (over.cos(), over.sin());
    let [wu, wv, wr] = step.nu;
    let (surge, sway) = (du - wr * wv, dv + wr * wu);
    let north = h * (u * c - v * s) + square * (surge * co - sway * so);
    let east = h * (u * s + v * c) + square * (surge * so + sway * co);
    [psi, pose[1] + north, pose[2] + east]
}
