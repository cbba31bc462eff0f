//! Checks of certificates in exact integer arithmetic: the code that made them is not used.

use crate::exact::{self, integers};
use crate::inverse::Certificate;
use crate::matrix::IntervalMatrix;
use crate::regularity::{Cell, SingularMember, Witness};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

/// The largest order whose vertex matrices are checked: `2^(2n-1)` determinants.
const VERTEX_LIMIT: usize = 6;

impl Certificate {
    /// True if the certificate proves its statement of `a`: that every member is regular, or that one is singular.
    ///
    /// Every check is exact, in integers or rationals; a certificate that does not fit the matrix is false.
    ///
    /// ```
    /// use interval_core::{IntervalMatrix, inverse};
    /// let a = IntervalMatrix::new(1, 1, vec![1.0], vec![2.0])?;
    /// let certificate = inverse::exact(&a)?.certificate.expect("proved");
    /// assert!(certificate.verify(&a));
    /// let wider = IntervalMatrix::new(1, 1, vec![-1.0], vec![2.0])?;
    /// assert!(!certificate.verify(&wider));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn verify(&self, a: &IntervalMatrix) -> bool {
        if a.order().is_err() || !a.is_bounded() {
            return false;
        }
        match self {
            Self::Regular(witness) => regular(a, witness),
            Self::Singular(member) => singular(a, member),
            Self::Determinant { lo, hi } => determinant(a, *lo, *hi),
        }
    }
}

fn finite(x: &[f64], length: usize) -> bool {
    x.len() == length && x.iter().all(|v| v.is_finite())
}

fn regular(a: &IntervalMatrix, witness: &Witness) -> bool {
    let n = a.rows();
    match witness {
        Witness::Contraction { approximate_inverse, norm } => {
            *norm < 1.0 && contracts(a, approximate_inverse, &vec![1.0; n], Some(*norm))
        }
        Witness::ScaledContraction { approximate_inverse, vector } => contracts(a, approximate_inverse, vector, None),
        Witness::NonnegativeInverses => [a.lo(), a.hi()]
            .into_iter()
            .all(|m| exact::inverse(m, n).is_some_and(|(_, inverse)| inverse.iter().all(|x| !x.is_negative()))),
        Witness::PositiveDefinite { shift, vector, congruence } => positive_definite(a, *shift, vector, congruence),
        Witness::Cells(cell) => cell_is_regular(a, cell),
        Witness::VertexDeterminants { sign } => {
            *sign != 0
                && n <= VERTEX_LIMIT
                && crate::regularity::vertices(a).all(|v| exact::determinant_sign(&v, n) == *sign)
        }
    }
}

/// `|I - R A| v < v` for every member, and `v > 0`; with a norm and `v = 1` also that it bounds `||I - R A||`.
fn contracts(a: &IntervalMatrix, r: &[f64], v: &[f64], norm: Option<f64>) -> bool {
    let n = a.rows();
    if !finite(r, n * n) || !finite(v, n) || v.iter().any(|&x| x <= 0.0) {
        return false;
    }
    let (r, r_exponent) = integers(r);
    let bounds: Vec<f64> = a.lo().iter().chain(a.hi()).copied().collect();
    let (bounds, exponent) = integers(&bounds);
    let (v, _) = integers(v);
    // Products are multiples of 2^(r_exponent + exponent); the identity is brought to the same scale, or they to it.
    let scale = r_exponent + exponent;
    let (one, lift) = if scale <= 0 { (BigInt::one() << -scale, 0) } else { (BigInt::one(), scale) };
    (0..n).all(|i| {
        let mut sum = BigInt::zero();
        for j in 0..n {
            let (mut least, mut most) = (BigInt::zero(), BigInt::zero());
            for k in 0..n {
                let factor = &r[i * n + k];
                let (p, q) = (factor * &bounds[k * n + j], factor * &bounds[n * n + k * n + j]);
                if factor.is_negative() {
                    least += q;
                    most += p;
                } else {
                    least += p;
                    most += q;
                }
            }
            let delta = if i == j { one.clone() } else { BigInt::zero() };
            let (below, above) = (&delta - (most << lift), &delta - (least << lift));
            sum += below.abs().max(above.abs()) * &v[j];
        }
        let bounded = |norm: f64| {
            norm.is_finite()
                && BigRational::from_integer(sum.clone())
                    <= exact::rational(norm) * BigRational::from_integer(one.clone())
        };
        sum < &one * &v[i] && norm.is_none_or(bounded)
    })
}

fn cell_is_regular(a: &IntervalMatrix, cell: &Cell) -> bool {
    let mut open = vec![(a.clone(), cell)];
    while let Some((a, cell)) = open.pop() {
        match cell {
            Cell::Regular { approximate_inverse, vector } => {
                if !contracts(&a, approximate_inverse, vector, None) {
                    return false;
                }
            }
            Cell::Halved { entry, value, halves } => {
                let inside = |e: usize| a.lo()[e] <= *value && *value <= a.hi()[e];
                if *entry >= a.lo().len() || !inside(*entry) {
                    return false;
                }
                let (below, above) = crate::regularity::halves(&a, *entry, *value);
                open.push((below, &halves[0]));
                open.push((above, &halves[1]));
            }
        }
    }
    true
}

