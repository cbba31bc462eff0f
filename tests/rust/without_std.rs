//! The crate without the standard library: its own square roots, fused products and integers give the bits of the
//! library's, its tables are those of the ball arithmetic, and every function has the same bits in both builds.
//!
//! `make no-std` runs this file without `std` as well. The digests of `bits.txt` are those of both builds; with
//! `IVSID_WRITE=1` the tables and the digests are written anew.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::type_complexity,
    reason = "counts, and a table of functions"
)]
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

use interval_core::rounding::slices::{Binary, Unary};
use interval_core::software::Real;
use interval_core::{DecoratedInterval, Interval, reductions, rounding, tables_source};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// `SplitMix64`.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Any double, one of moderate size, one with few bits, or one from a place where rounding goes wrong.
    fn double(&mut self) -> f64 {
        const PLACES: [f64; 12] =
            [0.0, -0.0, 1.0, 0.5, f64::MAX, f64::MIN_POSITIVE, 5e-324, f64::INFINITY, 2.5, 4.5e15, 1e-300, 1.4e154];
        let bits = self.bits();
        let moderate = f64::from_bits((bits & !(0x7ff << 52)) | ((1003 + (bits >> 7) % 60) << 52));
        match bits % 5 {
            0 => f64::from_bits(bits.rotate_left(17)),
            1 => PLACES[(bits >> 10) as usize % PLACES.len()] * if bits >> 63 == 0 { 1.0 } else { -1.0 },
            2 => f64::from_bits(moderate.to_bits() & !((1 << (20 + (bits >> 20) % 32)) - 1)),
            _ => moderate,
        }
    }

    fn number(&mut self) -> f64 {
        loop {
            let x = self.double();
            if !x.is_nan() {
                return x;
            }
        }
    }

    fn interval(&mut self) -> Interval {
        let (a, b) = (self.number(), self.number());
        match self.bits() % 8 {
            0 => Interval::EMPTY,
            // Narrow ones: the last resort settles most of them.
            1..=4 => {
                let width = if self.bits() % 2 == 0 { a.abs() * 1e-9 } else { 0.0 };
                Interval::new(a, a + width).unwrap_or(Interval::ONE)
            }
            _ => Interval::new(a.min(b), a.max(b)).unwrap_or(Interval::ENTIRE),
        }
    }
}

/// A number of operations, from `IVSID_CASES`.
fn cases(usual: usize) -> usize {
    std::env::var("IVSID_CASES").map_or(usual, |text| text.parse::<f64>().expect("IVSID_CASES is a number") as usize)
}

/// Bits in which every NaN is the same number, and no NaN: the compiler takes one NaN for another.
fn bits(x: f64) -> u64 {
    if x.is_nan() { 1 } else { x.to_bits() }
}

#[test]
fn operations_in_integers_have_the_bits_of_the_library() {
    let mut random = Random(71);
    for _ in 0..cases(200_000) {
        let (a, b, c) = (random.double(), random.double(), random.double());
        let same = |name: &str, ours: f64, theirs: f64| {
            assert_eq!(bits(ours), bits(theirs), "{name} of {a:e}, {b:e}, {c:e}: {ours:e} for {theirs:e}");
        };
        same("sqrt", Real::sqrt(a), f64::sqrt(a));
        same("mul_add", Real::mul_add(a, b, c), f64::mul_add(a, b, c));
        // Sums that cancel, to nothing or nearly so.
        let near = -(a * b);
        same("mul_add", Real::mul_add(a, b, near), f64::mul_add(a, b, near));
        let beside = f64::from_bits(near.to_bits() ^ (c.to_bits() & 3));
        same("mul_add", Real::mul_add(a, b, beside), f64::mul_add(a, b, beside));
        same("floor", Real::floor(a), f64::floor(a));
        same("ceil", Real::ceil(a), f64::ceil(a));
        same("trunc", Real::trunc(a), f64::trunc(a));
        same("round", Real::round(a), f64::round(a));
        same("round_ties_even", Real::round_ties_even(a), f64::round_ties_even(a));
        same("fract", Real::fract(a), f64::fract(a));
    }
}

#[test]
fn halves_and_squares_are_rounded_as_the_library_does() {
    for k in -4000..4000 {
        let x = f64::from(k) / 4.0;
        for (ours, theirs) in [
            (Real::round(x), f64::round(x)),
            (Real::round_ties_even(x), f64::round_ties_even(x)),
            (Real::floor(x), f64::floor(x)),
            (Real::ceil(x), f64::ceil(x)),
            (Real::sqrt(x * x), x.abs()),
            (Real::sqrt((x * x).next_up()), f64::sqrt((x * x).next_up())),
        ] {
            assert_eq!(ours.to_bits(), theirs.to_bits(), "{x}");
        }
    }
    for k in 0..1074 {
        // Products that end below the smallest double, about a tie.
        let (a, b) = (f64::from_bits(1 << (k % 52)), 0.5_f64.powi(k % 60) * 1.5);
        let c = f64::from_bits(u64::try_from(k).unwrap_or(0));
        assert_eq!(Real::mul_add(a, b, c).to_bits(), f64::mul_add(a, b, c).to_bits(), "{k}");
    }
}

