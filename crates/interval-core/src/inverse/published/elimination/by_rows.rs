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
    // Column by column, so that a step works on as many rows at a time as a vector has lanes.
    let mut panel = [[0.0; PADDED]; BLOCK];
    let mut rows = [[0.0; PADDED]; BLOCK];
    let mut first = 0;
    while first < n {
        let width = BLOCK.min(n - first);
        for (k, column) in panel.iter_mut().enumerate() {
            if k < width {
                let from = work[first + k..].iter().step_by(stride);
                column[..n].iter_mut().zip(from).for_each(|(x, &y)| *x = y);
            } else {
                column.fill(0.0);
            }
        }
        for k in 0..width {
            let p = first + k;
            let pivot_row = largest(p..n, |i| panel[k][i]);
            swaps[p] = pivot_row;
            let pivot = panel[k][pivot_row];
            if pivot == 0.0 || !pivot.is_finite() {
                return false;
            }
            for column in &mut panel {
                column.swap(p, pivot_row);
            }
            swap_rows(work, stride, p, pivot_row);
            let reciprocal = 1.0 / pivot;
            panel[k][p] = 1.0;
            let row: [f64; BLOCK] = std::array::from_fn(|c| panel[c][p] * reciprocal);
            let mut i = 0;
            while i < n {
                let factor = -V::load(&panel[k][i..]);
                for (c, column) in panel.iter_mut().enumerate() {
                    let step = V::splat(row[c]);
                    let sum = if c == k { factor * step } else { factor.mul_add(step, V::load(&column[i..])) };
                    sum.store(&mut column[i..]);
                }
                i += V::N;
            }
            panel.iter_mut().zip(row).for_each(|(column, x)| column[p] = x);
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
            for (i, target) in work.chunks_exact_mut(stride).enumerate() {
                let target = &mut target[c..][..V::N];
                let sum = V::splat(panel[0][i]).mul_add(a, V::load(target));
                let sum = V::splat(panel[1][i]).mul_add(b, sum);
                let sum = V::splat(panel[2][i]).mul_add(d, sum);
                V::splat(panel[3][i]).mul_add(e, sum).store(target);
            }
            c += V::N;
        }
        for (k, column) in panel[..width].iter().enumerate() {
            let to = work[first + k..].iter_mut().step_by(stride);
            to.zip(&column[..n]).for_each(|(x, &y)| *x = y);
        }
        first += width;
    }
    undo_swaps(work, n, stride, &swaps);
    true
}
