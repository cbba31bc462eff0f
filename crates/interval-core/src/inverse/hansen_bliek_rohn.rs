//! The hull of a preconditioned system in closed form (Hansen 1992, Bliek 1992, Rohn 1993; Ning and Kearfott, *SIAM J. Numer.
//! Anal.* 34 (1997) 1289-1305).
//!
//! For a point matrix `R` every `A x = b` implies `C x = c` with `C` in `[I - G, I + G]`, `G >= |I - R A|`, and `c` in `R b`.
//! If `G v < v` for some `v > 0`, all those `C` are nonsingular, `M = (I - G)^-1 >= 0`, and the solutions have the hull
//!
//! ```text
//! [min(l, nu l), max(u, nu u)],   u_k = sum over j /= k of M_kj |c_j| + M_kk sup c_k,   l_k likewise with - and inf c_k,
//! ```
//!
//! `nu_k = 1 / (2 M_kk - 1)`. `M` is enclosed by Krawczyk's method, and the formula evaluated in intervals.

use super::{Certificate, Outcome, UNBOUNDED, krawczyk};
use crate::approximate;
use crate::error::Error;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;
use crate::regularity::{Witness, contracted_vector, residual};

/// Encloses the inverse column by column; not applicable where no `v` with `G v < v` is found.
///
/// # Errors
/// A matrix that is not square.
pub fn hansen_bliek_rohn(a: &IntervalMatrix) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let n = a.order()?;
    Ok(enclose_solution(a, &IntervalMatrix::identity(n)))
}

/// Encloses every solution of `A X = B`, `A` square with as many rows as `B`.
pub(crate) fn enclose_solution(a: &IntervalMatrix, b: &IntervalMatrix) -> Outcome {
    if !(a.is_bounded() && b.is_bounded()) {
        return Outcome::not_applicable(UNBOUNDED);
    }
    let n = a.rows();
    let Some(r) = approximate::inverse(&a.midpoint(), n) else {
        return Outcome::not_applicable("the midpoint matrix has no usable approximate inverse");
    };
    let g = residual(&r, a).magnitude();
    let Some(v) = contracted_vector(&g, n) else {
        return Outcome::not_applicable("no v > 0 with |I - R A| v < v was found: strong regularity is not proved");
    };
    let Some(m) = inverse_of_comparison(&g, n) else {
        return Outcome::not_applicable("the inverse of I - |I - R A| could not be enclosed");
    };
    let Ok(c) = IntervalMatrix::from_points(n, n, &r).multiply(b) else {
        return Outcome::not_applicable("the right-hand side does not fit the matrix");
    };
    let columns = b.columns();
    let mut entries = Vec::with_capacity(n * columns);
    for k in 0..n {
        let diagonal = m.get(k, k);
        let nu = (diagonal + diagonal - Interval::ONE).recip();
        for column in 0..columns {
            let others = (0..n)
                .filter(|&j| j != k)
                .fold(Interval::ZERO, |sum, j| sum + m.get(k, j) * number(c.get(j, column).magnitude()));
            let own = c.get(k, column);
            let upper = others + diagonal * number(own.hi());
            let lower = diagonal * number(own.lo()) - others;
            let hi = upper.hi().max((nu * upper).hi());
            let lo = lower.lo().min((nu * lower).lo());
            entries.push(Interval::raw(lo, hi));
        }
    }
    let value = IntervalMatrix::from_entries(n, columns, &entries);
    if !value.is_bounded() {
        return Outcome::not_applicable("a bound of the closed form overflows");
    }
    Outcome::enclosed(&value, Certificate::Regular(Witness::ScaledContraction { approximate_inverse: r, vector: v }))
}

/// A finite bound as an interval.
fn number(x: f64) -> Interval {
    Interval::raw(x, x)
}

/// `(I - G)^-1` for a `G` whose spectral radius is proved to be below 1: at least the identity.
fn inverse_of_comparison(g: &[f64], n: usize) -> Option<IntervalMatrix> {
    let entries: Vec<Interval> = g
        .iter()
        .enumerate()
        .map(|(at, &x)| if at % (n + 1) == 0 { Interval::ONE - number(x) } else { number(-x) })
        .collect();
    let outcome = krawczyk(&IntervalMatrix::from_entries(n, n, &entries)).ok()?;
    let value = outcome.value?;
    let least = |at: usize| if at.is_multiple_of(n + 1) { 1.0 } else { 0.0 };
    let kept = value.lower.iter().zip(&value.upper).enumerate();
    let entries: Option<Vec<Interval>> = kept.map(|(at, (&l, &h))| Interval::new(l.max(least(at)), h).ok()).collect();
    Some(IntervalMatrix::from_entries(n, n, &entries?))
}
