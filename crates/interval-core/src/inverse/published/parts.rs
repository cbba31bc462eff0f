//! A sweep in parts, for callers that share its partitions among machines: the extremes of a range of members, and the
//! outcome of all ranges. The bits are those of one sweep.

use super::{Extremes, Form, Members, Monitor, not_an_enclosure, refused, singular};
use crate::error::Error;
use crate::inverse::{Endpoints, Outcome};
use crate::matrix::IntervalMatrix;
use crate::rounding::slices::Backend;
use std::ops::Range;

/// The extremes of some members, row-major: the least and the largest inverse over `I`, and the same over `S`.
#[derive(Debug, Clone, PartialEq)]
pub struct Part(pub [Vec<f64>; 4]);

impl Part {
    fn extremes(self) -> Extremes {
        let [a, b, c, d] = self.0;
        Extremes { infima: Endpoints { lower: a, upper: b }, suprema: Endpoints { lower: c, upper: d } }
    }

    fn of(extremes: Extremes) -> Self {
        Self([extremes.infima.lower, extremes.infima.upper, extremes.suprema.lower, extremes.suprema.upper])
    }
}

/// The extremes of the members `k + 1` of both sets for `k` in the range; `None` where one is singular, or where the
/// method does not apply.
///
/// # Errors
/// A matrix that is not square, `partitions` of 0, or a range beyond them.
///
/// # Example
/// ```
/// use interval_core::{IntervalMatrix, inverse::{Form, published, published_of_parts, published_part}};
/// let a = IntervalMatrix::new(1, 1, vec![1.0], vec![2.0])?;
/// let parts = [published_part(&a, 10, Form::Literal, 0..4)?, published_part(&a, 10, Form::Literal, 4..10)?];
/// assert_eq!(published_of_parts(&a, 10, Form::Literal, parts)?, published(&a, 10)?);
/// # Ok::<(), interval_core::Error>(())
/// ```
pub fn published_part(
    a: &IntervalMatrix,
    partitions: u64,
    form: Form,
    range: Range<u64>,
) -> Result<Option<Part>, Error> {
    if refused(a, partitions)?.is_some() {
        return Ok(None);
    }
    if range.is_empty() || range.end > partitions {
        return Err(Error::Zero { what: "the number of partitions of a part" });
    }
    let members = Members::new(a, partitions, Backend::chosen());
    Ok(members.sweep(form, range, &Monitor::default()).map(Part::of))
}

/// The outcome of [`published`](super::published()) or [`published_hull`](super::published_hull()) from the parts of
/// all partitions; any that is `None` stands for a singular member.
///
/// # Errors
/// A matrix that is not square, or `partitions` of 0.
pub fn published_of_parts(
    a: &IntervalMatrix,
    partitions: u64,
    form: Form,
    parts: impl IntoIterator<Item = Option<Part>>,
) -> Result<Outcome, Error> {
    if let Some(outcome) = refused(a, partitions)? {
        return Ok(outcome);
    }
    let mut whole = Extremes::none(a.rows() * a.rows());
    for part in parts {
        let Some(part) = part else { return Ok(singular()) };
        whole = whole.merge(&part.extremes());
    }
    Ok(not_an_enclosure(whole.ends(form)))
}
