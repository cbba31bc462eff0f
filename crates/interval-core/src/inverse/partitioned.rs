//! The rigorous partition (docs/theory.md, "Inverses", partition): the hull of the inverse over a box of matrices is
//! the hull of those over its cells.
//!
//! A cell is settled when its exact hull is known (its signs are fixed, its midpoint is the identity, or its order
//! allows sign accord), or when its enclosure already lies inside the hull that certified members attain. Any other
//! cell is halved along the entry that moves the inverse most. When the budget of cells ends, the open cells count with
//! their enclosures, and the gap bounds the excess width. Cells are taken level by level, so the result does not depend
//! on the number of threads.

use super::exact::{Ends, Settled, by_sign_accord, exact_by_vertices, settle};
use super::{Certificate, Outcome, UNBOUNDED};
use crate::error::Error;
use crate::matrix::IntervalMatrix;
use crate::parallel;
use crate::regularity::{
    Regularity, SingularMember, VERTEX_LIMIT, by_determinants, decide, halves, largest_smear, null_vector,
};
use crate::rounding::sub_up;
use crate::scaling::Scaled;
use crate::status::Status;

/// Cells that are examined at most if the caller names no other number: a bound of the time.
pub const DEFAULT_CELLS: usize = 4096;

/// The hull of the inverse by halving, or the proof that a member is singular.
///
/// `cells` is the largest number of cells to examine. The status is `Enclosed` also if the budget ends with an
/// enclosure. Then [`Outcome::gap`] is the largest distance of a bound from one that is attained.
///
/// # Errors
/// A matrix that is not square, or `cells` of 0.
pub fn partitioned(a: &IntervalMatrix, cells: usize) -> Result<Outcome, Error> {
    partitioned_by(a, cells, &mut |level| {
        Some(parallel::map(level.len(), level.len() > 1, |at| look(&level[at], level.len() == 1)))
    })
}

/// Looks at the cells of a level, a single one as the whole matrix; `None` ends the search.
pub(super) type Look<'a> = dyn FnMut(&[IntervalMatrix]) -> Option<Vec<Cell>> + 'a;

/// [`partitioned()`] with cells that someone else may look at.
pub(super) fn partitioned_by(a: &IntervalMatrix, cells: usize, look: &mut Look<'_>) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    a.order()?;
    if cells == 0 {
        return Err(Error::Zero { what: "the number of cells" });
    }
    if !a.is_bounded() {
        return Ok(Outcome::not_applicable(UNBOUNDED));
    }
    let Some(scaled) = Scaled::new(a) else {
        return Ok(Outcome::not_applicable(
            "the entries differ so much in size that scaling by powers of two is not exact",
        ));
    };
    let (member, examined) = match divide(&scaled.a, cells, look) {
        Division::Hull(hull) => return certified(a, &scaled, &hull),
        Division::Singular(member) => (scaled.member(member), 1),
        Division::Open(examined) => (None, examined),
    };
    Ok(match (member, decide(a)) {
        (Some(member), _) | (None, Regularity::Singular(member)) => Outcome::singular(member),
        (None, Regularity::Regular(_) | Regularity::NotProved) => Outcome::without_value(
            Status::NotProved,
            None,
            format!("after {examined} cells some are neither proved regular nor singular; allow more cells"),
        ),
    })
}

/// The outcome for a hull whose cells are all regular: with a certificate of the whole matrix.
fn certified(a: &IntervalMatrix, scaled: &Scaled, hull: &Hull) -> Result<Outcome, Error> {
    let (least, most) = scaled.unscale_inward(&hull.attained_lower, &hull.attained_upper);
    let mut outcome = if a.rows() <= VERTEX_LIMIT && !hull.tight && !hull.ended {
        // Small orders get the doubles next to the hull.
        exact_by_vertices(a)?
    } else {
        let Some(value) = scaled.unscale(&hull.lower, &hull.upper) else {
            return Ok(Outcome::not_applicable("a bound of the inverse overflows"));
        };
        let Regularity::Regular(witness) = decide(a) else {
            return Ok(Outcome::without_value(
                Status::NotProved,
                None,
                "every cell is enclosed, but no certificate of regularity of the whole was found within its budget"
                    .into(),
            ));
        };
        Outcome::enclosed(value, Certificate::Regular(witness))
    };
    outcome.gap = outcome.bounds().map(|bounds| gap(bounds, (&least, &most)));
    if let (true, Some(gap)) = (hull.ended, outcome.gap) {
        outcome.reason = Some(format!("the budget of cells ended; a bound may be too wide by up to {gap:.3e}"));
    }
    Ok(outcome)
}

/// An upper bound of the largest distance of a bound from the attained values.
fn gap((lower, upper): (&[f64], &[f64]), (least, most): (&[f64], &[f64])) -> f64 {
    let below = lower.iter().zip(least).map(|(&bound, &attained)| sub_up(attained, bound));
    let above = upper.iter().zip(most).map(|(&bound, &attained)| sub_up(bound, attained));
    below.chain(above).fold(0.0, f64::max)
}

