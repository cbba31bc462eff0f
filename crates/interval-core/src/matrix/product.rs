//! Products of interval matrices: sums of tightest products, each rounded outward.

use super::IntervalMatrix;
use crate::error::Error;
use crate::interval::Interval;

impl IntervalMatrix {
    /// The product `self * other`.
    ///
    /// # Errors
    /// Where the inner dimensions differ.
    pub fn multiply(&self, other: &Self) -> Result<Self, Error> {
        if self.columns() != other.rows() {
            return Err(Error::Shape {
                what: "the right factor's number of rows",
                given: other.rows(),
                needed: self.columns(),
            });
        }
        let mut entries = Vec::with_capacity(self.rows() * other.columns());
        for i in 0..self.rows() {
            for j in 0..other.columns() {
                let mut sum = Interval::ZERO;
                for k in 0..self.columns() {
                    sum = sum + self.get(i, k) * other.get(k, j);
                }
                entries.push(sum);
            }
        }
        Ok(Self::from_entries(self.rows(), other.columns(), &entries))
    }

    /// `A'A`: symmetric, with squares on the diagonal, which a plain product would widen.
    #[must_use]
    pub fn gram(&self) -> Self {
        let n = self.columns();
        let mut entries = vec![Interval::ZERO; n * n];
        for row in 0..self.rows() {
            for i in 0..n {
                let x = self.get(row, i);
                entries[i * n + i] = entries[i * n + i] + x.square();
                for j in 0..i {
                    let term = x * self.get(row, j);
                    entries[i * n + j] = entries[i * n + j] + term;
                }
            }
        }
        for i in 0..n {
            for j in 0..i {
                entries[j * n + i] = entries[i * n + j];
            }
        }
        Self::from_entries(n, n, &entries)
    }

    /// `A'y` for a vector `y`.
    ///
    /// # Errors
    /// Where `y` has another length than `A` has rows.
    pub fn transposed_product(&self, y: &[Interval]) -> Result<Vec<Interval>, Error> {
        if y.len() != self.rows() {
            return Err(Error::Shape { what: "the right-hand side", given: y.len(), needed: self.rows() });
        }
        let mut sums = vec![Interval::ZERO; self.columns()];
        for (row, &value) in y.iter().enumerate() {
            for (j, sum) in sums.iter_mut().enumerate() {
                *sum = *sum + self.get(row, j) * value;
            }
        }
        Ok(sums)
    }
}
