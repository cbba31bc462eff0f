//! Regularity by a partition of which every cell is regular: cells that do not contract are halved along the entry that
//! moves the inverse most.

use super::singular::steps;
use super::{Preconditioned, null_vector};
use crate::matrix::IntervalMatrix;
use crate::witness::Cell;

pub(crate) enum Verdict {
    Regular(Cell),
    Singular(Vec<f64>),
    Open,
}

/// Cells that are tried at most: a bound of the time.
const CELLS: usize = 4096;
/// Halvings of one cell at most: the proof is a tree that is walked recursively.
const DEPTH: usize = 100;
/// Operations that all cells together may take: a bound of the time for large orders.
const OPERATIONS: usize = 2_000_000_000;

/// Halves until every cell is proved, one holds a singular member, or the budget ends.
pub(crate) fn prove(a: &IntervalMatrix) -> Verdict {
    let n = a.rows();
    let mut budget = CELLS.min(OPERATIONS / ((8 + 2 * steps(n)) * n * n * n)).max(1);
    examine(a, &mut budget, 0)
}

fn examine(a: &IntervalMatrix, budget: &mut usize, depth: usize) -> Verdict {
    if *budget == 0 || depth > DEPTH {
        return Verdict::Open;
    }
    *budget -= 1;
    let preconditioned = Preconditioned::new(a);
    let contracted = preconditioned.as_ref().and_then(|p| p.contracted().map(|vector| (p.r.clone(), vector)));
    if let Some((approximate_inverse, vector)) = contracted {
        return Verdict::Regular(Cell::Regular { approximate_inverse, vector });
    }
    if let Some(x) = null_vector(a) {
        return Verdict::Singular(x);
    }
    let Some((entry, value)) = largest_smear(a, preconditioned.as_ref().map(|p| p.r.as_slice())) else {
        return Verdict::Open;
    };
    let (below, above) = halves(a, entry, value);
    let below = match examine(&below, budget, depth + 1) {
        Verdict::Regular(cell) => cell,
        other => return other,
    };
    match examine(&above, budget, depth + 1) {
        Verdict::Regular(above) => Verdict::Regular(Cell::Halved { entry, value, halves: Box::new([below, above]) }),
        other => other,
    }
}

/// The cell cut at a value of one entry.
pub(crate) fn halves(a: &IntervalMatrix, entry: usize, value: f64) -> (IntervalMatrix, IntervalMatrix) {
    (a.with_bounds(entry, a.lo()[entry], value), a.with_bounds(entry, value, a.hi()[entry]))
}

/// The entry along which the inverse moves most, `max |B_ik| Delta_kl max |B_lj|` (docs/theory.md, "Inverses",
/// partition), and its midpoint; without an inverse the entry of largest radius. `None` where no entry can be halved.
pub(crate) fn largest_smear(a: &IntervalMatrix, inverse: Option<&[f64]>) -> Option<(usize, f64)> {
    let n = a.rows();
    let size = |row: usize, column: usize| inverse.map_or(1.0, |b| b[row * n + column].abs());
    let columns: Vec<f64> = (0..n).map(|k| (0..n).map(|i| size(i, k)).fold(0.0, f64::max)).collect();
    let rows: Vec<f64> = (0..n).map(|l| (0..n).map(|j| size(l, j)).fold(0.0, f64::max)).collect();
    let (middle, spread) = super::split(a);
    (0..n * n)
        .filter(|&at| a.lo()[at] < middle[at] && middle[at] < a.hi()[at])
        .map(|at| (at, columns[at / n] * spread[at] * rows[at % n]))
        .max_by(|x, y| x.1.total_cmp(&y.1))
        .map(|(at, _)| (at, middle[at]))
}
