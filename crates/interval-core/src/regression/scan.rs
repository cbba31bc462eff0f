//! One pass over all rows for all pending vertices: the half-spaces that they violate most.
//!
//! The rows are read once, in blocks that are turned into midpoints and radii, column by column. Every vertex is tried
//! on a block while it lies in the nearest cache. Violations are measured in units of the row's normal. The findings of
//! the vectors are looked at again row by row, with a tolerance relative to the terms of that row. A scan proposes and
//! proves nothing.
//!
//! Pieces of rows do not depend on the number of threads, and nothing is fused: the same rows come back from every back
//! end.

#![expect(clippy::inline_always, reason = "the kernel is compiled inside functions with wider instruction sets")]

use super::rows::Rows;
use crate::lanes::{Vector, backends};
use crate::linear_program::{HalfSpaces, VIOLATION, violation};
use crate::parallel;
use crate::rounding::slices::Backend;
use std::collections::HashSet;

/// Rows of a block, which lies in the nearest cache while every vertex is tried on it.
const BLOCK: usize = 64;
/// Rows of the largest piece. The size follows from the number of rows, not from that of threads.
const PIECE: usize = 4096;
/// Half-spaces that one vertex may add in one pass: few, so that the working set stays small.
const TAKEN: std::ops::RangeInclusive<usize> = 2..=6;
/// Half-spaces that all vertices together add in one pass, approximately.
const TOGETHER: usize = 120;

/// A vertex `point + M ray` of a working set, with the signs that its orthant's coefficients are made with.
pub(crate) struct Vertex<P> {
    pub(crate) polyhedron: P,
    pub(crate) signs: Vec<i8>,
    pub(crate) point: Vec<f64>,
    /// Only where the vertex is not finite.
    pub(crate) ray: Option<Vec<f64>>,
}

/// The pieces of the rows, and the number of pieces that are left out.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pass {
    piece: usize,
    count: usize,
    stride: usize,
}

impl Pass {
    /// Every `stride`-th piece of `m` rows.
    pub(crate) fn new(m: usize, stride: usize) -> Self {
        let piece = (m / 16).next_multiple_of(BLOCK).clamp(BLOCK, PIECE);
        Self { piece, count: m.div_ceil(piece).div_ceil(stride), stride }
    }

    /// The number of pieces of a whole pass.
    pub(crate) fn pieces(m: usize) -> usize {
        Self::new(m, 1).count
    }
}

/// Powers of two near the reciprocals of the columns' largest entries.
pub(crate) fn column_scale(rows: &Rows<'_>) -> Vec<f64> {
    rows.magnitude()
        .iter()
        .map(|&l| if l > 0.0 { crate::linear_program::program::power_of_two_near(l).recip() } else { 1.0 })
        .collect()
}

/// For every vertex the half-spaces that it violates most, those that are `known` left out; the most violated one
/// first.
pub(crate) fn scan<P: HalfSpaces>(
    rows: &Rows<'_>,
    scale: &[f64],
    vertices: &[Vertex<P>],
    known: &HashSet<usize>,
    pass: Pass,
    backend: Backend,
) -> Vec<Vec<usize>> {
    let (m, n) = (rows.count(), rows.columns());
    // Vectors for the finite vertices; the others are tried row by row.
    let finite: Vec<usize> = (0..vertices.len()).filter(|&k| vertices[k].ray.is_none()).collect();
    let open: Vec<usize> = (0..vertices.len()).filter(|&k| vertices[k].ray.is_some()).collect();
    let points: Vec<f64> = finite.iter().flat_map(|&k| vertices[k].point.iter().copied()).collect();
    let tilts: Vec<f64> = finite
        .iter()
        .flat_map(|&k| vertices[k].point.iter().zip(&vertices[k].signs).map(|(x, &s)| x * f64::from(s)))
        .collect();
    let worthwhile = pass.count > 1 && pass.count * pass.piece * n * vertices.len() > 1 << 16;
    let found = parallel::map(pass.count, worthwhile, |piece| {
        let start = piece * pass.stride * pass.piece;
        let end = m.min(start + pass.piece);
        let mut best: Vec<Option<(bool, f64, usize)>> = vec![None; vertices.len()];
        let mut g = vec![0.0; n];
        if !finite.is_empty() {
            let blocks = (end - start).div_ceil(BLOCK);
            let mut maxima = vec![0.0; blocks * finite.len()];
            maxima_of(backend, rows.slices(start, end), scale, &points, &tilts, &mut maxima);
            for (block, maxima) in maxima.chunks_exact(finite.len()).enumerate() {
                let first = start + block * BLOCK;
                for (&k, &most) in finite.iter().zip(maxima) {
                    if best[k].is_none_or(|b| most > b.1) && most > 0.0 {
                        for i in first..end.min(first + BLOCK) {
                            look(&vertices[k], scale, m, i, known, &mut g, &mut best[k]);
                        }
                    }
                }
            }
        }
        for &k in &open {
            (start..end).for_each(|i| look(&vertices[k], scale, m, i, known, &mut g, &mut best[k]));
        }
        best
    });
    let mut g = vec![0.0; n];
    let taken = (TOGETHER / vertices.len().max(1)).clamp(*TAKEN.start(), *TAKEN.end());
    (0..vertices.len())
        .map(|k| {
            let mut candidates: Vec<(bool, f64, usize)> = found.iter().filter_map(|best| best[k]).collect();
            let mut beside = None;
            rows.open().iter().for_each(|&i| look(&vertices[k], scale, m, i, known, &mut g, &mut beside));
            candidates.extend(beside);
            candidates.sort_by(|a, b| (b.0, b.1).partial_cmp(&(a.0, a.1)).unwrap_or(std::cmp::Ordering::Equal));
            let mut indices: Vec<usize> = candidates.into_iter().map(|c| c.2).take(taken).collect();
            indices.dedup();
            indices
        })
        .collect()
}

