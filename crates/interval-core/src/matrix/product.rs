//! Products of interval matrices.
//!
//! The tight product sums tightest products, each partial sum rounded outward. The fast one computes midpoints and
//! radii by three ordinary products with a bound of their rounding errors. It is wider, by at most half for narrow
//! operands.

use super::IntervalMatrix;
use crate::approximate;
use crate::doubles::Neighbours as _;
use crate::error::Error;
use crate::interval::Interval;
use crate::parallel;
use crate::rounding::slices::{Backend, Packed};
use crate::rounding::{add_up, check_environment, sub_down};

impl IntervalMatrix {
    fn inner_dimension(&self, other: &Self) -> Result<(), Error> {
        check_environment()?;
        if self.columns() == other.rows() {
            Ok(())
        } else {
            let (given, needed) = (other.rows(), self.columns());
            Err(Error::Shape { what: "the right factor's number of rows", given, needed })
        }
    }

    /// The product `self * other`, tight: every product and every partial sum is the tightest interval. The bits depend
    /// neither on the processor nor on the number of threads.
    ///
    /// # Errors
    /// Inner dimensions that differ.
    ///
    /// ```
    /// use interval_core::IntervalMatrix;
    /// let a = IntervalMatrix::new(1, 2, vec![1.0, -1.0], vec![2.0, 1.0])?;
    /// let b = IntervalMatrix::new(2, 1, vec![3.0, 4.0], vec![3.0, 4.0])?;
    /// assert_eq!(a.multiply(&b)?, IntervalMatrix::new(1, 1, vec![-1.0], vec![10.0])?);
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    pub fn multiply(&self, other: &Self) -> Result<Self, Error> {
        self.multiply_on(Backend::chosen(), other)
    }

    /// [`multiply`](Self::multiply) on a back end of the caller's choice.
    ///
    /// # Errors
    /// Inner dimensions that differ.
    pub fn multiply_on(&self, backend: Backend, other: &Self) -> Result<Self, Error> {
        self.inner_dimension(other)?;
        let small = self.columns() == 0 || self.rows() * other.columns() < 4;
        if small || !self.is_bounded() || !other.is_bounded() {
            return Ok(self.multiply_by_entries(other));
        }
        let (n, columns) = (self.columns(), other.columns());
        let packed = Packed::new(other.rows(), columns, other.lo(), other.hi());
        let mut lo = vec![0.0; self.rows() * columns];
        let mut hi = lo.clone();
        let row = |i: usize, lo: &mut [f64], hi: &mut [f64]| {
            packed.row_product(backend, (&self.lo()[i * n..][..n], &self.hi()[i * n..][..n]), (lo, hi));
        };
        parallel::rows(self.rows() * n * columns, columns, &mut lo, &mut hi, row);
        Self::new(self.rows(), columns, lo, hi)
    }

    fn multiply_by_entries(&self, other: &Self) -> Self {
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
        Self::from_entries(self.rows(), other.columns(), &entries)
    }

    /// The product by midpoints and radii, in rounding to nearest with a-priori bounds: three ordinary products.
    ///
    /// With `u = 2^-53`, `k` the inner dimension and `m`, `r` midpoints and radii, `C = fl(mA mB)` is within
    /// `k u |mA| |mB| + k eta / 2` of `mA mB` for any order of summation (Jeannerod and Rump, *SIAM J. Matrix Anal.
    /// Appl.* 34 (2013) 338-346), and the members deviate by at most `|mA| rB + rA (|mB| + rB)`. Both together are
    /// bounded by `|mA| T1 + rA T2`, `T1 >= (k + 1) u |mB| + rB`, `T2 >= |mB| + rB`. The last factor and term bound the
    /// rounding of these two products. Entries that are not finite are computed tightly instead.
    ///
    /// # Errors
    /// Inner dimensions that differ.
    pub fn multiply_fast(&self, other: &Self) -> Result<Self, Error> {
        // The unit roundoff of a double, 2^-53.
        const UNIT: f64 = f64::EPSILON / 2.0;
        self.inner_dimension(other)?;
        let (m, k, n) = (self.rows(), self.columns(), other.columns());
        if !self.is_bounded() || !other.is_bounded() || k == 0 || k > 1 << 20 {
            return self.multiply(other);
        }
        #[expect(clippy::cast_precision_loss, reason = "at most 2^20")]
        let terms = k as f64;
        let (ma, mb) = (self.midpoint(), other.midpoint());
        let (ra, rb) = (self.radius(), other.radius());
        let magnitude: Vec<f64> = ma.iter().map(|x| x.abs()).collect();
        let t1: Vec<f64> =
            mb.iter().zip(&rb).map(|(x, r)| ((terms + 1.0) * UNIT * x.abs() + r).above().above()).collect();
        let t2: Vec<f64> = mb.iter().zip(&rb).map(|(x, r)| (x.abs() + r).above()).collect();
        let centre = approximate::product(&ma, &mb, m, k, n);
        let first = approximate::product(&magnitude, &t1, m, k, n);
        let second = approximate::product(&ra, &t2, m, k, n);
        let growth = 1.0 + 2.0 * (terms + 4.0) * UNIT;
        let tiny = 2.0 * terms * f64::from_bits(1);
        let (mut lo, mut hi) = (Vec::with_capacity(m * n), Vec::with_capacity(m * n));
        for (i, &c) in centre.iter().enumerate() {
            let r = ((first[i] + second[i]) * growth + tiny).above();
            let (below, above) = (sub_down(c, r), add_up(c, r));
            if below.is_finite() && above.is_finite() {
                lo.push(below);
                hi.push(above);
            } else {
                let (row, column) = (i / n, i % n);
                let sum = (0..k).fold(Interval::ZERO, |s, l| s + self.get(row, l) * other.get(l, column));
                lo.push(sum.lo());
                hi.push(sum.hi());
            }
        }
        Self::new(m, n, lo, hi)
    }

    /// `A x` for a vector `x`, each product and partial sum the tightest interval.
    ///
    /// # Errors
    /// A length of `x` other than the number of columns of `A`.
    pub fn multiply_vector(&self, x: &[Interval]) -> Result<Vec<Interval>, Error> {
        check_environment()?;
        if x.len() != self.columns() {
            return Err(Error::Shape { what: "the vector", given: x.len(), needed: self.columns() });
        }
        let row = |i: usize| x.iter().enumerate().fold(Interval::ZERO, |sum, (j, &v)| sum + self.get(i, j) * v);
        Ok((0..self.rows()).map(row).collect())
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
    /// A length of `y` other than the number of rows of `A`.
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
