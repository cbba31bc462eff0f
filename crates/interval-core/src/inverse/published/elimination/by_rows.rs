//! One member in cache, eliminated along its rows by blocks of pivots of its own.

use super::{Plan, finite, largest, swap_rows, undo_swaps};
use crate::inverse::published::{Extremes, ORDER_LIMIT};
use crate::lanes::{Vector, backends};
use crate::matrix::IntervalMatrix;
use std::ops::Range;

backends!(
    /// Extremes over the members of the range; false at a singular one.
    pub(super) fn sweep(plan: &Plan, a: &IntervalMatrix, hull: bool, range: Range<u64>, found: &mut Extremes) -> bool = rows
);

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

/// Pivots that are taken together: a row is loaded and stored once for all of them.
const BLOCK: usize = 4;
/// Rows are padded to the widest vector.
const PADDED: usize = ORDER_LIMIT.next_multiple_of(8);

/// The same by blocks of pivots. In place, the columns of a block end as the columns of the transformation `T` that its
/// steps apply to the rows: outside the block row `i` becomes `row_i + sum_k T_ik row_k`, in the block
/// `sum_k T_ik row_k`, `k` over the block.
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
