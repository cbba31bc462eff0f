//! What the kernels of elementary functions ask of a vector beyond the arithmetic: a fused product, and the bits of
//! numbers that hold an integer.

use super::super::kernel::Lanes;
use crate::doubles::signed;

/// 1.5 * 2^52: the doubles about it are the integers, so a sum with it is rounded to an integer, which stands in its
/// lowest bits as a two's complement.
pub(super) const SHIFT: f64 = 6_755_399_441_055_744.0;

/// The bits of the mantissa and of 1, and the exponent's bias on top of [`SHIFT`]: what takes a number apart.
pub(in super::super) const MANTISSA: i64 = (1 << 52) - 1;
pub(in super::super) const ONE_EXPONENT: i64 = 1023 << 52;
pub(in super::super) const SHIFT_BITS: i64 = signed(SHIFT.to_bits());
pub(in super::super) const SHIFTED_BIAS: f64 = SHIFT + 1023.0;

/// The largest index of a table whose length is a power of two: the mask of the bits that count.
pub(in super::super) const fn last_index(size: usize) -> i64 {
    assert!(size.is_power_of_two());
    #[expect(clippy::cast_possible_wrap, reason = "the length of a table")]
    let last = (size - 1) as i64;
    last
}

/// A vector with a fused product. An integer `n`, `|n| < 2^51`, is *shifted* if it stands as `SHIFT + n`.
pub(in super::super) trait Fused: Lanes {
    /// `self * b + c`, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// The entries of a table at the lowest bits of a shifted integer; the table's length is a power of two.
    fn gather<const SIZE: usize>(self, table: &[f64; SIZE]) -> Self;
    /// `2^(n >> 6)` of a shifted integer `n`, for a result that is normal.
    fn power_of_64ths(self) -> Self;
    /// The lanes of a shifted integer that have one of these bits set.
    fn has_bits(self, bits: i64) -> Self::Mask;
    /// The mantissa in [1, 2) and the exponent of a positive normal number.
    fn mantissa_exponent(self) -> (Self, Self);
    fn not(mask: Self::Mask) -> Self::Mask;
    /// One bit a lane, the first lane lowest.
    fn flags(mask: Self::Mask) -> u32;
}

/// `self + SHIFT`, the nearest integer shifted, and that integer as a double.
#[inline(always)]
pub(super) fn nearest<L: Fused>(x: L) -> (L, L) {
    let shifted = x.add(L::splat(SHIFT));
    (shifted, shifted.sub(L::splat(SHIFT)))
}

/// `((c0 z + c1) z + ...)`, each step rounded once.
#[inline(always)]
pub(super) fn polynomial<L: Fused, const COUNT: usize>(z: L, coefficients: [f64; COUNT]) -> L {
    let mut value = L::splat(coefficients[0]);
    for &c in &coefficients[1..] {
        value = z.mul_add(value, L::splat(c));
    }
    value
}