fn here(path: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

fn writes() -> bool {
    std::env::var_os("IVSID_WRITE").is_some()
}

#[test]
fn tables_are_those_of_the_ball_arithmetic() {
    let path = here("crates/interval-core/src/elementary/tables/values.rs");
    let text = fs::read_to_string(&path).expect("the tables");
    let (head, _) = text.split_once("= [").expect("an array");
    let computed = format!("{head}= [{}\n];\n", tables_source());
    if writes() {
        fs::write(&path, &computed).expect("the tables");
    }
    assert!(text == computed, "other tables: run with IVSID_WRITE=1, and ask why they changed");
}

/// Fowler, Noll and Vo's hash of 64 bits.
struct Digest(u64);

impl Digest {
    fn add(&mut self, x: u64) {
        for byte in x.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn interval(&mut self, x: Interval) {
        self.add(x.lo().to_bits());
        self.add(x.hi().to_bits());
    }

    fn text(&mut self, x: &str) {
        x.bytes().for_each(|b| self.add(b.into()));
    }
}

/// The digest of what a function makes of 300 draws, which begin anew for every function.
fn digest(name: &str, into: &mut String, f: impl Fn(&mut Random, &mut Digest)) {
    let (mut random, mut digest) = (Random(5), Digest(0xcbf2_9ce4_8422_2325));
    for _ in 0..300 {
        f(&mut random, &mut digest);
    }
    let _ = writeln!(into, "{name} {:016x}", digest.0);
}

#[test]
fn every_function_has_the_same_bits_with_and_without_the_standard_library() {
    let mut found = String::new();
    let out = &mut found;
    for op in Unary::ALL {
        digest(op.name(), out, |r, d| d.interval(op.scalar()(r.interval())));
    }
    for op in Binary::ALL {
        digest(op.name(), out, |r, d| d.interval(op.scalar()(r.interval(), r.interval())));
    }
    digest("fma", out, |r, d| d.interval(r.interval().mul_add(r.interval(), r.interval())));
    digest("powi", out, |r, d| {
        let n = i32::try_from(r.bits() % 41).unwrap_or(0) - 20;
        d.interval(r.interval().powi(n));
    });
    digest("rootn", out, |r, d| {
        let n = i32::try_from(r.bits() % 13).unwrap_or(0) - 6;
        d.interval(r.interval().rootn(if n == 0 { 7 } else { n }));
    });
    let reverses: [(&str, fn(Interval, Interval) -> Interval); 4] = [
        ("sin_rev", Interval::sin_rev),
        ("cos_rev", Interval::cos_rev),
        ("tan_rev", Interval::tan_rev),
        ("cosh_rev", Interval::cosh_rev),
    ];
    for (name, f) in reverses {
        digest(name, out, |r, d| d.interval(f(r.interval(), r.interval())));
    }
    digest("directed", out, |r, d| {
        let (a, b, c) = (r.number(), r.number(), r.number());
        for x in
            [rounding::fma_up(a, b, c), rounding::fma_down(a, b, c), rounding::mul_up(a, b), rounding::div_down(a, b)]
        {
            d.add(bits(x));
        }
    });
    digest("sums", out, |r, d| {
        let (x, y): (Vec<f64>, Vec<f64>) = (0..7).map(|_| (r.double(), r.double())).unzip();
        for s in [reductions::sum(&x), reductions::sum_abs(&x), reductions::sum_square(&x), reductions::dot(&x, &y)] {
            d.add(bits(s));
        }
    });
    digest("text", out, |r, d| {
        let x = r.interval();
        d.text(&x.to_string());
        d.text(&format!("{x:?}{}", x.to_exact()));
        d.interval(x.to_string().parse().expect("a literal that was written"));
        let read = format!("{}.{}e{}", r.bits() % 1000, r.bits(), r.bits() % 60).parse::<Interval>();
        d.interval(read.expect("a decimal number"));
    });
    digest("decorated", out, |r, d| {
        let decorated = |r: &mut Random| DecoratedInterval::from(r.interval());
        let x = decorated(r).sqrt() + decorated(r).floor();
        d.text(&x.to_string());
    });
    let path = here("tests/rust/bits.txt");
    if writes() {
        fs::write(&path, &*out).expect("the digests");
    }
    let known = fs::read_to_string(&path).expect("the digests");
    for (ours, theirs) in out.lines().zip(known.lines()) {
        assert_eq!(ours, theirs, "a function and the digest of its bits");
    }
    assert_eq!(out.lines().count(), known.lines().count());
}
