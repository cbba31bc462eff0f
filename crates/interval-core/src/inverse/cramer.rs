//! Interval Cramer's rule, the method of Nirmala and Ganesan (paper, section IV.B) in outward-rounded arithmetic:
//! ratios of interval determinants. It refuses when the determinant contains 0.

use super::{Certificate, Outcome, UNBOUNDED};
use crate::error::Error;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;

/// Orders above this are refused: the expansion has `2^n` minors, and its bounds are too wide to use at smaller orders
/// already.
pub const ORDER_LIMIT: usize = 10;

/// Encloses the inverse by cofactors over the determinant.
///
/// # Errors
/// A matrix that is not square.
pub fn cramer(a: &IntervalMatrix) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let n = a.order()?;
    let det = match determinant(a) {
        Ok(det) => det,
        Err(refusal) => return Ok(Outcome::not_applicable(refusal)),
    };
    let mut entries = Vec::with_capacity(n * n);
    let mut minors = vec![Interval::ONE; 1 << n];
    for i in 0..n {
        for j in 0..n {
            let cofactor = minor(a, j, i, &mut minors);
            entries.push(if (i + j) % 2 == 0 { cofactor / det } else { -cofactor / det });
        }
    }
    let certificate = Certificate::Determinant { lo: det.lo(), hi: det.hi() };
    let value = IntervalMatrix::from_entries(n, n, &entries);
    if !value.is_bounded() {
        return Ok(Outcome::not_applicable("a ratio of determinants overflows"));
    }
    Ok(Outcome::enclosed(value, certificate))
}

/// The interval determinant of a square matrix, or why it cannot divide where it contains 0.
pub(crate) fn determinant(a: &IntervalMatrix) -> Result<Interval, String> {
    if !a.is_bounded() {
        return Err(UNBOUNDED.into());
    }
    if a.rows() > ORDER_LIMIT {
        return Err(format!("order {} exceeds {ORDER_LIMIT}, the limit of Cramer's rule", a.rows()));
    }
    let det = expand_all(a);
    if !det.is_bounded() {
        return Err("the interval determinant overflows".into());
    }
    if det.lo() <= 0.0 && det.hi() >= 0.0 {
        return Err(format!("the interval determinant {det} contains 0"));
    }
    Ok(det)
}

/// An enclosure of every member's determinant; the order is at most [`ORDER_LIMIT`].
pub(crate) fn expand_all(a: &IntervalMatrix) -> Interval {
    let every: [usize; ORDER_LIMIT] = std::array::from_fn(|k| k);
    let every = &every[..a.rows()];
    expand(a, every, every, &mut vec![Interval::ONE; 1 << a.rows()])
}

/// The determinant without row `i` and column `j`.
fn minor(a: &IntervalMatrix, i: usize, j: usize, minors: &mut [Interval]) -> Interval {
    let without = |skip: usize| -> [usize; ORDER_LIMIT] { std::array::from_fn(|k| if k < skip { k } else { k + 1 }) };
    let rest = a.rows() - 1;
    expand(a, &without(i)[..rest], &without(j)[..rest], minors)
}

/// Laplace expansion by rows with shared minors: `minors[mask]` is the determinant of the first `|mask|` rows in the
/// columns of `mask`. The first entry of `minors` is 1.
fn expand(a: &IntervalMatrix, rows: &[usize], columns: &[usize], minors: &mut [Interval]) -> Interval {
    let n = columns.len();
    for mask in 1_usize..1 << n {
        let row = rows[mask.count_ones() as usize - 1];
        let term = |position: usize| {
            let entry = a.get(row, columns[position]);
            // A product with the determinant of nothing, or a sum with 0, is exact and costs as much as any other.
            if mask.is_power_of_two() { entry } else { entry * minors[mask & !(1 << position)] }
        };
        let mut left = mask;
        let mut next = || {
            let position = left.trailing_zeros() as usize;
            left &= left - 1;
            (position, left.count_ones() % 2 == 0)
        };
        let (first, positive) = next();
        let mut sum = if positive { term(first) } else { -term(first) };
        for _ in 1..mask.count_ones() {
            let (position, positive) = next();
            sum = if positive { sum + term(position) } else { sum - term(position) };
        }
        minors[mask] = sum;
    }
    minors[(1 << n) - 1]
}
