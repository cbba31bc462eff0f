//! Every back end gives the bits of the scalar operators, on any operands and however a slice is cut.
//!
//! `IVSID_CASES` sets the number of operand pairs of an operation and back end (default 1e6 for arithmetic).
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "random bits are cut on purpose, counts are positive"
)]

mod common;

use common::Random;
use interval_core::rounding::slices::{
    Backend, Binary, Bounds, BoundsMut, Unary, binary_on_arrays, binary_with, unary, unary_on_arrays, unary_with,
};
use interval_core::{Error, Interval};

/// Intervals with the bounds that hurt: points, wide and unbounded ones, the empty one, zeros of both signs.
fn spicy_interval(random: &mut Random) -> Interval {
    let choice = random.bits();
    let (a, b) = (random.spicy(), random.spicy());
    let (lo, hi) = if a <= b { (a, b) } else { (b, a) };
    match choice % 32 {
        0 => Interval::EMPTY,
        1 => Interval::ENTIRE,
        2 => Interval::new(f64::NEG_INFINITY, hi).expect("a half line"),
        3 => Interval::new(lo, f64::INFINITY).expect("a half line"),
        4 => Interval::new(0.0, hi.abs()).expect("ordered"),
        5 => Interval::new(-hi.abs(), -0.0).expect("ordered"),
        6 => Interval::new(-0.0, 0.0).expect("ordered"),
        7..=11 => Interval::point(a).expect("finite"),
        12..=15 => Interval::new(a, a.next_up()).unwrap_or(Interval::ONE),
        16..=23 => {
            // Moderate numbers, where the fast paths run.
            let (a, b) = (random.unit(), random.unit());
            Interval::new(a.min(b), a.max(b)).expect("ordered")
        }
        _ => Interval::new(lo, hi).expect("ordered"),
    }
}

fn cases(default: usize) -> usize {
    std::env::var("IVSID_CASES").ok().and_then(|n| n.parse::<f64>().ok()).map_or(default, |n| n as usize)
}

fn split(x: &[Interval]) -> (Vec<f64>, Vec<f64>) {
    (x.iter().map(|v| v.lo()).collect(), x.iter().map(|v| v.hi()).collect())
}

fn bits(x: Interval) -> (u64, u64) {
    (x.lo().to_bits(), x.hi().to_bits())
}

const BLOCK: usize = 10_007;

/// Fewer cases where each costs a transcendental function, and fewer still of those that are made of others' kernels.
fn share(name: &str, arithmetic: bool, all: usize) -> usize {
    match (arithmetic, RECOMMENDED.contains(&name)) {
        (true, _) => all,
        (_, false) => all / 20,
        (_, true) => all / 200,
    }
}

/// Functions of table 10.5 of IEEE 1788 and reciprocals.
const RECOMMENDED: [&str; 25] = [
    "exp_m1",
    "exp2_m1",
    "exp10_m1",
    "ln_1p",
    "log2_1p",
    "log10_1p",
    "cbrt",
    "rsqrt",
    "sin_pi",
    "cos_pi",
    "tan_pi",
    "asin_pi",
    "acos_pi",
    "atan_pi",
    "sec",
    "csc",
    "cot",
    "acot",
    "sech",
    "csch",
    "coth",
    "acoth",
    "atan2_pi",
    "hypot",
    "compound_m1",
];

fn available() -> Vec<Backend> {
    Backend::ALL.into_iter().filter(|b| b.is_available()).collect()
}

#[test]
fn one_operand() {
    for &op in Unary::ALL {
        let mut random = Random(11);
        let mut left = share(op.name(), op.is_arithmetic(), cases(1_000_000));
        while left > 0 {
            let x: Vec<Interval> = (0..BLOCK.min(left)).map(|_| spicy_interval(&mut random)).collect();
            left -= x.len();
            let scalars: Vec<_> = x.iter().map(|&operand| bits(op.scalar()(operand))).collect();
            let (lo, hi) = split(&x);
            for backend in available() {
                let (mut low, mut high) = (vec![0.0; x.len()], vec![0.0; x.len()]);
                let bounds = Bounds::new(&lo, &hi).expect("sound bounds");
                unary_with(backend, op, bounds, BoundsMut { lo: &mut low, hi: &mut high }).expect("equal lengths");
                for (i, &scalar) in scalars.iter().enumerate() {
                    let given = (low[i].to_bits(), high[i].to_bits());
                    assert_eq!(given, scalar, "{backend:?} {} {}", op.name(), x[i].to_exact());
                }
            }
        }
    }
}

