//! Intervals: containment for members, tightness of the ends, sets, text.
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::items_after_statements,
    reason = "test data are small numbers"
)]

mod common;

use common::{Random, is_down, is_up, q};
use interval_core::exact::{from_decimal, outward_decimal};
use interval_core::{Error, Interval};
use num_rational::BigRational;
use proptest::prelude::*;

fn random_interval(random: &mut Random) -> Interval {
    let (a, b) = (random.spicy(), random.spicy());
    Interval::new(a.min(b), a.max(b)).expect("ordered")
}

/// Extremes of an operation over the four corners, exactly: where it is monotone in each operand they are the range.
fn corners(
    x: Interval,
    y: Interval,
    f: impl Fn(BigRational, BigRational) -> BigRational,
) -> (BigRational, BigRational) {
    let values: Vec<BigRational> =
        [(x.lo(), y.lo()), (x.lo(), y.hi()), (x.hi(), y.lo()), (x.hi(), y.hi())].map(|(a, b)| f(q(a), q(b))).to_vec();
    (values.iter().min().expect("four").clone(), values.iter().max().expect("four").clone())
}

fn assert_tightest(result: Interval, (least, most): &(BigRational, BigRational), what: &str) {
    assert!(result.lo() == f64::NEG_INFINITY || q(result.lo()) <= *least, "{what}: lower end above the exact one");
    assert!(result.hi() == f64::INFINITY || q(result.hi()) >= *most, "{what}: upper end below the exact one");
    assert!(is_down(result.lo(), least) && is_up(result.hi(), most), "{what}: not tightest");
}

#[test]
fn arithmetic_is_enclosing_and_tightest() {
    let mut random = Random(11);
    for _ in 0..6_000 {
        let (x, y) = (random_interval(&mut random), random_interval(&mut random));
        assert_tightest(x + y, &corners(x, y, |a, b| a + b), &format!("{x} + {y}"));
        assert_tightest(x - y, &corners(x, y, |a, b| a - b), &format!("{x} - {y}"));
        assert_tightest(x * y, &corners(x, y, |a, b| a * b), &format!("{x} * {y}"));
        if !y.contains(0.0) {
            assert_tightest(x / y, &corners(x, y, |a, b| a / b), &format!("{x} / {y}"));
        }
        let (low, high) = (q(x.mignitude()), q(x.magnitude()));
        assert_tightest(x.square(), &(&low * &low, &high * &high), &format!("{x}^2"));
        let drag = |a: f64| q(a) * q(a.abs());
        assert_tightest(x.signed_square(), &(drag(x.lo()), drag(x.hi())), &format!("{x} |{x}|"));
    }
}

#[test]
fn division_by_intervals_with_zero() {
    let at = |a, b| Interval::new(a, b).expect("ordered");
    assert!((at(1.0, 2.0) / Interval::ZERO).is_empty());
    assert_eq!(at(1.0, 2.0) / at(-1.0, 1.0), Interval::ENTIRE);
    assert_eq!(Interval::ZERO / at(-1.0, 1.0), Interval::ZERO);
    assert_eq!(at(1.0, 2.0) / at(0.0, 4.0), at(0.25, f64::INFINITY));
    assert_eq!(at(-2.0, -1.0) / at(0.0, 4.0), at(f64::NEG_INFINITY, -0.25));
    assert_eq!(at(-2.0, 1.0) / at(0.0, 4.0), Interval::ENTIRE);
    assert_eq!(at(1.0, 2.0) / at(-4.0, 0.0), at(f64::NEG_INFINITY, -0.25));
    assert_eq!(at(1.0, f64::INFINITY) / at(2.0, f64::INFINITY), at(0.0, f64::INFINITY));
}

#[test]
fn unbounded_and_empty_operands() {
    let half = Interval::new(1.0, f64::INFINITY).expect("half line");
    assert_eq!(half * Interval::ZERO, Interval::ZERO);
    assert_eq!(half + half, Interval::new(2.0, f64::INFINITY).expect("half line"));
    assert_eq!(half - half, Interval::ENTIRE);
    for result in [half + Interval::EMPTY, half * Interval::EMPTY, half / Interval::EMPTY, -Interval::EMPTY] {
        assert!(result.is_empty());
    }
    assert!(Interval::EMPTY.square().is_empty() && Interval::EMPTY.width().is_nan());
    assert_eq!(Interval::ENTIRE.midpoint(), 0.0);
    assert_eq!(half.sqrt(), half);
    assert!(Interval::new(-2.0, -1.0).expect("ordered").sqrt().is_empty());
}

