//! Intervals: containment for members, tightness of the ends, sets, text.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::items_after_statements,
    reason = "test data are small numbers"
)]

mod common;

use common::{Random, is_down, is_up, q};
use interval_core::exact::{from_text, outward_decimal};
use interval_core::reductions::sum_intervals;
use interval_core::rounding::slices::{Binary, Unary};
use interval_core::{DecoratedInterval, Decoration, Error, Interval};
use num_bigint::BigInt;
use num_rational::BigRational;
use proptest::prelude::*;

const PIECES: [&str; 34] = [
    "[",
    "]",
    ",",
    "?",
    "??",
    "u",
    "d",
    "e",
    "E3",
    "e-400",
    "e99999",
    "0x",
    "0X1.8p-3",
    "p+3",
    "1",
    "10",
    "0.1",
    "-",
    "+",
    "/",
    "1/3",
    ".",
    "inf",
    "-INF",
    "nai",
    "empty",
    "Entire",
    "_com",
    "_dac",
    "_ill",
    " ",
    "\t",
    "9007199254740993",
    "\u{e9}",
];

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
        let value = from_text(&text).unwrap();
        let outside = if up { value >= q(x) } else { value <= q(x) };
        prop_assert!(outside);
    }

    #[test]
    fn reading_encloses_the_decimal(digits in "-?[0-9]{1,25}(\\.[0-9]{1,25})?(e-?[0-9]{1,3})?") {
        let x: Interval = digits.parse().unwrap();
        let exact = from_text(&digits).unwrap();
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
    assert_eq!(read("[,]"), Ok(Interval::ENTIRE));
    assert_eq!(read("[0x1.8p1, 22/7]").map(Interval::lo), Ok(3.0));
    assert_eq!(read("-10?2ue1"), Interval::new(-100.0, -80.0));
    for bad in [
        "",
        "[",
        "[1",
        "1]",
        "[a]",
        "[1, 2, 3]",
        "0x",
        "1e",
        "--1",
        ".",
        "nan",
        "[1/0]",
        "[2/-3]",
        "1?2x",
        "[nai]",
        "[1,2]_com",
        "5?e",
    ] {
        assert!(matches!(read(bad), Err(Error::Text { .. })), "{bad}");
    }
}

#[test]
fn literals_far_outside_the_range_are_read() {
    let read = |s: &str| s.parse::<Interval>();
    let tiny = Interval::new(0.0, 5e-324);
    for valid in ["[2e-5500, 1e-5400]", "[0x2p-30000, 0x1p-29000]", "[2e-25500, 1e-25400]"] {
        assert_eq!(read(valid), tiny, "{valid}");
    }
    assert_eq!(read("[2e5400, 1e5500]"), Interval::new(f64::MAX, f64::INFINITY));
    assert_eq!(read("[-1e5400, -2e5300]"), Interval::new(f64::NEG_INFINITY, f64::MIN));
    assert_eq!(read("[1e-5500, 1e-6000]"), Err(Error::ReversedBounds { index: 0 }));
    assert!(read("[1e999999999999999999999, 1]").is_err());
}

#[test]
fn a_zero_is_never_negative() {
    for text in ["-1e-400", "[-0, -0]", "-0.0", "[-1, -0]", "-0?"] {
        let x: Interval = text.parse().unwrap();
        assert!(x.hi() != 0.0 || x.hi().is_sign_positive(), "{text}");
        assert!(x.lo() != 0.0 || x.lo().is_sign_positive(), "{text}");
    }
    let one = Interval::ONE;
    for x in [sum_intervals(&[]), sum_intervals(&[one, -one]), one - one, -Interval::ZERO, (-one).powi(2) - one] {
        assert!(x.hi() != 0.0 || x.hi().is_sign_positive());
    }
}

/// Two fractions of neighbouring Fibonacci numbers agree in thousands of terms of their continued fractions.
#[test]
fn long_fractions_are_compared_on_a_small_stack() {
    let mut pair = (BigInt::from(1), BigInt::from(1));
    let mut numbers = Vec::new();
    for k in 0..19_000 {
        pair = (pair.1.clone(), &pair.0 + &pair.1);
        if k >= 18_996 {
            numbers.push(pair.0.to_string());
        }
    }
    let text = format!("[{}/{}, {}/{}]", numbers[0], numbers[1], numbers[2], numbers[3]);
    let small = std::thread::Builder::new().stack_size(256 * 1024);
    let read = small.spawn(move || text.parse::<Interval>()).unwrap().join().unwrap();
    assert!(read.is_ok() || read == Err(Error::ReversedBounds { index: 0 }));
}

