//! The interval Gauss-Seidel iteration on the preconditioned system (Neumaier 1990, section 4.3; Moore, Kearfott and
//! Cloud 2009).
//!
//! For `C = R A` and `z = R b`, `x_i` is intersected with `(z_i - sum_{j != i} C_ij x_j) / C_ii`, from a box that holds
//! all solutions. Each gain is used at once, until nothing changes. The first box is `v max_i |z_i| / u_i` for
//! `|I - C| v <= v - u`, `u > 0`.

use super::column;
use crate::error::Error;
use crate::interval::Interval;
use crate::inverse::{Certificate, Outcome, UNBOUNDED};
use crate::matrix::IntervalMatrix;
use crate::regularity::{Preconditioned, Witness, slack};
use crate::rounding::{div_up, mul_up};

/// Sweeps at most; they end before if nothing changes. Each sweep keeps an enclosure, so any number is sound (Neumaier
/// 1990, section 4.3).
const SWEEPS: usize = 60;

/// Encloses every solution of `A x = b` for members `A`, `b`. The method does not apply if no `v` with
/// `|I - R A| v < v` is found.
///
/// # Errors
/// Shapes that do not fit.
pub fn gauss_seidel(a: &IntervalMatrix, b: &[Interval]) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let right = column(a, b)?;
    let n = a.rows();
    if !(a.is_bounded() && right.is_bounded()) {
        return Ok(Outcome::not_applicable(UNBOUNDED));
    }
    let Some(preconditioned) = Preconditioned::new(a) else {
        return Ok(Outcome::not_applicable("the midpoint matrix has no usable approximate inverse"));
    };
    let Some(v) = preconditioned.contracted() else {
        return Ok(Outcome::not_applicable("no v > 0 with |I - R A| v < v was found: strong regularity is not proved"));
    };
    let Some(u) = slack(&preconditioned.g, &v) else {
        return Ok(Outcome::not_applicable("no v > 0 with |I - R A| v < v was found: strong regularity is not proved"));
    };
    let r = IntervalMatrix::from_points(n, n, &preconditioned.r);
    let (c, z) = (r.multiply(a)?, r.multiply(&right)?);
    let scale = z.magnitude().iter().zip(&u).map(|(&z, &u)| div_up(z, u)).fold(0.0, f64::max);
    let mut x: Vec<Interval> = Vec::with_capacity(n);
    for &entry in &v {
        let reach = mul_up(scale, entry);
        if !reach.is_finite() {
            return Ok(Outcome::not_applicable("the start box of the iteration overflows"));
        }
        x.push(Interval::raw(-reach, reach));
    }
    for _ in 0..SWEEPS {
        let before = x.clone();
        for i in 0..n {
            let others = (0..n).filter(|&j| j != i).fold(z.get(i, 0), |rest, j| rest - c.get(i, j) * x[j]);
            let next = (others / c.get(i, i)).intersection(x[i]);
            // The solutions are in both, so an empty intersection cannot be.
            if !next.is_empty() {
                x[i] = next;
            }
        }
        if x == before {
            break;
        }
    }
    let witness = Witness::ScaledContraction { approximate_inverse: preconditioned.r, vector: v };
    Ok(Outcome::enclosed(IntervalMatrix::from_entries(n, 1, &x), Certificate::Regular(witness)))
}