#[test]
fn construction_is_refused_with_a_cause() {
    assert_eq!(Interval::new(2.0, 1.0), Err(Error::ReversedBounds { index: 0 }));
    assert_eq!(Interval::new(f64::NAN, 1.0), Err(Error::NotANumber { index: 0 }));
    assert_eq!(Interval::new(f64::INFINITY, f64::INFINITY), Err(Error::NoFinitePoint { index: 0 }));
    assert_eq!(Interval::new(f64::INFINITY, f64::NEG_INFINITY), Err(Error::ReversedBounds { index: 0 }));
}

#[test]
fn midpoint_and_radius_cover_the_interval() {
    let mut random = Random(13);
    for _ in 0..20_000 {
        let x = random_interval(&mut random);
        let (m, r) = (x.midpoint(), x.radius());
        assert!(x.contains(m), "{x}");
        assert!(r == f64::INFINITY || (q(m) - q(r) <= q(x.lo()) && q(x.hi()) <= q(m) + q(r)), "{x}");
        assert!(x.width() == f64::INFINITY || q(x.hi()) - q(x.lo()) <= q(x.width()), "{x}");
    }
}

proptest! {
    #[test]
    fn inclusion_is_kept(a in -1e3..1e3_f64, b in 0.0..10.0_f64, c in -1e3..1e3_f64, d in 0.0..10.0_f64, s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
        let (x, y) = (Interval::new(a, a + b).unwrap(), Interval::new(c, c + d).unwrap());
        let inner = |v: Interval, s: f64| {
            let p = (v.lo() + s * v.width()).clamp(v.lo(), v.hi());
            Interval::new(p, v.hi()).unwrap()
        };
        let (p, r) = (inner(x, s), inner(y, t));
        prop_assert!((p + r).subset(x + y) && (p - r).subset(x - y) && (p * r).subset(x * y) && (p / r).subset(x / y));
        prop_assert!(p.square().subset(x.square()) && p.abs().subset(x.abs()) && p.signed_square().subset(x.signed_square()));
    }

    #[test]
    fn decimals_are_outward_and_read_back(bits in any::<u64>(), up in any::<bool>()) {
        let x = f64::from_bits(bits);
        prop_assume!(x.is_finite());
        let text = outward_decimal(x, up);
        prop_assert_eq!(text.parse::<f64>().unwrap(), x);
        let value = from_decimal(&text).unwrap();
        let outside = if up { value >= q(x) } else { value <= q(x) };
        prop_assert!(outside);
    }

    #[test]
    fn reading_encloses_the_decimal(digits in "-?[0-9]{1,25}(\\.[0-9]{1,25})?(e-?[0-9]{1,3})?") {
        let x: Interval = digits.parse().unwrap();
        let exact = from_decimal(&digits).unwrap();
        prop_assert!(is_down(x.lo(), &exact) && is_up(x.hi(), &exact));
    }

    #[test]
    fn text_never_panics(text in "\\PC{0,20}") {
        let _ = text.parse::<Interval>();
    }
}

#[test]
fn text_forms() {
    let read = |s: &str| s.parse::<Interval>();
    assert_eq!(read("[1, 2]"), Interval::new(1.0, 2.0));
    assert_eq!(read(" [ 1 ] "), Interval::point(1.0));
    assert_eq!(read("[empty]"), Ok(Interval::EMPTY));
    assert_eq!(read("[-inf, 3]"), Interval::new(f64::NEG_INFINITY, 3.0));
    assert_eq!(read("1e999").map(Interval::hi), Ok(f64::INFINITY));
    assert_eq!(read("1e999").map(Interval::lo), Ok(f64::MAX));
    assert_eq!(read("1e-999999999999").map(|x| (x.lo(), x.hi())), Ok((0.0, 5e-324)));
    assert_eq!(read("[2, 1]"), Err(Error::ReversedBounds { index: 0 }));
    // Too close for doubles, but still reversed.
    assert_eq!(read("[0.1000000000000000000001, 0.1]"), Err(Error::ReversedBounds { index: 0 }));
    for bad in ["", "[", "[1", "1]", "[a]", "[1, 2, 3]", "0x", "1e", "--1", ".", "[,]", "nan"] {
        assert!(matches!(read(bad), Err(Error::Text { .. })), "{bad}");
    }
}
