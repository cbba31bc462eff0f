//! The closed form for a midpoint that is the identity (Rohn, *Explicit inverse of an interval matrix with unit
//! midpoint*, ELA 22 (2011) 138-150): with `M = (I - Delta)^-1` the hull is `[-M_ij, M_ij]` off the diagonal and
//! `[M_ii / (2 M_ii - 1), M_ii]` on it.

use super::ends::Ends;
use crate::inverse::hansen_bliek_rohn::Tail;
use crate::matrix::IntervalMatrix;
use crate::rounding::{add_down, add_up, div_down, div_up, sub_down, sub_up};

/// `None` where the midpoint is not the identity, exactly.
pub(super) fn hull(a: &IntervalMatrix, v: &[f64]) -> Option<Ends> {
    let n = a.rows();
    let centred = |at: usize| {
        let (lo, hi) = (a.lo()[at], a.hi()[at]);
        // lo + hi is exact here: 2 on the diagonal only for bounds whose sum is, which subtracting 1 from each shows.
        if at % (n + 1) == 0 {
            lo > 0.0 && hi < 2.0 && hi - 1.0 == 1.0 - lo && exact(lo) && exact(hi)
        } else {
            lo == -hi
        }
    };
    if !(0..n * n).all(centred) {
        return None;
    }
    // With R = I the deviations are the radii themselves, without rounding.
    let radii: Vec<f64> =
        a.hi().iter().enumerate().map(|(at, &hi)| if at % (n + 1) == 0 { hi - 1.0 } else { hi }).collect();
    let tail = Tail::new(&radii, v, n)?;
    let (mut lower, mut upper) = (tail.upper.clone(), tail.upper.clone());
    let (mut attained_lower, mut attained_upper) = (tail.lower.clone(), tail.lower.clone());
    for at in 0..n * n {
        if at % (n + 1) == 0 {
            // M / (2 M - 1) = 1 / 2 + 1 / (4 M - 2) falls with M.
            let (most, least) = (add_up(1.0, tail.upper[at]), add_down(1.0, tail.lower[at]));
            upper[at] = most;
            attained_upper[at] = least;
            lower[at] = div_down(most, sub_up(add_up(most, most), 1.0)).max(0.5);
            attained_lower[at] = div_up(least, sub_down(add_down(least, least), 1.0));
        } else {
            lower[at] = -tail.upper[at] + 0.0;
            attained_lower[at] = -tail.lower[at] + 0.0;
        }
    }
    Some(Ends { lower, upper, attained_lower, attained_upper, tight: false })
}

/// True if `1 - x` is computed without rounding, for `0 < x < 2`.
fn exact(x: f64) -> bool {
    1.0 - (1.0 - x) == x
}
