//! Misuse of the library: one variant a cause. A numerical outcome is never an error but a `Status`.

#[cfg(feature = "alloc")]
use alloc::string::String;
use core::fmt;

/// Misuse by a caller, with the given and the needed values.
#[non_exhaustive]
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Error {
    /// A bound is NaN.
    NotANumber {
        /// Flat position of the bound.
        index: usize,
    },
    /// A lower bound lies above its upper bound.
    ReversedBounds {
        /// Flat position of the entry.
        index: usize,
    },
    /// An interval without a finite point, such as \[inf, inf\].
    NoFinitePoint {
        /// Flat position of the entry.
        index: usize,
    },
    /// Two shapes do not fit.
    Shape {
        /// The operand.
        what: &'static str,
        /// The number given.
        given: usize,
        /// The number needed.
        needed: usize,
    },
    /// A square matrix is needed.
    NotSquare {
        /// Rows given.
        rows: usize,
        /// Columns given.
        columns: usize,
    },
    /// A count that has to be positive.
    Zero {
        /// The count.
        what: &'static str,
    },
    /// The processor rounds otherwise than to nearest, or flushes subnormal numbers to zero.
    Environment,
    /// A name that is not among those known.
    #[cfg(feature = "alloc")]
    Name {
        /// The kind of the name.
        what: &'static str,
        /// The name given.
        given: String,
        /// The names known.
        known: String,
    },
    /// Text that is no interval literal.
    #[cfg(feature = "alloc")]
    Text {
        /// The text given.
        text: String,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotANumber { index } => {
                write!(f, "bound {index} is NaN; give a number, or an infinity for an open end")
            }
            Self::ReversedBounds { index } => {
                write!(f, "the lower bound exceeds the upper bound at entry {index}; swap them or mend the data")
            }
            Self::NoFinitePoint { index } => write!(
                f,
                "entry {index} has no finite point; a lower bound must be below +inf and an upper bound above -inf"
            ),
            Self::Shape { what, given, needed } => write!(f, "{what} has {given} entries where {needed} are needed"),
            Self::NotSquare { rows, columns } => {
                write!(f, "a square matrix is needed, this one is {rows} by {columns}")
            }
            Self::Zero { what } => write!(f, "{what} must be at least 1"),
            Self::Environment => f.write_str(
                "the processor does not round to nearest or flushes subnormal numbers to zero; undo the change of the \
         floating-point mode",
            ),
            #[cfg(feature = "alloc")]
            Self::Name { what, given, known } => write!(f, "{what} '{given}' is not available; choose one of {known}"),
            #[cfg(feature = "alloc")]
            Self::Text { text } => {
                write!(f, "'{text}' is not an interval; write [lower, upper] or a number, for example [0.1, 0.2]")
            }
        }
    }
}

impl core::error::Error for Error {}

#[cfg(feature = "alloc")]
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
