//! Oracles: exact rationals, a small reproducible generator, and operands that hurt.
#![allow(
    dead_code,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "each test file uses its own part"
)]

pub mod corners;
pub mod matrices;
pub mod rows;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Float, One, Signed, Zero};

/// A double as a fraction in lowest terms: an odd whole number times a power of two, so that nothing is left to reduce.
pub fn q(x: f64) -> BigRational {
    assert!(x.is_finite());
    let (mantissa, exponent, sign) = x.integer_decode();
    if mantissa == 0 {
        return BigRational::zero();
    }
    let zeros = mantissa.trailing_zeros();
    let odd = BigInt::from(i64::from(sign) * (mantissa >> zeros).cast_signed());
    let exponent = i64::from(exponent) + i64::from(zeros);
    let power = BigInt::one() << exponent.unsigned_abs();
    if exponent < 0 { BigRational::new_raw(odd, power) } else { BigRational::from_integer(odd * power) }
}

/// `SplitMix64`: reproducible without a dependency.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [-1, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Any finite double; every second one from the places where rounding goes wrong.
    pub fn spicy(&mut self) -> f64 {
        const PLACES: [f64; 12] = [
            0.0,
            f64::MAX,
            f64::MIN_POSITIVE,
            5e-324,
            1.0,
            1.5,
            1e-300,
            1e300,
            1.340_780_792_994_259_7e154,
            1e-162,
            2.004_168_360_008_973e-292,
            9_007_199_254_740_992.0,
        ];
        let choice = self.bits();
        let x = match choice % 4 {
            0 => {
                let place = PLACES[(choice >> 8) as usize % PLACES.len()];
                let shifted = f64::from_bits(place.to_bits().wrapping_add((choice >> 32) % 5).wrapping_sub(2));
                if shifted.is_finite() { shifted } else { place }
            }
            1 => self.unit(),
            _ => f64::from_bits(self.bits()),
        };
        let x = if x.is_finite() { x } else { 1.0 };
        if choice & 0x80 == 0 { x } else { -x }
    }
}

/// True if `x` is the largest double not above `exact`.
pub fn is_down(x: f64, exact: &BigRational) -> bool {
    let below = x == f64::NEG_INFINITY || q(x) <= *exact;
    let next = x.next_up();
    below && (next == f64::INFINITY || q(next) > *exact)
}

/// True if `x` is the smallest double not below `exact`.
pub fn is_up(x: f64, exact: &BigRational) -> bool {
    is_down(-x, &-exact.clone())
}

/// The exact inverse of a square rational matrix, and its determinant.
pub fn invert(a: &[BigRational], n: usize) -> (BigRational, Option<Vec<BigRational>>) {
    let all: Vec<usize> = (0..n).collect();
    columns_of_inverse(a, n, &all)
}

/// The determinant and, row by row, some columns of the inverse, by fraction-free Gauss-Jordan elimination (Bareiss): the
/// rows are scaled to integers, and every division is exact, so that no fraction has to be reduced on the way.
pub fn columns_of_inverse(a: &[BigRational], n: usize, columns: &[usize]) -> (BigRational, Option<Vec<BigRational>>) {
    let scales: Vec<BigInt> = a.chunks_exact(n).map(common_denominator).collect();
    let mut m: Vec<Vec<BigInt>> = a
        .chunks_exact(n)
        .zip(&scales)
        .enumerate()
        .map(|(i, (row, scale))| {
            let unit = columns.iter().map(|&j| if i == j { scale.clone() } else { BigInt::zero() });
            row.iter().map(|x| x.numer() * (scale / x.denom())).chain(unit).collect()
        })
        .collect();
    let (mut previous, mut swapped) = (BigInt::one(), false);
    for p in 0..n {
        let Some(r) = (p..n).find(|&r| !m[r][p].is_zero()) else { return (BigRational::zero(), None) };
        if r != p {
            m.swap(r, p);
            swapped = !swapped;
        }
        let row = m[p].clone();
        for (i, other) in m.iter_mut().enumerate() {
            if i != p {
                let factor = other[p].clone();
                // What stands left of the pivot is zero by now, or is the diagonal, which is not read again.
                for (x, y) in other[p..].iter_mut().zip(&row[p..]) {
                    *x = (&row[p] * &*x - &factor * y) / &previous;
                }
            }
        }
        previous.clone_from(&row[p]);
    }
    let determinant = if swapped { -&previous } else { previous.clone() };
    let positive = |x: &BigInt| {
        let (numer, denom) = (x.clone(), previous.clone());
        if denom.is_negative() { BigRational::new_raw(-numer, -denom) } else { BigRational::new_raw(numer, denom) }
    };
    let inverse = m.iter().flat_map(|row| &row[n..]).map(positive).collect();
    (BigRational::new(determinant, scales.iter().product()), Some(inverse))
}

/// A common multiple of the denominators: the least one for doubles, whose denominators are powers of two.
fn common_denominator(row: &[BigRational]) -> BigInt {
    let largest = row.iter().map(BigRational::denom).max().expect("a row").clone();
    row.iter()
        .fold(largest, |multiple, x| if (&multiple % x.denom()).is_zero() { multiple } else { multiple * x.denom() })
}

pub fn integer(x: i64) -> BigRational {
    BigRational::from_integer(BigInt::from(x))
}
