//! The set of all parameters that are consistent with every interval row: its proved interval hull.
//!
//! `theta` is consistent when some member of `A` and some member of `y` give `A theta = y`. The set is a polyhedron in
//! every orthant and need not be connected, so every orthant is closed: by bounds, or by a proof that the set does not
//! meet it. A column without radius needs no sign.

use super::check_rows;
use super::directions::directions;
use super::inflation;
use super::orthant::{DataRow, Orthant};
use super::outliers::{NODE_LIMIT, Outliers, trees};
use super::prove::{Proof, prove};
use super::rows::Rows;
use super::search::{Asked, Piece, Pool, solve};
use super::signs::{ORTHANT_LIMIT, SignProof, cover, every};
use crate::certified::Certified;
use crate::error::Error;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;
use crate::parallel;
use crate::rounding::slices::Backend;
use crate::status::FeasibleStatus;

/// The options of [`feasible_rows`].
#[derive(Debug, Clone, Default)]
pub struct FeasibleOptions {
    /// Signs of the parameters that are known beforehand: 1, -1, or 0 for none. The result holds under this assumption.
    pub signs: Option<Vec<i8>>,
    /// The number `q` of rows that may be wrong: the result holds for every parameter that all rows but `q` allow.
    pub outliers: usize,
    /// The back end of the scans; the bits are the same on all of them.
    pub backend: Option<Backend>,
}

/// One proved end of one parameter in one orthant.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundCertificate {
    /// The parameter.
    pub column: usize,
    /// True if it is the upper end.
    pub upper: bool,
    /// The end; infinite where none was proved.
    pub bound: f64,
    /// Rows of the basis: row number, whether its lower right-hand side is meant, multiplier (an approximation).
    pub rows: Vec<DataRow>,
    /// Unknowns whose sign constraint is in the basis, with the multiplier.
    pub signs: Vec<(usize, f64)>,
}

/// The result for one orthant.
#[derive(Debug, Clone, PartialEq)]
pub enum OrthantOutcome {
    /// Proved to hold no consistent parameter, by these rows (as in [`BoundCertificate`]).
    Empty {
        /// Row number, whether its lower right-hand side is meant, multiplier.
        rows: Vec<DataRow>,
    },
    /// Enclosed by these bounds, two for each parameter.
    Bounded(Vec<BoundCertificate>),
}

/// One orthant and its outcome.
#[derive(Debug, Clone, PartialEq)]
pub struct OrthantResult {
    /// 1 or -1; 0 for an unknown that needs no sign.
    pub signs: Vec<i8>,
    /// Rows that are taken to be wrong here; none unless outliers are allowed.
    pub dropped: Vec<usize>,
    /// The outcome, by the proof of this orthant.
    pub outcome: Certified<OrthantOutcome>,
}

/// The hull of the consistent parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct FeasibleSet {
    /// The proved property of the set as a whole.
    pub status: FeasibleStatus,
    /// Bounds of each parameter, ends without a proved bound infinite; empty where the set is.
    pub parameters: Certified<Vec<Interval>>,
    /// The smallest factor on all radii at which a parameter is consistent, an estimate. The value is `None` if no
    /// factor helps.
    pub inflation: Option<f64>,
    /// A parameter at which that factor is attained.
    pub centre: Option<Vec<f64>>,
    /// Approximate directions in which the set is unbounded, scaled to a largest entry of 1. They are a basis of the
    /// null space if the set holds whole lines, else rays.
    pub directions: Vec<Vec<f64>>,
    /// Every orthant that the set may meet, with its proof.
    pub orthants: Vec<OrthantResult>,
    /// The proofs that the set meets no other orthant; empty if all of them are listed.
    pub sign_proofs: Vec<SignProof>,
    /// The rows that may be wrong; `None` unless outliers are allowed.
    pub outliers: Option<Outliers>,
    /// The reason for which the method does not apply.
    pub reason: Option<String>,
}

