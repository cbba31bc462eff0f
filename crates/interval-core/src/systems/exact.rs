//! The exact hull of the solution set of `A x = b` (Rohn, *Reliable Computing* 11 (2005); docs/theory.md, "Square
//! systems"): the hull of the solutions of `A_c x - b_c = T_y (Delta |x| + delta)` over all sign vectors `y`.

use super::column;
use crate::absolute_value::{Equations, Solution};
use crate::approximate;
use crate::error::Error;
use crate::interval::Interval;
use crate::inverse::{ACCORD_LIMIT, Certificate, Outcome, UNBOUNDED, exact as exact_inverse};
use crate::matrix::IntervalMatrix;
use crate::parallel;
use crate::scaling::Scaled;

/// The hull of all solutions, or the proof that a member of `A` is singular. Up to order [`ACCORD_LIMIT`].
///
/// # Errors
/// Shapes that do not fit.
pub fn exact(a: &IntervalMatrix, b: &[Interval]) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let right = column(a, b)?;
    let n = a.rows();
    if !right.is_bounded() {
        return Ok(Outcome::not_applicable(UNBOUNDED));
    }
    if n > ACCORD_LIMIT {
        return Ok(Outcome::not_applicable(format!("order {n} exceeds {ACCORD_LIMIT}, the limit of sign accord")));
    }
    let inverse = exact_inverse(a)?;
    if inverse.enclosure().is_none() {
        return Ok(Outcome { value: None, ..inverse });
    }
    let Some((scaled, (right, common))) = Scaled::new(a).and_then(|s| s.right_hand_side(b).map(|r| (s, r))) else {
        return Ok(Outcome::not_applicable(
            "the entries differ so much in size that scaling by powers of two is not exact",
        ));
    };
    let within = if scaled.is_trivial() { None } else { Some(exact_inverse(&scaled.a)?) };
    let value = within
        .as_ref()
        .unwrap_or(&inverse)
        .enclosure()
        .and_then(|inverse| hull(&scaled.a, &right, &inverse.magnitude()))
        .and_then(|(lower, upper)| scaled.unscale_solution(&lower, &upper, common));
    let Some(value) = value else {
        return Ok(Outcome::not_applicable("sign accord did not end, or a bound overflows"));
    };
    let Some(Certificate::Regular(witness)) = inverse.certificate else {
        return Ok(Outcome::not_applicable("the inverse came without a certificate of regularity"));
    };
    Ok(Outcome::enclosed(value, Certificate::Regular(witness)))
}

fn hull(a: &IntervalMatrix, b: &[Interval], magnitude: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let n = a.rows();
    let start = approximate::inverse(&a.midpoint(), n)?;
    let middle: Vec<f64> = b.iter().map(|x| x.midpoint()).collect();
    let guess: Vec<bool> =
        start.chunks_exact(n).map(|row| row.iter().zip(&middle).map(|(r, m)| r * m).sum::<f64>() > 0.0).collect();
    let one = |bits: usize| -> Option<Solution> {
        let positive: Vec<bool> = (0..n).map(|k| bits >> k & 1 == 1).collect();
        let ends: Vec<f64> = b.iter().zip(&positive).map(|(x, &p)| if p { x.hi() } else { x.lo() }).collect();
        let equations = Equations::new(a, &positive);
        let solution = equations.solve(&ends, &mut guess.clone())?;
        Some(equations.refine(&ends, &solution))
    };
    let solutions: Option<Vec<Solution>> = parallel::map(1 << n, n >= 6, one).into_iter().collect();
    let solutions = solutions?;
    let lo = (0..n).map(|i| solutions.iter().map(|s| s.lower(magnitude, i).0).fold(f64::INFINITY, f64::min)).collect();
    let hi =
        (0..n).map(|i| solutions.iter().map(|s| s.upper(magnitude, i).0).fold(f64::NEG_INFINITY, f64::max)).collect();
    Some((lo, hi))
}
