//! The choice of the half-space that enters a basis and of the row that leaves it, in plain floats with relative
//! tolerances.

use super::Row;

/// Relative size below which a violation counts as rounding: about 900 unit roundoffs. It steers the search and proves
/// nothing.
pub(crate) const VIOLATION: f64 = 1e-13;
/// Relative size below which a pivot counts as rounding: about 90 000 unit roundoffs. It steers the search and proves
/// nothing.
const PIVOT: f64 = 1e-11;

/// By how much `g x <= h` is violated at `point + M ray`, and whether at order `M`. The value is `None` if it holds up
/// to the tolerance, which is relative to the terms.
pub(crate) fn violation(g: &[f64], h: f64, point: &[f64], ray: Option<&[f64]>, tolerance: f64) -> Option<(bool, f64)> {
    if let Some(ray) = ray {
        let (large, size) = terms(g, ray);
        // The ray comes out of an elimination, so a term that vanishes leaves more behind than one rounding.
        if large.abs() > 10.0 * VIOLATION * size {
            return (large > 0.0).then_some((true, large));
        }
    }
    let (sum, size) = terms(g, point);
    (sum - h > tolerance * (size + h.abs())).then_some((false, sum - h))
}

/// `g x` and the sum of the magnitudes of its terms, in four strands that a vector register holds.
fn terms(g: &[f64], x: &[f64]) -> (f64, f64) {
    let (mut sums, mut sizes) = ([0.0; 4], [0.0; 4]);
    let (gs, xs) = (g.chunks_exact(4), x.chunks_exact(4));
    let rest = gs.remainder().iter().zip(xs.remainder());
    for (a, b) in gs.zip(xs) {
        for k in 0..4 {
            let term = a[k] * b[k];
            sums[k] += term;
            sizes[k] += term.abs();
        }
    }
    let start = ((sums[0] + sums[1]) + (sums[2] + sums[3]), (sizes[0] + sizes[1]) + (sizes[2] + sizes[3]));
    rest.fold(start, |(sum, size), (a, b)| (sum + a * b, size + (a * b).abs()))
}

/// The position that keeps the multipliers non-negative (smallest ratio; ties: rows at infinity, then the largest
/// pivot, or with `careful` the smallest index). The value is `None` if no multiplier falls, which proves infeasibility
/// up to rounding.
pub(super) fn leaving(rows: &[Row], alpha: &[f64], multipliers: &[f64], careful: bool) -> Option<usize> {
    let size = alpha.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let mut best: Option<(f64, usize)> = None;
    for (i, (&a, &m)) in alpha.iter().zip(multipliers).enumerate() {
        if a <= PIVOT * size {
            continue;
        }
        let ratio = m / a;
        let better = best.is_none_or(|(least, k)| {
            ratio < least
                || (ratio == least
                    && if careful {
                        rows[i].order() < rows[k].order()
                    } else {
                        (rows[i].is_at_infinity(), a) > (rows[k].is_at_infinity(), alpha[k])
                    })
        });
        if better {
            best = Some((ratio, i));
        }
    }
    best.map(|(_, i)| i)
}
