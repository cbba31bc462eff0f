//! The closed form for order 3 on the stack, with the bits of the general form: every step does the same operations in
//! the same order, nine entries of the lanes of vectors at a time, without a copy or a second look at bounds.
//!
//! Matrices with an infinite or a very small or large entry, with a zero among the bounds `G` or the coefficients
//! `beta`, or without `G (1, 1, 1)' < (1, 1, 1)'` are left to the general form: it has rules for them.

use super::Growth;
use crate::lanes::{Vector, backends, two_product, two_sum};
use crate::matrix::IntervalMatrix;
use crate::regularity::{Accuracy, row_growth};
use crate::rounding::slices::Backend;
use crate::rounding::{add_down, add_up, div_up, sub_down, sub_up};
use nalgebra::SMatrix;

/// Nine entries, row-major, and room for whole vectors.
const PADDED: usize = 16;
type Entries = [f64; PADDED];

/// 2^-300 to 2^300: entries of the matrix and of `R`, so that no product underflows or overflows.
const MODERATE: core::ops::RangeInclusive<f64> =
    f64::from_bits((1023 - 300) << 52)..=f64::from_bits((1023 + 300) << 52);
/// 2^-900 to 2^900: dividends whose quotients by numbers of 2^-60 to 2^60 have a residual that is a double.
const DIVIDENDS: core::ops::RangeInclusive<f64> =
    f64::from_bits((1023 - 900) << 52)..=f64::from_bits((1023 + 900) << 52);
/// 2^-60 to 2^60.
const DIVISORS: core::ops::RangeInclusive<f64> = f64::from_bits((1023 - 60) << 52)..=f64::from_bits((1023 + 60) << 52);

/// Lower and upper bounds, and `R`, row-major.
pub(super) type Enclosure = ([f64; 9], [f64; 9], [f64; 9]);

/// The enclosure of the inverse; `None` where the general form has to decide.
pub(super) fn enclose(a: &IntervalMatrix) -> Option<Enclosure> {
    enclose_on(Backend::chosen(), a.lo().try_into().ok()?, a.hi().try_into().ok()?)
}

backends!(fn enclose_on(lo: &[f64; 9], hi: &[f64; 9]) -> Option<Enclosure> = enclose_lanes);

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn enclose_lanes<V: Vector>(lo: &[f64; 9], hi: &[f64; 9]) -> Option<Enclosure> {
    let (mut middle, mut spread) = ([0.0; 9], [0.0; 9]);
    for at in 0..9 {
        let (l, h) = (lo[at], hi[at]);
        let m = 0.5 * (l + h);
        middle[at] = m;
        spread[at] = sub_up(h, m).max(sub_up(m, l));
    }
    let r = inverse(&middle)?;
    if !(all_moderate(lo) && all_moderate(hi) && all_moderate(&middle) && all_moderate(&r)) {
        return None;
    }
    let g = deviation::<V>(&r, &middle, &spread)?;
    let mut rest = [0.0; 3];
    for i in 0..3 {
        rest[i] = sub_down(1.0, row_growth(g[3 * i] + g[3 * i + 1] + g[3 * i + 2], 3));
        // Below 2^-60 a quotient by it is the general form's to round.
        if !DIVISORS.contains(&rest[i]) {
            return None;
        }
    }
    let (upper, least) = tail::<V>(&g, &rest)?;
    let (lower, upper) = closed_form::<V>(&g, (&upper, &least), &r)?;
    Some((lower, upper, r))
}

fn all_moderate(entries: &[f64; 9]) -> bool {
    entries.iter().all(|x| *x == 0.0 || MODERATE.contains(&x.abs()))
}

/// As [`approximate::inverse`](crate::approximate::inverse), whose matrices are on the heap.
fn inverse(a: &[f64; 9]) -> Option<[f64; 9]> {
    // Row-major storage is that of the transpose, and its inverse is stored as the transpose again.
    let inverse = SMatrix::<f64, 3, 3>::from_column_slice(a).lu().try_inverse()?;
    inverse.as_slice().try_into().ok()
}

