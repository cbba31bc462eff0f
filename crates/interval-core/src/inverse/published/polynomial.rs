//! Orders up to 3: entries of the inverse as ratios of polynomials in `tau`, both signs of `tau` at once.
//!
//! A cofactor of `A_c + tau Delta` is `c_0 + c_1 tau + c_2 tau^2`, and the determinant has one term more. At `-tau` the
//! odd terms change their sign. The coefficients are sums of products of midpoints and radii in twice the working
//! precision, rounded once. With `S` the cofactor's permanent over `|A_c| + |Delta|` and `D` that of the determinant, a
//! cofactor is within `6 u S` and the determinant within `8 u D` of the exact ones, so an entry `x = c / d` is within
//! `(6 S + 8 |x| D) u / |d| + 2 u |x|`: cofactors and determinants that are evaluated from the entries of the member
//! lose as much, up to the constants.

use super::{Extremes, Form};
use crate::elementary::{Dd, two_sum};
use crate::lanes::{Vector, backends};
use crate::matrix::IntervalMatrix;
use std::ops::Range;

/// Entries of order 3, the largest order whose entries are ratios of polynomials here.
const ENTRIES: usize = 9;

/// Coefficients of the adjugate, row-major, and of the determinant by powers of `tau`.
pub(super) struct Coefficients {
    n: usize,
    adjugate: [[f64; 3]; ENTRIES],
    determinant: [f64; 4],
    /// A determinant above this cannot make an entry overflow.
    least: f64,
}

type Polynomial = [Dd; 4];

