//! The proof of a basis over the rationals: the last resort where rounding leaves a sign open.
//!
//! For multipliers `l >= 0` of half-spaces `g x <= h` with `c + G' l = 0`, every point of the polyhedron satisfies
//! `c x >= -h l`. The unknowns have no box, so the equation has to hold exactly: the multipliers are those of the
//! basis, solved fraction-free.

use super::{HalfSpaces, Row};
use crate::exact;
use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// The multipliers of the basis for `direction * x[column]`. The value is `None` if the basis proves nothing. The bound
/// is `-sum l h`.
pub(crate) fn basis_multipliers(
    problem: &impl HalfSpaces,
    rows: &[Row],
    column: usize,
    direction: f64,
) -> Option<Vec<(usize, BigRational)>> {
    let n = problem.dimension();
    let (transposed, _) = basis(problem, rows, n);
    let mut objective = vec![0.0; n];
    objective[column] = -direction;
    let multipliers = exact::solve(&transposed, &objective, n)?;
    let mut found = Vec::with_capacity(n);
    for (&row, multiplier) in rows.iter().zip(multipliers) {
        match row {
            Row::Given(index) if !multiplier.is_negative() => found.push((index, multiplier)),
            Row::AtInfinity { .. } if multiplier.is_zero() => {}
            _ => return None,
        }
    }
    Some(found)
}

/// The bound that exact multipliers give: `direction * x[column]` is at least this.
pub(crate) fn exact_bound(problem: &impl HalfSpaces, multipliers: &[(usize, BigRational)]) -> BigRational {
    let mut g = vec![0.0; problem.dimension()];
    multipliers
        .iter()
        .filter(|(_, l)| !l.is_zero())
        .fold(BigRational::zero(), |sum, (index, l)| sum - l * exact::rational(problem.half_space(*index, &mut g)))
}

/// Proves over the rationals that the half-spaces contradict each other: the last one's normal is a combination of the
/// others' with coefficients `<= 0` (Farkas). Returns the half-spaces of the contradiction with their positive
/// multipliers.
pub(crate) fn farkas(problem: &impl HalfSpaces, others: &[Row], entering: usize) -> Option<Vec<(usize, BigRational)>> {
    let n = problem.dimension();
    let (transposed, right) = basis(problem, others, n);
    let mut g = vec![0.0; n];
    let h = problem.half_space(entering, &mut g);
    let alpha = exact::solve(&transposed, &g, n)?;
    let mut gap = exact::rational(h);
    let mut multipliers = Vec::with_capacity(n + 1);
    for ((&row, a), h) in others.iter().zip(alpha).zip(&right) {
        match row {
            _ if a.is_zero() => {}
            Row::Given(index) if a.is_negative() => {
                gap -= &a * exact::rational(*h);
                multipliers.push((index, -a));
            }
            _ => return None,
        }
    }
    multipliers.push((entering, BigRational::from_integer(1.into())));
    gap.is_negative().then_some(multipliers)
}

/// The transposed basis matrix, row-major, and the right-hand sides.
fn basis(problem: &impl HalfSpaces, rows: &[Row], n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut transposed = vec![0.0; n * n];
    let mut right = vec![0.0; n];
    let mut g = vec![0.0; n];
    for (i, &row) in rows.iter().enumerate() {
        right[i] = row.half_space(problem, &mut g);
        for (j, &x) in g.iter().enumerate() {
            transposed[j * n + i] = x;
        }
    }
    (transposed, right)
}