proptest! {
    /// Near-literals made of the pieces of the grammar: refused or read, never a panic, and printed as what reads back.
    #[test]
    fn pieces_of_literals_never_panic(pieces in prop::collection::vec(prop::sample::select(PIECES.to_vec()), 0..12)) {
        let text = pieces.concat();
        if let Ok(x) = text.parse::<Interval>() {
            // Decimals are outward, and reading them is outward again: at most one step, while hexadecimals are exact.
            let read: Interval = x.to_string().parse().unwrap();
            prop_assert!(x.subset(read) && read.lo() >= x.lo().next_down() && read.hi() <= x.hi().next_up() || x.is_empty());
            prop_assert_eq!(x.to_exact().parse::<Interval>(), Ok(x));
        }
        if let Ok(x) = text.parse::<DecoratedInterval>() {
            let read: DecoratedInterval = x.to_string().parse().unwrap();
            prop_assert!(read.decoration() == x.decoration());
        }
    }

    /// Inclusion isotonicity: parts of the operands give parts of the result, for every operation.
    #[test]
    fn parts_give_parts(seed: u64) {
        let mut random = Random(seed);
        let (x, y) = (random_interval(&mut random), random_interval(&mut random));
        let part = |v: Interval, random: &mut Random| {
            let inside = |t: f64| t.clamp(v.lo().max(f64::MIN), v.hi().min(f64::MAX));
            let (a, b) = (inside(random.spicy()), inside(v.midpoint() * (1.0 + random.unit() * 1e-3)));
            Interval::new(a.min(b), a.max(b)).expect("ordered")
        };
        let (u, v) = (part(x, &mut random), part(y, &mut random));
        for op in Unary::ALL {
            prop_assert!(op.scalar()(u).subset(op.scalar()(x)), "{} {u} {x}", op.name());
        }
        for op in Binary::ALL {
            // Cancellation is not a function of members.
            if !matches!(op, Binary::CancelMinus | Binary::CancelPlus | Binary::Intersection) {
                prop_assert!(op.scalar()(u, v).subset(op.scalar()(x, y)), "{} {u} {v} {x} {y}", op.name());
            }
        }
    }

    /// A decoration never grows, whatever the operation.
    #[test]
    fn decorations_never_grow(seed: u64, rank in 1..5_usize) {
        let mut random = Random(seed);
        let (x, y) = (random_interval(&mut random), random_interval(&mut random));
        let ranks = [Decoration::Ill, Decoration::Trv, Decoration::Def, Decoration::Dac, Decoration::Com];
        let (x, y) = (DecoratedInterval::new(x, ranks[rank]), DecoratedInterval::from(y));
        for z in [x + y, x - y, x * y, x / y, x.pow(y), x.atan2(y), x.sqrt(), x.ln(), x.tan(), x.floor(), x.acosh()] {
            prop_assert!(z.decoration() <= x.decoration());
            prop_assert!(z.decoration() > Decoration::Ill);
        }
        prop_assert!((DecoratedInterval::NAI * x).is_nai() && x.max(DecoratedInterval::NAI).is_nai());
    }

    /// Numbers that a reverse operation leaves out do not solve the equation; numbers that solve it stay in.
    #[test]
    fn reverse_operations_keep_the_solutions(seed: u64) {
        let mut random = Random(seed);
        let t = 8.0 * random.unit();
        let width = |random: &mut Random| 2.0_f64.powi(-i32::try_from(random.bits() % 20).unwrap());
        let x = Interval::new(t - width(&mut random), t + width(&mut random)).expect("ordered");
        let point = Interval::point(t).expect("finite");
        prop_assert!(point.sin().sin_rev(x).contains(t));
        prop_assert!(point.cos().cos_rev(x).contains(t));
        prop_assert!(point.tan().tan_rev(x).contains(t));
        prop_assert!(point.cosh().cosh_rev(x).contains(t));
        prop_assert!(point.square().sqr_rev(x).contains(t));
        for n in [-5, -2, -1, 1, 2, 3, 8] {
            prop_assert!(point.powi(n).powi_rev(x, n).contains(t), "{n}");
        }
        let y = Interval::point(random.unit()).expect("finite");
        let base = point.abs();
        prop_assert!(y.pow_rev_base(base.pow(y), x.abs()).contains(base.lo()));
        prop_assert!(base.pow_rev_exponent(base.pow(y), y).contains(y.lo()));
    }
}
