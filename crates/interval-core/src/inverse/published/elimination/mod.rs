//! Orders above 3: Gauss-Jordan elimination in place, with fused products on every back end.
//!
//! Small orders put one member into each lane, all with the pivots of the midpoint. If a pivot of a lane is much
//! smaller than the midpoint's, that member alone is inverted again with its own pivots. Larger orders keep one member
//! in cache and eliminate along its rows, each with its own pivots.

mod by_lanes;
mod by_rows;

use super::{Extremes, Form};
use crate::approximate;
use crate::matrix::IntervalMatrix;
use crate::rounding::slices::Backend;
use std::ops::Range;

/// The largest order with one member a lane: its vectors fit the first cache.
const LANES_LIMIT: usize = 20;
/// The least ratio of a lane's pivot to the midpoint's: 2^-8 costs the elimination about eight bits.
const PIVOT_LOSS: f64 = 1.0 / 256.0;

/// The step between members, and how the midpoint is eliminated.
pub(super) struct Plan {
    n: usize,
    partitions: u64,
    /// The published step `Delta / N`, row-major.
    step: Vec<f64>,
    /// The order of the rows of `A` that puts the pivots of the midpoint on the diagonal, and the least pivots allowed.
    order: Vec<usize>,
    pivots: Vec<f64>,
}

impl Plan {
    pub(super) fn new(a: &IntervalMatrix, partitions: u64) -> Self {
        let n = a.rows();
        #[expect(clippy::cast_precision_loss, reason = "the published step is a plain float; nothing is claimed of it")]
        let step = a.lo().iter().zip(a.hi()).map(|(l, h)| (0.5 * h - 0.5 * l) / partitions as f64).collect();
        let (order, pivots) = approximate::pivots(&a.midpoint(), n);
        let pivots = pivots.into_iter().map(|p| p * PIVOT_LOSS).collect();
        Self { n, partitions, step, order, pivots }
    }

    /// Extremes over the members `j` of both sets; false at a singular one.
    pub(super) fn extremes(
        &self,
        backend: Backend,
        a: &IntervalMatrix,
        form: Form,
        range: Range<u64>,
        found: &mut Extremes,
    ) -> bool {
        let hull = form == Form::Hull;
        if self.n <= LANES_LIMIT {
            by_lanes::sweep(backend, self, a, hull, range, found)
        } else {
            by_rows::sweep(backend, self, a, hull, range, found)
        }
    }

    /// The number of steps from member `j` to the end of its set.
    #[expect(clippy::cast_precision_loss, reason = "the published sweep is a computation in floats")]
    #[inline]
    fn shift(&self, j: u64) -> f64 {
        (self.partitions - j) as f64
    }
}

/// True if all extremes that were looked for are finite.
fn finite(found: &Extremes, hull: bool) -> bool {
    let finite = |x: &[f64]| x.iter().all(|v| v.is_finite());
    let literal = finite(&found.infima.lower) && finite(&found.suprema.upper);
    literal && (!hull || (finite(&found.infima.upper) && finite(&found.suprema.lower)))
}

/// The first position of the largest magnitude.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn largest(range: Range<usize>, value: impl Fn(usize) -> f64) -> usize {
    let mut best = range.start;
    for i in range {
        if value(i).abs() > value(best).abs() {
            best = i;
        }
    }
    best
}

fn swap_rows(work: &mut [f64], stride: usize, p: usize, other: usize) {
    if p != other {
        let (above, below) = work.split_at_mut(other * stride);
        above[p * stride..][..stride].swap_with_slice(&mut below[..stride]);
    }
}

/// Rows that were exchanged before a step are columns of the inverse that are exchanged after it.
fn undo_swaps(work: &mut [f64], n: usize, stride: usize, swaps: &[usize]) {
    for p in (0..n).rev().filter(|&p| swaps[p] != p) {
        for row in work.chunks_exact_mut(stride) {
            row.swap(p, swaps[p]);
        }
    }
}