#[test]
fn two_operands() {
    for &op in Binary::ALL {
        let mut random = Random(12);
        let mut left = share(op.name(), op.is_arithmetic(), cases(1_000_000));
        while left > 0 {
            let n = BLOCK.min(left);
            left -= n;
            let x: Vec<Interval> = (0..n).map(|_| spicy_interval(&mut random)).collect();
            let y: Vec<Interval> = (0..n).map(|_| spicy_interval(&mut random)).collect();
            let scalars: Vec<_> = x.iter().zip(&y).map(|(&x, &y)| bits(op.scalar()(x, y))).collect();
            let ((a, b), (c, d)) = (split(&x), split(&y));
            for backend in available() {
                let (mut low, mut high) = (vec![0.0; n], vec![0.0; n]);
                let (left, right) = (Bounds::new(&a, &b).expect("sound"), Bounds::new(&c, &d).expect("sound"));
                let out = BoundsMut { lo: &mut low, hi: &mut high };
                binary_with(backend, op, left, right, out).expect("equal lengths");
                for (i, &scalar) in scalars.iter().enumerate() {
                    let given = (low[i].to_bits(), high[i].to_bits());
                    let operands = || (x[i].to_exact(), y[i].to_exact());
                    assert_eq!(given, scalar, "{backend:?} {} {:?}", op.name(), operands());
                }
            }
        }
    }
}

type Way = fn(Bounds, Bounds, BoundsMut) -> Result<(), Error>;

/// Every way in refuses results and operands of other lengths, the ways of the tests as well.
#[test]
fn other_lengths_are_refused() {
    let (ends, short) = ([1.0, 2.0, 3.0], [1.0, 2.0]);
    let of = |x| Bounds::new(x, x).expect("sound");
    let ways: [Way; 4] = [
        |x, _, out| unary_with(Backend::Portable, Unary::Sqrt, x, out),
        |x, _, out| unary_on_arrays(Unary::Sqrt, x, out),
        |x, y, out| binary_with(Backend::Portable, Binary::Add, x, y, out),
        |x, y, out| binary_on_arrays(Binary::Add, x, y, out),
    ];
    let refused = |way: usize, right: &[f64], lower: usize, upper: usize| {
        let (mut low, mut high) = (vec![0.0; lower], vec![0.0; upper]);
        let given =
            ways[way](of(&ends), Bounds::new(right, right).expect("sound"), BoundsMut { lo: &mut low, hi: &mut high });
        matches!(given, Err(Error::Shape { .. }))
    };
    for way in 0..4 {
        assert!(!refused(way, &ends, 3, 3), "equal lengths, way {way}");
        for (lower, upper) in [(2, 3), (3, 2), (4, 3), (0, 0)] {
            assert!(refused(way, &ends, lower, upper), "results of {lower} and {upper}, way {way}");
        }
    }
    assert!(refused(2, &short, 3, 3) && refused(3, &short, 3, 3), "operands of other lengths");
}

/// All pairs of bounds from a short list, as first and as second operands, in every lane of a block.
#[test]
fn corners_in_every_lane() {
    let inf = f64::INFINITY;
    let ends =
        [-inf, -f64::MAX, -1.5, -f64::MIN_POSITIVE, -5e-324, -0.0, 0.0, 5e-324, 1e-300, 1.0, 3.0, 1e200, f64::MAX, inf];
    let mut all = vec![Interval::EMPTY];
    for a in ends {
        all.extend(ends.iter().filter_map(|&b| Interval::new(a, b).ok()));
    }
    for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
        for &op in &Binary::ALL[..8] {
            for &y in &all {
                // A quiet neighbourhood keeps the fast path alive up to the lane that matters.
                for shift in 0..3 {
                    let x: Vec<Interval> = (0..shift).map(|_| Interval::ONE).chain(all.iter().copied()).collect();
                    let ((a, b), (c, d)) = (split(&x), split(&vec![y; x.len()]));
                    let (mut low, mut high) = (vec![0.0; x.len()], vec![0.0; x.len()]);
                    let (left, right) = (Bounds::new(&a, &b).expect("sound"), Bounds::new(&c, &d).expect("sound"));
                    let out = BoundsMut { lo: &mut low, hi: &mut high };
                    binary_with(backend, op, left, right, out).expect("equal lengths");
                    for (i, &operand) in x.iter().enumerate() {
                        let given = (low[i].to_bits(), high[i].to_bits());
                        let scalar = op.scalar()(operand, y);
                        let text = (operand.to_exact(), y.to_exact());
                        assert_eq!(given, bits(scalar), "{backend:?} {} {text:?}: {scalar}", op.name());
                    }
                }
            }
        }
    }
}

