//! Orders above 3: Gauss-Jordan elimination in place, with fused products on every back end.
//!
//! Small orders put one member into each lane, all with the pivots of the midpoint. Where a pivot of a lane is much smaller than
//! the midpoint's, that member alone is inverted again with its own pivots. Larger orders keep one member in cache and eliminate
//! along its rows, each with its own pivots.

use super::{Extremes, Form, ORDER_LIMIT};
use crate::approximate;
use crate::lanes::{Vector, backends};
use crate::matrix::IntervalMatrix;
use crate::rounding::slices::Backend;
use std::ops::Range;

/// The largest order with one member a lane: its vectors fit the first cache.
const LANES_LIMIT: usize = 20;
/// A lane's pivot may be this much smaller than the midpoint's.
const PIVOT_LOSS: f64 = 1.0 / 256.0;

/// The step between members, and how the midpoint is eliminated.
pub(super) struct Plan {
    n: usize,
    partitions: u64,
    /// The published step `Delta / N`, row-major.
    step: Vec<f64>,
    /// Which row of `A` stands where, so that the pivots of the midpoint stand on the diagonal; and the least pivots allowed.
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
            by_lanes(backend, self, a, hull, range, found)
        } else {
            by_rows(backend, self, a, hull, range, found)
        }
    }

    /// How many steps member `j` is away from the end of its set.
    #[expect(clippy::cast_precision_loss, reason = "the published sweep is a computation in floats")]
    #[inline]
    fn shift(&self, j: u64) -> f64 {
        (self.partitions - j) as f64
    }
}

backends!(fn by_lanes(plan: &Plan, a: &IntervalMatrix, hull: bool, range: Range<u64>, found: &mut Extremes) -> bool = lanes);
backends!(fn by_rows(plan: &Plan, a: &IntervalMatrix, hull: bool, range: Range<u64>, found: &mut Extremes) -> bool = rows);

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn lanes<V: Vector>(plan: &Plan, a: &IntervalMatrix, hull: bool, range: Range<u64>, found: &mut Extremes) -> bool {
    let n = plan.n;
    let mut work = vec![V::splat(0.0); n * n];
    let mut single = vec![0.0; n * n];
    let mut start = range.start;
    let sets = [(a.lo(), 1.0, &mut found.infima, true, hull), (a.hi(), -1.0, &mut found.suprema, hull, true)];
    for (from, direction, ends, least, most) in sets {
        let mut low = vec![V::splat(f64::INFINITY); n * n];
        let mut high = vec![V::splat(f64::NEG_INFINITY); n * n];
        start = range.start;
        while start < range.end {
            // Lanes beyond the range repeat its last member.
            let shift = V::from_fn(|lane| direction * plan.shift((start + lane as u64).min(range.end - 1)));
            for (i, &row) in plan.order.iter().enumerate() {
                for j in 0..n {
                    let at = row * n + j;
                    work[i * n + j] = shift.mul_add(V::splat(plan.step[at]), V::splat(from[at]));
                }
            }
            let margin = eliminate(&mut work, n, &plan.pivots).array();
            for (lane, &margin) in margin.as_ref().iter().enumerate() {
                if margin >= 0.0 {
                    continue;
                }
                form_member(&mut single, from, shift.array().as_ref()[lane], &plan.step);
                if !invert_with_pivots(&mut single, n) {
                    return false;
                }
                for i in 0..n {
                    for (k, &row) in plan.order.iter().enumerate() {
                        let mut lanes = work[i * n + k].array();
                        lanes.as_mut()[lane] = single[i * n + row];
                        work[i * n + k] = V::load(lanes.as_ref());
                    }
                }
            }
            for (at, &x) in work.iter().enumerate() {
                if least {
                    low[at] = x.least(low[at]);
                }
                if most {
                    high[at] = x.most(high[at]);
                }
            }
            start += V::N as u64;
        }
        // Column k of the inverse of the permuted matrix is column order[k] of the inverse.
        for i in 0..n {
            for (k, &row) in plan.order.iter().enumerate() {
                let (at, from) = (i * n + row, i * n + k);
                ends.lower[at] = low[from].array().as_ref().iter().copied().fold(ends.lower[at], f64::min);
                ends.upper[at] = high[from].array().as_ref().iter().copied().fold(ends.upper[at], f64::max);
            }
        }
    }
    let _ = start;
    finite(found, hull)
}

/// Whether all extremes that were looked for are finite.
fn finite(found: &Extremes, hull: bool) -> bool {
    let finite = |x: &[f64]| x.iter().all(|v| v.is_finite());
    let literal = finite(&found.infima.lower) && finite(&found.suprema.upper);
    literal && (!hull || (finite(&found.infima.upper) && finite(&found.suprema.lower)))
}

