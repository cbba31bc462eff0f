//! The exact hull of the inverse (Rohn and Farhadsefat, ELA 22 (2011); docs/theory.md, "Inverses").
//!
//! Over a regular interval matrix every entry of the inverse attains its extremes at vertex matrices. Four forms find
//! the hull:
//! - *sign-stable* (S): if every entry of the inverse keeps its sign, the two vertices of entry `ij` follow from row
//!   `i` and column `j` of the signs;
//! - *unit midpoint* (U): `I` plus or minus radii has a closed form;
//! - *sign accord* (B): column `j` over all sign vectors `y` solves `A_c x - T_y Delta |x| = e_j`: `n 2^n` solutions;
//! - *vertices* (V): all `2^(2n-1)` of them in rational arithmetic, the cross-check.
//!
//! The forms S and B are the same computation, [`absolute_value`](crate::absolute_value), over few or over all sign
//! vectors.

mod ends;
mod three;
mod unit_midpoint;
mod vertices;

pub use vertices::exact_by_vertices;

use super::hansen_bliek_rohn::closed_form;
use super::{Certificate, Outcome, UNBOUNDED};
use crate::error::Error;
use crate::matrix::IntervalMatrix;
use crate::regularity::{Preconditioned, Regularity, VERTEX_LIMIT, Witness, decide};
use crate::scaling::Scaled;
use crate::status::Status;
pub(crate) use ends::{Ends, by_sign_accord};

/// The largest order for sign accord: `n 2^n` systems.
pub const ACCORD_LIMIT: usize = 12;
/// The largest order for the sign-stable form: `2 n^2` systems.
pub const SIGN_LIMIT: usize = 64;

/// The hull of the inverse of a matrix of order 3, row-major, where the form for order 3 decides.
pub(crate) fn hull_of_three(lo: &[f64], hi: &[f64]) -> Option<([f64; 9], [f64; 9])> {
    three::hull(lo.try_into().ok()?, hi.try_into().ok()?).map(|(lower, upper, _)| (lower, upper))
}

/// The hulls of the inverses of a batch of order 3, where those of several are found side by side: `solved` tells which.
pub(crate) fn hulls_of_three(lo: &[f64], hi: &[f64], lower: &mut [f64], upper: &mut [f64], solved: &mut [bool]) {
    three::hulls(lo, hi, lower, upper, solved);
}

/// The hull of the inverse with the cheapest form that applies, or the proof that a member is singular.
///
/// # Errors
/// A matrix that is not square.
///
/// # Example
/// ```
/// use interval_core::{IntervalMatrix, Status, inverse};
/// let a = IntervalMatrix::new(1, 1, vec![1.0], vec![2.0])?;
/// let outcome = inverse::exact(&a)?;
/// assert_eq!(outcome.status, Status::Enclosed);
/// assert_eq!(outcome.bounds(), Some((&[0.5][..], &[1.0][..])));
/// # Ok::<(), interval_core::Error>(())
/// ```
pub fn exact(a: &IntervalMatrix) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let n = a.order()?;
    if !a.is_bounded() {
        return Ok(Outcome::not_applicable(UNBOUNDED));
    }
    let of_three = match (n, a.lo().try_into(), a.hi().try_into()) {
        (3, Ok(lo), Ok(hi)) => three::hull(lo, hi),
        _ => None,
    };
    if let Some((lower, upper, r)) = of_three {
        let value = IntervalMatrix::new(3, 3, lower.to_vec(), upper.to_vec())?;
        let witness = Witness::ScaledContraction { approximate_inverse: r.to_vec(), vector: vec![1.0; 3] };
        return Ok(Outcome::enclosed(value, Certificate::Regular(witness)));
    }
    let Some(scaled) = Scaled::new(a) else {
        return if n <= VERTEX_LIMIT { exact_by_vertices(a) } else { Ok(Outcome::not_applicable(SCALE)) };
    };
    match settle(&scaled.a, false) {
        Settled::Hull { ends, witness } => {
            let tight = ends.tight || n > VERTEX_LIMIT;
            let value = scaled.unscale(&ends.lower, &ends.upper).filter(|_| tight);
            let Some((value, witness)) = value.zip(witness_of(a, &scaled, witness)) else {
                return if n <= VERTEX_LIMIT { exact_by_vertices(a) } else { Ok(Outcome::not_applicable(RANGE)) };
            };
            Ok(Outcome::enclosed(value, Certificate::Regular(witness)))
        }
        Settled::Regular { .. } => Ok(Outcome::not_applicable(format!(
            "the signs of the inverse vary and order {n} exceeds {ACCORD_LIMIT}, the limit of sign accord, or {SIGN_LIMIT}, \
             that of fixed signs: use partitioned or hansen-bliek-rohn"
        ))),
        Settled::Open if n <= VERTEX_LIMIT => exact_by_vertices(a),
        Settled::Open => Ok(match decide(a) {
            Regularity::Singular(member) => Outcome::singular(member),
            Regularity::Regular(witness) => by_accord_of(a, &scaled, witness),
            Regularity::NotProved => Outcome::without_value(
                Status::NotProved,
                None,
                "neither regularity nor a singular member was proved within the budget".into(),
            ),
        }),
    }
}

