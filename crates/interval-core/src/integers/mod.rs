//! Integers of any size, for the last resort of a rounding and for the text of numbers: what the scalar part of the crate
//! needs, so that it needs no other crate. Products and quotients are those of the schoolbook (Knuth, *The Art of
//! Computer Programming*, volume 2, section 4.3.1), which are the fastest up to some thousand bits.

mod digits;

use alloc::vec;
use alloc::vec::Vec;
use core::cmp::Ordering;
use core::fmt;
use core::ops::{Add, Mul, Neg, Shl, Shr, Sub};
use digits::{
    WIDTH, compare, difference, divided_by_digit, high, low, product, quotient, shifted_down, shifted_up, sum, trimmed,
};

/// An integer: its sign, and the digits of its magnitude to base 2^64, the lowest first, without leading zeros.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Integer {
    negative: bool,
    digits: Vec<u64>,
}

impl Integer {
    pub const ZERO: Self = Self { negative: false, digits: Vec::new() };

    fn made(negative: bool, digits: Vec<u64>) -> Self {
        Self { negative: negative && !digits.is_empty(), digits }
    }

    /// The integer of a sign and digits to base 2^32, the lowest first.
    pub fn from_halves(negative: bool, halves: &[u32]) -> Self {
        let whole = |pair: &[u32]| u64::from(pair[0]) | (u64::from(pair.get(1).copied().unwrap_or(0)) << 32);
        Self::made(negative, trimmed(halves.chunks(2).map(whole).collect()))
    }

    /// Digits of the magnitude to base 2^64, the lowest first.
    #[cfg_attr(not(feature = "exact"), expect(dead_code, reason = "for conversions to other integers"))]
    pub fn digits(&self) -> &[u64] {
        &self.digits
    }

    /// The number that digits of a radix up to 36 write; `None` where a character is none.
    pub fn parse(text: &str, radix: u32) -> Option<Self> {
        let mut digits: Vec<u64> = Vec::new();
        for c in text.chars() {
            let mut carry = u64::from(c.to_digit(radix)?);
            for slot in &mut digits {
                let total = u128::from(*slot) * u128::from(radix) + u128::from(carry);
                *slot = low(total);
                carry = high(total);
            }
            if carry != 0 {
                digits.push(carry);
            }
        }
        Some(Self::made(false, digits))
    }

    pub fn is_zero(&self) -> bool {
        self.digits.is_empty()
    }

    pub fn is_one(&self) -> bool {
        !self.negative && self.digits == [1]
    }

    pub fn is_negative(&self) -> bool {
        self.negative
    }

    pub fn is_positive(&self) -> bool {
        !self.negative && !self.is_zero()
    }

    /// Length of the magnitude in bits; 0 for 0.
    pub fn bits(&self) -> u64 {
        self.digits.last().map_or(0, |top| WIDTH * (self.digits.len() as u64) - u64::from(top.leading_zeros()))
    }

    /// Number of zeros at the end of the magnitude in bits; `None` for 0.
    pub fn trailing_zeros(&self) -> Option<u64> {
        let at = self.digits.iter().position(|&d| d != 0)?;
        Some(WIDTH * (at as u64) + u64::from(self.digits[at].trailing_zeros()))
    }

    pub fn abs(&self) -> Self {
        Self::made(false, self.digits.clone())
    }

    /// The order of the magnitudes.
    pub fn compare_magnitude(&self, other: &Self) -> Ordering {
        compare(&self.digits, &other.digits)
    }

    /// The magnitude, if it has at most 64 bits.
    pub fn magnitude(&self) -> Option<u64> {
        match self.digits[..] {
            [] => Some(0),
            [digit] => Some(digit),
            _ => None,
        }
    }

    pub fn to_i64(&self) -> Option<i64> {
        let magnitude = i128::from(self.magnitude()?);
        i64::try_from(if self.negative { -magnitude } else { magnitude }).ok()
    }

    /// The member of 0, ..., `modulus - 1` that differs from it by a multiple of the modulus.
    pub fn modulo(&self, modulus: u64) -> u64 {
        let rest = divided_by_digit(&self.digits, modulus).1;
        if self.negative && rest != 0 { modulus - rest } else { rest }
    }

    /// The quotient, towards zero, by an integer that is not zero.
    pub fn quotient(&self, divisor: &Self) -> Self {
        Self::made(self.negative != divisor.negative, quotient(&self.digits, &divisor.digits))
    }

