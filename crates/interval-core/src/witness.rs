//! Proofs that an interval matrix is regular or holds a singular member, as numbers.

/// A proof that an interval matrix is regular.
#[derive(Debug, Clone, PartialEq)]
pub enum Witness {
    /// `||I - R A|| <= norm < 1` in the maximum row sum norm for this `R` (row-major): `R A` and with it `A` is
    /// nonsingular for every member.
    Contraction {
        /// An approximate inverse of the midpoint, row-major.
        approximate_inverse: Vec<f64>,
        /// Upper bound of the norm.
        norm: f64,
    },
    /// `|I - R A| v < v` for this `R` (row-major) and `v > 0`: the same in a norm scaled by `v`.
    ScaledContraction {
        /// An approximate inverse of the midpoint, row-major.
        approximate_inverse: Vec<f64>,
        /// The positive vector.
        vector: Vec<f64>,
    },
    /// The matrices of lower and of upper bounds have non-negative inverses (Kuttler 1971).
    NonnegativeInverses,
    /// `S = m'm - shift I` is positive definite for the midpoints `m`, and the radii have a spectral norm of at most
    /// the root of the shift (Rex and Rohn, *SIAM J. Matrix Anal. Appl.* 20 (1998) 437-445): proved by
    /// `||I - X S X'|| < 1`.
    PositiveDefinite {
        /// Upper bound of the square of the radii's spectral norm.
        shift: f64,
        /// The non-negative vector `w` that shows it: `D'D w <= shift w` for the radii `D`.
        vector: Vec<f64>,
        /// The matrix `X`, row-major, approximately the inverse of a Cholesky factor.
        congruence: Vec<f64>,
    },
    /// Every cell of a partition is regular by a scaled contraction.
    Cells(Cell),
    /// The determinants of all vertex matrices `A_c - T_y Delta T_z` have this strict sign (Baumann 1984).
    VertexDeterminants {
        /// -1 or 1.
        sign: i8,
    },
}

/// A proof that an interval matrix holds a singular member.
#[derive(Debug, Clone, PartialEq)]
pub enum SingularMember {
    /// This member (row-major) has determinant zero, exactly.
    Member(Vec<f64>),
    /// For this vector (not zero) every row of `A x` contains 0, exactly: choosing in each row a member of it that
    /// gives 0 makes a member `A` with `A x = 0`.
    NullVector(Vec<f64>),
    /// These two members (row-major) have determinants of opposite sign: on the segment between them one is zero.
    OppositeSigns(Vec<f64>, Vec<f64>),
}

/// A cell of the partition: proved, or halved.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// `|I - R A| v < v` for every member of the cell.
    Regular {
        /// An approximate inverse of the cell's midpoint, row-major.
        approximate_inverse: Vec<f64>,
        /// The positive vector.
        vector: Vec<f64>,
    },
    /// The cell halved at a value of one entry; both halves contain it.
    Halved {
        /// Flat position of the entry.
        entry: usize,
        /// The value at which it is cut.
        value: f64,
        /// The half below and the half above.
        halves: Box<[Cell; 2]>,
    },
}
