//! The exponential of a vector of intervals.

use super::double_double::{Dd, two_product, two_sum};
use super::fused::{Fused, nearest, polynomial};
use super::tables::Columns;
use crate::elementary::{EXP_ERROR, TABLES};

/// Arguments of the kernel: `e^x` is normal up to a factor of two on either side.
const LEAST: f64 = -707.0;
const MOST: f64 = 708.0;
/// From here on, away from zero, `e^x` is not a neighbour of 1: 2^-54.
const SMALL: f64 = f64::from_bits((1023 - 54) << 52);

/// `e^x = m 2^k`, as `elementary::exponential::kernel` for a double: `m` and `2^k`.
///
/// Each lane does the operations of that function on an argument without a low part, so its relative error is below
/// 2^-73, proved there. `2^k` is normal for `-707 <= x <= 708`: `|n| < 2^17`, and `k = n >> 6` from -1020 to 1021.
#[inline(always)]
fn kernel<L: Fused>(x: L, columns: &Columns) -> (Dd<L>, L) {
    let tables = &TABLES;
    let (shifted, n) = nearest(x.mul(L::splat(tables.steps_per_unit)));
    let low = two_product(n, L::splat(tables.step[1]));
    let s = two_sum(n.mul_add(L::splat(-tables.step[0]), x), low.hi.neg());
    let r = two_sum(s.hi, s.lo.sub(low.lo));
    let z = r.hi;
    let tail = polynomial(z, [1.0 / 40320.0, 1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0]);
    let p = r.add(r.square().scale(0.5)).add_f64(z.mul(z).mul(z).mul(tail));
    let base = Dd { hi: shifted.gather(&columns.exp2[0]), lo: shifted.gather(&columns.exp2[1]) };
    (base.add(base.mul(p)), shifted.power_of_64ths())
}

/// Both bounds, and the lanes where they are the tightest.
#[inline(always)]
pub(super) fn exp<L: Fused>(a: L, b: L, columns: &Columns) -> (L, L, L::Mask) {
    let ((low, low_power), (high, high_power)) = (kernel(a, columns), kernel(b, columns));
    let ((lo, lo_known), (hi, hi_known)) = (low.down(EXP_ERROR), high.up(EXP_ERROR));
    let small = L::splat(SMALL);
    let within = L::both(L::splat(LEAST).less_equal(a), b.less_equal(L::splat(MOST)));
    let away = L::both(small.less_equal(a.abs()), small.less_equal(b.abs()));
    let sound = L::both(L::both(within, away), a.less_equal(b));
    (lo.mul(low_power), hi.mul(high_power), L::both(sound, L::both(lo_known, hi_known)))
}
