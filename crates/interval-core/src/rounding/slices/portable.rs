//! Vectors as small arrays, which the compiler maps to the registers of the baseline. No `unsafe`, any processor.

use super::kernel::Lanes;
use crate::doubles::{signed, unsigned};
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// Doubles of a vector, which the compiler splits into registers of the baseline.
const WIDTH: usize = 4;

/// Four doubles.
#[derive(Clone, Copy)]
pub(super) struct Arrays([f64; WIDTH]);

/// All bits of a lane set, or none.
#[derive(Clone, Copy)]
pub(super) struct Flags([u64; WIDTH]);

#[inline(always)]
fn each(f: impl Fn(usize) -> f64) -> Arrays {
    Arrays(core::array::from_fn(f))
}

#[inline(always)]
fn flags(f: impl Fn(usize) -> bool) -> Flags {
    Flags(core::array::from_fn(|i| if f(i) { u64::MAX } else { 0 }))
}

/// `a b - c` for `c` near `a b`.
#[cfg(any(target_arch = "aarch64", target_feature = "fma"))]
#[inline(always)]
fn product_less(a: f64, b: f64, c: f64) -> f64 {
    a.mul_add(b, -c)
}

/// The same by Veltkamp's splitting and Dekker's product: the halves of 26 bits multiply exactly. A factor above 2^996
/// overflows in the splitting and gives NaN.
#[cfg(not(any(target_arch = "aarch64", target_feature = "fma")))]
#[inline(always)]
fn product_less(a: f64, b: f64, c: f64) -> f64 {
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    let p = a * b;
    let error = ((ah * bh - p) + ah * bl + al * bh) + al * bl;
    // p - c is exact: the two are equal or neighbours.
    (p - c) + error
}

#[cfg(not(any(target_arch = "aarch64", target_feature = "fma")))]
#[inline(always)]
fn halves(x: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * x;
    let high = scaled - (scaled - x);
    (high, x - high)
}

impl Lanes for Arrays {
    type Mask = Flags;
    const N: usize = WIDTH;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        each(|i| from[i])
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[..WIDTH].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; WIDTH])
    }
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        each(|i| self.0[i] + b.0[i])
    }
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        each(|i| self.0[i] - b.0[i])
    }
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        each(|i| self.0[i] * b.0[i])
    }
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        each(|i| self.0[i] / b.0[i])
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        each(|i| self.0[i].sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        each(|i| self.0[i].abs())
    }
    #[inline(always)]
    fn neg(self) -> Self {
        each(|i| -self.0[i])
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        each(|i| if self.0[i] < b.0[i] { self.0[i] } else { b.0[i] })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        each(|i| if self.0[i] > b.0[i] { self.0[i] } else { b.0[i] })
    }
    #[inline(always)]
    fn product_less(self, b: Self, c: Self) -> Self {
        each(|i| product_less(self.0[i], b.0[i], c.0[i]))
    }
    #[inline(always)]
    fn less(self, b: Self) -> Flags {
        flags(|i| self.0[i] < b.0[i])
    }
    #[inline(always)]
    fn less_equal(self, b: Self) -> Flags {
        flags(|i| self.0[i] <= b.0[i])
    }
    #[inline(always)]
    fn equal(self, b: Self) -> Flags {
        flags(|i| self.0[i] == b.0[i])
    }
    #[inline(always)]
    fn select(mask: Flags, yes: Self, no: Self) -> Self {
        each(|i| f64::from_bits((mask.0[i] & yes.0[i].to_bits()) | (!mask.0[i] & no.0[i].to_bits())))
    }
    #[inline(always)]
    fn both(a: Flags, b: Flags) -> Flags {
        Flags(core::array::from_fn(|i| a.0[i] & b.0[i]))
    }
    #[inline(always)]
    fn either(a: Flags, b: Flags) -> Flags {
        Flags(core::array::from_fn(|i| a.0[i] | b.0[i]))
    }
    #[inline(always)]
    fn all(mask: Flags) -> bool {
        mask.0.iter().fold(u64::MAX, |all, flag| all & flag) != 0
    }
    #[inline(always)]
    fn above_if(self, mask: Flags) -> Self {
        // Bits count upwards for positive and downwards for negative numbers; the flag is -1 as a number.
        each(|i| {
            let bits = self.0[i].to_bits();
            let negative = unsigned(signed(bits) >> 63);
            f64::from_bits(bits.wrapping_sub((mask.0[i] ^ negative).wrapping_sub(negative)))
        })
    }
    #[inline(always)]
    fn below_if(self, mask: Flags) -> Self {
        each(|i| {
            let bits = self.0[i].to_bits();
            let negative = unsigned(signed(bits) >> 63);
            f64::from_bits(bits.wrapping_add((mask.0[i] ^ negative).wrapping_sub(negative)))
        })
    }
}
