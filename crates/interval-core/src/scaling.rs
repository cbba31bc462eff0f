//! Rows and columns scaled by powers of two: the inverse is scaled by the same powers, exactly.

use crate::interval::Interval;
use crate::matrix::IntervalMatrix;
use crate::witness::{SingularMember, Witness};

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
        // Geometric means of the extremes, in turn, bring rows and columns to a common size.
        for _ in 0..4 {
            for i in 0..n {
                let sizes = (0..n).filter(|&j| size[i * n + j] > 0.0);
                let found: Vec<i32> = sizes.map(|j| exponent_of(size[i * n + j]) + columns[j]).collect();
                rows[i] = -middle_of(&found);
            }
            for j in 0..n {
                let sizes = (0..n).filter(|&i| size[i * n + j] > 0.0);
                let found: Vec<i32> = sizes.map(|i| exponent_of(size[i * n + j]) + rows[i]).collect();
                columns[j] = -middle_of(&found);
            }
        }
        let scale = |bounds: &[f64]| -> Option<Vec<f64>> {
            let scaled = |(at, &x): (usize, &f64)| {
                exactly(x, rows[at / n] + columns[at % n]).filter(|y| x == 0.0 || y.abs() > 1e-250)
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

    /// The values that members of the scaled matrix attain, rounded inward: upper bounds of the least entries and lower
    /// bounds of the largest.
    pub(crate) fn unscale_inward(&self, least: &[f64], most: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let n = self.a.rows();
        let by = |at: usize| self.columns[at / n] + self.rows[at % n];
        let least = least.iter().enumerate().map(|(at, &x)| -scaled_down(-x, by(at))).collect();
        (least, most.iter().enumerate().map(|(at, &x)| scaled_down(x, by(at))).collect())
    }

    /// The right-hand side of a system with the scaled matrix, and the common power of two that it is scaled by
    /// besides. The value is `None` if a scaled bound is not exact.
    pub(crate) fn right_hand_side(&self, b: &[Interval]) -> Option<(Vec<Interval>, i32)> {
        let moved: Vec<i32> = b.iter().zip(&self.rows).map(|(x, r)| exponent_of(x.magnitude()) + r).collect();
        let used = moved.iter().zip(b).filter(|(_, x)| x.magnitude() > 0.0).map(|(&e, _)| e);
        let largest = used.max().unwrap_or(0);
        let common = if largest.abs() > 200 { -largest } else { 0 };
        let scaled = |(x, r): (&Interval, &i32)| {
            let (lo, hi) = (exactly(x.lo(), r + common)?, exactly(x.hi(), r + common)?);
            Some(Interval::raw(lo, hi))
        };
        let scaled: Option<Vec<Interval>> = b.iter().zip(&self.rows).map(scaled).collect();
        Some((scaled?, common))
    }

    /// Bounds of the solutions of a system as it was.
    pub(crate) fn unscale_solution(&self, lower: &[f64], upper: &[f64], common: i32) -> Option<IntervalMatrix> {
        let lo: Vec<f64> = lower.iter().zip(&self.columns).map(|(&x, c)| scaled_down(x, c - common) + 0.0).collect();
        let hi: Vec<f64> = upper.iter().zip(&self.columns).map(|(&x, c)| -scaled_down(-x, c - common) + 0.0).collect();
        let finite = lo.iter().chain(&hi).all(|x| x.is_finite());
        finite.then(|| IntervalMatrix::new(lo.len(), 1, lo, hi).ok()).flatten()
    }

    /// True if nothing was scaled.
    pub(crate) fn is_trivial(&self) -> bool {
        self.rows.iter().chain(&self.columns).all(|&e| e == 0)
    }

    /// A singular member of the matrix as it was. The value is `None` if it is none in doubles.
    pub(crate) fn member(&self, member: SingularMember) -> Option<SingularMember> {
        if self.is_trivial() {
            return Some(member);
        }
        let n = self.a.rows();
        let back = |m: &[f64]| -> Option<Vec<f64>> {
            m.iter().enumerate().map(|(at, &x)| exactly(x, -self.rows[at / n] - self.columns[at % n])).collect()
        };
        Some(match member {
            SingularMember::Member(m) => SingularMember::Member(back(&m)?),
            SingularMember::OppositeSigns(m, o) => SingularMember::OppositeSigns(back(&m)?, back(&o)?),
            SingularMember::NullVector(x) => SingularMember::NullVector(self.vector(&x)?),
        })
    }

    /// `x_i 2^(columns_i)`, all of them times one power of two, exactly.
    fn vector(&self, x: &[f64]) -> Option<Vec<f64>> {
        let common = middle_of(&self.columns);
        x.iter().zip(&self.columns).map(|(&v, &by)| exactly(v, by - common)).collect()
    }

    /// A witness of the matrix as it was. The value is `None` if it is none in doubles.
    pub(crate) fn witness(&self, witness: Witness) -> Option<Witness> {
        let n = self.a.rows();
        match witness {
            witness if self.is_trivial() => Some(witness),
            Witness::ScaledContraction { approximate_inverse, vector } => {
                self.contraction(&approximate_inverse, &vector)
            }
            Witness::Contraction { approximate_inverse, .. } => self.contraction(&approximate_inverse, &vec![1.0; n]),
            // Signs do not change with positive factors.
            Witness::VertexDeterminants { sign } => Some(Witness::VertexDeterminants { sign }),
            Witness::NonnegativeInverses | Witness::PositiveDefinite { .. } | Witness::Cells(_) => None,
        }
    }

    fn contraction(&self, r: &[f64], v: &[f64]) -> Option<Witness> {
        let n = self.a.rows();
        let by = |at: usize| self.columns[at / n] + self.rows[at % n];
        let approximate_inverse: Option<Vec<f64>> = r.iter().enumerate().map(|(at, &x)| exactly(x, by(at))).collect();
        let vector = self.vector(v)?;
        Some(Witness::ScaledContraction { approximate_inverse: approximate_inverse?, vector })
    }
}

/// `x 2^by` where that is a double.
fn exactly(x: f64, by: i32) -> Option<f64> {
    let y = scaled_down(x, by);
    (y.is_finite() && scaled_down(y, -by) == x).then_some(y)
}

fn exponent_of(x: f64) -> i32 {
    if x > 0.0 { binary_exponent(x) } else { 0 }
}

/// The midpoint of the least and the largest.
fn middle_of(exponents: &[i32]) -> i32 {
    let (least, most) = (exponents.iter().min(), exponents.iter().max());
    least.zip(most).map_or(0, |(a, b)| (a + b) / 2)
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
