//! A side of an interval row as a half-space over a box.
//!
//! The row `sum [a_j] x_j` in `[y]` says that the least value of its left side is at most `y.hi`, and the greatest at
//! least `y.lo`. Each side reads `sum min(p_j x_j, q_j x_j) <= h` with `p <= q`: concave in `x`. Over a box, a term whose
//! `x_j` has a sign is linear. One without a sign is at least its chord between the ends of the box, the best linear
//! function below it there, so that the half-space of the chords holds every point of the box that the row allows.

use crate::bounds::Bounds;
use interval_core::rounding::{add_up, mul_down, mul_up, sub_down, sub_up};

/// Rows with larger numbers say nothing: no product of two of them overflows.
const MODERATE: f64 = 1e100;

/// One side of a row, and the half-space `g x <= h` that it implies over the box for which it was made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfSpace<const N: usize> {
    lower: [f64; N],
    upper: [f64; N],
    right: f64,
    /// The time at which the row holds \[s\].
    pub(crate) time: f64,
    /// Growth of the right-hand side by the rates of the parameters \[1/s\].
    drift: f64,
    /// The coefficients over the box.
    pub(crate) g: [f64; N],
    /// The right-hand side over the box, at `time`.
    h: f64,
    /// `sum |g_j| w_j`, the change of the left side across the box: the unit of a violation.
    pub(crate) size: f64,
    /// The distance to the vertices, in units of their spread: small for rows that may cut soon.
    pub(crate) value: f64,
    /// The vertex to which it is closest, by column and side.
    pub(crate) nearest: (u8, bool),
}

impl<const N: usize> HalfSpace<N> {
    /// A place without a row.
    pub(crate) const NONE: Self = Self {
        lower: [0.0; N],
        upper: [0.0; N],
        right: f64::INFINITY,
        time: 0.0,
        drift: 0.0,
        g: [0.0; N],
        h: f64::INFINITY,
        size: 1.0,
        value: f64::INFINITY,
        nearest: (0, false),
    };

    /// The side of `y.hi`, or with `least` that of `y.lo`. The value is `None` if it says nothing.
    pub(crate) fn of_row(a: &[Bounds; N], y: Bounds, least: bool, time: f64, rates: &[f64; N]) -> Option<Self> {
        let mut row = Self { right: if least { -y.lo } else { y.hi }, time, ..Self::NONE };
        for j in 0..N {
            (row.lower[j], row.upper[j]) = if least { (-a[j].hi, -a[j].lo) } else { (a[j].lo, a[j].hi) };
            if rates[j] > 0.0 {
                let most = row.lower[j].abs().max(row.upper[j].abs());
                row.drift = add_up(row.drift, mul_up(most, rates[j]));
            }
        }
        let moderate = row.lower.iter().chain(&row.upper).chain([&row.right, &row.drift]).all(|x| x.abs() <= MODERATE);
        let says = row.right < 0.0 || row.upper.iter().chain(&row.lower).any(|x| *x != 0.0);
        (moderate && says).then_some(row)
    }

    /// Makes the half-space over `region`.
    pub(crate) fn derive(&mut self, region: &[Bounds; N]) {
        let mut h = self.right;
        for j in 0..N {
            let (p, q, Bounds { lo, hi }) = (self.lower[j], self.upper[j], region[j]);
            self.g[j] = if p == q || lo >= 0.0 {
                p
            } else if hi <= 0.0 {
                q
            } else {
                // Any slope will do; the chord's is the best. The distance of the concave term to the line is least at
                // an end of the box, and is rounded down there.
                let slope = p + (q - p) * (-lo / (hi - lo));
                let below = mul_down(sub_up(q, slope), lo).min(mul_down(sub_down(p, slope), hi));
                h = add_up(h, -below);
                slope
            };
        }
        self.h = h;
        self.size = self.g.iter().zip(region).map(|(g, x)| g.abs() * x.width()).sum::<f64>().max(f64::MIN_POSITIVE);
    }

    /// The right-hand side at a later time, rounded up: each parameter has moved by at most its rate.
    #[inline]
    pub(crate) fn right(&self, now: f64) -> f64 {
        if self.drift == 0.0 { self.h } else { add_up(self.h, mul_up(self.drift, sub_up(now, self.time).max(0.0))) }
    }

    /// The left side at a point, rounded to nearest: no proof.
    #[inline]
    pub(crate) fn at(&self, x: &[f64; N]) -> f64 {
        let mut sum = 0.0;
        for j in 0..N {
            sum += self.g[j] * x[j];
        }
        sum
    }
}
