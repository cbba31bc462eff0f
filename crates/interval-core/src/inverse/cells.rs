//! The cells of [`partitioned`](super::partitioned()) as numbers, for callers that share them among machines. The bits
//! are those of one machine: a cell's answer depends on nothing but the cell.

use super::Outcome;
use super::exact::Ends;
use super::partitioned::{Cell, look, partitioned_by};
use crate::error::Error;
use crate::matrix::IntervalMatrix;
use crate::parallel;

/// Cells of a level that are worth sharing.
const WORTHWHILE: usize = 32;

/// The exact hull of a cell.
const HULL: u8 = 0;
/// The same, every bound of which is the double next to the exact one.
const TIGHT: u8 = 1;
/// An enclosure of a regular cell.
const REGULAR: u8 = 2;
/// Neither.
const OPEN: u8 = 3;
/// A proof that a member is singular, which the asker makes again.
const AGAIN: u8 = 4;

/// Bounds of the answer of one cell: up to four matrices.
const MATRICES: usize = 4;

/// Answers of cells: a code for each, and four matrices of n² numbers for each, row-major, 0 where they say nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Answers {
    /// What is known of each cell.
    pub codes: Vec<u8>,
    /// Its numbers.
    pub numbers: Vec<f64>,
}

/// The answers of cells of order `n`, whose bounds stand one after the other.
///
/// # Errors
/// Bounds of no intervals, or of another number.
pub fn cell_answers(n: usize, lower: &[f64], upper: &[f64]) -> Result<Answers, Error> {
    crate::rounding::check_environment()?;
    let cells = lower
        .chunks(n * n)
        .zip(upper.chunks(n * n))
        .map(|(l, u)| IntervalMatrix::new(n, n, l.to_vec(), u.to_vec()))
        .collect::<Result<Vec<_>, _>>()?;
    let found = parallel::map(cells.len(), cells.len() > 1, |at| look(&cells[at], false));
    let mut answers = Answers { codes: Vec::new(), numbers: Vec::with_capacity(found.len() * MATRICES * n * n) };
    for cell in found {
        let (code, matrices) = numbers(cell);
        answers.codes.push(code);
        answers.numbers.extend(matrices.iter().flatten());
        let missing = (MATRICES - matrices.len()) * n * n;
        answers.numbers.extend(std::iter::repeat_n(0.0, missing));
    }
    Ok(answers)
}

fn numbers(cell: Cell) -> (u8, Vec<Vec<f64>>) {
    match cell {
        Cell::Hull(e) => {
            (if e.tight { TIGHT } else { HULL }, vec![e.lower, e.upper, e.attained_lower, e.attained_upper])
        }
        Cell::Regular { enclosure, attained: None } => {
            (REGULAR, vec![enclosure.lo().to_vec(), enclosure.hi().to_vec()])
        }
        Cell::Regular { .. } | Cell::Singular(_) => (AGAIN, Vec::new()),
        Cell::Open => (OPEN, Vec::new()),
    }
}

/// [`partitioned`](super::partitioned()), whose cells are answered by `ask`: it is given the order, the lower and the
/// upper bounds of cells, and returns what [`cell_answers`] does of them, or `None` to end the search.
///
/// # Errors
/// A matrix that is not square, or `cells` of 0.
pub fn partitioned_shared(
    a: &IntervalMatrix,
    cells: usize,
    ask: &mut dyn FnMut(usize, Vec<f64>, Vec<f64>) -> Option<Answers>,
) -> Result<Outcome, Error> {
    let n = a.order()?;
    let mut shared = |level: &[IntervalMatrix]| {
        if level.len() < WORTHWHILE {
            return Some(parallel::map(level.len(), level.len() > 1, |at| look(&level[at], level.len() == 1)));
        }
        let lower = level.iter().flat_map(|c| c.lo().iter().copied()).collect();
        let upper = level.iter().flat_map(|c| c.hi().iter().copied()).collect();
        let answers = ask(n, lower, upper)?;
        let sizes = (level.len(), level.len() * MATRICES * n * n);
        if (answers.codes.len(), answers.numbers.len()) != sizes {
            return None;
        }
        let each = answers.codes.iter().zip(answers.numbers.chunks(MATRICES * n * n));
        each.zip(level).map(|((&code, numbers), cell)| read(code, numbers, cell)).collect()
    };
    partitioned_by(a, cells, &mut shared)
}

/// The answer of a cell from its numbers; `None` where they are none.
fn read(code: u8, numbers: &[f64], cell: &IntervalMatrix) -> Option<Cell> {
    let n = cell.rows();
    let matrix = |k: usize| numbers[k * n * n..(k + 1) * n * n].to_vec();
    Some(match code {
        HULL | TIGHT => Cell::Hull(Ends {
            lower: matrix(0),
            upper: matrix(1),
            attained_lower: matrix(2),
            attained_upper: matrix(3),
            tight: code == TIGHT,
        }),
        REGULAR => Cell::Regular { enclosure: IntervalMatrix::new(n, n, matrix(0), matrix(1)).ok()?, attained: None },
        OPEN => Cell::Open,
        AGAIN => look(cell, false),
        _ => return None,
    })
}
