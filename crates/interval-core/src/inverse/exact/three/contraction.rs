//! The first step for one matrix, or for one in each lane: `R`, bounds of `|I - R A|`, and their norm.

use super::UNIT;
use crate::lanes::Vector;

/// 2^-1000: more than the products of an entry of `G` lose by underflow, and too little to matter beside an entry.
const UNDERFLOW: f64 = f64::from_bits((1023 - 1000) << 52);

/// An approximate inverse `R` of the midpoint and `G >= |I - R A|` for every member, row-major.
pub(super) struct Contraction<V> {
    pub r: [V; 9],
    pub g: [V; 9],
    /// Upper bounds of the sums of the rows of `G`, the largest of which is its norm. NaN where a product overflows.
    pub sums: [V; 3],
}

impl<V: Vector> Contraction<V> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
    pub(super) fn of(lo: &[V; 9], hi: &[V; 9]) -> Self {
        let zero = V::splat(0.0);
        let (mut middle, mut spread) = ([zero; 9], [zero; 9]);
        for at in 0..9 {
            let (l, h) = (lo[at], hi[at]);
            let m = V::splat(0.5) * (l + h);
            middle[at] = m;
            // The radius, and what the rounding of a product with the midpoint may add.
            spread[at] = (h - m).most(m - l) * V::splat(1.0 + 4.0 * UNIT) + V::splat(6.0 * UNIT) * m.abs();
        }
        let r = adjugate_over_determinant(&middle);
        let (mut g, mut sums) = ([zero; 9], [zero; 3]);
        for i in 0..3 {
            for j in 0..3 {
                let delta = if i == j { 1.0 } else { 0.0 };
                let (x, y, z) = (r[3 * i], r[3 * i + 1], r[3 * i + 2]);
                let error = V::splat(delta) - (x * middle[j] + y * middle[3 + j] + z * middle[6 + j]);
                let reach = x.abs() * spread[j] + y.abs() * spread[3 + j] + z.abs() * spread[6 + j];
                let rounding = V::splat(6.0 * UNIT * delta + UNDERFLOW);
                g[3 * i + j] = (error.abs() + rounding + reach) * V::splat(1.0 + 16.0 * UNIT);
            }
            sums[i] = (g[3 * i] + g[3 * i + 1] + g[3 * i + 2]) * V::splat(1.0 + 4.0 * UNIT);
        }
        Self { r, g, sums }
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
pub(super) fn product<V: Vector>(a: &[V; 9], b: &[V; 9]) -> [V; 9] {
    let mut c = [V::splat(0.0); 9];
    for i in 0..3 {
        for j in 0..3 {
            c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
        }
    }
    c
}

/// The inverse in plain floats.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn adjugate_over_determinant<V: Vector>(m: &[V; 9]) -> [V; 9] {
    let mut c = [
        m[4] * m[8] - m[5] * m[7],
        m[2] * m[7] - m[1] * m[8],
        m[1] * m[5] - m[2] * m[4],
        m[5] * m[6] - m[3] * m[8],
        m[0] * m[8] - m[2] * m[6],
        m[2] * m[3] - m[0] * m[5],
        m[3] * m[7] - m[4] * m[6],
        m[1] * m[6] - m[0] * m[7],
        m[0] * m[4] - m[1] * m[3],
    ];
    let reciprocal = V::splat(1.0) / (m[0] * c[0] + m[1] * c[3] + m[2] * c[6]);
    for x in &mut c {
        *x = *x * reciprocal;
    }
    c
}
