//! A singular member by its null vector: for `x != 0` with 0 in every row of `A x` (Oettli and Prager) each row has a
//! member that is orthogonal to `x`, and these rows make a singular matrix.
//!
//! The search moves one row at a time to where the determinant falls most. With `B = A^-1` a change `d` of row `k`
//! multiplies the determinant by `1 + d B_k`, `B_k` the column of `B`. If that can reach zero, `B_k` is the null
//! vector.

use crate::approximate;
use crate::exact::rational;
use crate::matrix::IntervalMatrix;
use crate::rounding::{add_down, add_up, mul_down, mul_up};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// Entries stay this part of the radius inside their ends at first, so that rounding does not lose a vector that was
/// found.
const MARGINS: [f64; 2] = [1.0 - 1e-6, 1.0];

/// A proved null vector of some member. The value is `None` if the search finds none.
pub(super) fn search(a: &IntervalMatrix) -> Option<Vec<f64>> {
    MARGINS.into_iter().find_map(|margin| descend(a, margin)).or_else(|| of_midpoint(a))
}

/// The direction that the midpoint shrinks most, for midpoints that are singular themselves.
fn of_midpoint(a: &IntervalMatrix) -> Option<Vec<f64>> {
    let n = a.rows();
    let x = approximate::least_singular_vector(&a.midpoint(), n)?;
    is_null_vector(a, &x).then_some(x)
}

/// One descent from the midpoint.
pub(crate) fn null_vector(a: &IntervalMatrix) -> Option<Vec<f64>> {
    descend(a, MARGINS[0]).or_else(|| of_midpoint(a))
}

/// Steps of a descent: enough to visit every row some times, as long as the inverses do not take longer than a second.
pub(crate) fn steps(n: usize) -> usize {
    (4 * n + 8).min(2_000_000_000 / (2 * n * n * n) + 1)
}

fn descend(a: &IntervalMatrix, margin: f64) -> Option<Vec<f64>> {
    let n = a.rows();
    let (middle, spread) = super::split(a);
    let mut member = middle.clone();
    let mut inverse = approximate::inverse(&member, n)?;
    for _ in 0..steps(n) {
        let target = |k: usize, l: usize, inverse: &[f64]| {
            let at = k * n + l;
            let falls = if inverse[l * n + k] > 0.0 { -1.0 } else { 1.0 };
            (middle[at] + falls * margin * spread[at]).clamp(a.lo()[at], a.hi()[at])
        };
        let factor = |k: usize| {
            1.0 + (0..n).map(|l| (target(k, l, &inverse) - member[k * n + l]) * inverse[l * n + k]).sum::<f64>()
        };
        let (k, least) = (0..n).map(|k| (k, factor(k))).min_by(|x, y| x.1.total_cmp(&y.1))?;
        if least <= 0.0 {
            let x: Vec<f64> = (0..n).map(|l| inverse[l * n + k]).collect();
            let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let x: Vec<f64> = x.iter().map(|v| v / largest).collect();
            return is_null_vector(a, &x).then_some(x);
        }
        if least > 1.0 - 1e-9 {
            return None;
        }
        for l in 0..n {
            member[k * n + l] = target(k, l, &inverse);
        }
        inverse = approximate::inverse(&member, n)?;
    }
    None
}

/// True if `x` is not zero and every row of `A x` contains 0: in directed rounding, or in rationals where that does not
/// decide.
pub(crate) fn is_null_vector(a: &IntervalMatrix, x: &[f64]) -> bool {
    let n = a.columns();
    if x.len() != n || x.iter().any(|v| !v.is_finite()) || x.iter().all(|&v| v == 0.0) {
        return false;
    }
    (0..a.rows()).all(|i| {
        let (lo, hi) = (&a.lo()[i * n..][..n], &a.hi()[i * n..][..n]);
        // The ends of the row's range over its members.
        let least = |j: usize| if x[j] > 0.0 { lo[j] } else { hi[j] };
        let most = |j: usize| if x[j] > 0.0 { hi[j] } else { lo[j] };
        let below = (0..n).fold(0.0, |sum, j| add_up(sum, mul_up(least(j), x[j]))) <= 0.0;
        let above = (0..n).fold(0.0, |sum, j| add_down(sum, mul_down(most(j), x[j]))) >= 0.0;
        let sum = |end: &dyn Fn(usize) -> f64| {
            (0..n).fold(BigRational::zero(), |sum, j| sum + rational(end(j)) * rational(x[j]))
        };
        (below || !sum(&least).is_positive()) && (above || !sum(&most).is_negative())
    })
}
