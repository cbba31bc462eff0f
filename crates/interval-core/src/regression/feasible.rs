//! The set of all parameters that are consistent with every interval row: its proved interval hull.
//!
//! `theta` is consistent when some member of `A` and some member of `y` give `A theta = y`. The set is a polyhedron in every
//! orthant and need not be connected, so every orthant is closed: by bounds, or by a proof that the set does not meet it.
//! A column without radius needs no sign.

use super::check_rows;
use super::inflation::{Attained, Inflation};
use super::orthant::Orthant;
use crate::error::Error;
use crate::interval::Interval;
use crate::linear_program::{Answer, Bound, HalfSpaces, Row, Simplex, exact_bound, farkas, proved_box, safe_bound};
use crate::matrix::IntervalMatrix;
use crate::status::Status;
use num_traits::ToPrimitive;

/// The largest number of columns with a radius: two to this power orthants are examined.
pub const SIGN_LIMIT: usize = 12;

/// One proved end of one parameter in one orthant.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundCertificate {
    /// The parameter.
    pub column: usize,
    /// Whether it is the upper end.
    pub upper: bool,
    /// The end; infinite where none was proved.
    pub bound: f64,
    /// Rows of the basis: row number, whether its lower right-hand side is meant, multiplier (an approximation).
    pub rows: Vec<(usize, bool, f64)>,
    /// Unknowns whose sign constraint is in the basis, with the multiplier.
    pub signs: Vec<(usize, f64)>,
}

/// What is known of one orthant.
#[derive(Debug, Clone, PartialEq)]
pub enum OrthantOutcome {
    /// Proved to hold no consistent parameter, by these rows (as in [`BoundCertificate`]).
    Empty {
        /// Row number, whether its lower right-hand side is meant, multiplier.
        rows: Vec<(usize, bool, f64)>,
    },
    /// Enclosed by these bounds, two for each parameter.
    Bounded(Vec<BoundCertificate>),
}

/// One orthant and its outcome.
#[derive(Debug, Clone, PartialEq)]
pub struct OrthantResult {
    /// 1 or -1; 0 for an unknown that needs no sign.
    pub signs: Vec<i8>,
    /// The outcome.
    pub outcome: OrthantOutcome,
}

/// The hull of the consistent parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct FeasibleSet {
    /// `Enclosed`, `Empty`, `Unbounded` (some end infinite), or `NotApplicable`.
    pub status: Status,
    /// Bounds of each parameter, ends without a proved bound infinite; empty where the set is.
    pub parameters: Vec<Interval>,
    /// The smallest factor on all radii at which a parameter is consistent, an estimate; `None` where no factor helps.
    pub inflation: Option<f64>,
    /// Where that factor is attained.
    pub centre: Option<Vec<f64>>,
    /// Directions in which the set goes on for ever, scaled to a largest entry of 1; approximations.
    pub directions: Vec<Vec<f64>>,
    /// Every orthant with its proof.
    pub orthants: Vec<OrthantResult>,
    /// Why the method does not apply.
    pub reason: Option<String>,
}

/// Computes the hull.
///
/// # Errors
/// Shapes that do not fit, and empty right-hand sides.
///
/// # Example
/// ```
/// use interval_core::{Interval, IntervalMatrix, Status, regression::feasible_set};
/// let a = IntervalMatrix::new(2, 1, vec![1.0, 2.0], vec![1.0, 2.0])?;
/// let y = [Interval::new(0.9, 1.1)?, Interval::new(1.9, 2.1)?];
/// let set = feasible_set(&a, &y)?;
/// assert_eq!(set.status, Status::Enclosed);
/// assert!(set.parameters[0].contains(1.0) && set.parameters[0].width() < 0.11);
/// # Ok::<(), interval_core::Error>(())
/// ```
pub fn feasible_set(a: &IntervalMatrix, y: &[Interval]) -> Result<FeasibleSet, Error> {
    crate::rounding::check_environment()?;
    check_rows(a, y)?;
    if let Some(index) = y.iter().position(|v| v.is_empty()) {
        return Err(Error::NoFinitePoint { index });
    }
    let n = a.columns();
    let signed: Vec<usize> = (0..n).filter(|&j| (0..a.rows()).any(|i| a.get(i, j).width() > 0.0)).collect();
    if signed.len() > SIGN_LIMIT {
        let reason =
            format!("{} parameters have uncertain regressors; at most {SIGN_LIMIT} are possible", signed.len());
        return Ok(FeasibleSet {
            status: Status::NotApplicable,
            parameters: vec![Interval::ENTIRE; n],
            inflation: None,
            centre: None,
            directions: Vec::new(),
            orthants: Vec::new(),
            reason: Some(reason),
        });
    }
    let inflation = Inflation::new(a, y);
    let mut orthants = Vec::with_capacity(1 << signed.len());
    let mut directions: Vec<Vec<f64>> = Vec::new();
    let mut least: Option<Attained> = None;
    for bits in 0..1_usize << signed.len() {
        let mut signs = vec![0_i8; n];
        for (k, &j) in signed.iter().enumerate() {
            signs[j] = if bits >> k & 1 == 0 { 1 } else { -1 };
        }
        let outcome = examine(&Orthant::new(a, y, &signs), &mut directions);
        if let Some(attained) = inflation.smallest(&signs)
            && attained.factor.is_finite()
            && least.as_ref().is_none_or(|l| attained.factor < l.factor)
        {
            least = Some(attained);
        }
        orthants.push(OrthantResult { signs, outcome });
    }
    let parameters = hull(&orthants, n);
    let status = if parameters.iter().any(|x| x.is_empty()) {
        Status::Empty
    } else if parameters.iter().all(|x| x.is_bounded()) {
        Status::Enclosed
    } else {
        Status::Unbounded
    };
    let (inflation, centre) = least.map_or((None, None), |l| (Some(l.factor), Some(l.point)));
    Ok(FeasibleSet { status, parameters, inflation, centre, directions, orthants, reason: None })
}

