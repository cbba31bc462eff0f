//! Interval rows `A theta = y` where they lie: four borrowed arrays, checked once.

use crate::error::Error;
use crate::interval::Interval;
use crate::parallel;

/// Rows of one piece of a pass. The size is fixed, so that the result does not depend on the number of threads.
const PIECE: usize = 1 << 14;

/// `m` interval rows with `n` columns: bounds of the matrix, row-major, and of the right-hand sides. Nothing is copied.
#[derive(Debug, Clone)]
pub struct Rows<'a> {
    columns: usize,
    lower: &'a [f64],
    upper: &'a [f64],
    right_lower: &'a [f64],
    right_upper: &'a [f64],
    /// The largest finite magnitude of each column.
    magnitude: Vec<f64>,
    uncertain: Vec<bool>,
    /// Rows with an infinite bound of a regressor.
    open: Vec<usize>,
}

/// The findings of one piece of the rows on the columns.
struct Survey {
    magnitude: Vec<f64>,
    uncertain: Vec<bool>,
    open: Vec<usize>,
}

impl<'a> Rows<'a> {
    /// Borrows the bounds and checks them in one pass.
    ///
    /// # Errors
    /// Lengths that do not fit, NaN, reversed bounds, and entries without a finite point.
    ///
    /// # Example
    /// ```
    /// use interval_core::regression::Rows;
    /// let rows = Rows::new(2, &[1.0, 0.0, 0.0, 1.0], &[1.0, 0.1, 0.1, 1.0], &[0.9, 1.9], &[1.1, 2.1])?;
    /// assert_eq!((rows.count(), rows.columns()), (2, 2));
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    pub fn new(
        columns: usize,
        lower: &'a [f64],
        upper: &'a [f64],
        right_lower: &'a [f64],
        right_upper: &'a [f64],
    ) -> Result<Self, Error> {
        if columns == 0 {
            return Err(Error::Zero { what: "the number of columns" });
        }
        let rows = right_lower.len();
        if right_upper.len() != rows {
            return Err(Error::Shape { what: "the upper right-hand side", given: right_upper.len(), needed: rows });
        }
        let needed = rows.saturating_mul(columns);
        if lower.len() != needed {
            return Err(Error::Shape { what: "the lower bound", given: lower.len(), needed });
        }
        if upper.len() != needed {
            return Err(Error::Shape { what: "the upper bound", given: upper.len(), needed });
        }
        if rows == 0 {
            return Err(Error::Zero { what: "the number of rows" });
        }
        let mut whole = Self {
            columns,
            lower,
            upper,
            right_lower,
            right_upper,
            magnitude: Vec::new(),
            uncertain: Vec::new(),
            open: Vec::new(),
        };
        let pieces = rows.div_ceil(PIECE);
        let surveys = parallel::map(pieces, pieces > 1, |k| whole.survey(k * PIECE, rows.min((k + 1) * PIECE)));
        let (mut magnitude, mut uncertain, mut open) = (vec![0.0_f64; columns], vec![false; columns], Vec::new());
        for survey in surveys {
            let survey = survey?;
            magnitude.iter_mut().zip(survey.magnitude).for_each(|(a, b)| *a = a.max(b));
            uncertain.iter_mut().zip(survey.uncertain).for_each(|(a, b)| *a |= b);
            open.extend(survey.open);
        }
        (whole.magnitude, whole.uncertain, whole.open) = (magnitude, uncertain, open);
        Ok(whole)
    }

    fn survey(&self, start: usize, end: usize) -> Result<Survey, Error> {
        let n = self.columns;
        let (lower, upper) = (&self.lower[start * n..end * n], &self.upper[start * n..end * n]);
        let (mut magnitude, mut different) = (vec![0.0_f64; n], vec![0.0_f64; n]);
        let mut good = true;
        let mut finite = true;
        for (low, high) in lower.chunks_exact(n).zip(upper.chunks_exact(n)) {
            for j in 0..n {
                let (l, h) = (low[j], high[j]);
                // NaN fails the comparison.
                good &= l <= h && l < f64::INFINITY && h > f64::NEG_INFINITY;
                let (a, b) = (l.abs(), h.abs());
                let most = if a > b { a } else { b };
                finite &= most < f64::INFINITY;
                magnitude[j] = if most > magnitude[j] { most } else { magnitude[j] };
                let width = h - l;
                different[j] = if width > different[j] { width } else { different[j] };
            }
        }
        if !good {
            for (k, (&l, &h)) in lower.iter().zip(upper).enumerate() {
                Interval::at(l, h, start * n + k)?;
            }
        }
        for i in start..end {
            let (l, h) = (self.right_lower[i], self.right_upper[i]);
            if l == f64::INFINITY && h == f64::NEG_INFINITY {
                return Err(Error::NoFinitePoint { index: i });
            }
            Interval::at(l, h, i)?;
        }
        let mut open = Vec::new();
        if !finite {
            magnitude.fill(0.0);
            for (k, (low, high)) in lower.chunks_exact(n).zip(upper.chunks_exact(n)).enumerate() {
                if low.iter().chain(high).any(|x| x.is_infinite()) {
                    open.push(start + k);
                }
                for (j, x) in low.iter().zip(high).map(|(l, h)| [l.abs(), h.abs()]).enumerate() {
                    magnitude[j] = x.into_iter().filter(|v| v.is_finite()).fold(magnitude[j], f64::max);
                }
            }
        }
        Ok(Survey { magnitude, uncertain: different.iter().map(|&d| d > 0.0).collect(), open })
    }

    /// Number of rows.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.right_lower.len()
    }

    /// Number of columns.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// Lower and upper bounds of a row.
    ///
    /// # Panics
    /// Outside the rows.
    #[must_use]
    pub fn row(&self, i: usize) -> (&'a [f64], &'a [f64]) {
        let at = i * self.columns..(i + 1) * self.columns;
        (&self.lower[at.clone()], &self.upper[at])
    }

    /// Lower and upper bound of a right-hand side.
    ///
    /// # Panics
    /// Outside the rows.
    #[must_use]
    pub fn right(&self, i: usize) -> (f64, f64) {
        (self.right_lower[i], self.right_upper[i])
    }

    /// True for each column that has an entry with a radius, and so needs a sign.
    #[must_use]
    pub fn uncertain(&self) -> &[bool] {
        &self.uncertain
    }

    pub(super) fn magnitude(&self) -> &[f64] {
        &self.magnitude
    }

    pub(super) fn open(&self) -> &[usize] {
        &self.open
    }

    /// The rows `start .. end` as four slices.
    pub(super) fn slices(&self, start: usize, end: usize) -> [&'a [f64]; 4] {
        let n = self.columns;
        [
            &self.lower[start * n..end * n],
            &self.upper[start * n..end * n],
            &self.right_lower[start..end],
            &self.right_upper[start..end],
        ]
    }
}
