//! Approximations in plain floats. Nothing here is a bound: a proof has to close around it.

use nalgebra::{DMatrix, DVector};

/// An approximate inverse of an `n` by `n` matrix, row-major; `None` where elimination meets a zero pivot or overflows.
pub(crate) fn inverse(a: &[f64], n: usize) -> Option<Vec<f64>> {
    let inverse = DMatrix::from_row_slice(n, n, a).lu().try_inverse()?;
    inverse.iter().all(|x| x.is_finite()).then(|| inverse.transpose().as_slice().to_vec())
}

/// A factorised basis matrix: solves with it and with its transpose.
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

    /// `B^-T v`.
    pub(crate) fn solve_transposed(&self, v: &[f64]) -> Vec<f64> {
        self.inverse.tr_mul(&DVector::from_column_slice(v)).as_slice().to_vec()
    }
}

/// A least-squares solution of `A x = b` for `m` by `n` row-major `A`, by its normal equations with columns scaled to
/// unit length; a start for searches, so a singular system just gives zeros.
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

/// The product of an `m` by `k` and a `k` by `n` matrix, all row-major, in any order of summation.
pub(crate) fn product(a: &[f64], b: &[f64], m: usize, k: usize, n: usize) -> Vec<f64> {
    // Row-major storage is that of the transposes, whose product is the transpose of the product.
    let (left, right) = (DMatrix::from_column_slice(n, k, b), DMatrix::from_column_slice(k, m, a));
    (left * right).as_slice().to_vec()
}
