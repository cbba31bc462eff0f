//! Dense interval matrices in two row-major arrays of bounds.

mod nalgebra_matrices;
mod product;

use crate::error::Error;
use crate::interval::Interval;
use crate::rounding::{add_up, mul_up, sqrt_up};

/// A `rows` by `columns` interval matrix. No entry is empty.
#[derive(Debug, Clone, PartialEq)]
pub struct IntervalMatrix {
    rows: usize,
    columns: usize,
    lo: Vec<f64>,
    hi: Vec<f64>,
}

impl IntervalMatrix {
    /// The matrix with these bounds, row-major.
    ///
    /// # Errors
    /// Wrong lengths, NaN, reversed bounds and entries without a finite point are refused.
    ///
    /// # Example
    /// ```
    /// use interval_core::IntervalMatrix;
    /// // the example of section IV.A of the paper
    /// let q = IntervalMatrix::new(2, 2, vec![2.0, -2.0, -1.5, -2.0], vec![4.0, 2.0, 4.5, 3.5])?;
    /// assert_eq!(q.norm(), 8.0);
    /// assert_eq!(q.midpoint(), [3.0, 0.0, 1.5, 0.75]);
    /// assert_eq!(q.radius(), [1.0, 2.0, 3.0, 2.75]);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    pub fn new(rows: usize, columns: usize, lo: Vec<f64>, hi: Vec<f64>) -> Result<Self, Error> {
        let needed = rows.saturating_mul(columns);
        if lo.len() != needed {
            return Err(Error::Shape { what: "the lower bound", given: lo.len(), needed });
        }
        if hi.len() != needed {
            return Err(Error::Shape { what: "the upper bound", given: hi.len(), needed });
        }
        for (index, (&l, &h)) in lo.iter().zip(&hi).enumerate() {
            Interval::at(l, h, index)?;
        }
        Ok(Self { rows, columns, lo, hi })
    }

    /// A matrix of non-empty intervals, row-major.
    pub(crate) fn from_entries(rows: usize, columns: usize, entries: &[Interval]) -> Self {
        debug_assert_eq!(entries.len(), rows * columns);
        let lo = entries.iter().map(|x| x.lo()).collect();
        let hi = entries.iter().map(|x| x.hi()).collect();
        Self { rows, columns, lo, hi }
    }

    /// A matrix of finite numbers, row-major.
    pub(crate) fn from_points(rows: usize, columns: usize, points: &[f64]) -> Self {
        Self { rows, columns, lo: points.to_vec(), hi: points.to_vec() }
    }

    /// The identity.
    #[must_use]
    pub fn identity(n: usize) -> Self {
        let mut points = vec![0.0; n * n];
        for i in 0..n {
            points[i * n + i] = 1.0;
        }
        Self::from_points(n, n, &points)
    }

    /// Number of rows.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// Lower bounds, row-major.
    #[must_use]
    pub fn lo(&self) -> &[f64] {
        &self.lo
    }

    /// Upper bounds, row-major.
    #[must_use]
    pub fn hi(&self) -> &[f64] {
        &self.hi
    }

    /// The entry in row `i`, column `j`.
    ///
    /// # Panics
    /// Outside the matrix.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> Interval {
        let at = i * self.columns + j;
        Interval::raw(self.lo[at], self.hi[at])
    }

    /// The entries, row-major.
    pub fn entries(&self) -> impl Iterator<Item = Interval> + '_ {
        self.lo.iter().zip(&self.hi).map(|(&l, &h)| Interval::raw(l, h))
    }

    /// The order of a square matrix.
    ///
    /// # Errors
    /// A matrix that is not square, or has no entry.
    pub fn order(&self) -> Result<usize, Error> {
        if self.rows != self.columns {
            Err(Error::NotSquare { rows: self.rows, columns: self.columns })
        } else if self.rows == 0 {
            Err(Error::Zero { what: "the order of the matrix" })
        } else {
            Ok(self.rows)
        }
    }

    /// True if every bound is finite.
    #[must_use]
    pub fn is_bounded(&self) -> bool {
        self.lo.iter().chain(&self.hi).all(|x| x.is_finite())
    }

    /// Midpoints, row-major ([`Interval::midpoint`]).
    #[must_use]
    pub fn midpoint(&self) -> Vec<f64> {
        self.entries().map(Interval::midpoint).collect()
    }

    /// Radii about the midpoints, rounded up ([`Interval::radius`]).
    #[must_use]
    pub fn radius(&self) -> Vec<f64> {
        self.entries().map(Interval::radius).collect()
    }

    /// The maximum row sum of magnitudes, rounded up (the norm of section IV.A of the paper).
    #[must_use]
    pub fn norm(&self) -> f64 {
        (0..self.rows)
            .map(|i| (0..self.columns).fold(0.0, |sum, j| add_up(sum, self.get(i, j).magnitude())))
            .fold(0.0, f64::max)
    }

    /// The maximum column sum of magnitudes, rounded up.
    #[must_use]
    pub fn norm_one(&self) -> f64 {
        (0..self.columns)
            .map(|j| (0..self.rows).fold(0.0, |sum, i| add_up(sum, self.get(i, j).magnitude())))
            .fold(0.0, f64::max)
    }

    /// The root of the sum of squared magnitudes (Frobenius), rounded up.
    #[must_use]
    pub fn norm_frobenius(&self) -> f64 {
        sqrt_up(self.entries().map(Interval::magnitude).fold(0.0, |sum, x| add_up(sum, mul_up(x, x))))
    }

    /// Smallest absolute values, row-major.
    #[must_use]
    pub fn mignitude(&self) -> Vec<f64> {
        self.entries().map(Interval::mignitude).collect()
    }

    /// Largest absolute values, row-major.
    #[must_use]
    pub fn magnitude(&self) -> Vec<f64> {
        self.entries().map(Interval::magnitude).collect()
    }

    /// Ostrowski's comparison matrix, row-major: mignitudes on the diagonal, negative magnitudes elsewhere.
    ///
    /// ```
    /// use interval_core::IntervalMatrix;
    /// let a = IntervalMatrix::new(2, 2, vec![3.0, -1.0, 0.5, -4.0], vec![4.0, 2.0, 0.5, -2.0])?;
    /// assert_eq!(a.comparison(), [3.0, -2.0, -0.5, 2.0]);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    #[must_use]
    pub fn comparison(&self) -> Vec<f64> {
        let entry = |(at, x): (usize, Interval)| {
            if at / self.columns == at % self.columns { x.mignitude() } else { -x.magnitude() }
        };
        self.entries().enumerate().map(entry).collect()
    }

    /// The transpose.
    #[must_use]
    pub fn transpose(&self) -> Self {
        let mut entries = Vec::with_capacity(self.lo.len());
        for j in 0..self.columns {
            entries.extend((0..self.rows).map(|i| self.get(i, j)));
        }
        Self::from_entries(self.columns, self.rows, &entries)
    }

    /// The same with other bounds of one entry.
    pub(crate) fn with_bounds(&self, at: usize, lo: f64, hi: f64) -> Self {
        let mut other = self.clone();
        (other.lo[at], other.hi[at]) = (lo, hi);
        other
    }

    /// Entrywise intersection. The value is `None` if an entry would be empty. The shapes are equal.
    pub(crate) fn intersection(&self, other: &Self) -> Option<Self> {
        let entries: Vec<Interval> = self.entries().zip(other.entries()).map(|(a, b)| a.intersection(b)).collect();
        if entries.iter().any(|x| x.is_empty()) {
            return None;
        }
        Some(Self::from_entries(self.rows, self.columns, &entries))
    }

    /// Entrywise sum; the shapes are equal.
    pub(crate) fn add(&self, other: &Self) -> Self {
        let entries: Vec<Interval> = self.entries().zip(other.entries()).map(|(a, b)| a + b).collect();
        Self::from_entries(self.rows, self.columns, &entries)
    }
}