/// Bounds of `|I - R A|`, as [`deviation`](crate::regularity::deviation) has them; `None` where one is not positive.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn deviation<V: Vector>(r: &[f64; 9], middle: &[f64; 9], spread: &[f64; 9]) -> Option<[f64; 9]> {
    let (mut factors, mut middles, mut spreads) = ([[0.0; PADDED]; 3], [[0.0; PADDED]; 3], [[0.0; PADDED]; 3]);
    let mut minus_identity = [0.0; PADDED];
    for k in 0..3 {
        minus_identity[4 * k] = -1.0;
        for at in 0..9 {
            factors[k][at] = r[3 * (at / 3) + k];
            middles[k][at] = middle[3 * k + at % 3];
            spreads[k][at] = spread[3 * k + at % 3];
        }
    }
    let accuracy = Accuracy::of(3);
    let mut g = [0.0; PADDED];
    let mut from = 0;
    while from < 9 {
        let mut sum = V::load(&minus_identity[from..]);
        let (mut magnitude, mut lost) = (sum.abs(), V::splat(0.0));
        let (mut reach, mut reach_lost) = (V::splat(0.0), V::splat(0.0));
        for k in 0..3 {
            let factor = V::load(&factors[k][from..]);
            let (p, p_error) = two_product(factor, V::load(&middles[k][from..]));
            let (s, s_error) = two_sum(sum, p);
            (sum, lost, magnitude) = (s, lost + (s_error + p_error), magnitude + p.abs());
            let (p, p_error) = two_product(factor.abs(), V::load(&spreads[k][from..]));
            let (s, s_error) = two_sum(reach, p);
            (reach, reach_lost) = (s, reach_lost + (s_error + p_error));
        }
        let (rest, reach) = (sum + lost, reach + reach_lost);
        let bound = (rest.abs() + V::splat(accuracy.square) * magnitude + reach) * V::splat(accuracy.growth);
        // Where all three are zero, the entry may be zero for every member, which the general form looks at.
        let some = magnitude + reach;
        some.choose(bound + V::splat(accuracy.tiny), V::splat(f64::NAN)).store(&mut g[from..]);
        from += V::N;
    }
    let g: [f64; 9] = g[..9].try_into().ok()?;
    g.iter().all(|&x| x > 0.0 && x.is_finite()).then_some(g)
}

/// Row `i` times column `j` in the order of the inner index.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn product(a: &[f64; 9], b: &[f64; 9]) -> [f64; 9] {
    let mut c = [0.0; 9];
    for i in 0..3 {
        for j in 0..3 {
            c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
        }
    }
    c
}

/// Bounds of nine entries in lanes, before their rounding: doubles, and numbers with the signs of what they miss.
struct Rounded {
    value: Entries,
    missing: Entries,
}

impl Rounded {
    const NONE: Self = Self { value: [0.0; PADDED], missing: [0.0; PADDED] };

    /// Sums.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
    fn sum<V: Vector>(&mut self, x: &Entries, y: &Entries) {
        let mut from = 0;
        while from < 9 {
            let (sum, error) = two_sum(V::load(&x[from..]), V::load(&y[from..]));
            sum.store(&mut self.value[from..]);
            error.store(&mut self.missing[from..]);
            from += V::N;
        }
    }

    /// Quotients; `false` where one is not known to be right.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
    fn quotient<V: Vector>(&mut self, x: &Entries, y: &Entries) -> bool {
        let mut from = 0;
        while from < 9 {
            let (x, y) = (V::load(&x[from..]), V::load(&y[from..]));
            let quotient = x / y;
            let (p, p_error) = two_product(quotient, y);
            quotient.store(&mut self.value[from..]);
            // x - p is exact: the two are equal or neighbours.
            ((x - p) - p_error).store(&mut self.missing[from..]);
            from += V::N;
        }
        x[..9].iter().all(|x| *x == 0.0 || DIVIDENDS.contains(&x.abs()))
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
    fn down(&self) -> Entries {
        let mut found = [0.0; PADDED];
        for at in 0..9 {
            let (x, missing) = (self.value[at], self.missing[at]);
            let step = if x > 0.0 { u64::MAX } else { 1 };
            found[at] = f64::from_bits(x.to_bits().wrapping_add(if missing < 0.0 { step } else { 0 })) + 0.0;
        }
        found
    }

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
    fn up(&self) -> Entries {
        let mut found = [0.0; PADDED];
        for at in 0..9 {
            let (x, missing) = (self.value[at], self.missing[at]);
            let step = if x > 0.0 { 1 } else { u64::MAX };
            found[at] = f64::from_bits(x.to_bits().wrapping_add(if missing > 0.0 { step } else { 0 })) + 0.0;
        }
        found
    }
}

/// Upper and lower bounds of `V = (I - G)^-1 G`, as [`Tail`](super::Tail) has them for `v = (1, 1, 1)'`.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn tail<V: Vector>(g: &[f64; 9], rest: &[f64; 3]) -> Option<([f64; 9], [f64; 9])> {
    let growth = Growth::of(3);
    let mut comparison = [0.0; 9];
    for at in 0..9 {
        comparison[at] = if at % 4 == 0 { 1.0 - g[at] } else { -g[at] };
    }
    let mut w = product(g, &inverse(&comparison)?);
    for x in &mut w {
        *x = x.max(0.0);
    }
    let image = product(g, &w);
    if !w.iter().chain(&image).all(|x| x.is_finite()) {
        return None;
    }
    // G + G W - W, whose upper end is the excess and whose lower end is the lack below zero.
    let (mut low, mut high, mut bounds, mut minus, mut divisors) =
        ([0.0; PADDED], [0.0; PADDED], [0.0; PADDED], [0.0; PADDED], [1.0; PADDED]);
    for at in 0..9 {
        (low[at], high[at]) = (growth.below(image[at]), growth.above(image[at]));
        (bounds[at], minus[at], divisors[at]) = (g[at], -w[at], rest[at / 3]);
    }
    let (mut below, mut above) = (Rounded::NONE, Rounded::NONE);
    below.sum::<V>(&low, &bounds);
    above.sum::<V>(&high, &bounds);
    let (low, high) = (below.down(), above.up());
    below.sum::<V>(&low, &minus);
    above.sum::<V>(&high, &minus);
    let (mut low, mut high) = (below.down(), above.up());
    for at in 0..9 {
        (low[at], high[at]) = (low[at].min(0.0), high[at].max(0.0));
    }
    if !(below.quotient::<V>(&low, &divisors) && above.quotient::<V>(&high, &divisors)) {
        return None;
    }
    let (low, high) = (below.down(), above.up());
    let (mut lack, mut excess) = ([0.0; PADDED], [0.0; PADDED]);
    for at in 0..9 {
        let column = at % 3;
        lack[at] = low[column].min(low[3 + column]).min(low[6 + column]);
        excess[at] = high[column].max(high[3 + column]).max(high[6 + column]);
        minus[at] = w[at];
    }
    below.sum::<V>(&lack, &minus);
    above.sum::<V>(&excess, &minus);
    let (low, high) = (below.down(), above.up());
    let (mut upper, mut lower) = ([0.0; 9], [0.0; 9]);
    for at in 0..9 {
        (upper[at], lower[at]) = (high[at], low[at].max(g[at]));
    }
    upper.iter().all(|x| x.is_finite()).then_some((upper, lower))
}

