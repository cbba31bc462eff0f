//! Matrices of `nalgebra` in and out. Storage there is by columns, here by rows.

use crate::error::Error;
use crate::matrix::IntervalMatrix;
use nalgebra::{DMatrix, Dim, Matrix, RawStorage, SMatrix};

/// The bounds of a matrix, lower and upper.
impl<R: Dim, C: Dim, S: RawStorage<f64, R, C>, T: RawStorage<f64, R, C>>
    TryFrom<(&Matrix<f64, R, C, S>, &Matrix<f64, R, C, T>)> for IntervalMatrix
{
    type Error = Error;

    /// ```
    /// use interval_core::IntervalMatrix;
    /// use nalgebra::Matrix2;
    /// let (lower, upper) = (Matrix2::new(1.0, 2.0, 3.0, 4.0), Matrix2::new(1.5, 2.5, 3.5, 4.5));
    /// let a = IntervalMatrix::try_from((&lower, &upper))?;
    /// assert_eq!(a.lo(), [1.0, 2.0, 3.0, 4.0]);
    /// let (low, high): (Matrix2<f64>, Matrix2<f64>) = (&a).try_into()?;
    /// assert_eq!((low, high), (lower, upper));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    fn try_from((lower, upper): (&Matrix<f64, R, C, S>, &Matrix<f64, R, C, T>)) -> Result<Self, Error> {
        let by_rows = |m: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
            (0..lower.nrows()).flat_map(|i| (0..lower.ncols()).map(move |j| (i, j))).map(|(i, j)| m(i, j)).collect()
        };
        if lower.shape() != upper.shape() {
            let (given, needed) = (upper.nrows() * upper.ncols(), lower.nrows() * lower.ncols());
            return Err(Error::Shape { what: "the upper bound", given, needed });
        }
        let (lo, hi) = (by_rows(&|i, j| lower[(i, j)]), by_rows(&|i, j| upper[(i, j)]));
        Self::new(lower.nrows(), lower.ncols(), lo, hi)
    }
}

/// Lower and upper bounds.
impl From<&IntervalMatrix> for (DMatrix<f64>, DMatrix<f64>) {
    fn from(a: &IntervalMatrix) -> Self {
        let of = |bounds: &[f64]| DMatrix::from_row_slice(a.rows(), a.columns(), bounds);
        (of(a.lo()), of(a.hi()))
    }
}

/// Lower and upper bounds of a matrix whose size is known.
impl<const R: usize, const C: usize> TryFrom<&IntervalMatrix> for (SMatrix<f64, R, C>, SMatrix<f64, R, C>) {
    type Error = Error;

    fn try_from(a: &IntervalMatrix) -> Result<Self, Error> {
        if (a.rows(), a.columns()) != (R, C) {
            return Err(Error::Shape { what: "the matrix", given: a.rows() * a.columns(), needed: R * C });
        }
        let of = |bounds: &[f64]| SMatrix::from_row_slice(bounds);
        Ok((of(a.lo()), of(a.hi())))
    }
}