/// The witness for the matrix as it was, or another one where scaling it back rounds.
fn witness_of(a: &IntervalMatrix, scaled: &Scaled, witness: Witness) -> Option<Witness> {
    scaled.witness(witness).or_else(|| match decide(a) {
        Regularity::Regular(witness) => Some(witness),
        Regularity::Singular(_) | Regularity::NotProved => None,
    })
}

const RANGE: &str = "a bound of the inverse, or the certificate, lies beyond the range of doubles";
const SCALE: &str = "the entries differ so much in size that scaling by powers of two is not exact";

/// Sign accord where regularity was proved otherwise than by one contraction.
fn by_accord_of(a: &IntervalMatrix, scaled: &Scaled, witness: Witness) -> Outcome {
    let n = a.rows();
    if n > ACCORD_LIMIT {
        return Outcome::not_applicable(format!("order {n} exceeds {ACCORD_LIMIT}, the limit of sign accord"));
    }
    match ends::by_sign_accord(&scaled.a, None).and_then(|ends| scaled.unscale(&ends.lower, &ends.upper)) {
        Some(value) => Outcome::enclosed(value, Certificate::Regular(witness)),
        None => Outcome::not_applicable("sign accord did not end, or a bound overflows"),
    }
}

/// The findings on a matrix that is not cut.
pub(crate) enum Settled {
    /// Its exact hull.
    Hull { ends: Ends, witness: Witness },
    /// Regular, with an enclosure and with the values that some members attain, but too large for an exact form.
    Regular { enclosure: IntervalMatrix, attained: Option<Ends> },
    /// Strong regularity is not proved.
    Open,
}

/// The hull of a strongly regular matrix by the cheapest form that applies.
///
/// `attain` asks for the values that members attain if the hull is not found.
pub(crate) fn settle(a: &IntervalMatrix, attain: bool) -> Settled {
    let n = a.rows();
    let Some(preconditioned) = Preconditioned::new(a) else { return Settled::Open };
    let Some(v) = preconditioned.contracted() else { return Settled::Open };
    let z = IntervalMatrix::from_points(n, n, &preconditioned.r);
    let Some(enclosure) = closed_form(&preconditioned, &v, &z) else { return Settled::Open };
    let magnitude = enclosure.magnitude();
    let fixed = enclosure.entries().all(|x| x.lo() > 0.0 || x.hi() < 0.0 || (x.lo() == 0.0 && x.hi() == 0.0));
    let along_signs = || {
        let positive: Vec<bool> = preconditioned.r.iter().map(|&x| x > 0.0).collect();
        (n <= SIGN_LIMIT).then(|| ends::by_signs(a, &positive, &magnitude)).flatten()
    };
    let ends = if fixed {
        along_signs()
    } else if let Some(ends) = unit_midpoint::hull(a, &v) {
        Some(ends)
    } else if n <= ACCORD_LIMIT {
        ends::by_sign_accord(a, Some(magnitude.clone()))
    } else {
        None
    };
    if let Some(ends) = ends {
        let witness = Witness::ScaledContraction { approximate_inverse: preconditioned.r, vector: v };
        return Settled::Hull { ends, witness };
    }
    let attained = match (attain, n <= ATTAIN_LIMIT) {
        (true, true) if !fixed => along_signs(),
        (true, _) => at_midpoint(a),
        _ => None,
    };
    Settled::Regular { enclosure, attained }
}

/// The largest order at which attained values are sought at the vertices that the signs of the midpoint's inverse name,
/// `2 n^2` systems. Larger orders take the midpoint.
const ATTAIN_LIMIT: usize = 24;

/// The values that the midpoint attains.
fn at_midpoint(a: &IntervalMatrix) -> Option<Ends> {
    let n = a.rows();
    let point = IntervalMatrix::from_points(n, n, &a.midpoint());
    let preconditioned = Preconditioned::new(&point)?;
    let z = IntervalMatrix::from_points(n, n, &preconditioned.r);
    let value = closed_form(&preconditioned, &preconditioned.contracted()?, &z)?;
    let (lower, upper) = (value.lo().to_vec(), value.hi().to_vec());
    Some(Ends { attained_lower: upper.clone(), attained_upper: lower.clone(), lower, upper, tight: false })
}