#[test]
fn bad_bounds_are_refused_with_their_place() {
    let inf = f64::INFINITY;
    let cases = [
        (f64::NAN, 3.0, Error::NotANumber { index: 37 }),
        (1.0, f64::NAN, Error::NotANumber { index: 37 }),
        (3.0, 2.0, Error::ReversedBounds { index: 37 }),
        (inf, inf, Error::NoFinitePoint { index: 37 }),
        (-inf, -inf, Error::NoFinitePoint { index: 37 }),
    ];
    for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
        for n in [38, 64, 100] {
            for (lo, hi, cause) in &cases {
                let (good_lo, good_hi) = (vec![1.0; n], vec![2.0; n]);
                let (mut bad_lo, mut bad_hi) = (good_lo.clone(), good_hi.clone());
                (bad_lo[37], bad_hi[37]) = (*lo, *hi);
                let good = Bounds::new(&good_lo, &good_hi).expect("equal lengths");
                let bad = Bounds::new(&bad_lo, &bad_hi).expect("equal lengths");
                let (mut low, mut high) = (vec![0.0; n], vec![0.0; n]);
                for op in Binary::ALL {
                    for (x, y) in [(good, bad), (bad, good)] {
                        let out = BoundsMut { lo: &mut low, hi: &mut high };
                        let refused = binary_with(backend, *op, x, y, out);
                        assert_eq!(refused.as_ref().err(), Some(cause), "{backend:?} {}", op.name());
                    }
                }
                for op in Unary::ALL {
                    let refused = unary_with(backend, *op, bad, BoundsMut { lo: &mut low, hi: &mut high });
                    assert_eq!(refused.as_ref().err(), Some(cause), "{backend:?} {}", op.name());
                }
            }
        }
    }
    assert!(Bounds::new(&[1.0], &[]).is_err());
}

#[test]
fn long_slices_on_several_threads_give_the_same_bits_and_name_the_first_refusal() {
    let n = 300_001;
    let mut random = Random(13);
    let x: Vec<Interval> = (0..n).map(|_| spicy_interval(&mut random)).collect();
    let (mut lo, hi) = split(&x);
    let run = |lo: &[f64], op: Unary| {
        let (mut low, mut high) = (vec![0.0; n], vec![0.0; n]);
        let bounds = Bounds::new(lo, &hi).expect("equal lengths");
        unary(op, bounds, BoundsMut { lo: &mut low, hi: &mut high }).map(|()| (low, high))
    };
    for op in [Unary::Square, Unary::Exp] {
        let (low, high) = run(&lo, op).expect("sound bounds");
        assert!((0..n).all(|i| (low[i].to_bits(), high[i].to_bits()) == bits(op.scalar()(x[i]))));
    }
    (lo[200_000], lo[299_999]) = (f64::NAN, f64::NAN);
    for op in [Unary::Square, Unary::Exp] {
        assert_eq!(run(&lo, op).err(), Some(Error::NotANumber { index: 200_000 }));
    }
}

/// The door asks the processor: under upward rounding, or with subnormal numbers flushed, nothing is computed.
#[cfg(target_arch = "x86_64")]
#[test]
#[expect(unsafe_code, reason = "the control register is changed and restored, with only the call in between")]
fn a_changed_rounding_mode_is_refused() {
    const UPWARD: u32 = 0x4000;
    const FLUSH_TO_ZERO: u32 = 0x8000;
    const DENORMALS_ARE_ZERO: u32 = 0x0040;
    let (lo, hi) = ([1.0], [2.0]);
    let x = Bounds::new(&lo, &hi).expect("equal lengths");
    for change in [0, UPWARD, 0x2000, 0x6000, FLUSH_TO_ZERO, DENORMALS_ARE_ZERO] {
        let (mut low, mut high) = ([0.0], [0.0]);
        let (mut old, mut new) = (0_u32, 0_u32);
        unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut old) };
        new |= old | change;
        unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const new) };
        let result = unary_with(Backend::Portable, Unary::Square, x, BoundsMut { lo: &mut low, hi: &mut high });
        unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const old) };
        assert_eq!(result, if change == 0 { Ok(()) } else { Err(Error::Environment) }, "{change:x}");
    }
}

#[test]
fn names_go_both_ways() {
    assert!(Unary::ALL.iter().all(|op| Unary::from_name(op.name()) == Some(*op)));
    assert!(Binary::ALL.iter().all(|op| Binary::from_name(op.name()) == Some(*op)));
    assert_eq!(Unary::from_name("cube"), None);
}

