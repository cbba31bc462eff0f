//! Is every member of an interval matrix nonsingular? Answers with a certificate.

use crate::approximate;
use crate::exact;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;
use crate::rounding::{add_up, mul_up};

/// The largest order for which all vertex matrices are examined: 2^(2n-1) of them.
pub const VERTEX_LIMIT: usize = 4;

/// The verdict on an interval matrix.
#[derive(Debug, Clone, PartialEq)]
pub enum Regularity {
    /// Every member is nonsingular.
    Regular(Witness),
    /// Some member is singular.
    Singular(SingularMember),
    /// Neither was proved.
    NotProved,
}

/// Why an interval matrix is regular.
#[derive(Debug, Clone, PartialEq)]
pub enum Witness {
    /// `||I - R A|| <= norm < 1` in the maximum row sum norm for this `R` (row-major): `R A` and with it `A` is
    /// nonsingular for every member.
    Contraction {
        /// An approximate inverse of the midpoint, row-major.
        approximate_inverse: Vec<f64>,
        /// Upper bound of the norm.
        norm: f64,
    },
    /// `|I - R A| v < v` for this `R` (row-major) and `v > 0`: the same in a norm scaled by `v`.
    ScaledContraction {
        /// An approximate inverse of the midpoint, row-major.
        approximate_inverse: Vec<f64>,
        /// The positive vector.
        vector: Vec<f64>,
    },
    /// The matrices of lower and of upper bounds have non-negative inverses (Kuttler 1971).
    NonnegativeInverses,
    /// The determinants of all vertex matrices `A_c - T_y Delta T_z` have this strict sign (Baumann 1984).
    VertexDeterminants {
        /// -1 or 1.
        sign: i8,
    },
}

/// Why an interval matrix holds a singular member.
#[derive(Debug, Clone, PartialEq)]
pub enum SingularMember {
    /// This member (row-major) has determinant zero, exactly.
    Member(Vec<f64>),
    /// These two members (row-major) have determinants of opposite sign: on the segment between them one is zero.
    OppositeSigns(Vec<f64>, Vec<f64>),
}

/// Proves regularity by contraction, plain or scaled, or for small orders decides it by the vertex determinants.
///
/// The matrix is square and bounded.
#[must_use]
pub fn regularity(a: &IntervalMatrix) -> Regularity {
    if !crate::rounding::environment_is_default() {
        return Regularity::NotProved;
    }
    if let Some(witness) = contraction(a).or_else(|| scaled_contraction(a)) {
        return Regularity::Regular(witness);
    }
    if a.rows() > VERTEX_LIMIT {
        return Regularity::NotProved;
    }
    let n = a.rows();
    let mut first: Option<(i8, Vec<f64>)> = None;
    for vertex in vertices(a) {
        let sign = exact::determinant_sign(&vertex, n);
        if sign == 0 {
            return Regularity::Singular(SingularMember::Member(vertex));
        }
        match &first {
            None => first = Some((sign, vertex)),
            Some((other, member)) if *other != sign => {
                return Regularity::Singular(SingularMember::OppositeSigns(member.clone(), vertex));
            }
            Some(_) => {}
        }
    }
    Regularity::Regular(Witness::VertexDeterminants { sign: first.map_or(1, |(sign, _)| sign) })
}

/// `||I - R A|| < 1` for an approximate inverse `R` of the midpoint (METHODS 4.1, strong regularity).
fn contraction(a: &IntervalMatrix) -> Option<Witness> {
    let n = a.rows();
    let approximate_inverse = approximate::inverse(&a.midpoint(), n)?;
    let norm = residual(&approximate_inverse, a).norm();
    (norm < 1.0).then_some(Witness::Contraction { approximate_inverse, norm })
}

/// `|I - R A| v < v` for an approximate inverse `R` of the midpoint and a `v > 0` (METHODS 4.1, the verified form of
/// `rho(|I - R A|) < 1`).
fn scaled_contraction(a: &IntervalMatrix) -> Option<Witness> {
    let n = a.rows();
    let approximate_inverse = approximate::inverse(&a.midpoint(), n)?;
    let vector = contracted_vector(&residual(&approximate_inverse, a).magnitude(), n)?;
    Some(Witness::ScaledContraction { approximate_inverse, vector })
}

/// A positive `v` with `G v < v`, proved in upward rounding: an approximation of `(I - G)^-1` times ones, or of the dominant
/// eigenvector of `G`.
pub(crate) fn contracted_vector(g: &[f64], n: usize) -> Option<Vec<f64>> {
    let holds = |v: &[f64]| {
        g.chunks_exact(n).zip(v).all(|(row, &target)| {
            let product = row.iter().zip(v).fold(0.0, |sum, (&x, &y)| add_up(sum, mul_up(x, y)));
            target > 0.0 && target.is_finite() && product < target
        })
    };
    let mut v = vec![1.0; n];
    for _ in 0..20 {
        if holds(&v) {
            return Some(v);
        }
        // One step of the sum 1 + G + G^2 + ..., scaled: towards the dominant eigenvector, kept positive.
        let next: Vec<f64> =
            g.chunks_exact(n).map(|row| 1e-3 + row.iter().zip(&v).map(|(x, y)| x * y).sum::<f64>()).collect();
        let largest = next.iter().copied().fold(0.0, f64::max);
        v = next.into_iter().map(|x| x / largest).collect();
    }
    let shifted: Vec<f64> = g.iter().enumerate().map(|(at, x)| if at % (n + 1) == 0 { 1.0 - x } else { -x }).collect();
    let inverse = approximate::inverse(&shifted, n)?;
    let sums: Vec<f64> = inverse.chunks_exact(n).map(|row| row.iter().sum()).collect();
    holds(&sums).then_some(sums)
}

/// `I - R A` for a point matrix `R`, row-major.
pub(crate) fn residual(r: &[f64], a: &IntervalMatrix) -> IntervalMatrix {
    let n = a.rows();
    let mut entries = Vec::with_capacity(n * n);
    for i in 0..n {
        for j in 0..n {
            let start = if i == j { Interval::ONE } else { Interval::ZERO };
            entries.push((0..n).fold(start, |sum, k| {
                let factor = r[i * n + k];
                sum - Interval::raw(factor, factor) * a.get(k, j)
            }));
        }
    }
    IntervalMatrix::from_entries(n, n, &entries)
}

/// The vertex matrices `A_c - T_y Delta T_z` for sign vectors `y`, `z` with `y_1 = 1`, row-major. `y_i z_j = 1` takes the
/// lower bound, so the entries are exact.
pub(crate) fn vertices(a: &IntervalMatrix) -> impl Iterator<Item = Vec<f64>> + '_ {
    let n = a.rows();
    (0..1_usize << (2 * n - 1)).map(move |bits| {
        let (y, z) = (bits >> n, bits & ((1 << n) - 1));
        let mut vertex = Vec::with_capacity(n * n);
        for i in 0..n {
            for j in 0..n {
                let opposite = ((y >> i) ^ (z >> j)) & 1 == 1;
                let at = i * n + j;
                vertex.push(if opposite { a.hi()[at] } else { a.lo()[at] });
            }
        }
        vertex
    })
}

/// Each column's largest magnitude.
pub(crate) fn column_norms(a: &IntervalMatrix) -> Vec<f64> {
    (0..a.columns()).map(|j| (0..a.rows()).map(|i| a.get(i, j).magnitude()).fold(0.0, f64::max)).collect()
}
