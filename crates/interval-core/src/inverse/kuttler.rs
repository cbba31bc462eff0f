//! Matrices whose two extreme members have non-negative inverses, M-matrices above all (Kuttler, *Math. Comp.* 25
//! (1971) 237-241).
//!
//! If `L^-1 >= 0` and `U^-1 >= 0` for the matrices of lower and of upper bounds, every member is nonsingular and the
//! inverse has the hull `[U^-1, L^-1]`.

use super::{Certificate, Outcome, UNBOUNDED, hansen_bliek_rohn};
use crate::error::Error;
use crate::exact;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;
use crate::regularity::Witness;

/// The largest order with rational inverses, which show entries that are zero. Their cost grows fast with the order.
const RATIONAL_LIMIT: usize = 6;

/// The hull of the inverse. The method does not apply if one of the two inverses is not proved to be non-negative.
///
/// # Errors
/// A matrix that is not square.
pub fn kuttler(a: &IntervalMatrix) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let n = a.order()?;
    if !a.is_bounded() {
        return Ok(Outcome::not_applicable(UNBOUNDED));
    }
    let (Some(least), Some(most)) = (nonnegative_inverse(a.hi(), n), nonnegative_inverse(a.lo(), n)) else {
        return Ok(Outcome::not_applicable(
            "the inverses of the two extreme members are not proved to be non-negative",
        ));
    };
    let entries: Option<Vec<Interval>> =
        least.iter().zip(&most).map(|(l, m)| Interval::new(l.lo(), m.hi()).ok()).collect();
    let Some(entries) = entries.filter(|e| e.iter().all(|x| x.is_bounded())) else {
        return Ok(Outcome::not_applicable("a bound of the inverse overflows"));
    };
    let value = IntervalMatrix::from_entries(n, n, &entries);
    Ok(Outcome::enclosed(value, Certificate::Regular(Witness::NonnegativeInverses)))
}

/// Enclosures of the entries of a point inverse, all of them proved to be at least zero.
fn nonnegative_inverse(points: &[f64], n: usize) -> Option<Vec<Interval>> {
    let entries: Vec<Interval> = if n <= RATIONAL_LIMIT {
        let (_, inverse) = exact::inverse(points, n)?;
        inverse.iter().map(|x| Interval::made(exact::ratio_down(x), exact::ratio_up(x))).collect()
    } else {
        hansen_bliek_rohn(&IntervalMatrix::from_points(n, n, points)).ok()?.enclosure()?.entries().collect()
    };
    entries.iter().all(|x| x.lo() >= 0.0).then_some(entries)
}
