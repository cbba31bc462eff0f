//! A causal filter of groups of rows, whose results are laid out in blocks of time, in unit length where that is
//! wanted.

use pulp::{Arch, Simd, WithSimd};

/// Samples that are summed at once: few enough to stay in the processor's registers.
const STRETCH: usize = 16;
/// Numbers of a result from which waking other threads costs less than it saves.
const WORTHWHILE: usize = 1 << 19;
/// The least squared length of a column: a column of zeros is divided by its root, not by zero.
const NOTHING: f64 = 1e-300;

/// Rows that are whitened together.
#[derive(Clone, Copy, Debug)]
pub struct Group<'a> {
    /// The rows of the signals.
    pub rows: &'a [usize],
    /// Shape (lags + 1, rows, rows): the weight of each row's value some samples ago in each row.
    pub taps: &'a [f64],
}

/// The layout of results.
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    /// Rows of each column.
    pub rows: usize,
    /// Samples of each row.
    pub n: usize,
    /// Samples in a block; samples beyond the last whole block are left out.
    pub length: usize,
    /// The factor of each sample, if any.
    pub weight: Option<&'a [f64]>,
    /// True if each column is divided by its length.
    pub unit: bool,
}

impl Layout<'_> {
    /// Numbers of a column in the result.
    #[must_use]
    pub fn numbers(&self) -> usize {
        self.n / self.length * self.length * self.rows
    }
}

/// Whitens columns, each of shape (rows, n), into shape (blocks, rows, length), and gives the length of each, 1 where
/// none is asked for.
///
/// Samples before the first one count as zero. The columns are shared between `threads` threads.
///
/// # Panics
/// Lengths that do not fit each other.
pub fn whiten(columns: &[&[f64]], groups: &[Group], layout: Layout, threads: usize, out: &mut [f64]) -> Vec<f64> {
    let numbers = layout.numbers();
    assert!(layout.length > 0 && out.len() == columns.len() * numbers, "a result of the layout's size is needed");
    assert!(columns.iter().all(|c| c.len() == layout.rows * layout.n), "columns of the layout's size are needed");
    assert!(layout.weight.is_none_or(|w| w.len() >= layout.n), "a weight for each sample is needed");
    for g in groups {
        let square = g.rows.len() * g.rows.len();
        assert!(square > 0 && g.taps.len() % square == 0 && !g.taps.is_empty(), "square taps are needed");
        assert!(g.rows.iter().all(|&r| r < layout.rows), "rows of the columns are needed");
    }
    if numbers == 0 {
        return vec![if layout.unit { NOTHING.sqrt() } else { 1.0 }; columns.len()];
    }
    let threads = if out.len() < WORTHWHILE { 1 } else { threads.clamp(1, columns.len()) };
    let mut shares: Vec<Vec<Task>> = (0..threads).map(|_| Vec::new()).collect();
    for (i, (out, column)) in out.chunks_exact_mut(numbers).zip(columns).enumerate() {
        shares[i % threads].push((i, column, out));
    }
    let work = |share: Vec<Task>| {
        let mut scratch = Vec::new();
        let one =
            |(i, column, out)| (i, Arch::new().dispatch(One { column, groups, layout, scratch: &mut scratch, out }));
        share.into_iter().map(one).collect::<Vec<(usize, f64)>>()
    };
    let mut lengths = vec![1.0; columns.len()];
    // Threads of this call alone: a process that is forked later has none of a pool's, and would wait for them for
    // ever.
    std::thread::scope(|scope| {
        let own = shares.pop();
        let others: Vec<_> = shares.into_iter().map(|share| scope.spawn(|| work(share))).collect();
        let mut done: Vec<_> = own.into_iter().flat_map(work).collect();
        for other in others {
            done.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        for (i, length) in done {
            lengths[i] = length;
        }
    });
    lengths
}

/// A column's number, its samples, and the place of its result.
type Task<'a> = (usize, &'a [f64], &'a mut [f64]);

/// One column, compiled for each width of vectors.
struct One<'a> {
    column: &'a [f64],
    groups: &'a [Group<'a>],
    layout: Layout<'a>,
    scratch: &'a mut Vec<f64>,
    out: &'a mut [f64],
}