/// Bounds over all cells so far, and the values that members attain.
struct Hull {
    lower: Vec<f64>,
    upper: Vec<f64>,
    attained_lower: Vec<f64>,
    attained_upper: Vec<f64>,
    /// True if the budget ended before every cell was settled.
    ended: bool,
    /// True if every settled cell's bounds are the doubles next to its hull.
    tight: bool,
}

enum Division {
    Hull(Hull),
    Singular(SingularMember),
    Open(usize),
}

/// The result of one cell.
pub(super) enum Cell {
    Hull(Ends),
    Regular { enclosure: IntervalMatrix, attained: Option<Ends> },
    Singular(SingularMember),
    Open,
}

fn divide(a: &IntervalMatrix, cells: usize, look: &mut Look<'_>) -> Division {
    let n = a.rows();
    let mut hull = Hull {
        lower: vec![f64::INFINITY; n * n],
        upper: vec![f64::NEG_INFINITY; n * n],
        attained_lower: vec![f64::INFINITY; n * n],
        attained_upper: vec![f64::NEG_INFINITY; n * n],
        ended: false,
        tight: true,
    };
    let mut level = vec![a.clone()];
    let mut examined = 0;
    while !level.is_empty() {
        examined += level.len();
        let Some(answers) = look(&level) else { return Division::Open(examined) };
        let mut open: Vec<(IntervalMatrix, Option<IntervalMatrix>)> = Vec::new();
        for (cell, answer) in level.into_iter().zip(answers) {
            match answer {
                Cell::Singular(member) => return Division::Singular(member),
                Cell::Hull(ends) => hull.include(&ends),
                Cell::Regular { enclosure, attained } => {
                    if let Some(ends) = attained {
                        hull.include(&ends);
                    }
                    open.push((cell, Some(enclosure)));
                }
                Cell::Open => open.push((cell, None)),
            }
        }
        open.retain(|(_, enclosure)| !enclosure.as_ref().is_some_and(|e| hull.holds(e)));
        let mut next = Vec::with_capacity(2 * open.len());
        let room = cells.saturating_sub(examined) / 2;
        let enough = open.len() <= room;
        for (cell, enclosure) in open {
            let magnitude = enclosure.as_ref().map(IntervalMatrix::magnitude);
            let cut = if enough { largest_smear(&cell, magnitude.as_deref()) } else { None };
            match (cut, enclosure) {
                (Some((entry, value)), _) => next.extend(<[IntervalMatrix; 2]>::from(halves(&cell, entry, value))),
                (None, Some(enclosure)) => {
                    hull.ended = true;
                    hull.widen(&enclosure);
                }
                (None, None) => return Division::Open(examined),
            }
        }
        level = next;
    }
    Division::Hull(hull)
}

/// Attained values are sought in the whole matrix only: they cost more than the rest.
pub(super) fn look(cell: &IntervalMatrix, whole: bool) -> Cell {
    match settle(cell, whole) {
        Settled::Hull { ends, .. } => Cell::Hull(ends),
        Settled::Regular { enclosure, attained } => Cell::Regular { enclosure, attained },
        Settled::Open if cell.rows() <= VERTEX_LIMIT => match by_determinants(cell) {
            Regularity::Singular(member) => Cell::Singular(member),
            Regularity::Regular(_) => by_sign_accord(cell, None).map_or(Cell::Open, Cell::Hull),
            Regularity::NotProved => Cell::Open,
        },
        Settled::Open => null_vector(cell).map_or(Cell::Open, |x| Cell::Singular(SingularMember::NullVector(x))),
    }
}

fn fold(into: &mut [f64], from: &[f64], choose: fn(f64, f64) -> f64) {
    into.iter_mut().zip(from).for_each(|(a, &b)| *a = choose(*a, b));
}

impl Hull {
    /// Includes the exact hull of a cell, or bounds from both sides of the values that some of its members attain.
    fn include(&mut self, ends: &Ends) {
        fold(&mut self.lower, &ends.lower, f64::min);
        fold(&mut self.upper, &ends.upper, f64::max);
        fold(&mut self.attained_lower, &ends.attained_lower, f64::min);
        fold(&mut self.attained_upper, &ends.attained_upper, f64::max);
        self.tight &= ends.tight;
    }

    fn widen(&mut self, enclosure: &IntervalMatrix) {
        fold(&mut self.lower, enclosure.lo(), f64::min);
        fold(&mut self.upper, enclosure.hi(), f64::max);
    }

    /// True if members attain more than this enclosure on both sides of every entry; then it adds nothing to the hull,
    /// which holds those members.
    fn holds(&self, enclosure: &IntervalMatrix) -> bool {
        let below = enclosure.lo().iter().zip(&self.attained_lower).all(|(x, a)| x >= a);
        below && enclosure.hi().iter().zip(&self.attained_upper).all(|(x, a)| x <= a)
    }
}
