//! The proof of a basis in directed rounding: enclosures of its exact multipliers, far cheaper than the rationals.
//!
//! Neumaier and Shcherbina (*Math. Prog.* 99 (2004) 283-296) bound a linear program from any multipliers, but inside a
//! box, and the unknowns here have none. The exact multipliers of a basis need no box: Krawczyk's method encloses them,
//! and where all are proved positive the bound follows from the basis alone.

use super::program::power_of_two_near;
use super::{HalfSpaces, Row};
use crate::interval::Interval;
use crate::inverse::enclose_solution;
use crate::matrix::IntervalMatrix;

/// Encloses the solution of `sum l_i g_i = right` for the rows `g_i` of a basis. The value is `None` if the basis is
/// not proved regular.
fn combination(problem: &impl HalfSpaces, rows: &[Row], right: &[f64]) -> Option<Vec<Interval>> {
    let n = rows.len();
    let mut matrix = vec![0.0; n * n];
    let mut g = vec![0.0; n];
    for (i, row) in rows.iter().enumerate() {
        row.half_space(problem, &mut g);
        g.iter().enumerate().for_each(|(j, &x)| matrix[j * n + i] = x);
    }
    let mut right = right.to_vec();
    let largest = |entries: &mut dyn Iterator<Item = &f64>| entries.fold(0.0_f64, |a, x| a.max(x.abs()));
    let mut exact = true;
    let mut by = |x: &mut f64, s: f64| {
        let scaled = *x * s;
        // Powers of two cost nothing unless they leave the range.
        exact &= scaled.is_finite() && scaled / s == *x;
        *x = scaled;
    };
    for j in 0..n {
        let s = power_of_two_near(largest(&mut matrix[j * n..(j + 1) * n].iter())).recip();
        matrix[j * n..(j + 1) * n].iter_mut().chain([&mut right[j]]).for_each(|x| by(x, s));
    }
    let mut scale = vec![1.0; n];
    for (i, s) in scale.iter_mut().enumerate() {
        *s = power_of_two_near(largest(&mut matrix[i..].iter().step_by(n))).recip();
        matrix[i..].iter_mut().step_by(n).for_each(|x| by(x, *s));
    }
    if !exact {
        return None;
    }
    let a = IntervalMatrix::from_points(n, n, &matrix);
    let found = enclose_solution(&a, &IntervalMatrix::from_points(n, 1, &right));
    let solution = found.enclosure()?;
    Some(scale.iter().enumerate().map(|(i, &s)| solution.get(i, 0) * Interval::raw(s, s)).collect())
}

/// Multipliers of the basis for `direction * x[column]`, each proved positive, by the names of their half-spaces. The
/// value is `None` if that is not certain.
pub(crate) fn enclosed_multipliers(
    problem: &impl HalfSpaces,
    rows: &[Row],
    column: usize,
    direction: f64,
) -> Option<Vec<(usize, Interval)>> {
    let mut objective = vec![0.0; rows.len()];
    objective[column] = -direction;
    let multipliers = combination(problem, rows, &objective)?;
    let positive = |(row, l): (&Row, Interval)| match *row {
        Row::Given(index) if l.lo() > 0.0 => Some((index, l)),
        _ => None,
    };
    rows.iter().zip(multipliers).map(positive).collect()
}

/// A lower bound of the bound `-sum l h` that the exact multipliers prove.
pub(crate) fn enclosed_bound(problem: &impl HalfSpaces, multipliers: &[(usize, Interval)]) -> f64 {
    let mut g = vec![0.0; problem.dimension()];
    let term = |&(index, l): &(usize, Interval)| {
        let h = problem.half_space(index, &mut g);
        l * Interval::raw(h, h)
    };
    let terms: Vec<Interval> = multipliers.iter().map(term).collect();
    -crate::reductions::sum_intervals(&terms).hi()
}

/// The proof that a half-space contradicts the basis, with approximate multipliers. The value is `None` if that is not
/// certain.
pub(crate) fn enclosed_farkas(problem: &impl HalfSpaces, rows: &[Row], entering: usize) -> Option<Vec<(usize, f64)>> {
    let mut g = vec![0.0; rows.len()];
    let h = problem.half_space(entering, &mut g);
    let alpha = combination(problem, rows, &g)?;
    let mut gap = Interval::raw(h, h);
    let mut weights = Vec::with_capacity(rows.len() + 1);
    for (&row, a) in rows.iter().zip(alpha) {
        let Row::Given(index) = row else { return None };
        if a.hi() >= 0.0 {
            return None;
        }
        let right = problem.half_space(index, &mut g);
        gap = gap - a * Interval::raw(right, right);
        weights.push((index, -a.midpoint()));
    }
    weights.push((entering, 1.0));
    (gap.hi() < 0.0).then_some(weights)
}
