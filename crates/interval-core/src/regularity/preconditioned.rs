//! Strong regularity, verified: an approximate inverse `R` of the midpoint and bounds `G >= |I - R A|` over every
//! member (docs/theory.md, "Regularity"). `G v < v` for some `v > 0` proves that `R` and every member are nonsingular.

use crate::approximate;
use crate::error::Error;
use crate::interval::Interval;
use crate::lanes::{One, Vector, backends, two_product, two_sum};
use crate::matrix::IntervalMatrix;
use crate::rounding::slices::Backend;
use crate::rounding::{sub_down, sub_up};

/// The unit roundoff of a double, 2^-53.
const UNIT: f64 = f64::EPSILON / 2.0;
/// The smallest positive double, 2^-1074.
const SMALLEST: f64 = f64::from_bits(1);

/// The preconditioned matrix `R A`.
pub(crate) struct Preconditioned {
    /// Its order.
    pub n: usize,
    /// `R`, row-major.
    pub r: Vec<f64>,
    /// Bounds of `|I - R A|`, row-major.
    pub g: Vec<f64>,
}

impl Preconditioned {
    /// For a square and bounded matrix. The value is `None` if the midpoint has no usable approximate inverse.
    ///
    /// `R m - I` for midpoints `m` is summed in twice the working precision (Ogita, Rump and Oishi, *SIAM J. Sci.
    /// Comput.* 26 (2005) 1955-1988): the result is within `u |res| + gamma^2 (1 + |R| |m|)` of the sum. The radii
    /// enter by an ordinary product of non-negative numbers, whose relative error is at most `(n + 2) u`.
    pub(crate) fn new(a: &IntervalMatrix) -> Option<Self> {
        let n = a.rows();
        let (middle, spread) = split(a);
        let r = approximate::inverse(&middle, n)?;
        let g = deviation(&r, &middle, &spread, n);
        g.iter().all(|x| x.is_finite()).then_some(Self { n, r, g })
    }

    /// A `v > 0` with `G v < v`.
    pub(crate) fn contracted(&self) -> Option<Vec<f64>> {
        contracted_vector(&self.g, self.n)
    }

    /// Upper bound of the maximum row sum of `G`.
    pub(crate) fn norm(&self) -> f64 {
        let one = vec![1.0; self.n];
        times(&self.g, &one).into_iter().fold(0.0, f64::max)
    }
}

/// Midpoints, and radii about them rounded up.
pub(crate) fn split(a: &IntervalMatrix) -> (Vec<f64>, Vec<f64>) {
    let middle = a.midpoint();
    let spread = (middle.iter().zip(a.lo()).zip(a.hi())).map(|((&m, &l), &h)| sub_up(h, m).max(sub_up(m, l))).collect();
    (middle, spread)
}

/// The largest order at which the product of the radii too is summed in twice the working precision. A plain sum with
/// its error bound saves time beyond.
const ACCURATE: usize = 64;

/// The numbers by which bounds of `|I - R A|` are above what was computed.
pub(crate) struct Accuracy {
    /// Of the magnitudes of the summands.
    pub square: f64,
    /// Of the whole sum.
    pub growth: f64,
    /// What underflow may lose.
    pub tiny: f64,
}

impl Accuracy {
    #[expect(clippy::cast_precision_loss, reason = "an order, far below 2^53")]
    pub(crate) fn of(n: usize) -> Self {
        let terms = n as f64 + 2.0;
        let gamma = 2.0 * terms * UNIT;
        // Without cancellation the compensated sum of the radii is right to the last bit but for gamma^2.
        let terms = if n <= ACCURATE { 2.0 } else { terms };
        // The relative error of the product of radii, two additions, this multiplication and the rounding of its factor.
        let growth = 1.0 + (terms + 4.0) * UNIT;
        Self { square: gamma * gamma, growth, tiny: 64.0 * (n as f64 + 4.0) * SMALLEST }
    }
}

/// Upper bounds of `|I - R A|` for every member.
pub(crate) fn deviation(r: &[f64], middle: &[f64], spread: &[f64], n: usize) -> Vec<f64> {
    let size: Vec<f64> = r.iter().map(|x| x.abs()).collect();
    let (mut rest, mut magnitude) = (vec![0.0; n * n], vec![0.0; n * n]);
    accurate_product(Backend::chosen(), r, middle, -1.0, &mut rest, &mut magnitude);
    let Accuracy { square, growth, tiny } = Accuracy::of(n);
    let reach = if n <= ACCURATE {
        let (mut reach, mut sums) = (vec![0.0; n * n], vec![0.0; n * n]);
        accurate_product(Backend::chosen(), &size, spread, 0.0, &mut reach, &mut sums);
        reach
    } else {
        approximate::product(&size, spread, n, n, n)
    };
    let bound = |at: usize| {
        // Zeros that are structural stay zeros, and with them those of the inverse.
        if rest[at] == 0.0 && magnitude[at] == 0.0 && reach[at] == 0.0 {
            let (row, column) = (&r[at / n * n..][..n], at % n);
            let vanishes = |k: usize| middle[k * n + column] == 0.0 && spread[k * n + column] == 0.0;
            if row.iter().enumerate().all(|(k, &x)| x == 0.0 || vanishes(k)) {
                return 0.0;
            }
        }
        (rest[at].abs() + square * magnitude[at] + reach[at]) * growth + tiny
    };
    (0..n * n).map(bound).collect()
}

