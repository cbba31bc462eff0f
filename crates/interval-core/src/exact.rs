//! Exact arithmetic over the rationals: the last resort of a proof where directed rounding cannot decide, and the
//! conversion between doubles and rationals.
//!
//! Doubles are dyadic, so a matrix of doubles is an integer matrix times a power of two. The elimination is
//! fraction-free (Bareiss, *Math. Comp.* 22 (1968) 565-578).

use crate::decimals::{self, Ratio};
use crate::dyadic::decode;
use crate::integers::Integer;
use num_bigint::{BigInt, Sign};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

pub use crate::decimals::outward_decimal;

/// The exact value of a finite double.
///
/// # Panics
/// On NaN and infinities, which no caller passes.
#[must_use]
pub fn rational(x: f64) -> BigRational {
    BigRational::from_float(x).expect("callers pass finite doubles")
}

/// The same integer in the terms of the scalar part.
fn integer(x: &BigInt) -> Integer {
    let (sign, halves) = x.to_u32_digits();
    Integer::from_halves(sign == Sign::Minus, &halves)
}

fn big(x: &Integer) -> BigInt {
    let bytes: Vec<u8> = x.digits().iter().flat_map(|d| d.to_le_bytes()).collect();
    BigInt::from_bytes_le(if x.is_negative() { Sign::Minus } else { Sign::Plus }, &bytes)
}

fn ratio(value: &BigRational) -> Ratio {
    Ratio { numerator: integer(value.numer()), denominator: integer(value.denom()) }
}

/// The largest double not above `value`.
#[must_use]
pub fn ratio_down(value: &BigRational) -> f64 {
    ratio(value).down()
}

/// The smallest double not below `value`.
#[must_use]
pub fn ratio_up(value: &BigRational) -> f64 {
    ratio(value).up()
}

/// The exact value of a number such as `-12.5e-3`, `2/3` or `0x1.8p-1`. The value is `None` if the text is not one.
#[must_use]
pub fn from_text(text: &str) -> Option<BigRational> {
    let found = decimals::from_text(text)?;
    Some(BigRational::new_raw(big(&found.numerator), big(&found.denominator)))
}

/// Integers `m` and the exponent `e` with `values[i] = m[i] * 2^e` exactly; the values are finite.
pub(crate) fn integers(values: &[f64]) -> (Vec<BigInt>, i64) {
    let parts: Vec<(i64, i64)> = values.iter().map(|&x| decode(x)).collect();
    let least = parts.iter().filter(|p| p.0 != 0).map(|p| p.1).min().unwrap_or(0);
    let scaled =
        parts.iter().map(|&(m, e)| if m == 0 { BigInt::zero() } else { BigInt::from(m) << (e - least) }).collect();
    (scaled, least)
}

/// Fraction-free Gauss-Jordan elimination of the integer matrix `[A | B]` (`n` rows, `n + k` columns, row-major).
///
/// Returns the determinant of `A`, and `det(A) * A^-1 B` in place of `B`; `None` for the second where the determinant
/// is 0.
fn eliminate(mut m: Vec<BigInt>, n: usize, k: usize) -> (BigInt, Option<Vec<BigInt>>) {
    let width = n + k;
    let mut previous = BigInt::one();
    let mut sign = 1;
    for p in 0..n {
        let Some(pivot_row) = (p..n).find(|&i| !m[i * width + p].is_zero()) else {
            return (BigInt::zero(), None);
        };
        if pivot_row != p {
            for j in 0..width {
                m.swap(p * width + j, pivot_row * width + j);
            }
            sign = -sign;
        }
        let pivot = m[p * width + p].clone();
        for i in 0..n {
            if i == p {
                continue;
            }
            let factor = m[i * width + p].clone();
            for j in 0..width {
                let value = &pivot * &m[i * width + j] - &factor * &m[p * width + j];
                m[i * width + j] = value / &previous;
            }
        }
        previous = pivot;
    }
    // Every diagonal entry now equals the determinant of the row-permuted matrix.
    let right = (0..n).flat_map(|i| m[i * width + n..(i + 1) * width].to_vec()).collect();
    (previous * sign, Some(if sign < 0 { negated(right) } else { right }))
}

fn negated(values: Vec<BigInt>) -> Vec<BigInt> {
    values.into_iter().map(|v| -v).collect()
}

/// The sign of the determinant of an `n` by `n` matrix of finite doubles, row-major: -1, 0 or 1.
#[must_use]
pub fn determinant_sign(a: &[f64], n: usize) -> i8 {
    let (m, _) = integers(a);
    let (determinant, _) = eliminate(m, n, 0);
    if determinant.is_zero() {
        0
    } else if determinant.is_positive() {
        1
    } else {
        -1
    }
}

/// The sign of the determinant and the exact inverse, row-major, of an `n` by `n` matrix of finite doubles.
#[must_use]
pub fn inverse(a: &[f64], n: usize) -> Option<(i8, Vec<BigRational>)> {
    let (m, exponent) = integers(a);
    let mut augmented = Vec::with_capacity(2 * n * n);
    for i in 0..n {
        augmented.extend_from_slice(&m[i * n..(i + 1) * n]);
        augmented.extend((0..n).map(|j| if i == j { BigInt::one() } else { BigInt::zero() }));
    }
    let (determinant, right) = eliminate(augmented, n, n);
    let sign = if determinant.is_negative() { -1 } else { 1 };
    let entries = right?.into_iter().map(|x| scaled_ratio(x, &determinant, -exponent)).collect();
    Some((sign, entries))
}

/// The exact solution of `a x = b` for finite doubles. The value is `None` if `a` is singular.
#[must_use]
pub fn solve(a: &[f64], b: &[f64], n: usize) -> Option<Vec<BigRational>> {
    let (left, left_exponent) = integers(a);
    let (right, right_exponent) = integers(b);
    let mut augmented = Vec::with_capacity(n * (n + 1));
    for i in 0..n {
        augmented.extend_from_slice(&left[i * n..(i + 1) * n]);
        augmented.push(right[i].clone());
    }
    let (determinant, solution) = eliminate(augmented, n, 1);
    let exponent = right_exponent - left_exponent;
    Some(solution?.into_iter().map(|x| scaled_ratio(x, &determinant, exponent)).collect())
}

/// `numerator / denominator * 2^exponent`.
fn scaled_ratio(numerator: BigInt, denominator: &BigInt, exponent: i64) -> BigRational {
    if exponent >= 0 {
        BigRational::new(numerator << exponent, denominator.clone())
    } else {
        BigRational::new(numerator, denominator << -exponent)
    }
}
