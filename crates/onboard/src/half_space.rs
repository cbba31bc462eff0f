//! A side of an interval row as a half-space over a box.
//!
//! The row `sum [a_j] x_j` in `[y]` says that the least value of its left side is at most `y.hi`, and the greatest at
//! least `y.lo`. Each side reads `sum min(p_j x_j, q_j x_j) <= h` with `p <= q`: concave in `x`. Over a box, a term whose
//! `x_j` has a sign is linear. One without a sign is at least its chord between the ends of the box, the best linear
//! function below it there, so that the half-space of the chords holds every point of the box that the row allows.
//!
//! The slope of every such line is `p + f (q - p)`, where `f` belongs to the box alone. So a row is kept as `p` and
//! `q - p`, the latter in half the bytes, rounded up: a row is looser by a ten-millionth of its own width.

use crate::bounds::Bounds;
use interval_core::rounding::{add_up, mul_down, mul_up, sub_down, sub_up};

/// Rows with larger numbers say nothing: no product of two of them overflows.
const MODERATE: f64 = 1e100;
/// Powers of two by which rows are scaled at most: their right-hand sides stay below 1e200.
const SCALED: i32 = 300;

/// One side of a row: `sum min(p_j x_j, q_j x_j) <= right`, scaled so that its largest coefficient lies in [1, 2).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side<const N: usize> {
    /// `p`.
    pub(crate) lower: [f64; N],
    /// At least `q - p`.
    pub(crate) span: [f32; N],
    pub(crate) right: f64,
    /// The time at which the row holds \[s\].
    pub(crate) time: f64,
    /// Growth of the right-hand side by the rates of the parameters \[1/s\].
    pub(crate) drift: f64,
}

/// A side over a box: `g x <= h`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfSpace<const N: usize> {
    pub(crate) g: [f64; N],
    pub(crate) h: f64,
    /// `sum |g_j| w_j`, the change of the left side across the box: the unit of a violation.
    pub(crate) size: f64,
}

impl<const N: usize> Side<N> {
    /// The side of `y.hi`, or with `least` that of `y.lo`. The value is `None` if it says nothing.
    pub(crate) fn of_row(a: &[Bounds; N], y: Bounds, least: bool, time: f64, rates: &[f64; N]) -> Option<Self> {
        let mut right = if least { -y.lo } else { y.hi };
        let (mut lower, mut upper, mut drift, mut largest) = ([0.0; N], [0.0; N], 0.0, 0.0_f64);
        for j in 0..N {
            (lower[j], upper[j]) = if least { (-a[j].hi, -a[j].lo) } else { (a[j].lo, a[j].hi) };
            let most = lower[j].abs().max(upper[j].abs());
            largest = largest.max(most);
            if rates[j] > 0.0 {
                drift = add_up(drift, mul_up(most, rates[j]));
            }
        }
        let moderate = [largest, right, drift].iter().all(|x| x.abs() <= MODERATE);
        if !(moderate && (right < 0.0 || largest > 0.0)) {
            return None;
        }
        let scale = inverse_power_of_two(largest);
        let mut span = [0.0; N];
        for j in 0..N {
            let q = mul_up(upper[j], scale);
            lower[j] = mul_down(lower[j], scale);
            span[j] = single_up(sub_up(q, lower[j]));
        }
        (right, drift) = (mul_up(right, scale), mul_up(drift, scale));
        Some(Self { lower, span, right, time, drift })
    }

    /// The half-space over `region`, whose slopes have the shares `f`.
    pub(crate) fn over(&self, region: &[Bounds; N], shares: &[f64; N]) -> HalfSpace<N> {
        let (mut g, mut h, mut size) = ([0.0; N], self.right, 0.0);
        for j in 0..N {
            let (p, f, Bounds { lo, hi }) = (self.lower[j], shares[j], region[j]);
            g[j] = slope(p, self.span[j], f);
            if f > 0.0 && f < 1.0 && self.span[j] > 0.0 {
                // Any slope will do; the chord's is the best. The distance of the concave term to the line is least at
                // an end of the box, and is rounded down there.
                let q = add_up(p, f64::from(self.span[j]));
                let below = mul_down(sub_up(q, g[j]), lo).min(mul_down(sub_down(p, g[j]), hi));
                h = add_up(h, -below);
            }
            size += g[j].abs() * region[j].width();
        }
        HalfSpace { g, h, size: size.max(f64::MIN_POSITIVE) }
    }
}

impl<const N: usize> HalfSpace<N> {
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

/// The share `f` of every parameter: 0 where none is negative, 1 where none is positive, else the chord's.
pub(crate) fn shares<const N: usize>(region: &[Bounds; N]) -> [f64; N] {
    region.map(|Bounds { lo, hi }| {
        if lo >= 0.0 {
            0.0
        } else if hi <= 0.0 {
            1.0
        } else {
            (-lo / (hi - lo)).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON)
        }
    })
}

/// The slope of a term: at least `q` for the share 1, and any number between `p` and `q` for a chord.
#[inline]
pub(crate) fn slope(p: f64, span: f32, f: f64) -> f64 {
    if span == 0.0 || f == 0.0 {
        p
    } else if f == 1.0 {
        add_up(p, f64::from(span))
    } else {
        p + f * f64::from(span)
    }
}

/// The growth of a right-hand side since its time, rounded up: each parameter has moved by at most its rate.
#[inline]
pub(crate) fn later(h: f64, drift: f64, time: f64, now: f64) -> f64 {
    if drift == 0.0 { h } else { add_up(h, mul_up(drift, sub_up(now, time).max(0.0))) }
}

/// The power of two that brings a number into [1, 2); 1 for 0.
fn inverse_power_of_two(x: f64) -> f64 {
    if x == 0.0 {
        return 1.0;
    }
    // The biased exponent; subnormal numbers have 0 there, and are below the limit anyway.
    let exponent = i32::try_from(x.to_bits() >> 52 & 0x7ff).unwrap_or(0) - 1023;
    let power = (-exponent).clamp(-2 * SCALED, SCALED);
    f64::from_bits(u64::try_from(power + 1023).unwrap_or(1023) << 52)
}

/// A number from 0 up in half the bytes, rounded up.
#[expect(clippy::cast_possible_truncation, reason = "the rounding is made good in the next line")]
fn single_up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { f32::from_bits(near.to_bits() + 1) } else { near }
}
