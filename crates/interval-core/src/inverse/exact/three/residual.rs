//! Which of two neighbouring doubles bounds an end: the sign of a residual without error.

use super::Square;
use super::entries::{Ends, Vertices};
use crate::doubles::Neighbours;
use crate::lanes::{One, two_product, two_sum};

/// Bounds of this size are multiples of 2^-202 as entries are, so that a product of four of them, below 2^600, is one of
/// 2^-808: neither it nor its error leaves the range of doubles.
const RANGE: std::ops::Range<f64> = super::SMALLEST..super::LARGEST;
/// Parts of a residual: 48 of the determinant's 24 times a bound, 4 of the cofactor.
const PARTS: usize = 52;

/// A sum of doubles without error: they do not overlap, the largest stands last (Shewchuk).
struct Expansion {
    parts: [f64; PARTS],
    length: usize,
}

impl Expansion {
    const ZERO: Self = Self { parts: [0.0; PARTS], length: 0 };

    fn add(&mut self, x: f64) {
        let (mut carried, mut kept) = (x, 0);
        for at in 0..self.length {
            let (sum, error) = two_sum(One(carried), One(self.parts[at]));
            if error.0 != 0.0 {
                self.parts[kept] = error.0;
                kept += 1;
            }
            carried = sum.0;
        }
        if carried != 0.0 {
            self.parts[kept] = carried;
            kept += 1;
        }
        self.length = kept;
    }

    fn add_product(&mut self, x: f64, y: f64) {
        let (product, error) = two_product(One(x), One(y));
        self.add(error.0);
        self.add(product.0);
    }

    /// Every part times a double.
    fn times(&self, x: f64) -> Self {
        let mut found = Self::ZERO;
        self.parts[..self.length].iter().for_each(|&part| found.add_product(part, x));
        found
    }

    fn sum(&mut self, other: &Self) {
        other.parts[..other.length].iter().for_each(|&part| self.add(part));
    }

    fn sign(&self) -> f64 {
        if self.length == 0 { 0.0 } else { self.parts[self.length - 1].signum() }
    }
}

/// The matrix of a lane as [`vertex_entries`](super::entries::vertex_entries) has it: its own row `j` first.
fn vertex(lo: &Square, hi: &Square, chosen: &Vertices, lane: usize) -> [[f64; 3]; 3] {
    std::array::from_fn(|k| {
        std::array::from_fn(|l| {
            let at = 3 * ((lane + k) % 3) + l;
            if chosen.rows[k][lane] * chosen.columns[l][lane] > 0.0 { hi[at] } else { lo[at] }
        })
    })
}

/// `a e - b d`.
fn minor(a: f64, e: f64, b: f64, d: f64) -> Expansion {
    let mut found = Expansion::ZERO;
    found.add_product(a, e);
    found.add_product(-b, d);
    found
}

/// The largest double that is not above the end of a lane, which lies between two bounds that differ. The value is
/// `None` where they are no neighbours and the end is not zero, or where a product could leave the range of doubles.
fn between(lo: &Square, hi: &Square, chosen: &Vertices, lane: usize, (below, above): (f64, f64)) -> Option<f64> {
    let zero = below < 0.0 && above > 0.0;
    let tried = if zero { 0.0 } else { above };
    if !(zero || (RANGE.contains(&tried.abs()) && below.above() == above)) {
        return None;
    }
    let m = vertex(lo, hi, chosen, lane);
    let [_, [d, e, f], [g, h, i]] = m;
    let minors = [minor(e, i, f, h), minor(f, g, d, i), minor(d, h, e, g)];
    let mut determinant = Expansion::ZERO;
    for (cofactor, x) in minors.iter().zip(m[0]) {
        determinant.sum(&cofactor.times(x));
    }
    let own = &minors[(lane % 9) / 3];
    // Lanes from 9 on hold ends with the other sign.
    let mirror = if lane < 9 { 1.0 } else { -1.0 };
    let mut residual = determinant.times(-tried);
    residual.sum(&own.times(mirror));
    let side = residual.sign() * determinant.sign();
    if zero {
        return (side == 0.0).then_some(0.0);
    }
    Some(if side >= 0.0 { above } else { below })
}

/// Settles the lanes whose error could change the rounding; false if one of them stays open.
pub(super) fn settle(lo: &Square, hi: &Square, chosen: &Vertices, zero: &[bool; 9], ends: &mut Ends) -> bool {
    for lane in (0..18).filter(|lane| !zero[lane % 9]) {
        let bounds = (f64::from_bits(ends.bound[lane]), f64::from_bits(ends.other[lane]));
        if ends.bound[lane] == ends.other[lane] {
            continue;
        }
        let Some(bound) = between(lo, hi, chosen, lane, bounds) else { return false };
        (ends.bound[lane], ends.other[lane]) = (bound.to_bits(), bound.to_bits());
    }
    true
}
