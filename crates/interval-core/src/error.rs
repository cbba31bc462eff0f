//! Misuse of the library: one variant a cause. A numerical outcome is never an error but a [`Status`](crate::Status).

use thiserror::Error as ThisError;

/// Misuse by a caller, with the given and the needed values.
#[non_exhaustive]
#[derive(Debug, Clone, PartialEq, Eq, ThisError)]
pub enum Error {
    /// A bound is NaN.
    #[error("bound {index} is NaN; give a number, or an infinity for an open end")]
    NotANumber {
        /// Flat position of the bound.
        index: usize,
    },
    /// A lower bound lies above its upper bound.
    #[error("the lower bound exceeds the upper bound at entry {index}; swap them or mend the data")]
    ReversedBounds {
        /// Flat position of the entry.
        index: usize,
    },
    /// An interval without a finite point, such as \[inf, inf\].
    #[error("entry {index} has no finite point; a lower bound must be below +inf and an upper bound above -inf")]
    NoFinitePoint {
        /// Flat position of the entry.
        index: usize,
    },
    /// Two shapes do not fit.
    #[error("{what} has {given} entries where {needed} are needed")]
    Shape {
        /// The operand.
        what: &'static str,
        /// The number given.
        given: usize,
        /// The number needed.
        needed: usize,
    },
    /// A square matrix is needed.
    #[error("a square matrix is needed, this one is {rows} by {columns}")]
    NotSquare {
        /// Rows given.
        rows: usize,
        /// Columns given.
        columns: usize,
    },
    /// A count that has to be positive.
    #[error("{what} must be at least 1")]
    Zero {
        /// The count.
        what: &'static str,
    },
    /// The processor rounds otherwise than to nearest, or flushes subnormal numbers to zero.
    #[error(
        "the processor does not round to nearest or flushes subnormal numbers to zero; undo the change of the \
         floating-point mode"
    )]
    Environment,
    /// A name that is not among those known.
    #[error("{what} '{given}' is not available; choose one of {known}")]
    Name {
        /// The kind of the name.
        what: &'static str,
        /// The name given.
        given: String,
        /// The names known.
        known: String,
    },
    /// Text that is no interval literal.
    #[error("'{text}' is not an interval; write [lower, upper] or a number, for example [0.1, 0.2]")]
    Text {
        /// The text given.
        text: String,
    },
}

impl Error {
    /// The same of a slice that starts `by` entries further on.
    pub(crate) fn moved(self, by: usize) -> Self {
        match self {
            Self::NotANumber { index } => Self::NotANumber { index: index + by },
            Self::ReversedBounds { index } => Self::ReversedBounds { index: index + by },
            Self::NoFinitePoint { index } => Self::NoFinitePoint { index: index + by },
            other => other,
        }
    }
}
