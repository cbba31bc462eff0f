//! One scaled norm bound for the whole inverse (Neumaier, *Interval Methods for Systems of Equations*, 1990, theorem
//! 4.1.11).
//!
//! With `R` an approximate inverse and `|I - R A| v <= beta v`, `beta < 1`, `v > 0`, every inverse lies in
//! `R + beta / (1 - beta) [-v w', v w']`, `w_j = max_i |R_ij| / v_i`. Cheap, and wide: all entries of a column share
//! one radius up to `v`.

use super::{Certificate, Outcome, UNBOUNDED};
use crate::error::Error;
use crate::matrix::IntervalMatrix;
use crate::regularity::{Preconditioned, Witness, times};
use crate::rounding::{add_up, div_up, mul_up, sub_down};

/// Encloses the inverse. The method does not apply if no `v` with `|I - R A| v < v` is found.
///
/// # Errors
/// A matrix that is not square.
pub fn neumaier(a: &IntervalMatrix) -> Result<Outcome, Error> {
    crate::rounding::check_environment()?;
    let n = a.order()?;
    if !a.is_bounded() {
        return Ok(Outcome::not_applicable(UNBOUNDED));
    }
    let Some(Preconditioned { r, g, .. }) = Preconditioned::new(a) else {
        return Ok(Outcome::not_applicable("the midpoint matrix has no usable approximate inverse"));
    };
    let Some(v) = crate::regularity::contracted_vector(&g, n) else {
        return Ok(Outcome::not_applicable("no v > 0 with |I - R A| v < v was found: strong regularity is not proved"));
    };
    let beta = times(&g, &v).iter().zip(&v).map(|(&y, &x)| div_up(y, x)).fold(0.0, f64::max);
    let scale = div_up(beta, sub_down(1.0, beta));
    let w: Vec<f64> = (0..n).map(|j| (0..n).map(|i| div_up(r[i * n + j].abs(), v[i])).fold(0.0, f64::max)).collect();
    let (mut lo, mut hi) = (vec![0.0; n * n], vec![0.0; n * n]);
    for i in 0..n {
        for j in 0..n {
            let (at, reach) = (i * n + j, mul_up(mul_up(scale, v[i]), w[j]));
            (lo[at], hi[at]) = (sub_down(r[at], reach) + 0.0, add_up(r[at], reach) + 0.0);
        }
    }
    if beta >= 1.0 || lo.iter().chain(&hi).any(|x| !x.is_finite()) {
        return Ok(Outcome::not_applicable("the bound beta / (1 - beta) overflows"));
    }
    let value = IntervalMatrix::new(n, n, lo, hi)?;
    let witness = Witness::ScaledContraction { approximate_inverse: r, vector: v };
    Ok(Outcome::enclosed(value, Certificate::Regular(witness)))
}
