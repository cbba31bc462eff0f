//! Oracles: exact rationals, a small reproducible generator, and operands that hurt.
#![allow(
    dead_code,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "each test file uses its own part"
)]

pub mod matrices;
pub mod rows;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};

pub fn q(x: f64) -> BigRational {
    BigRational::from_float(x).expect("finite")
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

/// The exact inverse of a square rational matrix by Gauss-Jordan elimination, and its determinant.
pub fn invert(a: &[BigRational], n: usize) -> (BigRational, Option<Vec<BigRational>>) {
    let mut m: Vec<Vec<BigRational>> = (0..n)
        .map(|i| {
            let mut row = a[i * n..(i + 1) * n].to_vec();
            row.extend((0..n).map(|j| if i == j { BigRational::one() } else { BigRational::zero() }));
            row
        })
        .collect();
    let mut determinant = BigRational::one();
    for p in 0..n {
        let Some(r) = (p..n).find(|&r| !m[r][p].is_zero()) else { return (BigRational::zero(), None) };
        if r != p {
            m.swap(r, p);
            determinant = -determinant;
        }
        let pivot = m[p][p].clone();
        determinant *= &pivot;
        for x in &mut m[p] {
            *x /= &pivot;
        }
        for i in 0..n {
            if i != p && !m[i][p].is_zero() {
                let factor = m[i][p].clone();
                for j in 0..2 * n {
                    let change = &factor * &m[p][j];
                    m[i][j] -= change;
                }
            }
        }
    }
    (determinant, Some(m.into_iter().flat_map(|row| row[n..].to_vec()).collect()))
}

pub fn integer(x: i64) -> BigRational {
    BigRational::from_integer(BigInt::from(x))
}
