//! Rows and columns scaled by powers of two: the inverse is scaled by the same powers, exactly.

use crate::matrix::IntervalMatrix;
use crate::regularity::{SingularMember, Witness};

/// A matrix with rows and columns scaled by powers of two, so that products neither overflow nor lose digits.
pub(crate) struct Scaled {
    pub a: IntervalMatrix,
    rows: Vec<i32>,
    columns: Vec<i32>,
}

impl Scaled {
    /// `None` where a scaled bound is not exact.
    pub(crate) fn new(a: &IntervalMatrix) -> Option<Self> {
        let n = a.rows();
        let (mut rows, mut columns) = (vec![0; n], vec![0; n]);
        let extreme = |x: f64| x != 0.0 && !(1e-60..1e60).contains(&x.abs());
        if !a.lo().iter().chain(a.hi()).any(|&x| extreme(x)) {
            return Some(Self { a: a.clone(), rows, columns });
        }
        let size = a.magnitude();
        let exponent = |x: f64| if x > 0.0 { binary_exponent(x) } else { 0 };
        // Geometric means of the extremes, in turn, bring rows and columns to a common size.
        for _ in 0..4 {
            for i in 0..n {
                let sizes = (0..n).filter(|&j| size[i * n + j] > 0.0);
                let found: Vec<i32> = sizes.map(|j| exponent(size[i * n + j]) + columns[j]).collect();
                rows[i] = -middle_of(&found);
            }
            for j in 0..n {
                let sizes = (0..n).filter(|&i| size[i * n + j] > 0.0);
                let found: Vec<i32> = sizes.map(|i| exponent(size[i * n + j]) + rows[i]).collect();
                columns[j] = -middle_of(&found);
            }
        }
        let scale = |bounds: &[f64]| -> Option<Vec<f64>> {
            let scaled = |(at, &x): (usize, &f64)| {
                let by = rows[at / n] + columns[at % n];
                let y = scaled_down(x, by);
                (scaled_down(y, -by) == x && y.is_finite() && (x == 0.0 || y.abs() > 1e-250)).then_some(y)
            };
            bounds.iter().enumerate().map(scaled).collect()
        };
        let a = IntervalMatrix::new(n, n, scale(a.lo())?, scale(a.hi())?).ok()?;
        Some(Self { a, rows, columns })
    }

    /// The ends of the inverse of the matrix as it was: `B_ij` is scaled by column `i` and row `j`.
    pub(crate) fn unscale(&self, lower: &[f64], upper: &[f64]) -> Option<IntervalMatrix> {
        let n = self.a.rows();
        let by = |at: usize| self.columns[at / n] + self.rows[at % n];
        let lo: Vec<f64> = lower.iter().enumerate().map(|(at, &x)| scaled_down(x, by(at)) + 0.0).collect();
        let hi: Vec<f64> = upper.iter().enumerate().map(|(at, &x)| -scaled_down(-x, by(at)) + 0.0).collect();
        let finite = lo.iter().chain(&hi).all(|x| x.is_finite());
        finite.then(|| IntervalMatrix::new(n, n, lo, hi).ok()).flatten()
    }

    /// A singular member of the matrix as it was. Members are scaled exactly; a null vector whose scaling rounds no longer
    /// proves anything, and its check says so.
    pub(crate) fn member(&self, member: SingularMember) -> SingularMember {
        let n = self.a.rows();
        let back = |m: Vec<f64>| -> Vec<f64> {
            m.iter().enumerate().map(|(at, &x)| scaled_down(x, -self.rows[at / n] - self.columns[at % n])).collect()
        };
        match member {
            SingularMember::Member(m) => SingularMember::Member(back(m)),
            SingularMember::OppositeSigns(m, o) => SingularMember::OppositeSigns(back(m), back(o)),
            SingularMember::NullVector(x) => {
                SingularMember::NullVector(x.iter().zip(&self.columns).map(|(&v, &by)| scaled_down(v, by)).collect())
            }
        }
    }

    /// A witness of the matrix as it was.
    pub(crate) fn witness(&self, witness: Witness) -> Witness {
        if self.rows.iter().chain(&self.columns).all(|&e| e == 0) {
            return witness;
        }
        let n = self.a.rows();
        match witness {
            Witness::ScaledContraction { approximate_inverse, vector } => {
                let r = approximate_inverse.iter().enumerate();
                let by = |at: usize| self.columns[at / n] + self.rows[at % n];
                let approximate_inverse: Vec<f64> = r.map(|(at, &x)| scaled_down(x, by(at))).collect();
                let vector = vector.iter().enumerate().map(|(i, &x)| scaled_down(x, self.columns[i])).collect();
                Witness::ScaledContraction { approximate_inverse, vector }
            }
            other => other,
        }
    }
}

/// The midpoint of the least and the largest.
fn middle_of(exponents: &[i32]) -> i32 {
    let (least, most) = (exponents.iter().min(), exponents.iter().max());
    least.zip(most).map_or(0, |(a, b)| i32::midpoint(*a, *b))
}

/// The exponent of a positive double's leading bit.
fn binary_exponent(x: f64) -> i32 {
    let biased = i32::try_from((x.to_bits() >> 52) & 0x7ff).unwrap_or(0);
    if biased == 0 { binary_exponent(x * f64::from_bits((1023 + 60) << 52)) - 60 } else { biased - 1023 }
}

/// `x 2^by` rounded down.
fn scaled_down(x: f64, by: i32) -> f64 {
    let mut value = x;
    let mut left = by;
    while left != 0 {
        let step = left.clamp(-900, 900);
        let factor = f64::from_bits(u64::from((1023 + step).unsigned_abs()) << 52);
        value = crate::rounding::mul_down(value, factor);
        left -= step;
    }
    value
}
