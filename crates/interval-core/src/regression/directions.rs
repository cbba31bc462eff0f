//! The directions in which a set is unbounded: a basis of the null space where the set contains whole lines, else rays.

use super::rows::Rows;
use crate::parallel;

/// Relative size below which an entry counts as the remainder of an elimination to zero. Directions are approximations
/// and prove nothing.
const ZERO: f64 = 1e-9;
/// Rows of one piece of a pass. The size is fixed, so that the result does not depend on the number of threads.
const PIECE: usize = 1 << 14;

/// From the rays of all orthants: the reduced echelon basis of their span where every member of it may be added to a
/// consistent parameter, else the rays that differ. Scaled to a largest entry of 1; approximations, with exact zeros.
pub(crate) fn directions(rows: &Rows<'_>, rays: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut distinct: Vec<Vec<f64>> = Vec::new();
    for ray in rays {
        let Some(unit) = scaled(ray) else { continue };
        let same = |d: &Vec<f64>| d.iter().zip(&unit).all(|(a, b)| (a - b).abs() < 1e-6);
        if !distinct.iter().any(same) {
            distinct.push(unit);
        }
    }
    let basis = echelon(&distinct, rows.columns());
    if basis.iter().all(|v| is_line(rows, v)) { basis } else { distinct }
}

/// With a largest entry of 1, and zero where it nearly vanishes.
fn scaled(ray: &[f64]) -> Option<Vec<f64>> {
    let largest = ray.iter().fold(0.0_f64, |a, x| if x.abs() > a.abs() { *x } else { a });
    if largest == 0.0 || !largest.is_finite() {
        return None;
    }
    Some(ray.iter().map(|x| if (x / largest).abs() < ZERO { 0.0 } else { x / largest }).collect())
}

/// A basis of the span, each member with a leading entry that the others lack.
fn echelon(vectors: &[Vec<f64>], n: usize) -> Vec<Vec<f64>> {
    let mut rest = vectors.to_vec();
    let mut basis: Vec<(usize, Vec<f64>)> = Vec::new();
    for column in 0..n {
        let Some(at) = (0..rest.len()).max_by(|&i, &j| rest[i][column].abs().total_cmp(&rest[j][column].abs())) else {
            break;
        };
        if rest[at][column].abs() < 1e-6 {
            continue;
        }
        let pivot = rest.swap_remove(at);
        let pivot: Vec<f64> = pivot.iter().map(|x| x / pivot[column]).collect();
        let clear = |v: &mut Vec<f64>| {
            let factor = v[column];
            for (x, p) in v.iter_mut().zip(&pivot) {
                *x -= factor * p;
                *x = if x.abs() < ZERO { 0.0 } else { *x };
            }
        };
        for v in &mut rest {
            clear(v);
        }
        for (_, v) in &mut basis {
            clear(v);
        }
        basis.push((column, pivot));
    }
    basis.into_iter().filter_map(|(_, v)| scaled(&v)).collect()
}

/// True if some member of every row is orthogonal to `v`, up to rounding.
fn is_line(rows: &Rows<'_>, v: &[f64]) -> bool {
    let (m, n) = (rows.count(), rows.columns());
    let pieces = m.div_ceil(PIECE);
    let holds = |piece: usize| {
        let [lower, upper, low, high] = rows.slices(piece * PIECE, m.min((piece + 1) * PIECE));
        lower.chunks_exact(n).zip(upper.chunks_exact(n)).zip(low.iter().zip(high)).all(|((l, u), (&yl, &yu))| {
            let (mut least, mut most, mut size) = (0.0, 0.0, 0.0);
            for ((&l, &u), &x) in l.iter().zip(u).zip(v) {
                let (p, q) = if x == 0.0 {
                    (0.0, 0.0)
                } else if x > 0.0 {
                    (l * x, u * x)
                } else {
                    (u * x, l * x)
                };
                least += p;
                most += q;
                size += p.abs().max(q.abs());
            }
            (least <= 1e-12 * size || yu == f64::INFINITY) && (most >= -1e-12 * size || yl == f64::NEG_INFINITY)
        })
    };
    parallel::map(pieces, pieces > 1, holds).into_iter().all(|x| x)
}
