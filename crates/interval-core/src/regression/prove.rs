//! From the bases of a search to proved ends of one orthant, or to the proof that the orthant is empty.
//!
//! Directed rounding proves nearly all of them. Cases that it leaves in doubt (a multiplier near zero, an open
//! direction, an end far from that of the search, ends that nearly meet) go to the same simplex method over the
//! rationals, on the working set alone.

use super::feasible::{BoundCertificate, OrthantOutcome};
use super::orthant::Orthant;
use super::rows::Rows;
use super::scan::{Pass, Vertex, scan};
use super::search::{Goal, Piece, Pool};
use crate::certified::Certified;
use crate::exact::{ratio_down, rational};
use crate::linear_program::{
    HalfSpaces, Outcome, Proved, Row, Subset, basis_multipliers, enclosed_bound, enclosed_farkas, enclosed_multipliers,
    exact_bound, farkas, minimum, violation,
};
use crate::parallel;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};

/// Relative distance of two ends below which the set may be empty by a rounding, so that the rationals decide.
const THIN: f64 = 1e-9;
/// Relative gap between the proved and the approximate end that exact arithmetic is asked to close.
const GAP: f64 = 1e-11;
/// Rounds of exact constraint generation at most: a bound of the time.
const ROUNDS: usize = 20;

/// The proof for one orthant, and the directions in which it seems open.
pub(crate) type Proof = (Certified<OrthantOutcome>, Vec<Vec<f64>>);

/// Proves the findings of the search of one piece.
pub(crate) fn prove(rows: &Rows<'_>, pool: &Pool, piece: &Piece<'_>) -> Proof {
    let orthant = &piece.orthant;
    if let Some((goal, entering)) = piece.contradiction {
        let basis: Vec<Row> = piece.goals[goal].search.basis(&piece.program).into_iter().map(|r| r.0).collect();
        let entering = piece.program.names()[entering];
        if let Some(weights) = enclosed_farkas(orthant, &basis, entering) {
            return (contradicted(orthant, &weights), Vec::new());
        }
        return match farkas(orthant, &basis, entering) {
            Some(weights) => (empty(orthant, &weights), Vec::new()),
            None => exactly(rows, pool, piece),
        };
    }
    let mut ends = Vec::with_capacity(piece.goals.len());
    let mut directions = Vec::new();
    for goal in &piece.goals {
        ends.push(match goal.outcome {
            _ if goal.retired => end(orthant, goal, None, &[]),
            Outcome::Vertex => proved_end(piece, goal),
            Outcome::Unbounded => {
                directions.push(goal.search.ray(&piece.program));
                end(orthant, goal, None, &[])
            }
            _ => match exact_goal(piece, goal) {
                Some(Proved::Empty { rows }) => {
                    return (empty(orthant, &named(piece.program.names(), rows)), Vec::new());
                }
                Some(Proved::Unbounded { ray }) => {
                    directions.push(ray);
                    end(orthant, goal, None, &[])
                }
                Some(Proved::Minimum { value, rows, .. }) => {
                    let weights = named(piece.program.names(), rows);
                    end(orthant, goal, Some(ratio_down(&value)), &approximate(&weights))
                }
                None => end(orthant, goal, None, &[]),
            },
        });
    }
    if ends.windows(2).any(|pair| pair[0].column == pair[1].column && is_thin(pair[0].bound, pair[1].bound)) {
        return exactly(rows, pool, piece);
    }
    (bounded(ends), directions)
}

fn is_thin(lower: f64, upper: f64) -> bool {
    let width = upper - lower;
    width.is_finite() && width <= THIN * lower.abs().max(upper.abs())
}

fn approximate(weights: &[(usize, BigRational)]) -> Vec<(usize, f64)> {
    // A multiplier below the range of doubles is still one.
    let near = |l: &BigRational| match l.to_f64().unwrap_or(f64::NAN) {
        0.0 if !l.is_zero() => f64::from_bits(1),
        near => near,
    };
    weights.iter().map(|(index, l)| (*index, near(l))).collect()
}