/// The union of the orthants' bounds; empty where every orthant is.
fn hull(orthants: &[OrthantResult], n: usize) -> Vec<Interval> {
    let mut parameters = vec![Interval::EMPTY; n];
    for orthant in orthants {
        let OrthantOutcome::Bounded(bounds) = &orthant.outcome else { continue };
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
    parameters
}

/// The values of one sign, with zero; every value for no sign.
fn half_line(sign: i8) -> Interval {
    match sign {
        1 => Interval::raw(0.0, f64::INFINITY),
        -1 => Interval::raw(f64::NEG_INFINITY, 0.0),
        _ => Interval::ENTIRE,
    }
}

/// Bounds every parameter in one orthant, or proves the orthant empty.
fn examine(orthant: &Orthant<'_>, directions: &mut Vec<Vec<f64>>) -> OrthantOutcome {
    let n = orthant.dimension();
    let search = Simplex::new(orthant);
    let mut proposals: Vec<Option<Bound>> = Vec::with_capacity(2 * n);
    for column in 0..n {
        for direction in [1.0, -1.0] {
            let mut objective = vec![0.0; n];
            objective[column] = direction;
            proposals.push(match search.minimise(&objective) {
                Answer::Basis { rows, .. } => Some(Bound { column, direction, rows }),
                Answer::Unbounded { ray } => {
                    note_direction(directions, &ray);
                    None
                }
                Answer::Infeasible { rows } => match farkas(orthant, &rows) {
                    Some(multipliers) => {
                        let weights = multipliers.iter().map(|m| m.to_f64().unwrap_or(f64::NAN));
                        let pairs: Vec<(Row, f64)> = rows.into_iter().zip(weights).collect();
                        return OrthantOutcome::Empty { rows: split(orthant, &pairs).0 };
                    }
                    None => None,
                },
                Answer::Failed => None,
            });
        }
    }
    let every: Option<Vec<Bound>> = proposals.iter().cloned().collect();
    let around = every.and_then(|bounds| proved_box(orthant, &bounds));
    let certificates: Vec<BoundCertificate> = proposals
        .into_iter()
        .enumerate()
        .map(|(k, proposal)| certify(orthant, k / 2, k % 2 == 1, proposal, around.as_deref()))
        .collect();
    match contradiction(&certificates, orthant.signs()) {
        Some(rows) => OrthantOutcome::Empty { rows },
        None => OrthantOutcome::Bounded(certificates),
    }
}

/// The rows of two proved ends that cross, or of one end on the wrong side of zero: they prove the orthant empty as well.
fn contradiction(certificates: &[BoundCertificate], signs: &[i8]) -> Option<Vec<(usize, bool, f64)>> {
    certificates.chunks_exact(2).zip(signs).find_map(|(ends, &sign)| {
        let (lower, upper) = (&ends[0], &ends[1]);
        if lower.bound > upper.bound {
            Some([lower.rows.clone(), upper.rows.clone()].concat())
        } else if sign > 0 && upper.bound < 0.0 {
            Some(upper.rows.clone())
        } else if sign < 0 && lower.bound > 0.0 {
            Some(lower.rows.clone())
        } else {
            None
        }
    })
}

/// One proved end, infinite where nothing is proved.
fn certify(
    orthant: &Orthant<'_>,
    column: usize,
    upper: bool,
    proposal: Option<Bound>,
    around: Option<&[Interval]>,
) -> BoundCertificate {
    let open = BoundCertificate {
        column,
        upper,
        bound: if upper { f64::INFINITY } else { f64::NEG_INFINITY },
        rows: Vec::new(),
        signs: Vec::new(),
    };
    let Some(proposal) = proposal else { return open };
    let proved = match around {
        Some(around) => Some(safe_bound(orthant, &proposal, around)),
        None => exact_bound(orthant, &proposal),
    };
    let Some(least) = proved.filter(|x| *x > f64::NEG_INFINITY) else { return open };
    let (rows, signs) = split(orthant, &proposal.rows);
    BoundCertificate { bound: if upper { -least } else { least }, rows, signs, ..open }
}

type Weighted = (Vec<(usize, bool, f64)>, Vec<(usize, f64)>);

/// Separates data rows from sign constraints.
fn split(orthant: &Orthant<'_>, rows: &[(Row, f64)]) -> Weighted {
    let m = (orthant.count() - orthant.dimension()) / 2;
    let (mut data, mut signs) = (Vec::new(), Vec::new());
    for &(row, weight) in rows {
        match row {
            Row::Given(index) if index < m => data.push((index, false, weight)),
            Row::Given(index) if index < 2 * m => data.push((index - m, true, weight)),
            Row::Given(index) => signs.push((index - 2 * m, weight)),
            Row::AtInfinity { .. } => {}
        }
    }
    (data, signs)
}

/// Keeps a direction that differs from those known (up to sign and length).
fn note_direction(directions: &mut Vec<Vec<f64>>, ray: &[f64]) {
    let largest = ray.iter().fold(0.0_f64, |a, x| if x.abs() > a.abs() { *x } else { a });
    if largest == 0.0 || !largest.is_finite() {
        return;
    }
    let unit: Vec<f64> = ray.iter().map(|x| if (x / largest).abs() < 1e-9 { 0.0 } else { x / largest }).collect();
    let known = |d: &Vec<f64>| d.iter().zip(&unit).all(|(a, b)| (a - b).abs() < 1e-6);
    if !directions.iter().any(known) {
        directions.push(unit);
    }
}
