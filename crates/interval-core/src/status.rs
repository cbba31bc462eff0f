//! The outcome of a method, as a value.

/// What a method proved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The value encloses every result; proved.
    Enclosed,
    /// The matrix contains a singular member; proved.
    Singular,
    /// Neither an enclosure nor its impossibility was proved. A value that stands beside it claims nothing.
    NotProved,
    /// The method's own conditions of use do not hold.
    NotApplicable,
    /// No parameter is consistent with the rows; proved.
    Empty,
    /// At least one end has no finite bound. The finite ends that are given are proved.
    Unbounded,
}

impl Status {
    /// The word that users read.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Enclosed => "enclosed",
            Self::Singular => "singular",
            Self::NotProved => "not_proved",
            Self::NotApplicable => "not_applicable",
            Self::Empty => "empty",
            Self::Unbounded => "unbounded",
        }
    }
}