/// Computes the hull.
///
/// # Errors
/// Shapes that do not fit, and empty right-hand sides.
///
/// # Example
/// ```
/// use interval_core::{Interval, IntervalMatrix, regression::{FeasibleStatus, feasible_set}};
/// let a = IntervalMatrix::new(2, 1, vec![1.0, 2.0], vec![1.0, 2.0])?;
/// let y = [Interval::new(0.9, 1.1)?, Interval::new(1.9, 2.1)?];
/// let set = feasible_set(&a, &y)?;
/// assert_eq!(set.status, FeasibleStatus::Enclosed);
/// assert!(set.parameters[0].contains(1.0) && set.parameters[0].width() < 0.11);
/// # Ok::<(), interval_core::Error>(())
/// ```
pub fn feasible_set(a: &IntervalMatrix, y: &[Interval]) -> Result<FeasibleSet, Error> {
    check_rows(a, y)?;
    let (low, high): (Vec<f64>, Vec<f64>) = y.iter().map(|v| (v.lo(), v.hi())).unzip();
    feasible_rows(&Rows::new(a.columns(), a.lo(), a.hi(), &low, &high)?, &FeasibleOptions::default())
}

/// The same of rows where they lie.
///
/// # Errors
/// Signs that do not fit the columns.
///
/// # Example
/// ```
/// use interval_core::regression::{FeasibleOptions, Rows, feasible_rows};
/// // |x| = 1, and x is known to be positive
/// let rows = Rows::new(1, &[-1.0, 1.0], &[1.0, 1.0], &[1.0, -1.0], &[1.0, 1.0])?;
/// let options = FeasibleOptions { signs: Some(vec![1]), ..FeasibleOptions::default() };
/// assert_eq!(feasible_rows(&rows, &options)?.parameters[0].lo(), 1.0);
/// # Ok::<(), interval_core::Error>(())
/// ```
pub fn feasible_rows(rows: &Rows<'_>, options: &FeasibleOptions) -> Result<FeasibleSet, Error> {
    crate::rounding::check_environment()?;
    let n = rows.columns();
    let known = options.signs.clone().unwrap_or_else(|| vec![0; n]);
    if known.len() != n {
        return Err(Error::Shape { what: "the list of signs", given: known.len(), needed: n });
    }
    let mut pool = Pool::new(rows, options.backend.unwrap_or_else(Backend::chosen));
    let known: Vec<i8> = known.into_iter().map(i8::signum).collect();
    if options.outliers > 0 {
        return Ok(with_outliers(rows, &mut pool, &known, options.outliers));
    }
    let Some((leaves, sign_proofs)) = cover(rows, &mut pool, &known) else {
        return Ok(FeasibleSet::without_answer(n, too_many(rows, &known)));
    };
    let Some(proofs) =
        union(rows, &mut pool, &leaves, Asked::Union).or_else(|| union(rows, &mut pool, &leaves, Asked::Each))
    else {
        return Ok(FeasibleSet::without_answer(n, "the ends of some orthants were not proved".to_owned()));
    };
    let mut all_rays = Vec::new();
    let mut orthants = Vec::with_capacity(leaves.len());
    for (signs, (outcome, rays)) in leaves.into_iter().zip(proofs) {
        all_rays.extend(rays);
        orthants.push(OrthantResult { signs, dropped: Vec::new(), outcome });
    }
    let parameters = hull(&orthants, n);
    let set = FeasibleSet { orthants, sign_proofs, ..FeasibleSet::new(rows, parameters, &all_rays) };
    Ok(set.with_inflation(rows, &pool, &[]))
}

/// The proof for each orthant; `None` if an end was left out for a piece that the proof then finds empty or closed.
fn union(rows: &Rows<'_>, pool: &mut Pool, leaves: &[Vec<i8>], asked: Asked) -> Option<Vec<Proof>> {
    let goals: Vec<(usize, f64)> = (0..rows.columns()).flat_map(|j| [(j, 1.0), (j, -1.0)]).collect();
    let mut pieces: Vec<Piece<'_>> =
        leaves.iter().map(|signs| Piece::new(Orthant::new(rows, signs.clone()), pool, &goals)).collect();
    solve(rows, pool, &mut pieces, asked);
    let proofs = parallel::map(pieces.len(), pieces.len() >= 16, |k| prove(rows, pool, &pieces[k]));
    let open = |k: usize, (piece, (outcome, _)): (&Piece<'_>, &Proof)| match &**outcome {
        OrthantOutcome::Bounded(ends) => !piece.goals[k].retired && ends[k].bound.is_infinite(),
        OrthantOutcome::Empty { .. } => false,
    };
    let witnessed = (0..goals.len())
        .all(|k| pieces.iter().all(|p| !p.goals[k].retired) || pieces.iter().zip(&proofs).any(|pair| open(k, pair)));
    witnessed.then_some(proofs)
}

