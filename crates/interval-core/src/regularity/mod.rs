//! Verdicts, with certificates, on whether every member of an interval matrix is nonsingular.

mod cells;
mod positive_definite;
mod preconditioned;
mod singular;

pub use crate::status::Verdict;
pub use crate::witness::{Cell, SingularMember, Witness};
pub(crate) use cells::{halves, largest_smear};
pub(crate) use preconditioned::{
    Accuracy, Preconditioned, contracted_vector, interval_residual, row_growth, slack, split, times,
};
pub(crate) use singular::null_vector;

use crate::error::Error;
use crate::exact;
use crate::matrix::IntervalMatrix;
use crate::parallel;
use crate::scaling::Scaled;

/// The largest order for which all vertex matrices are examined: 2^(2n-1) of them.
pub const VERTEX_LIMIT: usize = 4;

/// The verdict on an interval matrix.
#[derive(Debug, Clone, PartialEq)]
pub enum Regularity {
    /// Every member is nonsingular.
    Regular(Witness),
    /// Some member is singular.
    Singular(SingularMember),
    /// Neither was proved.
    NotProved,
}

impl Regularity {
    /// The verdict without its proof.
    #[must_use]
    pub const fn verdict(&self) -> Verdict {
        match self {
            Self::Regular(_) => Verdict::Regular,
            Self::Singular(_) => Verdict::Singular,
            Self::NotProved => Verdict::NotProved,
        }
    }
}

/// Proves regularity by contraction, plain or scaled, by the norm of the radii, or by a partition. Proves singularity
/// by a null vector. For orders up to [`VERTEX_LIMIT`] the vertex determinants decide.
///
/// # Errors
/// A matrix that is not square. One with an infinite bound is not proved.
pub fn regularity(a: &IntervalMatrix) -> Result<Regularity, Error> {
    crate::rounding::check_environment()?;
    a.order()?;
    Ok(if a.is_bounded() { decide(a) } else { Regularity::NotProved })
}

/// The verdicts on many matrices of order `n` whose bounds follow each other, each row-major, on all threads.
///
/// # Errors
/// Lengths that are not whole matrices, and bad bounds.
pub fn regularity_batch(n: usize, lo: &[f64], hi: &[f64]) -> Result<Vec<Regularity>, Error> {
    let size = n * n;
    if size == 0 {
        return Err(Error::Zero { what: "the order of the matrix" });
    }
    if hi.len() != lo.len() || lo.len() % size != 0 {
        return Err(Error::Shape { what: "the batch", given: hi.len(), needed: lo.len().next_multiple_of(size) });
    }
    let count = lo.len() / size;
    let one = |k: usize| {
        let part = k * size..(k + 1) * size;
        let a = IntervalMatrix::new(n, n, lo[part.clone()].to_vec(), hi[part.clone()].to_vec());
        regularity(&a.map_err(|e| e.moved(part.start))?)
    };
    parallel::map(count, count > 1, one).into_iter().collect()
}

/// The verdict on a square and bounded matrix, found on one that is scaled by powers of two.
pub(crate) fn decide(a: &IntervalMatrix) -> Regularity {
    let translated = Scaled::new(a).and_then(|scaled| {
        Some(match verdict(&scaled.a) {
            Regularity::Regular(witness) => Regularity::Regular(scaled.witness(witness)?),
            Regularity::Singular(member) => Regularity::Singular(scaled.member(member)?),
            Regularity::NotProved => Regularity::NotProved,
        })
    });
    match translated {
        Some(verdict) => verdict,
        // A certificate that is none in doubles: only the tests that need no scaling are left.
        None if a.rows() <= VERTEX_LIMIT => by_determinants(a),
        None => Regularity::NotProved,
    }
}

fn verdict(a: &IntervalMatrix) -> Regularity {
    if let Some(witness) = strongly_regular(a).or_else(|| positive_definite::prove(a)) {
        return Regularity::Regular(witness);
    }
    if let Some(x) = singular::search(a) {
        return Regularity::Singular(SingularMember::NullVector(x));
    }
    if a.rows() <= VERTEX_LIMIT {
        return by_determinants(a);
    }
    match cells::prove(a) {
        cells::Verdict::Regular(cell) => Regularity::Regular(Witness::Cells(cell)),
        cells::Verdict::Singular(x) => Regularity::Singular(SingularMember::NullVector(x)),
        cells::Verdict::Open => Regularity::NotProved,
    }
}

/// Contraction in the maximum norm or in a scaled one.
pub(crate) fn strongly_regular(a: &IntervalMatrix) -> Option<Witness> {
    let preconditioned = Preconditioned::new(a)?;
    let norm = preconditioned.norm();
    if norm < 1.0 {
        return Some(Witness::Contraction { approximate_inverse: preconditioned.r, norm });
    }
    let vector = preconditioned.contracted()?;
    Some(Witness::ScaledContraction { approximate_inverse: preconditioned.r, vector })
}

/// Decides by the signs of the determinants of all vertex matrices (Baumann 1984), in exact arithmetic.
pub(crate) fn by_determinants(a: &IntervalMatrix) -> Regularity {
    let n = a.rows();
    let mut first: Option<(i8, Vec<f64>)> = None;
    for vertex in vertices(a) {
        let sign = exact::determinant_sign(&vertex, n);
        if sign == 0 {
            return Regularity::Singular(SingularMember::Member(vertex));
        }
        match &first {
            None => first = Some((sign, vertex)),
            Some((other, member)) if *other != sign => {
                return Regularity::Singular(SingularMember::OppositeSigns(member.clone(), vertex));
            }
            Some(_) => {}
        }
    }
    Regularity::Regular(Witness::VertexDeterminants { sign: first.map_or(1, |(sign, _)| sign) })
}

/// The vertex matrices `A_c - T_y Delta T_z` for sign vectors `y`, `z` with `y_1 = 1`, row-major. `y_i z_j = 1` takes
/// the lower bound, so the entries are exact.
pub(crate) fn vertices(a: &IntervalMatrix) -> impl Iterator<Item = Vec<f64>> + '_ {
    let n = a.rows();
    (0..1_usize << (2 * n - 1)).map(move |bits| {
        let (y, z) = (bits >> n, bits & ((1 << n) - 1));
        let mut vertex = Vec::with_capacity(n * n);
        for i in 0..n {
            for j in 0..n {
                let opposite = ((y >> i) ^ (z >> j)) & 1 == 1;
                let at = i * n + j;
                vertex.push(if opposite { a.hi()[at] } else { a.lo()[at] });
            }
        }
        vertex
    })
}