/// `D'D w <= shift w` for radii `D` about the midpoints `m`, and `||I - X (m'm - shift I) X'|| < 1`.
fn positive_definite(a: &IntervalMatrix, shift: f64, w: &[f64], x: &[f64]) -> bool {
    let n = a.rows();
    if !shift.is_finite() || !finite(w, n) || !finite(x, n * n) || w.iter().any(|&v| v <= 0.0) {
        return false;
    }
    let rational = |values: &[f64]| -> Vec<BigRational> { values.iter().map(|&v| exact::rational(v)).collect() };
    let (m, lo, hi) = (rational(&a.midpoint()), rational(a.lo()), rational(a.hi()));
    let d: Vec<BigRational> = (0..n * n).map(|at| (&hi[at] - &m[at]).max(&m[at] - &lo[at])).collect();
    let (w, x, shift) = (rational(w), rational(x), exact::rational(shift));
    let row = |matrix: &[BigRational], v: &[BigRational], i: usize| {
        (0..n).fold(BigRational::zero(), |sum, j| sum + &matrix[i * n + j] * &v[j])
    };
    let image: Vec<BigRational> = (0..n).map(|i| row(&d, &w, i)).collect();
    let small =
        (0..n).all(|j| (0..n).fold(BigRational::zero(), |sum, i| sum + &d[i * n + j] * &image[i]) <= &shift * &w[j]);
    let product = |p: &[BigRational], q: &[BigRational], transposed: bool| -> Vec<BigRational> {
        let entry = |at: usize| {
            let (i, j) = (at / n, at % n);
            (0..n).fold(BigRational::zero(), |sum, k| {
                sum + &p[i * n + k] * &q[if transposed { j * n + k } else { k * n + j }]
            })
        };
        (0..n * n).map(entry).collect()
    };
    let turned: Vec<BigRational> = (0..n * n).map(|at| m[(at % n) * n + at / n].clone()).collect();
    let mut s = product(&turned, &m, false);
    for i in 0..n {
        s[i * n + i] -= &shift;
    }
    let image = product(&product(&x, &s, false), &x, true);
    small
        && (0..n).all(|i| {
            let deviation = (0..n).fold(BigRational::zero(), |sum, j| {
                let delta = if i == j { BigRational::one() } else { BigRational::zero() };
                sum + (delta - &image[i * n + j]).abs()
            });
            deviation < BigRational::one()
        })
}

fn singular(a: &IntervalMatrix, member: &SingularMember) -> bool {
    let n = a.rows();
    let belongs = |m: &[f64]| finite(m, n * n) && m.iter().zip(a.entries()).all(|(&x, e)| e.contains(x));
    match member {
        SingularMember::Member(m) => belongs(m) && exact::determinant_sign(m, n) == 0,
        SingularMember::OppositeSigns(m, o) => {
            belongs(m) && belongs(o) && exact::determinant_sign(m, n) * exact::determinant_sign(o, n) < 0
        }
        SingularMember::NullVector(x) => {
            let row = |i: usize| {
                (0..n).fold((BigRational::zero(), BigRational::zero()), |(least, most), j| {
                    let (v, e) = (exact::rational(x[j]), a.get(i, j));
                    let (p, q) = (exact::rational(e.lo()) * &v, exact::rational(e.hi()) * &v);
                    if v.is_negative() { (least + q, most + p) } else { (least + p, most + q) }
                })
            };
            finite(x, n)
                && x.iter().any(|&v| v != 0.0)
                && (0..n).map(row).all(|(least, most)| !least.is_positive() && !most.is_negative())
        }
    }
}

/// Laplace expansion over sets of columns in rational intervals: within `[lo, hi]`, which does not hold 0.
fn determinant(a: &IntervalMatrix, lo: f64, hi: f64) -> bool {
    let n = a.rows();
    if !(lo.is_finite() && hi.is_finite() && (lo > 0.0 || hi < 0.0) && lo <= hi) || n > 10 {
        return false;
    }
    let mut minors = vec![(BigRational::one(), BigRational::one()); 1 << n];
    for mask in 1_usize..1 << n {
        let row = mask.count_ones() as usize - 1;
        let mut sum = (BigRational::zero(), BigRational::zero());
        for j in (0..n).filter(|j| mask >> j & 1 == 1) {
            let entry = a.get(row, j);
            let minor = &minors[mask & !(1 << j)];
            let ends = [entry.lo(), entry.hi()].map(exact::rational);
            let products: Vec<BigRational> = ends.iter().flat_map(|e| [e * &minor.0, e * &minor.1]).collect();
            let least = products.iter().min().cloned().unwrap_or_default();
            let most = products.iter().max().cloned().unwrap_or_default();
            let even = (mask >> (j + 1)).count_ones() % 2 == 0;
            sum = if even { (sum.0 + least, sum.1 + most) } else { (sum.0 - most, sum.1 - least) };
        }
        minors[mask] = sum;
    }
    let (least, most) = &minors[(1 << n) - 1];
    exact::rational(lo) <= *least && *most <= exact::rational(hi)
}
