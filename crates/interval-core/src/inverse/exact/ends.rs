//! The ends of the hull from solutions of absolute value equations.

use crate::absolute_value::{Equations, Solution};
use crate::doubles::Neighbours as _;
use crate::matrix::IntervalMatrix;
use crate::parallel;

/// Bounds of the hull, row-major, and how far inside them members are proved to reach.
#[derive(Debug, Clone)]
pub(crate) struct Ends {
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
    /// Some member's inverse is at most this, entry by entry.
    pub attained_lower: Vec<f64>,
    /// Some member's inverse is at least this.
    pub attained_upper: Vec<f64>,
    /// Every bound is the double next to the exact one.
    pub tight: bool,
}

/// Orders below this run on one thread: the start of others costs more than it saves.
const PARALLEL: usize = 6;
/// Solutions that may attain an end and are refined, a bound of the time. The unrefined bound of any others counts.
const CANDIDATES: usize = 32;

/// One end of one entry: the bound, the attained value, and true if the bound is tight.
type End = (f64, f64, bool);

/// The values of entry `ij` at the vertices that row `i` and column `j` of the signs name. They are the hull if every
/// entry of the inverse is proved to keep its sign. `magnitude` is 0 for an entry that is 0.
pub(super) fn by_signs(a: &IntervalMatrix, signs: &[bool], magnitude: &[f64]) -> Option<Ends> {
    let n = a.rows();
    let positive = |i: usize, j: usize| signs[i * n + j];
    let zero = |i: usize, j: usize| magnitude[i * n + j] == 0.0;
    let row = |i: usize| -> Option<Vec<(End, End)>> {
        let above: Vec<bool> = (0..n).map(|k| positive(i, k)).collect();
        let below: Vec<bool> = above.iter().map(|p| !p).collect();
        let (below, above) = (Equations::new(a, &below), Equations::new(a, &above));
        (0..n)
            .map(|j| {
                if zero(i, j) {
                    return Some(((0.0, 0.0, true), (0.0, 0.0, true)));
                }
                let unit = unit_vector(n, j);
                let mut signs: Vec<bool> = (0..n).map(|l| positive(l, j)).collect();
                let lower = below.refine(&unit, &below.solve(&unit, &mut signs)?);
                let upper = above.refine(&unit, &above.solve(&unit, &mut signs)?);
                Some((lower_end(&lower, magnitude, i), upper_end(&upper, magnitude, i)))
            })
            .collect()
    };
    let rows: Option<Vec<_>> = parallel::map(n, n >= PARALLEL, row).into_iter().collect();
    collect(&rows?.into_iter().flatten().collect::<Vec<_>>())
}

/// The hull from all sign vectors, for a matrix that is proved regular. Without a bound of the magnitudes of the
/// inverses it follows from the solutions themselves.
pub(crate) fn by_sign_accord(a: &IntervalMatrix, magnitude: Option<Vec<f64>>) -> Option<Ends> {
    let n = a.rows();
    // A row without radius has one sign.
    let free: Vec<usize> = (0..n).filter(|&k| (0..n).any(|l| a.lo()[k * n + l] < a.hi()[k * n + l])).collect();
    let signs_of = |bits: usize| -> Vec<bool> {
        (0..n).map(|k| free.iter().position(|&f| f == k).is_none_or(|at| bits >> at & 1 == 1)).collect()
    };
    let start = crate::approximate::inverse(&a.midpoint(), n)?;
    let one = |bits: usize| -> Option<Vec<Solution>> {
        let equations = Equations::new(a, &signs_of(bits));
        let column = |j: usize| {
            let mut signs: Vec<bool> = (0..n).map(|l| start[l * n + j] > 0.0).collect();
            equations.solve(&unit_vector(n, j), &mut signs)
        };
        (0..n).map(column).collect()
    };
    let solutions: Option<Vec<Vec<Solution>>> =
        parallel::map(1 << free.len(), n >= PARALLEL, one).into_iter().collect();
    let solutions = solutions?;
    let magnitude = match magnitude {
        Some(magnitude) => magnitude,
        None => magnitude_of(&solutions, n)?,
    };
    let entry = |at: usize| {
        let (i, j) = (at / n, at % n);
        let ends: Vec<(f64, f64)> = solutions
            .iter()
            .map(|columns| {
                let (x, error) = (columns[j].x[i], columns[j].error(&magnitude, i));
                (crate::rounding::sub_down(x, error), crate::rounding::add_up(x, error))
            })
            .collect();
        let refine = |bits: usize| Equations::new(a, &signs_of(bits)).refine(&unit_vector(n, j), &solutions[bits][j]);
        let reached = ends.iter().map(|e| e.1).fold(f64::INFINITY, f64::min);
        let below: Vec<usize> = (0..ends.len()).filter(|&y| ends[y].0 <= reached).collect();
        let lower = least(&below, |y| lower_end(&refine(y), &magnitude, i), |y| (ends[y].0, ends[y].1));
        let reached = ends.iter().map(|e| e.0).fold(f64::NEG_INFINITY, f64::max);
        let above: Vec<usize> = (0..ends.len()).filter(|&y| ends[y].1 >= reached).collect();
        let mirrored = |(bound, attained, tight): End| (-bound, -attained, tight);
        let upper = least(&above, |y| mirrored(upper_end(&refine(y), &magnitude, i)), |y| (-ends[y].1, -ends[y].0));
        (lower, mirrored(upper))
    };
    collect(&parallel::map(n * n, n >= PARALLEL, entry))
}