backends!(fn accurate_product(r: &[f64], m: &[f64], diagonal: f64, rest: &mut [f64], size: &mut [f64]) = product_rows);

/// `R m` plus a number on the diagonal in twice the working precision, and the sums of the magnitudes of its terms.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn product_rows<V: Vector>(r: &[f64], m: &[f64], diagonal: f64, rest: &mut [f64], size: &mut [f64]) {
    let n = r.len().isqrt();
    for i in 0..n {
        let row = &r[i * n..][..n];
        let mut j = 0;
        while j + V::N <= n {
            let (value, magnitude) = entries::<V>(row, m, diagonal, i, j);
            value.store(&mut rest[i * n + j..]);
            magnitude.store(&mut size[i * n + j..]);
            j += V::N;
        }
        while j < n {
            let (value, magnitude) = entries::<One>(row, m, diagonal, i, j);
            value.store(&mut rest[i * n + j..]);
            magnitude.store(&mut size[i * n + j..]);
            j += 1;
        }
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn entries<V: Vector>(row: &[f64], m: &[f64], diagonal: f64, i: usize, j: usize) -> (V, V) {
    let n = row.len();
    let mut sum = V::from_fn(|lane| if i == j + lane { diagonal } else { 0.0 });
    let mut tail = V::splat(0.0);
    let mut size = sum.abs();
    for (k, &factor) in row.iter().enumerate() {
        let (p, p_error) = two_product(V::splat(factor), V::load(&m[k * n + j..]));
        let (s, s_error) = two_sum(sum, p);
        sum = s;
        tail = tail + (s_error + p_error);
        size = size + p.abs();
    }
    (sum + tail, size)
}

/// Upper bounds of `G v` for non-negative operands.
pub(crate) fn times(g: &[f64], v: &[f64]) -> Vec<f64> {
    let sum = |row: &[f64]| row_growth(row.iter().zip(v).map(|(x, y)| x * y).sum::<f64>(), v.len());
    g.chunks_exact(v.len()).map(sum).collect()
}

/// An upper bound of a sum of `n` products of non-negative numbers from its value in floats.
#[expect(clippy::cast_precision_loss, reason = "an order, far below 2^53")]
pub(crate) fn row_growth(sum: f64, n: usize) -> f64 {
    let terms = n as f64;
    sum * (1.0 + 2.0 * (terms + 4.0) * UNIT) + 2.0 * terms * SMALLEST
}

/// Lower bounds of `v - G v`, all positive. The value is `None` if one is not.
pub(crate) fn slack(g: &[f64], v: &[f64]) -> Option<Vec<f64>> {
    let rest: Vec<f64> = v.iter().zip(times(g, v)).map(|(&x, y)| sub_down(x, y)).collect();
    let holds = rest.iter().zip(v).all(|(&s, &x)| s > 0.0 && x > 0.0 && x.is_finite());
    holds.then_some(rest)
}

/// A positive `v` with `G v < v`, proved: an approximation of `(I - G)^-1` times ones, or of the dominant eigenvector
/// of `G`.
pub(crate) fn contracted_vector(g: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut v = vec![1.0; n];
    for _ in 0..20 {
        if slack(g, &v).is_some() {
            return Some(v);
        }
        // One step of the sum 1 + G + G^2 + ..., scaled: towards the dominant eigenvector, kept positive.
        let next: Vec<f64> = times(g, &v).into_iter().map(|x| 1e-3 + x).collect();
        let largest = next.iter().copied().fold(0.0, f64::max);
        v = next.into_iter().map(|x| x / largest).collect();
    }
    let shifted: Vec<f64> = g.iter().enumerate().map(|(at, x)| if at % (n + 1) == 0 { 1.0 - x } else { -x }).collect();
    let inverse = approximate::inverse(&shifted, n)?;
    let sums: Vec<f64> = inverse.chunks_exact(n).map(|row| row.iter().sum()).collect();
    slack(g, &sums).map(|_| sums)
}

/// `I - R A` for a point matrix `R`, row-major, and a bounded `A`, in interval arithmetic: products and partial sums are
/// the tightest, in the order of the inner index. A diagonal entry starts from 1, so these are summed by themselves.
pub(crate) fn interval_residual(r: &[f64], a: &IntervalMatrix) -> Result<IntervalMatrix, Error> {
    let n = a.rows();
    let minus_r: Vec<f64> = r.iter().map(|x| -x).collect();
    let mut entries: Vec<Interval> = IntervalMatrix::from_points(n, n, &minus_r).multiply(a)?.entries().collect();
    for i in 0..n {
        entries[i * (n + 1)] = (0..n).fold(Interval::ONE, |sum, k| {
            let factor = minus_r[i * n + k];
            sum + Interval::raw(factor, factor) * a.get(k, i)
        });
    }
    Ok(IntervalMatrix::from_entries(n, n, &entries))
}