/// Tries both half-spaces of row `i`.
fn look<P: HalfSpaces>(
    vertex: &Vertex<P>,
    scale: &[f64],
    m: usize,
    i: usize,
    known: &HashSet<usize>,
    g: &mut [f64],
    best: &mut Option<(bool, f64, usize)>,
) {
    for index in [i, i + m] {
        let h = vertex.polyhedron.half_space(index, g);
        if h == f64::INFINITY {
            continue;
        }
        let Some((at_large, amount)) = violation(g, h, &vertex.point, vertex.ray.as_deref(), VIOLATION) else {
            continue;
        };
        let amount = amount / g.iter().zip(scale).map(|(x, s)| (x * s).abs()).sum::<f64>().max(f64::MIN_POSITIVE);
        if best.is_none_or(|(order, most, _)| (at_large, amount) > (order, most)) && !known.contains(&index) {
            *best = Some((at_large, amount, index));
        }
    }
}

backends! {
    /// The largest violation in each block of rows, for each vertex, in units of the rows' normals; 0 where there is
    /// none.
    fn maxima_of(
        rows: [&[f64]; 4],
        scale: &[f64],
        points: &[f64],
        tilts: &[f64],
        maxima: &mut [f64],
    ) = blocks
}

/// `inf(A_i x) = c x - d |x|` and `sup(A_i x) = c x + d |x|` for midpoints `c` and radii `d`.
#[inline(always)]
fn blocks<V: Vector>(
    [lower, upper, low, high]: [&[f64]; 4],
    scale: &[f64],
    points: &[f64],
    tilts: &[f64],
    maxima: &mut [f64],
) {
    let n = scale.len();
    let vertices = points.len() / n;
    let mut middle = vec![0.0; n * BLOCK];
    let mut radius = vec![0.0; n * BLOCK];
    let (mut least, mut most, mut weight) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
    for (block, maxima) in maxima.chunks_exact_mut(vertices).enumerate() {
        let start = block * BLOCK;
        let count = BLOCK.min(low.len() - start);
        let (l, u) = (&lower[start * n..(start + count) * n], &upper[start * n..(start + count) * n]);
        if count < BLOCK {
            middle.fill(0.0);
            radius.fill(0.0);
            least.fill(f64::NEG_INFINITY);
            most.fill(f64::INFINITY);
        }
        weight.fill(0.0);
        for j in 0..n {
            let (c, d) = (&mut middle[j * BLOCK..(j + 1) * BLOCK], &mut radius[j * BLOCK..(j + 1) * BLOCK]);
            let s = scale[j];
            for (i, (l, u)) in l.chunks_exact(n).zip(u.chunks_exact(n)).enumerate() {
                let (l, u) = (0.5 * l[j], 0.5 * u[j]);
                c[i] = l + u;
                d[i] = u - l;
                weight[i] += (c[i].abs() + d[i]) * s;
            }
        }
        least[..count].copy_from_slice(&low[start..start + count]);
        most[..count].copy_from_slice(&high[start..start + count]);
        for w in &mut weight {
            *w = 1.0 / *w;
        }
        for ((x, tilt), maximum) in points.chunks_exact(n).zip(tilts.chunks_exact(n)).zip(maxima) {
            let mut worst = V::splat(0.0);
            let mut group = 0;
            while group < BLOCK {
                let (mut s, mut r) = ([V::splat(0.0); 4], [V::splat(0.0); 4]);
                for j in 0..n {
                    let (x, tilt) = (V::splat(x[j]), V::splat(tilt[j]));
                    let at = j * BLOCK + group;
                    let (c, d) = (&middle[at..at + 4 * V::N], &radius[at..at + 4 * V::N]);
                    for k in 0..4 {
                        s[k] = s[k] + V::load(&c[k * V::N..]) * x;
                        r[k] = r[k] + V::load(&d[k * V::N..]) * tilt;
                    }
                }
                for k in 0..4 {
                    let at = group + k * V::N;
                    let w = V::load(&weight[at..]);
                    let above = ((s[k] - r[k]) - V::load(&most[at..])) * w;
                    let below = (V::load(&least[at..]) - (s[k] + r[k])) * w;
                    // The second operand stays where the first is NaN.
                    worst = below.most(above.most(worst));
                }
                group += 4 * V::N;
            }
            *maximum = worst.array().as_ref().iter().fold(0.0, |a, &b| if b > a { b } else { a });
        }
    }
}
