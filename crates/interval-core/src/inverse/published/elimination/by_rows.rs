//! One member in cache, eliminated along its rows by blocks of pivots of its own.

use super::{Plan, finite, swap_rows, undo_swaps};
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
                    entry_by_entry::<V>(&mut ends.lower[i * n..][..n], row, V::least, |x, e| x < e);
                }
                if most {
                    entry_by_entry::<V>(&mut ends.upper[i * n..][..n], row, V::most, |x, e| x > e);
                }
            }
        }
    }
    finite(found, hull)
}

/// Each end is replaced by the entry that goes beyond it.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn entry_by_entry<V: Vector>(
    ends: &mut [f64],
    row: &[f64],
    choice: impl Fn(V, V) -> V,
    beyond: impl Fn(f64, f64) -> bool,
) {
    let whole = row.len() - row.len() % V::N;
    for (e, x) in ends.chunks_exact_mut(V::N).zip(row.chunks_exact(V::N)) {
        choice(V::load(x), V::load(e)).store(e);
    }
    for (e, &x) in ends[whole..].iter_mut().zip(&row[whole..]) {
        if beyond(x, *e) {
            *e = x;
        }
    }
}

/// Pivots that are taken together: a row is loaded and stored once for all of them.
const BLOCK: usize = 4;
/// Rows are padded to the widest vector.
const PADDED: usize = ORDER_LIMIT.next_multiple_of(8);

/// The first position of the largest magnitude among `p..n`, a vector of candidates at a time: the position that
/// [`largest`](super::largest) finds. Behind `n` the column holds zeros or NaN, which are never larger.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn largest_from<V: Vector>(column: &[f64; PADDED], p: usize, n: usize) -> usize {
    // NaN loses against every number, but nothing is larger than it where it is the first.
    if column[p].is_nan() {
        return p;
    }
    let (mut even, mut odd) = (V::splat(0.0), V::splat(0.0));
    let whole = p.next_multiple_of(V::N);
    let mut i = whole;
    while i < n {
        even = V::load(&column[i..]).abs().most(even);
        i += V::N;
        if i < n {
            odd = V::load(&column[i..]).abs().most(odd);
            i += V::N;
        }
    }
    let most = even.most(odd).array().as_ref().iter().fold(0.0, |most, &x| if x > most { x } else { most });
    let most = column[p..whole.min(n)].iter().fold(most, |most, x| if x.abs() > most { x.abs() } else { most });
    (p..n).find(|&i| column[i].abs() == most).unwrap_or(p)
}

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
            let pivot_row = largest_from::<V>(&panel[k], p, n);
            swaps[p] = pivot_row;
            let pivot = panel[k][pivot_row];
            if pivot == 0.0 || !pivot.is_finite() {
                return false;
            }
            for column in &mut panel {
                column.swap(p, pivot_row);
            }
            swap_rows(work, stride, p, pivot_row);
            panel[k][p] = 1.0;
            match k {
                0 => step::<V, 0>(&mut panel, p, n, 1.0 / pivot),
                1 => step::<V, 1>(&mut panel, p, n, 1.0 / pivot),
                2 => step::<V, 2>(&mut panel, p, n, 1.0 / pivot),
                _ => step::<V, 3>(&mut panel, p, n, 1.0 / pivot),
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
        // The columns of the block are the panel's, wherever they are whole vectors.
        let own = if BLOCK % V::N == 0 { first..first + BLOCK } else { 0..0 };
        for part in [0..own.start, own.end..n] {
            let mut c = part.start;
            // Two vectors of columns share what is loaded of the panel.
            while c + V::N < part.end {
                add_rows::<V, 2>(work, stride, c, &panel, &rows);
                c += 2 * V::N;
            }
            if c < part.end {
                add_rows::<V, 1>(work, stride, c, &panel, &rows);
            }
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

/// The step of pivot `K` of a block, which stands in row `p`: its reciprocal is given, and 1 stands in its place.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn step<V: Vector, const K: usize>(panel: &mut [[f64; PADDED]; BLOCK], p: usize, n: usize, reciprocal: f64) {
    let row = [panel[0][p], panel[1][p], panel[2][p], panel[3][p]].map(|x| x * reciprocal);
    let mut i = 0;
    while i < n {
        let factor = -V::load(&panel[K][i..]);
        for c in 0..BLOCK {
            let own = V::splat(row[c]);
            let sum = if c == K { factor * own } else { factor.mul_add(own, V::load(&panel[c][i..])) };
            sum.store(&mut panel[c][i..]);
        }
        i += V::N;
    }
    for c in 0..BLOCK {
        panel[c][p] = row[c];
    }
}

/// Adds the products of the panel with the rows of its pivots to every row, in `K` vectors of columns from `c` on.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn add_rows<V: Vector, const K: usize>(
    work: &mut [f64],
    stride: usize,
    c: usize,
    panel: &[[f64; PADDED]; BLOCK],
    rows: &[[f64; PADDED]; BLOCK],
) {
    let mut pivots = [[V::splat(0.0); K]; BLOCK];
    for b in 0..BLOCK {
        for k in 0..K {
            pivots[b][k] = V::load(&rows[b][c + k * V::N..]);
        }
    }
    let [first, second, third, fourth] = panel;
    let factors = first.iter().zip(second).zip(third).zip(fourth);
    for (target, (((&x, &y), &z), &t)) in work.chunks_exact_mut(stride).zip(factors) {
        let target = &mut target[c..][..K * V::N];
        let factors = [V::splat(x), V::splat(y), V::splat(z), V::splat(t)];
        for k in 0..K {
            let target = &mut target[k * V::N..][..V::N];
            let mut sum = V::load(target);
            for b in 0..BLOCK {
                sum = factors[b].mul_add(pivots[b][k], sum);
            }
            sum.store(target);
        }
    }
}
