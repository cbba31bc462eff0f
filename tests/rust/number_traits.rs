//! Generic code over `num-traits`: neutral elements to the bit, the same functions, and matrices of nalgebra over intervals.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

use interval_core::Interval;
use nalgebra::{Matrix2, Vector2};
use num_traits::{Inv, MulAdd, One, Pow, Zero};

fn interval(lo: f64, hi: f64) -> Interval {
    Interval::new(lo, hi).expect("bounds in order")
}

/// Horner's rule over anything that has neutral elements and products.
fn polynomial<T: Zero + MulAdd<Output = T> + Copy>(coefficients: &[T], x: T) -> T {
    coefficients.iter().rev().fold(T::zero(), |sum, &c| sum.mul_add(x, c))
}

#[test]
fn neutral_elements_change_no_bit() {
    let odd = [interval(-0.1, 0.3), Interval::EMPTY, Interval::ENTIRE, interval(5e-324, f64::INFINITY), Interval::ZERO];
    for x in odd {
        for y in [x + Interval::zero(), Interval::zero() + x, x * Interval::one(), Interval::one() * x] {
            assert_eq!((x.lo().to_bits(), x.hi().to_bits()), (y.lo().to_bits(), y.hi().to_bits()), "{x}");
        }
    }
    assert!(Interval::ZERO.is_zero() && !interval(0.0, 1.0).is_zero() && !interval(-1.0, 1.0).is_zero());
    assert!(Interval::ONE.is_one() && !interval(0.0, 1.0).is_one());
}

#[test]
fn functions_are_those_of_the_same_names() {
    let (x, y, z) = (interval(-1.5, 2.0), interval(0.25, 3.0), interval(-0.1, 0.1));
    assert_eq!(y.inv(), y.recip());
    assert_eq!(Pow::pow(x, 3), x.powi(3));
    assert_eq!(Pow::pow(y, x), y.pow(x));
    assert_eq!(MulAdd::mul_add(x, y, z), x.mul_add(y, z));
    // 1 + 2 x + 3 x^2 at [0.25, 3] lies in [1.6875, 34].
    let value = polynomial(&[interval(1.0, 1.0), interval(2.0, 2.0), interval(3.0, 3.0)], y);
    assert_eq!(value, interval(1.6875, 34.0));
}

#[test]
fn assigning_operators_are_the_operators() {
    let (a, b) = (interval(0.1, 0.2), interval(-3.0, 7.0));
    let mut x = a;
    x += b;
    assert_eq!(x, a + b);
    x -= b;
    assert_eq!(x, (a + b) - b);
    x *= b;
    assert_eq!(x, ((a + b) - b) * b);
    x /= a;
    assert_eq!(x, (((a + b) - b) * b) / a);
    assert_eq!([a, b, a].into_iter().sum::<Interval>(), a + b + a);
    assert_eq!([a, b, a].into_iter().product::<Interval>(), a * b * a);
}

#[test]
fn matrices_of_nalgebra_multiply_intervals() {
    let m = Matrix2::new(interval(1.0, 2.0), interval(-1.0, 0.0), interval(0.5, 0.5), interval(3.0, 4.0));
    let v = Vector2::new(interval(2.0, 3.0), interval(-1.0, 1.0));
    assert_eq!(m * v, Vector2::new(interval(1.0, 7.0), interval(-3.0, 5.5)));
}