/// Half-spaces of a working set by their names in the problem.
fn named(names: &[usize], rows: Vec<(usize, BigRational)>) -> Vec<(usize, BigRational)> {
    rows.into_iter().map(|(at, l)| (names[at], l)).collect()
}

/// Empty by multipliers in rationals.
fn empty(orthant: &Orthant<'_>, weights: &[(usize, BigRational)]) -> Certified<OrthantOutcome> {
    contradicted(orthant, &approximate(weights))
}

/// Empty by a Farkas certificate that was proved; its multipliers are stated as doubles.
fn contradicted(orthant: &Orthant<'_>, weights: &[(usize, f64)]) -> Certified<OrthantOutcome> {
    Certified::proved(OrthantOutcome::Empty { rows: orthant.split(weights).0 })
}

/// Enclosed by ends of [`end`], each of them proved or infinite.
fn bounded(ends: Vec<BoundCertificate>) -> Certified<OrthantOutcome> {
    Certified::proved(OrthantOutcome::Bounded(ends))
}

/// One end: `direction * x[column] >= least`, or nothing.
fn end(orthant: &Orthant<'_>, goal: &Goal, least: Option<f64>, weights: &[(usize, f64)]) -> BoundCertificate {
    let least = least.unwrap_or(f64::NEG_INFINITY);
    let upper = goal.direction < 0.0;
    let (rows, signs) = if least > f64::NEG_INFINITY { orthant.split(weights) } else { (Vec::new(), Vec::new()) };
    // Subtracting from zero makes -0 plain 0.
    BoundCertificate { column: goal.column, upper, bound: if upper { 0.0 - least } else { least }, rows, signs }
}

/// The end that the basis of the search proves, or the basis that the exact search puts in its place. Either way the
/// rows of the certificate prove it alone.
fn proved_end(piece: &Piece<'_>, goal: &Goal) -> BoundCertificate {
    let orthant = &piece.orthant;
    let rows: Vec<Row> = goal.search.basis(&piece.program).into_iter().map(|r| r.0).collect();
    if let Some(weights) = enclosed_multipliers(orthant, &rows, goal.column, goal.direction) {
        let least = enclosed_bound(orthant, &weights);
        let found = goal.direction * goal.search.point(&piece.program)[goal.column];
        if least >= found - GAP * found.abs() {
            let middle: Vec<(usize, f64)> = weights.iter().map(|(index, l)| (*index, l.midpoint())).collect();
            return end(orthant, goal, Some(least), &middle);
        }
    }
    if let Some(weights) = basis_multipliers(orthant, &rows, goal.column, goal.direction) {
        let least = ratio_down(&exact_bound(orthant, &weights));
        return end(orthant, goal, Some(least), &approximate(&weights));
    }
    match exact_goal(piece, goal) {
        Some(Proved::Minimum { value, rows, .. }) => {
            let weights = named(piece.program.names(), rows);
            end(orthant, goal, Some(ratio_down(&value)), &approximate(&weights))
        }
        _ => end(orthant, goal, None, &[]),
    }
}

fn exact_goal(piece: &Piece<'_>, goal: &Goal) -> Option<Proved> {
    let problem = Subset { problem: &piece.orthant, indices: piece.program.names() };
    minimum(&problem, goal.column, goal.direction, Some(goal.search.rows().to_vec()))
}