/// The least of the ends of several solutions, the first of them refined.
fn least(of: &[usize], refined: impl Fn(usize) -> End, coarse: impl Fn(usize) -> (f64, f64)) -> End {
    let mut end = (f64::INFINITY, f64::INFINITY, true);
    for (count, &y) in of.iter().enumerate() {
        let (bound, attained, tight) = if count < CANDIDATES {
            refined(y)
        } else {
            let (bound, attained) = coarse(y);
            (bound, attained, false)
        };
        if bound.is_nan() || bound < end.0 {
            end = (if bound.is_nan() { f64::NEG_INFINITY } else { bound }, end.1, tight);
        } else if bound == end.0 {
            // Another solution with the same bound that is tight shows that the bound is.
            end.2 |= tight;
        }
        end.1 = end.1.min(attained);
    }
    end
}

fn lower_end(solution: &Solution, magnitude: &[f64], i: usize) -> End {
    let (bound, tight) = solution.lower(magnitude, i);
    (bound, if tight { bound.above() } else { solution.upper(magnitude, i).0 }, tight)
}

fn upper_end(solution: &Solution, magnitude: &[f64], i: usize) -> End {
    let (bound, tight) = solution.upper(magnitude, i);
    (bound, if tight { bound.below() } else { solution.lower(magnitude, i).0 }, tight)
}

/// Upper bounds `H` of the magnitudes of all members' inverses from the solutions of all sign vectors, which attain
/// them: with `X` the largest approximations and `P` the largest residuals `H <= X + H P`, so in each row
/// `max H <= max X / (1 - q)`, `q` the largest column sum of `P`.
fn magnitude_of(solutions: &[Vec<Solution>], n: usize) -> Option<Vec<f64>> {
    use crate::rounding::{add_up, div_up, mul_up, sub_down};
    let (mut x, mut rest) = (vec![0.0_f64; n * n], vec![0.0_f64; n * n]);
    for columns in solutions {
        for (j, solution) in columns.iter().enumerate() {
            for i in 0..n {
                x[i * n + j] = x[i * n + j].max(solution.x[i].abs());
                rest[i * n + j] = rest[i * n + j].max(solution.rest[i]);
            }
        }
    }
    let sums: Vec<f64> = (0..n).map(|j| (0..n).fold(0.0, |sum, k| add_up(sum, rest[k * n + j]))).collect();
    let q = sums.iter().copied().fold(0.0, f64::max);
    if q.is_nan() || q >= 0.5 {
        return None;
    }
    let row = |i: usize| div_up((0..n).map(|j| x[i * n + j]).fold(0.0, f64::max), sub_down(1.0, q));
    Some((0..n * n).map(|at| add_up(x[at], mul_up(row(at / n), sums[at % n]))).collect())
}

fn unit_vector(n: usize, j: usize) -> Vec<f64> {
    (0..n).map(|k| if k == j { 1.0 } else { 0.0 }).collect()
}

fn collect(entries: &[(End, End)]) -> Option<Ends> {
    let ends = Ends {
        lower: entries.iter().map(|(l, _)| l.0).collect(),
        upper: entries.iter().map(|(_, u)| u.0).collect(),
        attained_lower: entries.iter().map(|(l, _)| l.1).collect(),
        attained_upper: entries.iter().map(|(_, u)| u.1).collect(),
        tight: entries.iter().all(|(l, u)| l.2 && u.2),
    };
    ends.lower.iter().chain(&ends.upper).all(|x| x.is_finite()).then_some(ends)
}
