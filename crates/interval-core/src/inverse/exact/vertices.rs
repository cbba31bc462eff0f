//! The vertex form (Rohn and Farhadsefat, ELA 22 (2011); docs/theory.md, "Inverses"): over a regular interval matrix
//! every entry of the inverse attains its extremes at vertex matrices `A_c - T_y Delta T_z`.
//!
//! The vertex inverses are computed in exact integer arithmetic, so the bounds are those of the hull, rounded outward
//! once.

use crate::error::Error;
use crate::exact::{self, ratio_down, ratio_up};
use crate::inverse::{Certificate, Outcome, UNBOUNDED};
use crate::matrix::IntervalMatrix;
use crate::regularity::{SingularMember, VERTEX_LIMIT, Witness, vertices};
use num_rational::BigRational;

/// The hull of the inverse, or the proof that a member is singular.
///
/// # Errors
/// A matrix that is not square.
pub fn exact_by_vertices(a: &IntervalMatrix) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let n = a.order()?;
    if n > VERTEX_LIMIT {
        return Ok(Outcome::not_applicable(format!("order {n} exceeds {VERTEX_LIMIT}, the limit of the vertex form")));
    }
    if !a.is_bounded() {
        return Ok(Outcome::not_applicable(UNBOUNDED));
    }
    let mut hull: Option<Vec<(BigRational, BigRational)>> = None;
    let mut first: Option<(i8, Vec<f64>)> = None;
    for vertex in vertices(a) {
        let Some((sign, inverse)) = exact::inverse(&vertex, n) else {
            return Ok(Outcome::singular(SingularMember::Member(vertex)));
        };
        match &first {
            Some((other, member)) if *other != sign => {
                return Ok(Outcome::singular(SingularMember::OppositeSigns(member.clone(), vertex)));
            }
            Some(_) => {}
            None => first = Some((sign, vertex)),
        }
        hull = Some(match hull {
            None => inverse.into_iter().map(|x| (x.clone(), x)).collect(),
            Some(bounds) => bounds
                .into_iter()
                .zip(inverse)
                .map(|((lo, hi), x)| {
                    if x < lo {
                        (x, hi)
                    } else if x > hi {
                        (lo, x)
                    } else {
                        (lo, hi)
                    }
                })
                .collect(),
        });
    }
    let (Some((sign, _)), Some(hull)) = (first, hull) else {
        return Ok(Outcome::not_applicable("the matrix has no entry"));
    };
    let lower = hull.iter().map(|(lo, _)| ratio_down(lo)).collect();
    let upper = hull.iter().map(|(_, hi)| ratio_up(hi)).collect();
    let value = match IntervalMatrix::new(n, n, lower, upper) {
        Ok(value) if value.is_bounded() => value,
        _ => return Ok(Outcome::not_applicable("a bound of the inverse overflows")),
    };
    Ok(Outcome::enclosed(value, Certificate::Regular(Witness::VertexDeterminants { sign })))
}
