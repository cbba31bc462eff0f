//! The inverse methods by name: the one place that knows all of them.

use super::published::{Watch, watched};
use super::{
    Batch, DEFAULT_CELLS, DEFAULT_PARTITIONS, Form, Outcome, Sweep, batch, cramer, exact, exact_batch,
    hansen_bliek_rohn, krawczyk, kuttler, neumaier, partitioned,
};
use crate::error::Error;
use crate::matrix::IntervalMatrix;
use crate::names::named;

named! {
    /// A method for the inverse of an interval matrix.
    Method, "method" {
        /// [`exact`](super::exact()): the hull.
        Exact => "exact",
        /// [`partitioned`](super::partitioned()): the hull by halving, or an enclosure with a stated gap.
        Partitioned => "partitioned",
        /// [`hansen_bliek_rohn`](super::hansen_bliek_rohn()): the hull of the preconditioned columns.
        HansenBliekRohn => "hansen-bliek-rohn",
        /// [`krawczyk`](super::krawczyk()): paper eq. 8-10, corrected.
        Krawczyk => "krawczyk",
        /// [`cramer`](super::cramer()): Nirmala and Ganesan.
        Cramer => "cramer",
        /// [`kuttler`](super::kuttler()): the hull where the inverses of the extreme members are non-negative.
        Kuttler => "kuttler",
        /// [`neumaier`](super::neumaier()): one norm bound.
        Neumaier => "neumaier",
        /// [`published`](super::published()): paper eq. 11-13 literally, no enclosure.
        Published => "published",
        /// [`published_hull`](super::published_hull()): the hull over both of its sets, no enclosure.
        PublishedHull => "published-hull",
    }
}

/// The options of the methods. Each method reads those that concern it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// N of the published methods.
    pub partitions: u64,
    /// Cells that [`Method::Partitioned`] examines at most.
    pub cells: usize,
    /// The way in which the published methods find their extremes.
    pub sweep: Sweep,
}

impl Default for Options {
    fn default() -> Self {
        Self { partitions: DEFAULT_PARTITIONS, cells: DEFAULT_CELLS, sweep: Sweep::Members }
    }
}

impl Options {
    /// One number for the partitions of a sweep and for the cells of a partition: a method reads one of them at most.
    #[must_use]
    pub fn with_count(count: u64, sweep: Sweep) -> Self {
        Self { partitions: count, cells: usize::try_from(count).unwrap_or(usize::MAX), sweep }
    }
}

impl Method {
    /// The default of the number that [`Options::with_count`] takes.
    #[must_use]
    pub fn default_count(self) -> u64 {
        match self {
            Self::Partitioned => u64::try_from(DEFAULT_CELLS).unwrap_or(u64::MAX),
            _ => DEFAULT_PARTITIONS,
        }
    }

    /// The inverse of a square interval matrix.
    ///
    /// # Errors
    /// A matrix that is not square, or a number of partitions or cells of 0.
    ///
    /// # Example
    /// ```
    /// use interval_core::{IntervalMatrix, inverse::{Method, Options}};
    /// let a = IntervalMatrix::new(1, 1, vec![1.0], vec![2.0])?;
    /// let method: Method = "hansen-bliek-rohn".parse()?;
    /// assert!(method.inverse(&a, &Options::default())?.enclosure().is_some());
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    pub fn inverse(self, a: &IntervalMatrix, options: &Options) -> Result<Outcome, Error> {
        self.inverse_watched(a, options, None)
    }

    /// The same, watched: a sweep that takes long runs on a thread of its own while this one asks `watch`.
    ///
    /// # Errors
    /// As [`inverse`](Self::inverse).
    pub fn inverse_watched(
        self,
        a: &IntervalMatrix,
        options: &Options,
        watch: Option<&mut Watch<'_>>,
    ) -> Result<Outcome, Error> {
        let sweep = |form: Form| watched(a, options.partitions, (form, options.sweep), watch);
        match self {
            Self::Exact => exact(a),
            Self::Partitioned => partitioned(a, options.cells),
            Self::HansenBliekRohn => hansen_bliek_rohn(a),
            Self::Krawczyk => krawczyk(a),
            Self::Cramer => cramer(a),
            Self::Kuttler => kuttler(a),
            Self::Neumaier => neumaier(a),
            Self::Published => sweep(Form::Literal),
            Self::PublishedHull => sweep(Form::Hull),
        }
    }

    /// The inverses of matrices of order `n` whose bounds follow each other, each row-major, on all threads.
    ///
    /// # Errors
    /// Lengths that are not whole matrices, bad bounds, and the refusals of [`inverse`](Self::inverse).
    pub fn inverse_batch(self, n: usize, lo: &[f64], hi: &[f64], options: &Options) -> Result<Batch, Error> {
        match self {
            Self::Exact => exact_batch(n, lo, hi),
            _ => batch(n, lo, hi, |a| self.inverse(a, options)),
        }
    }
}
