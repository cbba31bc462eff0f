//! Balls over the integers: `(mid +- rad) * 2^exp`, the arithmetic of the last resort, in which nothing rounds unseen.
//!
//! Every operation returns a ball that holds the exact result for all members of its operands. The function `shorten`
//! keeps the midpoint at a number of bits and moves the part that it cuts into the radius.

use crate::dyadic::{decode, dyadic_down, shifted};
use crate::integers::Integer;
use core::cmp::Ordering;

/// The numbers within `rad * 2^exp` of `mid * 2^exp`; `rad >= 0`.
#[derive(Debug, Clone)]
pub(crate) struct Ball {
    pub mid: Integer,
    pub rad: Integer,
    pub exp: i64,
}

/// `2^k`, infinite or zero beyond the range of normal numbers.
fn power_of_two(k: i64) -> f64 {
    match u64::try_from(k + 1023) {
        Ok(field @ 1..=2046) => f64::from_bits(field << 52),
        Ok(2047..) => f64::INFINITY,
        _ => 0.0,
    }
}

fn two() -> Integer {
    Integer::from(2_u64)
}

fn bits(x: &Integer) -> i64 {
    i64::try_from(x.bits()).unwrap_or(i64::MAX)
}

impl Ball {
    pub fn exact(mid: Integer, exp: i64) -> Self {
        Self { mid, rad: Integer::ZERO, exp }
    }

    pub fn integer(x: i64) -> Self {
        Self::exact(Integer::from(x), 0)
    }

    /// A finite double.
    pub fn from_f64(x: f64) -> Self {
        let (mantissa, exp) = decode(x);
        Self::exact(Integer::from(mantissa), exp)
    }

    /// True if it is one number.
    pub fn is_exact(&self) -> bool {
        self.rad.is_zero()
    }

    /// The sign that all members have; 0 where they differ.
    pub fn sign(&self) -> i32 {
        if self.mid.compare_magnitude(&self.rad) != Ordering::Greater {
            0
        } else if self.mid.is_positive() {
            1
        } else {
            -1
        }
    }

    /// The midpoint to double precision: for choosing a method, never for a bound.
    pub fn approximate(&self) -> f64 {
        let cut = (bits(&self.mid) - 60).max(0);
        #[expect(clippy::cast_precision_loss, reason = "an approximation")]
        let top = shifted(&self.mid, -cut).to_i64().unwrap_or(0) as f64;
        let exponent = (self.exp + cut).clamp(-4000, 4000);
        // Two steps, so that no factor overflows on the way to a subnormal number.
        let half = exponent / 2;
        let rest = exponent - half;
        top * power_of_two(half) * power_of_two(rest)
    }

    /// The same ball, or a slightly larger one, with a midpoint of at most `precision` bits.
    pub fn shorten(self, precision: i64) -> Self {
        let cut = bits(&self.mid).max(bits(&self.rad)) - precision;
        if cut <= 0 {
            return self;
        }
        let exact = self.is_exact() && self.mid.trailing_zeros().is_some_and(|z| i64::try_from(z).unwrap_or(0) >= cut);
        let mid = shifted(&self.mid, -cut);
        let rad = if exact { Integer::ZERO } else { &shifted(&self.rad, -cut) + &two() };
        Self { mid, rad, exp: self.exp + cut }
    }

    pub fn neg(self) -> Self {
        Self { mid: -self.mid, ..self }
    }

    pub fn add(&self, other: &Self) -> Self {
        let exp = self.exp.min(other.exp);
        let (a, b) = (self.exp - exp, other.exp - exp);
        Self {
            mid: &shifted(&self.mid, a) + &shifted(&other.mid, b),
            rad: &shifted(&self.rad, a) + &shifted(&other.rad, b),
            exp,
        }
    }

    pub fn sub(&self, other: &Self) -> Self {
        self.add(&other.clone().neg())
    }

    pub fn mul(&self, other: &Self) -> Self {
        let (a, b) = (&self.mid.abs() * &other.rad, &other.mid.abs() * &self.rad);
        let rad = &(&a + &b) + &(&self.rad * &other.rad);
        Self { mid: &self.mid * &other.mid, rad, exp: self.exp + other.exp }
    }

    /// Times a power of two.
    pub fn scale(self, power: i64) -> Self {
        Self { exp: self.exp + power, ..self }
    }

    /// The quotient to about `precision` bits. The value is `None` if the divisor may be zero.
    pub fn div(&self, other: &Self, precision: i64) -> Option<Self> {
        let least = &other.mid.abs() - &other.rad;
        if !least.is_positive() {
            return None;
        }
        let shift = (precision + bits(&other.mid) - bits(&self.mid)).max(0);
        let numerator = shifted(&self.mid, shift);
        let mid = numerator.quotient(&other.mid);
        // |x/y - m/d| <= (|x - m| + |m/d| |y - d|) / |y|, and one more for the truncated quotient.
        let rad = if self.is_exact() && other.is_exact() && (&mid * &other.mid) == numerator {
            Integer::ZERO
        } else {
            let slope = &(&mid.abs() + &Integer::from(1_u64)) * &other.rad;
            &(&shifted(&self.rad, shift) + &slope).quotient(&least) + &two()
        };
        Some(Self { mid, rad, exp: self.exp - other.exp - shift })
    }

    /// Divided by a positive integer.
    pub fn div_integer(&self, divisor: u64) -> Self {
        let guard = 64;
        let rad = &(&self.rad << guard).divided(divisor) + &two();
        Self { mid: (&self.mid << guard).divided(divisor), rad, exp: self.exp - 64 }
    }

    /// The square root to about `precision` bits. The value is `None` if a member may be negative.
    pub fn sqrt(&self, precision: i64) -> Option<Self> {
        if self.is_exact() && self.mid.is_zero() {
            return Some(self.clone());
        }
        let mut shift = (2 * precision - bits(&self.mid)).max(0);
        if (self.exp - shift) % 2 != 0 {
            shift += 1;
        }
        let (mid, rad) = (shifted(&self.mid, shift), shifted(&self.rad, shift));
        let least = &mid - &rad;
        if !least.is_positive() {
            return None;
        }
        let root = mid.sqrt();
        let rad = if self.is_exact() && &root * &root == mid {
            Integer::ZERO
        } else {
            // |sqrt(x) - sqrt(m)| <= |x - m| / sqrt(least).
            &rad.quotient(&least.sqrt()) + &two()
        };
        Some(Self { mid: root, rad, exp: (self.exp - shift) / 2 })
    }

    /// An integer within one of the midpoint.
    pub fn nearby_integer(&self) -> Integer {
        if self.exp >= 0 {
            return shifted(&self.mid, self.exp);
        }
        let half = Integer::from(1_u64) << (-self.exp - 1).unsigned_abs();
        shifted(&(&self.mid + &half), self.exp)
    }

    /// The lower end rounded down and the upper end rounded up to doubles.
    pub fn outward(&self) -> (f64, f64) {
        (dyadic_down(&(&self.mid - &self.rad), self.exp), -dyadic_down(&-(&self.mid + &self.rad), self.exp))
    }

    /// The largest double below and the smallest above the number inside, where the ball is small enough to tell.
    pub fn bracket(&self) -> Option<(f64, f64)> {
        let (low, high) = (&self.mid - &self.rad, &self.mid + &self.rad);
        let down = dyadic_down(&low, self.exp);
        let up = -dyadic_down(&-&high, self.exp);
        (down == dyadic_down(&high, self.exp) && up == -dyadic_down(&-low, self.exp)).then_some((down, up))
    }
}
