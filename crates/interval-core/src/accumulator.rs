//! Sums of doubles and of products of two doubles without error.
//!
//! A fixed-point accumulator spans all products of two doubles (Kulisch): nothing is lost before the last rounding, so
//! the result does not depend on the order of the operands.

use crate::dyadic::decode;
#[cfg(feature = "alloc")]
use crate::dyadic::dyadic_down;
#[cfg(feature = "alloc")]
use crate::integers::Integer;
#[cfg(feature = "alloc")]
use alloc::vec::Vec;
use core::cmp::Ordering;

/// The least exponent of a product of two doubles.
const LEAST: i64 = -2 * 1074;
/// Bits of a limb: half of its 64, which leaves room for sums before a carry.
const WIDTH: i64 = 32;
/// 2 * 1024 + 2 * 1074 bits, and 64 more for the carries of 2^64 terms.
const LIMBS: usize = 134;
/// Additions of less than 2^32 to a limb before its 64 bits could overflow.
const PATIENCE: u32 = 1 << 29;

/// A sum of doubles and of products of two doubles, without error.
struct Accumulator {
    limbs: [i64; LIMBS],
    pending: u32,
}

impl Accumulator {
    const fn new() -> Self {
        Self { limbs: [0; LIMBS], pending: 0 }
    }

    /// Adds `m 2^e`, `|m| < 2^108`.
    fn add(&mut self, m: i128, e: i64) {
        if m == 0 {
            return;
        }
        let offset = (e - LEAST).unsigned_abs();
        let (limb, shift) = ((offset / WIDTH.unsigned_abs()), offset % WIDTH.unsigned_abs());
        let magnitude = m.unsigned_abs();
        // Low and high halves, each shifted by less than a limb.
        let low = (magnitude & u128::from(u64::MAX)) << shift;
        let high = (magnitude >> 64) << shift;
        let sign = if m < 0 { -1 } else { 1 };
        let start = usize::try_from(limb).unwrap_or(LIMBS);
        for (part, at) in [(low, start), (high, start + 2)] {
            let mut rest = part;
            let mut index = at;
            while rest != 0 {
                let digit = i64::try_from(rest & 0xffff_ffff).unwrap_or(0);
                self.limbs[index] += sign * digit;
                rest >>= WIDTH;
                index += 1;
            }
        }
        self.pending += 1;
        if self.pending == PATIENCE {
            self.carry();
        }
    }

    fn carry(&mut self) {
        let mut carry = 0;
        for limb in &mut self.limbs[..LIMBS - 1] {
            let value = *limb + carry;
            *limb = value & 0xffff_ffff;
            carry = value >> WIDTH;
        }
        self.limbs[LIMBS - 1] += carry;
        self.pending = 0;
    }

    fn add_double(&mut self, x: f64) {
        let (m, e) = decode(x);
        self.add(m.into(), e);
    }

    fn add_product(&mut self, x: f64, y: f64) {
        let ((m, e), (n, f)) = (decode(x), decode(y));
        self.add(i128::from(m) * i128::from(n), e + f);
    }

    /// The sign of the sum.
    fn sign(mut self) -> Ordering {
        // All limbs but the last are then in 0, ..., 2^32 - 1, so that the last one tells a sum below zero.
        self.carry();
        if self.limbs[LIMBS - 1] < 0 {
            Ordering::Less
        } else if self.limbs.iter().all(|limb| *limb == 0) {
            Ordering::Equal
        } else {
            Ordering::Greater
        }
    }

    /// The sum as an integer multiple of `2^LEAST`.
    #[cfg(feature = "alloc")]
    fn value(mut self) -> Integer {
        self.carry();
        let negative = self.limbs[LIMBS - 1] < 0;
        if negative {
            for limb in &mut self.limbs {
                *limb = -*limb;
            }
            self.carry();
        }
        let digits: Vec<u32> = self.limbs.iter().map(|&limb| u32::try_from(limb).unwrap_or(u32::MAX)).collect();
        Integer::from_halves(negative, &digits)
    }
}

/// The effect of infinite and undefined terms on a sum.
#[derive(Clone, Copy)]
struct Special {
    nan: bool,
    positive: bool,
    negative: bool,
}

impl Special {
    const NONE: Self = Self { nan: false, positive: false, negative: false };

    fn note(&mut self, x: f64) {
        self.nan |= x.is_nan();
        self.positive |= x == f64::INFINITY;
        self.negative |= x == f64::NEG_INFINITY;
    }

    fn result(self) -> Option<f64> {
        if self.nan || (self.positive && self.negative) {
            Some(f64::NAN)
        } else if self.positive {
            Some(f64::INFINITY)
        } else if self.negative {
            Some(f64::NEG_INFINITY)
        } else {
            None
        }
    }
}

/// The exact sum of products, or the effect of infinite and undefined terms.
fn accumulated(terms: impl Iterator<Item = (f64, f64)>) -> Result<Accumulator, f64> {
    let mut special = Special::NONE;
    let mut sum = Accumulator::new();
    for (x, y) in terms {
        if x.is_finite() && y.is_finite() {
            if y == 1.0 { sum.add_double(x) } else { sum.add_product(x, y) }
        } else {
            special.note(x * y);
        }
    }
    special.result().map_or(Ok(sum), Err)
}

/// The exact sum of products as an integer multiple of `2^LEAST`, or the effect of infinite and undefined terms.
#[cfg(feature = "alloc")]
pub(crate) fn accumulate(terms: impl Iterator<Item = (f64, f64)>) -> Result<Integer, f64> {
    accumulated(terms).map(Accumulator::value)
}

/// The sum rounded down.
#[cfg(feature = "alloc")]
pub(crate) fn down(value: &Integer) -> f64 {
    dyadic_down(value, LEAST)
}

/// The sum rounded to nearest, ties to even.
#[cfg(feature = "alloc")]
pub(crate) fn nearest(value: &Integer) -> f64 {
    let (below, above) = (down(value), -down(&-value));
    if below == above {
        return below;
    }
    // Beyond the largest double the neighbour counts as 2^1024.
    let scaled = |x: f64| {
        let (m, e) = if x.is_finite() { decode(x) } else { (if x > 0.0 { 1 } else { -1 }, 1024) };
        Integer::from(m) << (e - LEAST).unsigned_abs()
    };
    match (value << 1).cmp(&(&scaled(below) + &scaled(above))) {
        Ordering::Less => below,
        Ordering::Greater => above,
        Ordering::Equal => {
            let even = |x: f64| x.is_infinite() || x.to_bits() & 1 == 0;
            if even(below) { below } else { above }
        }
    }
}

/// The sign of an exact sum of finite doubles.
pub(crate) fn sign_of_sum(x: &[f64]) -> Ordering {
    accumulated(x.iter().map(|&v| (v, 1.0))).map_or(Ordering::Equal, Accumulator::sign)
}

/// The sign of `a b + c - x` for finite doubles.
pub(crate) fn sign_of_fused(a: f64, b: f64, c: f64, x: f64) -> Ordering {
    accumulated([(a, b), (c, 1.0), (-x, 1.0)].into_iter()).map_or(Ordering::Equal, Accumulator::sign)
}
