//! Directed operations against exact rationals: enclosing, and apart from that tightest.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::items_after_statements,
    reason = "test data are small numbers"
)]

mod common;

use common::{Random, is_down, is_up, q};
use interval_core::rounding::{
    add_down, add_up, div_down, div_up, environment_is_default, mul_down, mul_up, sqrt_down, sqrt_up, sub_down, sub_up,
};
use num_rational::BigRational;
use num_traits::Zero;

const CASES: usize = 100_000;

fn check(name: &str, operation: impl Fn(f64, f64) -> Option<(f64, f64, BigRational)>) {
    let mut random = Random(name.len() as u64);
    let mut pairs: Vec<(f64, f64)> = Vec::new();
    for a in [f64::MAX, f64::MIN, 5e-324, -5e-324, 0.0, -0.0, 1.0, f64::MIN_POSITIVE, 2.0_f64.powi(970)] {
        for b in [f64::MAX, f64::MIN, 5e-324, -5e-324, 0.0, -0.0, 1.0, -1.0, 2.0_f64.powi(969), -2.0_f64.powi(970)] {
            pairs.push((a, b));
            pairs.push((b, a));
        }
    }
    pairs.extend((0..CASES).map(|_| (random.spicy(), random.spicy())));
    for (a, b) in pairs {
        let Some((down, up, exact)) = operation(a, b) else { continue };
        assert!(is_down(down, &exact), "{name}({a:e}, {b:e}): {down:e} is not below, or not the tightest lower bound");
        assert!(is_up(up, &exact), "{name}({a:e}, {b:e}): {up:e} is not above, or not the tightest upper bound");
    }
}

/// The oracle's own numbers are those that the library of fractions makes of doubles, and in lowest terms.
#[test]
fn doubles_are_fractions() {
    let mut random = Random(2);
    for x in (0..20_000).map(|_| random.spicy()).chain([0.0, -0.0, f64::MAX, f64::MIN, 5e-324, -5e-324]) {
        let known = BigRational::from_float(x).expect("finite");
        assert_eq!((q(x).numer(), q(x).denom()), (known.numer(), known.denom()), "{x:e}");
    }
}

#[test]
fn the_environment_is_the_default_one() {
    assert!(environment_is_default());
}

/// `a + b` over the larger of the two denominators, which are powers of two: not in lowest terms, which no comparison needs.
fn sum(a: f64, b: f64) -> BigRational {
    let (a, b) = (q(a), q(b));
    let denominator = a.denom().max(b.denom()).clone();
    let numerator = a.numer() * (&denominator / a.denom()) + b.numer() * (&denominator / b.denom());
    BigRational::new_raw(numerator, denominator)
}

#[test]
fn sums() {
    check("add", |a, b| Some((add_down(a, b), add_up(a, b), sum(a, b))));
}

#[test]
fn differences() {
    check("sub", |a, b| Some((sub_down(a, b), sub_up(a, b), sum(a, -b))));
}

#[test]
fn products() {
    check("mul", |a, b| Some((mul_down(a, b), mul_up(a, b), q(a) * q(b))));
}

#[test]
fn quotients() {
    check("div", |a, b| (b != 0.0).then(|| (div_down(a, b), div_up(a, b), q(a) / q(b))));
}

#[test]
fn square_roots() {
    let mut random = Random(5);
    let mut cases: Vec<f64> = (0..CASES).map(|_| random.spicy().abs()).collect();
    cases.extend((1..2000).map(f64::from).map(|x| x * x));
    for x in cases {
        let (down, up) = (sqrt_down(x), sqrt_up(x));
        assert!(&q(down) * &q(down) <= q(x) && &q(up) * &q(up) >= q(x), "sqrt({x:e})");
        assert!(down == up || down.next_up() == up, "sqrt({x:e}) is not tightest");
        assert!(down != up || &q(down) * &q(down) == q(x), "sqrt({x:e}) is exact only if it is");
    }
}

#[test]
fn infinite_operands_give_limits() {
    let inf = f64::INFINITY;
    assert_eq!(add_up(inf, 1.0), inf);
    assert_eq!(add_down(inf, -f64::MAX), inf);
    assert_eq!(add_up(-inf, f64::MAX), -inf);
    assert_eq!(mul_up(-inf, 2.0), -inf);
    assert_eq!(div_down(1.0, inf), 0.0);
    assert_eq!(div_up(-inf, 3.0), -inf);
    assert_eq!((add_up(-f64::MAX, -f64::MAX), add_down(-f64::MAX, -f64::MAX)), (f64::MIN, -inf));
    assert!(q(0.0).is_zero());
}
