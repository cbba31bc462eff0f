//! One member a lane, all with the pivots of the midpoint.

use super::{LANES_LIMIT, Plan, finite, largest, swap_rows, undo_swaps};
use crate::inverse::published::{Extremes, ORDER_LIMIT};
use crate::lanes::{Vector, backends};
use crate::matrix::IntervalMatrix;
use std::ops::Range;

backends!(
    /// Extremes over the members of the range; false at a singular one.
    pub(super) fn sweep(plan: &Plan, a: &IntervalMatrix, hull: bool, range: Range<u64>, found: &mut Extremes) -> bool = lanes
);

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn lanes<V: Vector>(plan: &Plan, a: &IntervalMatrix, hull: bool, range: Range<u64>, found: &mut Extremes) -> bool {
    let n = plan.n;
    let mut work = vec![V::splat(0.0); n * n];
    let mut single = vec![0.0; n * n];
    let sets = [(a.lo(), 1.0, &mut found.infima, true, hull), (a.hi(), -1.0, &mut found.suprema, hull, true)];
    for (from, direction, ends, least, most) in sets {
        let mut low = vec![V::splat(f64::INFINITY); n * n];
        let mut high = vec![V::splat(f64::NEG_INFINITY); n * n];
        let mut start = range.start;
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
    finite(found, hull)
}

/// Inverts as many matrices as there are lanes in place with the pivots on the diagonal. Lanes of the result that are
/// not at least 0 had a pivot that was too small.
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