/// The enclosure of the inverse, as [`closed_form`](super::closed_form) has it for `Z = R`.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn closed_form<V: Vector>(
    g: &[f64; 9],
    (upper, lower): (&[f64; 9], &[f64; 9]),
    r: &[f64; 9],
) -> Option<([f64; 9], [f64; 9])> {
    let growth = Growth::of(3);
    let (mut off_diagonal, mut size) = (*upper, *r);
    for i in 0..3 {
        off_diagonal[4 * i] = 0.0;
    }
    for x in &mut size {
        *x = x.abs();
    }
    let beta = product(&off_diagonal, &size);
    let (mut dividends, mut diagonals, mut least, mut most) =
        ([0.0; PADDED], [1.0; PADDED], [1.0; PADDED], [1.0; PADDED]);
    for i in 0..3 {
        let alpha =
            g[3 * i] * off_diagonal[i] + g[3 * i + 1] * off_diagonal[3 + i] + g[3 * i + 2] * off_diagonal[6 + i];
        let diagonal = add_down(1.0, lower[4 * i]);
        let reach = add_up(g[4 * i], div_up(growth.above(alpha), diagonal));
        let (from, to) = (sub_down(1.0, reach), add_up(1.0, reach));
        // Outside of the range the general form rounds, or says that there is no bound.
        if ![diagonal, from, to].iter().all(|x| DIVISORS.contains(x)) {
            return None;
        }
        for at in 3 * i..3 * i + 3 {
            (dividends[at], diagonals[at], least[at], most[at]) = (growth.above(beta[at]), diagonal, from, to);
        }
    }
    let (mut below, mut above) = (Rounded::NONE, Rounded::NONE);
    if beta.contains(&0.0) || !above.quotient::<V>(&dividends, &diagonals) {
        return None;
    }
    let (reach, mut minus, mut z) = (above.up(), [0.0; PADDED], [0.0; PADDED]);
    for at in 0..9 {
        (minus[at], z[at]) = (-reach[at], r[at]);
    }
    below.sum::<V>(&minus, &z);
    above.sum::<V>(&reach, &z);
    let (low, high) = (below.down(), above.up());
    let (mut low_divisors, mut high_divisors) = ([1.0; PADDED], [1.0; PADDED]);
    for at in 0..9 {
        low_divisors[at] = if low[at] < 0.0 { least[at] } else { most[at] };
        high_divisors[at] = if high[at] < 0.0 { most[at] } else { least[at] };
    }
    if !(below.quotient::<V>(&low, &low_divisors) && above.quotient::<V>(&high, &high_divisors)) {
        return None;
    }
    Some((below.down()[..9].try_into().ok()?, above.up()[..9].try_into().ok()?))
}