impl Coefficients {
    /// `None` for orders above 3, and where a product could over- or underflow.
    pub(super) fn new(a: &IntervalMatrix) -> Option<Self> {
        let n = a.rows();
        let moderate = |x: f64| x == 0.0 || (1e-75..1e75).contains(&x.abs());
        if n > 3 || !a.lo().iter().chain(a.hi()).all(|&x| moderate(x)) {
            return None;
        }
        let entry = |i: usize, j: usize| -> [Dd; 2] {
            let x = a.get(i, j);
            let (sum, difference) = (two_sum(x.lo(), x.hi()), two_sum(x.hi(), -x.lo()));
            [sum.scale(0.5), difference.scale(0.5)]
        };
        let zero = [Dd::from(0.0); 4];
        let one = [Dd::ONE, Dd::from(0.0), Dd::from(0.0), Dd::from(0.0)];
        // The minor without row i and column j, with its sign.
        let cofactor = |i: usize, j: usize| -> Polynomial {
            let rows: Vec<usize> = (0..n).filter(|&k| k != i).collect();
            let columns: Vec<usize> = (0..n).filter(|&l| l != j).collect();
            let minor = match n {
                1 => one,
                2 => times(entry(rows[0], columns[0]), &one),
                _ => {
                    let first = times(entry(rows[0], columns[0]), &times(entry(rows[1], columns[1]), &one));
                    let second = times(entry(rows[0], columns[1]), &times(entry(rows[1], columns[0]), &one));
                    std::array::from_fn(|p| first[p] - second[p])
                }
            };
            if (i + j) % 2 == 0 { minor } else { minor.map(|c| -c) }
        };
        let mut determinant = zero;
        for j in 0..n {
            let part = times(entry(0, j), &cofactor(0, j));
            determinant = std::array::from_fn(|p| determinant[p] + part[p]);
        }
        let mut adjugate = [[0.0; 3]; ENTRIES];
        for i in 0..n {
            for j in 0..n {
                let c = cofactor(j, i);
                adjugate[i * n + j] = std::array::from_fn(|p| c[p].hi);
            }
        }
        let largest = adjugate.iter().map(|c| c.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
        let least = (largest / 1e300).max(1e-300);
        Some(Self { n, adjugate, determinant: determinant.map(|c| c.hi), least })
    }

    /// Extremes over `tau = j / N` and `-j / N`; false where a determinant is zero or an entry may overflow.
    pub(super) fn extremes(
        &self,
        backend: crate::rounding::slices::Backend,
        partitions: u64,
        form: Form,
        range: Range<u64>,
        found: &mut Extremes,
    ) -> bool {
        let kernel = match (self.n, form) {
            (1, Form::Literal) => literal_1,
            (2, Form::Literal) => literal_2,
            (_, Form::Literal) => literal_3,
            (1, Form::Hull) => hull_1,
            (2, Form::Hull) => hull_2,
            (_, Form::Hull) => hull_3,
        };
        kernel(backend, self, partitions, range, found)
    }
}

/// `(m + r tau) p`.
fn times([m, r]: [Dd; 2], p: &Polynomial) -> Polynomial {
    let mut product = [Dd::from(0.0); 4];
    for power in 0..4 {
        product[power] = product[power] + m * p[power];
        if power < 3 {
            product[power + 1] = product[power + 1] + r * p[power];
        }
    }
    product
}

macro_rules! kernels {
    ($($name:ident $lanes:ident $entries:literal $hull:literal;)*) => {$(
        backends!(fn $name(c: &Coefficients, partitions: u64, range: Range<u64>, found: &mut Extremes) -> bool = $lanes);
        #[inline(always)]
        fn $lanes<V: Vector>(
            c: &Coefficients, partitions: u64, range: Range<u64>, found: &mut Extremes,
        ) -> bool {
            extremes::<V, $entries, $hull>(c, partitions, range, found)
        }
    )*};
}
kernels! {
    literal_1 literal_1_lanes 1 false;
    literal_2 literal_2_lanes 4 false;
    literal_3 literal_3_lanes 9 false;
    hull_1 hull_1_lanes 1 true;
    hull_2 hull_2_lanes 4 true;
    hull_3 hull_3_lanes 9 true;
}

/// No operation is fused, so that the bits do not depend on whether the processor can.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
#[expect(
    clippy::cast_precision_loss,
    reason = "the published sweep is a computation in floats; partitions stay below 2^53"
)]
fn extremes<V: Vector, const ENTRIES: usize, const HULL: bool>(
    c: &Coefficients,
    partitions: u64,
    range: Range<u64>,
    found: &mut Extremes,
) -> bool {
    let splat = V::splat;
    let (top, bottom) = (splat(f64::NEG_INFINITY), splat(f64::INFINITY));
    let (mut least_i, mut most_i) = ([bottom; ENTRIES], [top; ENTRIES]);
    let (mut least_s, mut most_s) = ([bottom; ENTRIES], [top; ENTRIES]);
    let mut smallest = bottom;
    let step = splat(1.0 / partitions as f64);
    let last = splat((range.end - 1) as f64);
    let mut index = V::from_fn(|lane| (range.start + lane as u64) as f64);
    let mut left = (range.end - range.start).div_ceil(V::N as u64);
    let [d0, d1, d2, d3] = c.determinant.map(splat);
    while left > 0 {
        let tau = index.least(last) * step;
        let square = tau * tau;
        let (even, odd) = (d0 + d2 * square, tau * (d1 + d3 * square));
        let (det_i, det_s) = (even - odd, even + odd);
        smallest = det_i.abs().least(det_s.abs()).least(smallest);
        let (scale_i, scale_s) = (splat(1.0) / det_i, splat(1.0) / det_s);
        for at in 0..ENTRIES {
            let [c0, c1, c2] = c.adjugate[at];
            let (even, odd) = (splat(c0) + splat(c2) * square, splat(c1) * tau);
            let (x_i, x_s) = ((even - odd) * scale_i, (even + odd) * scale_s);
            least_i[at] = x_i.least(least_i[at]);
            most_s[at] = x_s.most(most_s[at]);
            if HULL {
                most_i[at] = x_i.most(most_i[at]);
                least_s[at] = x_s.least(least_s[at]);
            }
        }
        index = index + splat(V::N as f64);
        left -= 1;
    }
    for at in 0..ENTRIES {
        let least = |x: V, y: f64| x.array().as_ref().iter().copied().fold(y, f64::min);
        let most = |x: V, y: f64| x.array().as_ref().iter().copied().fold(y, f64::max);
        found.infima.lower[at] = least(least_i[at], found.infima.lower[at]);
        found.suprema.upper[at] = most(most_s[at], found.suprema.upper[at]);
        if HULL {
            found.infima.upper[at] = most(most_i[at], found.infima.upper[at]);
            found.suprema.lower[at] = least(least_s[at], found.suprema.lower[at]);
        }
    }
    // A NaN fails the comparison as well.
    smallest.array().as_ref().iter().all(|&d| d > c.least)
}