/// Inverts as many matrices as there are lanes in place with the pivots on the diagonal. Lanes of the result that are not at least 0
/// had a pivot that was too small.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn eliminate<V: Vector>(work: &mut [V], n: usize, least: &[f64]) -> V {
    // Orders that the compiler knows are unrolled.
    match n {
        4 => eliminate_pairs(work, 4, least),
        5 => eliminate_pairs(work, 5, least),
        6 => eliminate_pairs(work, 6, least),
        7 => eliminate_pairs(work, 7, least),
        8 => eliminate_pairs(work, 8, least),
        _ => eliminate_pairs(work, n, least),
    }
}

/// Two pivots at a time, as in [`invert_by_blocks`]: stores cost more than products.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn eliminate_pairs<V: Vector>(work: &mut [V], n: usize, least: &[f64]) -> V {
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    let mut margin = V::splat(f64::INFINITY);
    let mut steps = [(zero, zero); LANES_LIMIT];
    let mut old = [(zero, zero); LANES_LIMIT];
    let mut p = 0;
    while p + 1 < n {
        let q = p + 1;
        let pivot = work[p * n + p];
        // NaN, which the later operand passes on, counts as too small.
        margin = margin.least(pivot.abs() - V::splat(least[p]));
        let first = one / pivot;
        let beside = work[p * n + q] * first;
        for i in 0..n {
            let factor = -work[i * n + p];
            steps[i] = (factor * first, factor.mul_add(beside, work[i * n + q]));
        }
        steps[p] = (first, beside);
        let pivot = steps[q].1;
        margin = margin.least(pivot.abs() - V::splat(least[q]));
        let second = one / pivot;
        let own = steps[q].0 * second;
        for step in &mut steps[..n] {
            let factor = -step.1;
            *step = (factor.mul_add(own, step.0), factor * second);
        }
        steps[q] = (own, second);
        for j in 0..n {
            old[j] = (work[p * n + j], work[q * n + j]);
        }
        work[p * n..(q + 1) * n].fill(zero);
        for (row, &(s, t)) in work.chunks_exact_mut(n).zip(&steps) {
            let (left, right) = row.split_at_mut(p);
            let apply = |x: &mut V, &(a, b): &(V, V)| *x = t.mul_add(b, s.mul_add(a, *x));
            left.iter_mut().zip(&old[..p]).for_each(|(x, o)| apply(x, o));
            right[2..].iter_mut().zip(&old[q + 1..n]).for_each(|(x, o)| apply(x, o));
            (row[p], row[q]) = (s, t);
        }
        p += 2;
    }
    if p < n {
        let pivot = work[p * n + p];
        margin = margin.least(pivot.abs() - V::splat(least[p]));
        let reciprocal = one / pivot;
        for j in 0..n {
            old[j].0 = work[p * n + j] * reciprocal;
        }
        for (i, row) in work.chunks_exact_mut(n).enumerate() {
            let factor = -row[p];
            for j in 0..n {
                row[j] = if i == p { old[j].0 } else { factor.mul_add(old[j].0, row[j]) };
            }
            row[p] = if i == p { reciprocal } else { factor * reciprocal };
        }
    }
    margin
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn rows<V: Vector>(plan: &Plan, a: &IntervalMatrix, hull: bool, range: Range<u64>, found: &mut Extremes) -> bool {
    let n = plan.n;
    let stride = n.next_multiple_of(8);
    // Rows that start on a cache line: vectors that cross one are stored at half the speed.
    let mut buffer = vec![0.0; n * stride + 8];
    let aligned = buffer.as_ptr().align_offset(64).min(8);
    let work = &mut buffer[aligned..][..n * stride];
    let sets = [(a.lo(), 1.0, &mut found.infima, true, hull), (a.hi(), -1.0, &mut found.suprema, hull, true)];
    for (from, direction, ends, least, most) in sets {
        for j in range.clone() {
            let shift = direction * plan.shift(j);
            for i in 0..n {
                let row = i * n..(i + 1) * n;
                let parts = from[row.clone()].iter().zip(&plan.step[row]);
                for (x, (&f, &s)) in work[i * stride..][..n].iter_mut().zip(parts) {
                    *x = shift.mul_add(s, f);
                }
            }
            if !invert_by_blocks::<V>(work, n, stride) {
                return false;
            }
            for i in 0..n {
                let row = &work[i * stride..][..n];
                if least {
                    let ends = &mut ends.lower[i * n..][..n];
                    ends.iter_mut().zip(row).for_each(|(e, &x)| *e = if x < *e { x } else { *e });
                }
                if most {
                    let ends = &mut ends.upper[i * n..][..n];
                    ends.iter_mut().zip(row).for_each(|(e, &x)| *e = if x > *e { x } else { *e });
                }
            }
        }
    }
    finite(found, hull)
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn form_member(into: &mut [f64], from: &[f64], shift: f64, step: &[f64]) {
    for ((x, &f), &s) in into.iter_mut().zip(from).zip(step) {
        *x = shift.mul_add(s, f);
    }
}

/// Inverts one matrix in place with partial pivoting; false where a pivot is zero or not finite.
fn invert_with_pivots(work: &mut [f64], n: usize) -> bool {
    let mut swaps = [0_usize; ORDER_LIMIT];
    for p in 0..n {
        let pivot_row = largest(p..n, |i| work[i * n + p]);
        swaps[p] = pivot_row;
        let pivot = work[pivot_row * n + p];
        if pivot == 0.0 || !pivot.is_finite() {
            return false;
        }
        swap_rows(work, n, p, pivot_row);
        let reciprocal = 1.0 / pivot;
        work[p * n + p] = 1.0;
        for x in &mut work[p * n..][..n] {
            *x *= reciprocal;
        }
        let (above, rest) = work.split_at_mut(p * n);
        let (row, below) = rest.split_at_mut(n);
        for target in above.chunks_exact_mut(n).chain(below.chunks_exact_mut(n)) {
            let factor = -target[p];
            target[p] = 0.0;
            for (x, &y) in target.iter_mut().zip(row.iter()) {
                *x = factor.mul_add(y, *x);
            }
        }
    }
    undo_swaps(work, n, n, &swaps);
    true
}

/// Pivots that are taken together: a row is loaded and stored once for all of them.
const BLOCK: usize = 4;
/// Rows are padded to the widest vector.
const PADDED: usize = ORDER_LIMIT.next_multiple_of(8);

/// The same by blocks of pivots. In place, the columns of a block end as the columns of the transformation `T` that its steps apply to
/// the rows: outside the block row `i` becomes `row_i + sum_k T_ik row_k`, in the block `sum_k T_ik row_k`, `k` over the block.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn invert_by_blocks<V: Vector>(work: &mut [f64], n: usize, stride: usize) -> bool {
    let mut swaps = [0_usize; ORDER_LIMIT];
    let mut panel = [[0.0; BLOCK]; ORDER_LIMIT];
    let mut rows = [[0.0; PADDED]; BLOCK];
    let mut first = 0;
    while first < n {
        let width = BLOCK.min(n - first);
        for (i, steps) in panel[..n].iter_mut().enumerate() {
            *steps = [0.0; BLOCK];
            steps[..width].copy_from_slice(&work[i * stride + first..][..width]);
        }
        for k in 0..width {
            let p = first + k;
            let pivot_row = largest(p..n, |i| panel[i][k]);
            swaps[p] = pivot_row;
            let pivot = panel[pivot_row][k];
            if pivot == 0.0 || !pivot.is_finite() {
                return false;
            }
            panel.swap(p, pivot_row);
            swap_rows(work, stride, p, pivot_row);
            let reciprocal = 1.0 / pivot;
            panel[p][k] = 1.0;
            let row = panel[p].map(|x| x * reciprocal);
            panel[p] = row;
            for (i, target) in panel[..n].iter_mut().enumerate() {
                if i != p {
                    // Storing the zero first would stall the load of the whole vector behind it.
                    let factor = -target[k];
                    for (x, y) in target.iter_mut().zip(row) {
                        *x = factor.mul_add(y, *x);
                    }
                    target[k] = factor * row[k];
                }
            }
        }
        for (k, row) in rows[..width].iter_mut().enumerate() {
            let from = &mut work[(first + k) * stride..][..stride];
            row[..stride].copy_from_slice(from);
            from.fill(0.0);
        }
        for row in &mut rows[width..] {
            row.fill(0.0);
        }
        let mut c = 0;
        while c < stride {
            let [a, b, d, e] =
                [V::load(&rows[0][c..]), V::load(&rows[1][c..]), V::load(&rows[2][c..]), V::load(&rows[3][c..])];
            for (target, t) in work.chunks_exact_mut(stride).zip(&panel) {
                let target = &mut target[c..][..V::N];
                let sum = V::splat(t[0]).mul_add(a, V::load(target));
                let sum = V::splat(t[1]).mul_add(b, sum);
                let sum = V::splat(t[2]).mul_add(d, sum);
                V::splat(t[3]).mul_add(e, sum).store(target);
            }
            c += V::N;
        }
        for (i, steps) in panel[..n].iter().enumerate() {
            work[i * stride + first..][..width].copy_from_slice(&steps[..width]);
        }
        first += width;
    }
    undo_swaps(work, n, stride, &swaps);
    true
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
