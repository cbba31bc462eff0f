//! The natural logarithm of a vector of intervals.

use super::double_double::{Dd, two_product, two_sum};
use super::fused::{Fused, nearest, polynomial};
use super::tables::Columns;
use crate::elementary::{LOG_ERROR, TABLES};

/// `ln(1 + r)`, lane by lane the operations of `elementary::logarithm::near_one`.
#[inline(always)]
fn near_one<L: Fused>(r: Dd<L>) -> Dd<L> {
    const SERIES: [f64; 10] = [
        -1.0 / 14.0,
        1.0 / 13.0,
        -1.0 / 12.0,
        1.0 / 11.0,
        -1.0 / 10.0,
        1.0 / 9.0,
        -1.0 / 8.0,
        1.0 / 7.0,
        -1.0 / 6.0,
        0.2,
    ];
    let z = r.hi;
    let tail = polynomial(z, SERIES);
    let square = r.square();
    let cubic = square.mul(r);
    let fourth = square.square();
    let high = fourth.scale(-0.25).add_f64(fourth.hi.mul(z).mul(tail));
    r.add(square.scale(-0.5).add(cubic.mul(Dd::splat(TABLES.third)).add(high)))
}

/// `ln x` for positive normal numbers, as `elementary::logarithm::of_double`.
///
/// Each lane does the operations of that function, so its relative error is below 2^-77, proved there. The index of the
/// table alone is rounded otherwise where two entries are equally near: both are within 1/256 of `m`, which is all that
/// the proof uses.
#[inline(always)]
fn kernel<L: Fused>(x: L, columns: &Columns) -> Dd<L> {
    let (m, e) = x.mantissa_exponent();
    let large = L::splat(1.40625).less(m);
    let m = L::select(large, m.mul(L::splat(0.5)), m);
    let e = L::select(large, e.add(L::splat(1.0)), e);
    let (shifted, _) = nearest(m.mul(L::splat(128.0)));
    let c = shifted.gather(&columns.log_point);
    let minus_log_c = Dd { hi: shifted.gather(&columns.log[0]), lo: shifted.gather(&columns.log[1]) };
    let p = two_product(m, c);
    let r = two_sum(p.hi.sub(L::splat(1.0)), p.lo);
    Dd::splat(TABLES.ln2).mul_f64(e).add(minus_log_c.add(near_one(r)))
}

/// Both bounds, and the lanes where they are the tightest.
#[inline(always)]
pub(super) fn ln<L: Fused>(a: L, b: L, columns: &Columns) -> (L, L, L::Mask) {
    let (lo, lo_known) = kernel(a, columns).down(LOG_ERROR);
    let (hi, hi_known) = kernel(b, columns).up(LOG_ERROR);
    let normal = L::both(L::splat(f64::MIN_POSITIVE).less_equal(a), b.less_equal(L::splat(f64::MAX)));
    (lo, hi, L::both(L::both(normal, a.less_equal(b)), L::both(lo_known, hi_known)))
}