/// The same in exact arithmetic throughout, with every row that the exact vertices violate, by however little.
fn exactly(rows: &Rows<'_>, pool: &Pool, piece: &Piece<'_>) -> Proof {
    let orthant = &piece.orthant;
    let mut names = piece.program.names().to_vec();
    let mut starts: Vec<Vec<Row>> = piece.goals.iter().map(|g| g.search.rows().to_vec()).collect();
    // A goal that cost too much once is not tried again.
    let mut given_up: Vec<bool> = piece.goals.iter().map(|g| g.retired).collect();
    for round in 0.. {
        let problem = Subset { problem: orthant, indices: &names };
        let found = parallel::map(piece.goals.len(), rows.columns() > 4, |k| {
            let goal = &piece.goals[k];
            if given_up[k] {
                return None;
            }
            minimum(&problem, goal.column, goal.direction, Some(starts[k].clone()))
        });
        let mut points: Vec<Vec<BigRational>> = Vec::new();
        let (mut ends, mut directions) = (Vec::new(), Vec::new());
        for (((goal, proved), start), give_up) in piece.goals.iter().zip(found).zip(&mut starts).zip(&mut given_up) {
            *give_up |= proved.is_none();
            ends.push(match proved {
                Some(Proved::Empty { rows }) => return (empty(orthant, &named(&names, rows)), Vec::new()),
                Some(Proved::Minimum { value, rows, point }) => {
                    if rows.len() == start.len() {
                        *start = rows.iter().map(|r| Row::Given(r.0)).collect();
                    }
                    if !points.contains(&point) {
                        points.push(point);
                    }
                    end(orthant, goal, Some(ratio_down(&value)), &approximate(&named(&names, rows)))
                }
                Some(Proved::Unbounded { ray }) => {
                    directions.push(ray);
                    end(orthant, goal, None, &[])
                }
                None => end(orthant, goal, None, &[]),
            });
        }
        let fresh = if round < ROUNDS { missed(rows, pool, orthant, &names, &points) } else { Vec::new() };
        if fresh.is_empty() {
            return (bounded(ends), directions);
        }
        names.extend(fresh);
    }
    unreachable!("the rounds are limited")
}

/// Half-spaces that exact points violate. A violation that a double and its remainder cannot tell from zero counts as
/// none, which only leaves a row out.
fn missed(
    rows: &Rows<'_>,
    pool: &Pool,
    orthant: &Orthant<'_>,
    names: &[usize],
    points: &[Vec<BigRational>],
) -> Vec<usize> {
    let mut known = pool.known().clone();
    known.extend(names);
    let vertices: Vec<Vertex<Remainders<'_>>> = points
        .iter()
        .map(|x| {
            let point: Vec<f64> = x.iter().map(|v| v.to_f64().unwrap_or(f64::NAN)).collect();
            let rest = x
                .iter()
                .zip(&point)
                .map(|(v, &p)| if p.is_finite() { (v - rational(p)).to_f64().unwrap_or(0.0) } else { 0.0 })
                .collect();
            let polyhedron = Remainders { orthant, point: point.clone(), rest };
            Vertex { polyhedron, signs: orthant.signs.clone(), ray: Some(vec![0.0; point.len()]), point }
        })
        .collect();
    let pass = Pass::new(rows.count(), 1);
    let mut found: Vec<usize> =
        scan(rows, &pool.scale, &vertices, &known, pass, pool.backend()).into_iter().flatten().collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// An orthant at one point that is known to twice the precision: a half-space that only seems to be violated says
/// nothing, and one that seems to hold by a rounding is shown with its violation enlarged.
struct Remainders<'a> {
    orthant: &'a Orthant<'a>,
    point: Vec<f64>,
    rest: Vec<f64>,
}

impl HalfSpaces for Remainders<'_> {
    fn dimension(&self) -> usize {
        self.orthant.dimension()
    }

    fn count(&self) -> usize {
        self.orthant.count()
    }

    fn half_space(&self, index: usize, g: &mut [f64]) -> f64 {
        let h = self.orthant.half_space(index, g);
        if h == f64::INFINITY || violation(g, h, &self.point, None, -1e-12).is_none() {
            return f64::INFINITY;
        }
        let (mut sum, mut error, mut size) = (-h, 0.0, h.abs());
        for ((&a, &x), &r) in g.iter().zip(&self.point).zip(&self.rest) {
            let p = a * x;
            let tail = a.mul_add(x, -p) + a * r;
            let s = sum + p;
            let part = s - sum;
            error += (sum - (s - part)) + (p - part) + tail;
            sum = s;
            size += p.abs();
        }
        let violated = sum + error;
        // Far enough below the value at the point for the tolerance of the scan; NaN is no violation.
        if violated > 1e-28 * size { h + sum - 1e-9 * size.max(f64::MIN_POSITIVE) } else { f64::INFINITY }
    }
}
