//! Approximations in plain floats. Nothing here is a bound: a proof has to close around it.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::{DMatrix, DVector};

/// An approximate inverse of an `n` by `n` matrix, row-major. The value is `None` if elimination meets a zero pivot or
/// overflows.
pub(crate) fn inverse(a: &[f64], n: usize) -> Option<Vec<f64>> {
    if n > BLOCKED {
        return blocked_inverse(a, n);
    }
    // Row-major storage is that of the transpose, and its inverse is stored as the transpose again.
    let inverse = DMatrix::from_column_slice(n, n, a).lu().try_inverse()?;
    inverse.iter().all(|x| x.is_finite()).then(|| inverse.as_slice().to_vec())
}

/// Orders above this are factorised by blocks: smaller matrices stay in the nearest cache without them.
const BLOCKED: usize = 24;

fn blocked_inverse(a: &[f64], n: usize) -> Option<Vec<f64>> {
    let transposed = MatRef::from_column_major_slice(a, n, n);
    let inverse = transposed.partial_piv_lu().inverse();
    let columns = (0..n).flat_map(|j| inverse.col(j).iter().copied().collect::<Vec<f64>>());
    let entries: Vec<f64> = columns.collect();
    entries.iter().all(|x| x.is_finite()).then_some(entries)
}

/// A factorised basis matrix.
pub(crate) struct Basis {
    inverse: DMatrix<f64>,
}

impl Basis {
    /// Factorises an `n` by `n` matrix, row-major.
    pub(crate) fn new(rows: &[f64], n: usize) -> Option<Self> {
        let inverse = DMatrix::from_row_slice(n, n, rows).lu().try_inverse()?;
        inverse.iter().all(|x| x.is_finite()).then_some(Self { inverse })
    }

    /// `B^-1 v`.
    pub(crate) fn solve(&self, v: &[f64]) -> Vec<f64> {
        (&self.inverse * DVector::from_column_slice(v)).as_slice().to_vec()
    }
}

/// A least-squares solution of `A x = b` for `m` by `n` row-major `A`, by its normal equations with columns scaled to
/// unit length. It is a start for searches, so a singular system gives zeros.
pub(crate) fn least_squares(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    let mut scale = vec![0.0_f64; n];
    for row in a.chunks_exact(n) {
        for (s, x) in scale.iter_mut().zip(row) {
            *s += x * x;
        }
    }
    let scale: Vec<f64> = scale.iter().map(|&s| if s > 0.0 { s.sqrt().recip() } else { 0.0 }).collect();
    let mut gram = DMatrix::zeros(n, n);
    let mut right = DVector::zeros(n);
    for (row, &y) in a.chunks_exact(n).zip(b) {
        for i in 0..n {
            right[i] += row[i] * scale[i] * y;
            for j in 0..n {
                gram[(i, j)] += row[i] * scale[i] * row[j] * scale[j];
            }
        }
    }
    match gram.lu().solve(&right) {
        Some(x) if x.iter().all(|v: &f64| v.is_finite()) => x.iter().zip(&scale).map(|(v, s)| v * s).collect(),
        _ => vec![0.0; n],
    }
}

/// The right singular vector of the least singular value, scaled to a largest entry of 1.
pub(crate) fn least_singular_vector(a: &[f64], n: usize) -> Option<Vec<f64>> {
    let svd = DMatrix::from_row_slice(n, n, a).try_svd(false, true, f64::EPSILON, 1000)?;
    let right = svd.v_t?;
    let (least, _) = svd.singular_values.iter().enumerate().min_by(|x, y| x.1.total_cmp(y.1))?;
    let x: Vec<f64> = right.row(least).iter().copied().collect();
    let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    (largest > 0.0).then(|| x.iter().map(|v| v / largest).collect())
}

/// Elimination with partial pivoting: which row stands at each pivot, and the sizes of the pivots. Rows without a
/// usable pivot stay in their order with a pivot that nothing is below.
pub(crate) fn pivots(a: &[f64], n: usize) -> (Vec<usize>, Vec<f64>) {
    let mut work = a.to_vec();
    let mut order: Vec<usize> = (0..n).collect();
    let mut pivots = vec![f64::INFINITY; n];
    for p in 0..n {
        let row = (p..n).max_by(|&i, &j| work[i * n + p].abs().total_cmp(&work[j * n + p].abs())).unwrap_or(p);
        let pivot = work[row * n + p];
        if pivot == 0.0 || !pivot.is_finite() {
            break;
        }
        pivots[p] = pivot.abs();
        if row != p {
            order.swap(p, row);
            for j in 0..n {
                work.swap(p * n + j, row * n + j);
            }
        }
        for i in p + 1..n {
            let factor = work[i * n + p] / pivot;
            for j in p..n {
                work[i * n + j] -= factor * work[p * n + j];
            }
        }
    }
    (order, pivots)
}

/// Solves `work = [A | b]`, `n` rows of `n + 1`, by elimination with partial pivoting; the solution takes the place of
/// `b`.
pub(crate) fn solve_in_place(work: &mut [f64], n: usize) -> Option<()> {
    let width = n + 1;
    for p in 0..n {
        let pivot_row = (p..n).max_by(|&i, &j| work[i * width + p].abs().total_cmp(&work[j * width + p].abs()))?;
        let pivot = work[pivot_row * width + p];
        if pivot == 0.0 || !pivot.is_finite() {
            return None;
        }
        if pivot_row != p {
            for j in p..width {
                work.swap(p * width + j, pivot_row * width + j);
            }
        }
        let (upper, below) = work.split_at_mut((p + 1) * width);
        let row = &upper[p * width..];
        for target in below.chunks_exact_mut(width) {
            let factor = target[p] / pivot;
            if factor != 0.0 {
                for j in p + 1..width {
                    target[j] -= factor * row[j];
                }
            }
        }
    }
    for p in (0..n).rev() {
        let sum: f64 = (p + 1..n).map(|j| work[p * width + j] * work[j * width + n]).sum();
        work[p * width + n] = (work[p * width + n] - sum) / work[p * width + p];
    }
    (0..n).all(|i| work[i * width + n].is_finite()).then_some(())
}

/// The product of an `m` by `k` and a `k` by `n` matrix, all row-major, in any order of summation.
pub(crate) fn product(a: &[f64], b: &[f64], m: usize, k: usize, n: usize) -> Vec<f64> {
    if m.min(n).min(k) > BLOCKED {
        let mut c = vec![0.0; m * n];
        let target = MatMut::from_row_major_slice_mut(&mut c, m, n);
        let (a, b) = (MatRef::from_row_major_slice(a, m, k), MatRef::from_row_major_slice(b, k, n));
        faer::linalg::matmul::matmul(target, Accum::Replace, a, b, 1.0, Par::Seq);
        return c;
    }
    // Row-major storage is that of the transposes, whose product is the transpose of the product.
    let (left, right) = (DMatrix::from_column_slice(n, k, b), DMatrix::from_column_slice(k, m, a));
    (left * right).as_slice().to_vec()
}