/// The hull where some rows may be wrong. Proofs of signs would use rows that may be among them, so every orthant is
/// looked at.
fn with_outliers(rows: &Rows<'_>, pool: &mut Pool, known: &[i8], allowed: usize) -> FeasibleSet {
    let n = rows.columns();
    let Some(leaves) = every(rows, known) else { return FeasibleSet::without_answer(n, too_many(rows, known)) };
    let Some(found) = trees(rows, pool, &leaves, allowed) else {
        let reason = format!("{allowed} wrong rows need more than {NODE_LIMIT} linear programs; allow fewer");
        return FeasibleSet::without_answer(n, reason);
    };
    let dropped = found.outliers.sets.first().cloned().unwrap_or_default();
    let set = FeasibleSet {
        orthants: found.nodes,
        outliers: Some(found.outliers),
        ..FeasibleSet::new(rows, found.parameters, &found.rays)
    };
    set.with_inflation(rows, pool, &dropped)
}

fn too_many(rows: &Rows<'_>, known: &[i8]) -> String {
    let open = known.iter().zip(rows.uncertain()).filter(|(k, u)| **k == 0 && **u).count();
    format!(
        "the signs of {open} parameters with uncertain regressors leave more than {ORTHANT_LIMIT} orthants open; state the \
         signs that are known"
    )
}

impl FeasibleSet {
    /// The set of these bounds.
    fn new(rows: &Rows<'_>, parameters: Certified<Vec<Interval>>, rays: &[Vec<f64>]) -> Self {
        let status = if parameters.iter().any(|x| x.is_empty()) {
            FeasibleStatus::Empty
        } else if parameters.iter().all(|x| x.is_bounded()) {
            FeasibleStatus::Enclosed
        } else {
            FeasibleStatus::Unbounded
        };
        let directions = if status == FeasibleStatus::Unbounded { directions(rows, rays) } else { Vec::new() };
        Self { status, parameters, directions, reason: None, ..Self::without_answer(0, String::new()) }
    }

    /// A factor of at most 1 is attained where the set is; only where it is nowhere do all orthants compete.
    fn with_inflation(mut self, rows: &Rows<'_>, pool: &Pool, dropped: &[usize]) -> Self {
        let empty = self.status == FeasibleStatus::Empty;
        let mut met: Vec<&[i8]> = self
            .orthants
            .iter()
            .filter(|o| empty || !matches!(*o.outcome, OrthantOutcome::Empty { .. }))
            .map(|o| o.signs.as_slice())
            .collect();
        met.sort_unstable();
        met.dedup();
        let m = rows.count();
        let mut start: Vec<usize> = pool.members.iter().map(|&index| index % m).collect();
        start.sort_unstable();
        start.dedup();
        if let Some(attained) = inflation::smallest(rows, &start, &met, dropped) {
            (self.inflation, self.centre) = (Some(attained.factor), Some(attained.point));
        }
        self
    }

    /// No answer: every parameter lies between the infinities.
    fn without_answer(n: usize, reason: String) -> Self {
        Self {
            status: FeasibleStatus::NotApplicable,
            parameters: Certified::proved(vec![Interval::ENTIRE; n]),
            inflation: None,
            centre: None,
            directions: Vec::new(),
            orthants: Vec::new(),
            sign_proofs: Vec::new(),
            outliers: None,
            reason: Some(reason),
        }
    }
}

/// The union of the orthants' bounds; empty where every orthant is. The orthants are all that the set may meet, and each
/// is certified.
fn hull(orthants: &[OrthantResult], n: usize) -> Certified<Vec<Interval>> {
    let mut parameters = vec![Interval::EMPTY; n];
    for orthant in orthants {
        let OrthantOutcome::Bounded(bounds) = &*orthant.outcome else { continue };
        let mut part: Vec<Interval> = orthant.signs.iter().map(|&s| half_line(s)).collect();
        for bound in bounds {
            let limit = if bound.upper {
                Interval::raw(f64::NEG_INFINITY, bound.bound)
            } else {
                Interval::raw(bound.bound, f64::INFINITY)
            };
            part[bound.column] = part[bound.column].intersection(limit);
        }
        parameters.iter_mut().zip(part).for_each(|(whole, x)| *whole = whole.hull(x));
    }
    Certified::proved(parameters)
}

/// The values of one sign, with zero; every value for no sign.
fn half_line(sign: i8) -> Interval {
    match sign {
        1 => Interval::raw(0.0, f64::INFINITY),
        -1 => Interval::raw(f64::NEG_INFINITY, 0.0),
        _ => Interval::ENTIRE,
    }
}