/// The arrays of other architectures, on this one: the bits of the scalar operators on all pairs of hard bounds.
#[test]
fn arrays_of_other_architectures() {
    let inf = f64::INFINITY;
    let ends = [-inf, -f64::MAX, -1.5, -1e-300, -5e-324, -0.0, 0.0, f64::MIN_POSITIVE, 0.1, 3.0, 1e200, f64::MAX, inf];
    let mut x = vec![Interval::EMPTY; 3];
    for a in ends {
        x.extend(ends.iter().filter_map(|&b| Interval::new(a, b).ok()));
    }
    x.extend([Interval::new(1.0, 1.1).expect("ordered"); 8]);
    let (lo, hi) = split(&x);
    let (mut low, mut high) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    let bounds = Bounds::new(&lo, &hi).expect("equal lengths");
    for op in [Unary::Neg, Unary::Abs, Unary::Square, Unary::Sqrt] {
        unary_on_arrays(op, bounds, BoundsMut { lo: &mut low, hi: &mut high }).expect("sound bounds");
        for (i, &operand) in x.iter().enumerate() {
            assert_eq!((low[i].to_bits(), high[i].to_bits()), bits(op.scalar()(operand)), "{} {operand}", op.name());
        }
    }
    for shift in 0..x.len() {
        let mut y = x.clone();
        y.rotate_left(shift);
        let (c, d) = split(&y);
        let other = Bounds::new(&c, &d).expect("equal lengths");
        for &op in &Binary::ALL[..8] {
            binary_on_arrays(op, bounds, other, BoundsMut { lo: &mut low, hi: &mut high }).expect("sound bounds");
            for (i, (&first, &second)) in x.iter().zip(&y).enumerate() {
                let scalar = op.scalar()(first, second);
                assert_eq!((low[i].to_bits(), high[i].to_bits()), bits(scalar), "{} {first} {second}", op.name());
            }
        }
    }
}

/// Numbers about which the vector kernels of elementary functions change their ways: ends of their ranges, multiples of
/// a quarter turn, entries of tables and halves between them; and ordinary ones of every size.
fn about_kernels(random: &mut Random) -> f64 {
    const PLACES: [f64; 12] = [
        -745.2,
        -708.4,
        -707.0,
        708.0,
        709.78,
        134_217_728.0,
        5.6e-17,
        7.5e-9,
        1.0,
        1.406_25,
        f64::MIN_POSITIVE,
        f64::MAX,
    ];
    let bits = random.bits();
    let sign = if bits & 1 == 0 { 1.0 } else { -1.0 };
    let steps = ((bits >> 1) % 2048) as f64 - 1024.0;
    let near = |x: f64| x * (steps * f64::EPSILON).mul_add(if bits >> 60 < 8 { 1.0 } else { 1e9 }, 1.0);
    let x = match (bits >> 16) % 8 {
        0 => sign * near(PLACES[((bits >> 20) % 12) as usize]),
        1 => near(((bits >> 20) % 4096) as f64 - 2048.0) * std::f64::consts::FRAC_PI_2,
        2 => sign * near(((bits >> 20) % 256) as f64 / 256.0),
        3 => near(((bits >> 20) % 65_536) as f64 - 32_768.0) * (std::f64::consts::LN_2 / 128.0),
        4 => sign * random.unit() * 2_f64.powi(((bits >> 20) % 90) as i32 - 60),
        5 => random.unit() * 710.0,
        _ => random.unit() * 8.0,
    };
    x.clamp(-f64::MAX, f64::MAX)
}

/// Elementary functions that have kernels for vectors, where these are at work: the bits of one interval at a time.
#[test]
fn kernels_of_elementary_functions() {
    let all = cases(1_000_000) / 25;
    for op in [Unary::Exp, Unary::Ln, Unary::Sin, Unary::Cos, Unary::Tan] {
        let mut random = Random(17);
        let mut left = all;
        while left > 0 {
            let n = BLOCK.min(left);
            left -= n;
            let x: Vec<Interval> = (0..n)
                .map(|_| {
                    let (a, width) = (about_kernels(&mut random), random.unit());
                    let b = match random.bits() % 4 {
                        0 => a,
                        1 => a.next_up().min(f64::MAX),
                        2 => (a + 2.0 * width.abs()).min(f64::MAX),
                        _ => about_kernels(&mut random),
                    };
                    // Half of the arguments of the logarithm would have none.
                    let (a, b) = if op == Unary::Ln { (a.abs(), b.abs()) } else { (a, b) };
                    Interval::new(a.min(b), a.max(b)).expect("ordered")
                })
                .collect();
            let (lo, hi) = split(&x);
            let scalars: Vec<_> = x.iter().map(|&operand| bits(op.scalar()(operand))).collect();
            for backend in available() {
                let (mut low, mut high) = (vec![0.0; n], vec![0.0; n]);
                let bounds = Bounds::new(&lo, &hi).expect("sound bounds");
                unary_with(backend, op, bounds, BoundsMut { lo: &mut low, hi: &mut high }).expect("equal lengths");
                for (i, &scalar) in scalars.iter().enumerate() {
                    let given = (low[i].to_bits(), high[i].to_bits());
                    assert_eq!(given, scalar, "{backend:?} {} {}", op.name(), x[i].to_exact());
                }
            }
        }
    }
}