impl WithSimd for One<'_> {
    type Output = f64;

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "it is compiled for the vectors of its caller")]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        one(self.column, self.groups, self.layout, self.scratch, self.out)
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "it is compiled for the vectors of its caller")]
fn one(column: &[f64], groups: &[Group], layout: Layout, scratch: &mut Vec<f64>, out: &mut [f64]) -> f64 {
    let n = layout.n;
    let stretches = n.div_ceil(STRETCH);
    let mut square = 0.0;
    let mut still = vec![true; layout.rows];
    for group in groups {
        let r = group.rows.len();
        let lags = group.taps.len() / (r * r) - 1;
        let rows = || group.rows.iter().map(|&i| &column[i * n..(i + 1) * n]);
        // Most signatures leave some axes alone, and nothing is left of axes that stand still.
        if group.taps.iter().all(|&v| v == 0.0) || rows().all(|x| x.iter().all(|&v| v == 0.0)) {
            continue;
        }
        let width = lags + stretches * STRETCH;
        scratch.clear();
        scratch.resize(r * width, 0.0);
        for (into, x) in scratch.chunks_exact_mut(width).zip(rows()) {
            into[lags..lags + n].copy_from_slice(x);
        }
        // Two rows at a time share the values that are read.
        for first in (0..r).step_by(2) {
            for start in (0..stretches).map(|s| s * STRETCH) {
                if first + 1 < r {
                    let [one, other] = sums::<2>(group, first, scratch, width, start);
                    place(&one, start, group.rows[first], layout, out);
                    place(&other, start, group.rows[first + 1], layout, out);
                } else {
                    let [one] = sums::<1>(group, first, scratch, width, start);
                    place(&one, start, group.rows[first], layout, out);
                }
            }
            for &row in &group.rows[first..r.min(first + 2)] {
                still[row] = false;
                if layout.unit {
                    square += squared(out, row, layout);
                }
            }
        }
    }
    for (row, part) in out.chunks_exact_mut(layout.length).enumerate() {
        if still[row % layout.rows] {
            part.fill(0.0);
        }
    }
    if !layout.unit {
        return 1.0;
    }
    let length = square.max(NOTHING).sqrt();
    let factor = 1.0 / length;
    for x in out.iter_mut() {
        *x *= factor;
    }
    length
}

/// A stretch of `Q` rows, the first of which is `first` in the group, from rows that stand `width` apart after as many
/// zeros as there are lags.
#[inline(always)]
#[expect(clippy::inline_always, reason = "it is compiled for the vectors of its caller")]
fn sums<const Q: usize>(group: &Group, first: usize, x: &[f64], width: usize, start: usize) -> [[f64; STRETCH]; Q] {
    let r = group.rows.len();
    let lags = group.taps.len() / (r * r) - 1;
    let mut sum = [[0.0; STRETCH]; Q];
    for j in 0..r {
        for lag in 0..=lags {
            let x: &[f64; STRETCH] =
                x[j * width + start + lags - lag..][..STRETCH].try_into().expect("a whole stretch");
            for q in 0..Q {
                let tap = group.taps[(lag * r + first + q) * r + j];
                for t in 0..STRETCH {
                    sum[q][t] += tap * x[t];
                }
            }
        }
    }
    sum
}

/// Puts a stretch of a row where its blocks are.
#[inline(always)]
#[expect(clippy::inline_always, reason = "it is compiled for the vectors of its caller")]
fn place(sum: &[f64; STRETCH], start: usize, row: usize, layout: Layout, out: &mut [f64]) {
    let last = (layout.n / layout.length * layout.length).min(start + STRETCH);
    let mut t = start;
    while t < last {
        let block = t / layout.length;
        let count = ((block + 1) * layout.length).min(last) - t;
        let at = (block * layout.rows + row) * layout.length + t % layout.length;
        let (into, from) = (&mut out[at..at + count], &sum[t - start..t - start + count]);
        match layout.weight {
            Some(w) => {
                for ((y, &x), &w) in into.iter_mut().zip(from).zip(&w[t..t + count]) {
                    *y = x * w;
                }
            }
            None => into.copy_from_slice(from),
        }
        t += count;
    }
}

/// The sum of squares of a row, in sixteen sums that are added in pairs.
#[inline(always)]
#[expect(clippy::inline_always, reason = "it is compiled for the vectors of its caller")]
fn squared(out: &[f64], row: usize, layout: Layout) -> f64 {
    let mut sum = [0.0; 16];
    let mut rest = 0.0;
    for block in out.chunks_exact(layout.rows * layout.length) {
        let whole = block[row * layout.length..(row + 1) * layout.length].chunks_exact(16);
        rest += whole.remainder().iter().map(|v| v * v).sum::<f64>();
        for part in whole {
            for k in 0..16 {
                sum[k] += part[k] * part[k];
            }
        }
    }
    let mut half = 8;
    while half > 0 {
        for k in 0..half {
            sum[k] += sum[k + half];
        }
        half /= 2;
    }
    sum[0] + rest
}