    /// The quotient, towards zero, by a positive number.
    pub fn divided(&self, divisor: u64) -> Self {
        Self::made(self.negative, divided_by_digit(&self.digits, divisor).0)
    }

    /// The largest integer whose square is not above a number that is not negative.
    pub fn sqrt(&self) -> Self {
        if self.is_zero() {
            return Self::ZERO;
        }
        // Newton's method falls from above to the root.
        let cut = self.bits().saturating_sub(60).next_multiple_of(2);
        let top = shifted_down(&self.digits, cut).0.first().copied().unwrap_or(0);
        let mut root = Self::from(top.isqrt() + 1) << (cut / 2);
        loop {
            let next = (&root + &self.quotient(&root)) >> 1;
            if compare(&next.digits, &root.digits) != Ordering::Less {
                return root;
            }
            root = next;
        }
    }

    pub fn pow(&self, mut exponent: u32) -> Self {
        let (mut found, mut square) = (Self::from(1_u64), self.clone());
        while exponent > 0 {
            if exponent % 2 == 1 {
                found = &found * &square;
            }
            exponent /= 2;
            if exponent > 0 {
                square = &square * &square;
            }
        }
        found
    }
}

impl From<u64> for Integer {
    fn from(x: u64) -> Self {
        Self::made(false, if x == 0 { Vec::new() } else { vec![x] })
    }
}

impl From<i64> for Integer {
    fn from(x: i64) -> Self {
        let magnitude = Self::from(x.unsigned_abs());
        Self::made(x < 0, magnitude.digits)
    }
}

impl PartialOrd for Integer {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Integer {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self.negative, other.negative) {
            (false, true) => Ordering::Greater,
            (true, false) => Ordering::Less,
            (false, false) => self.compare_magnitude(other),
            (true, true) => other.compare_magnitude(self),
        }
    }
}

impl Neg for Integer {
    type Output = Self;
    fn neg(self) -> Self {
        Self::made(!self.negative, self.digits)
    }
}

impl Neg for &Integer {
    type Output = Integer;
    fn neg(self) -> Integer {
        -self.clone()
    }
}

impl Add for &Integer {
    type Output = Integer;
    fn add(self, other: Self) -> Integer {
        if self.negative == other.negative {
            return Integer::made(self.negative, sum(&self.digits, &other.digits));
        }
        if self.compare_magnitude(other) == Ordering::Less {
            Integer::made(other.negative, difference(&other.digits, &self.digits))
        } else {
            Integer::made(self.negative, difference(&self.digits, &other.digits))
        }
    }
}

impl Sub for &Integer {
    type Output = Integer;
    fn sub(self, other: Self) -> Integer {
        self + &-other
    }
}

impl Mul for &Integer {
    type Output = Integer;
    fn mul(self, other: Self) -> Integer {
        Integer::made(self.negative != other.negative, product(&self.digits, &other.digits))
    }
}

impl Shl<u64> for &Integer {
    type Output = Integer;
    fn shl(self, by: u64) -> Integer {
        Integer::made(self.negative, shifted_up(&self.digits, by))
    }
}

impl Shl<u64> for Integer {
    type Output = Self;
    fn shl(self, by: u64) -> Self {
        &self << by
    }
}

/// Rounded down.
impl Shr<u64> for &Integer {
    type Output = Integer;
    fn shr(self, by: u64) -> Integer {
        let (digits, lost) = shifted_down(&self.digits, by);
        if self.negative && lost {
            return Integer::made(true, sum(&digits, &[1]));
        }
        Integer::made(self.negative, digits)
    }
}

impl Shr<u64> for Integer {
    type Output = Self;
    fn shr(self, by: u64) -> Self {
        &self >> by
    }
}

impl fmt::Display for Integer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// The largest power of ten of 64 bits.
        const STEP: u64 = 10_000_000_000_000_000_000;
        let mut parts = Vec::new();
        let mut rest = self.digits.clone();
        while !rest.is_empty() {
            let (left, part) = divided_by_digit(&rest, STEP);
            parts.push(part);
            rest = left;
        }
        if self.negative {
            f.write_str("-")?;
        }
        write!(f, "{}", parts.pop().unwrap_or(0))?;
        parts.iter().rev().try_for_each(|part| write!(f, "{part:019}"))
    }
}
