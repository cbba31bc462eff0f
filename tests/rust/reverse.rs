//! Reverse functions: every solution is kept, and the ends are the tightest ones.
//!
//! Tightness by the forward functions, which are compared with MPFR: between an end that is not the operand's and its
//! inner neighbour the function takes a value in `c`.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

mod common;

use common::Random;
use interval_core::Interval;

type Forward = fn(Interval) -> Interval;
type Reverse = fn(Interval, Interval) -> Interval;

const PAIRS: [(&str, Forward, Reverse); 10] = [
    ("sin", Interval::sin, Interval::sin_rev),
    ("cos", Interval::cos, Interval::cos_rev),
    ("tan", Interval::tan, Interval::tan_rev),
    ("cosh", Interval::cosh, Interval::cosh_rev),
    ("square", Interval::square, Interval::sqr_rev),
    ("abs", Interval::abs, Interval::abs_rev),
    ("cube", |x| x.powi(3), |c, x| c.powi_rev(x, 3)),
    ("power -2", |x| x.powi(-2), |c, x| c.powi_rev(x, -2)),
    ("power 1.7", |x| x.pow(exponent()), |c, x| exponent().pow_rev_base(c, x)),
    ("3^t", |t| base().pow(t), |c, t| base().pow_rev_exponent(c, t)),
];

fn exponent() -> Interval {
    Interval::point(1.7).expect("finite")
}

fn base() -> Interval {
    Interval::point(3.0).expect("finite")
}

fn ordered(a: f64, b: f64) -> Interval {
    Interval::new(a.min(b), a.max(b)).expect("ordered")
}

#[test]
fn solutions_are_kept_and_ends_are_tight() {
    examine(31, 6_000);
}

#[test]
#[ignore = "ten seconds of the mechanism above: make nightly"]
fn more_solutions_are_kept_and_ends_are_tight() {
    examine(32, 20_000);
}

/// Ends of operands from -20 to 20 and values from the range of a member, wide and down to points.
fn examine(seed: u64, cases: usize) {
    let mut random = Random(seed);
    for (name, forward, reverse) in PAIRS {
        let mut moved = 0;
        for _ in 0..cases {
            let size = f64::from(u8::try_from(random.bits() % 20).expect("small") + 1);
            let (t, u) = (size * random.unit(), size * random.unit());
            let x = ordered(t, u);
            let inside =
                ordered(0.3 * t + 0.7 * u, if random.bits().is_multiple_of(2) { t } else { 0.3 * t + 0.7 * u });
            let c = forward(inside);
            if c.is_empty() {
                continue;
            }
            let solutions = reverse(c, x);
            assert!(solutions.subset(x), "{name} {} {}", c.to_exact(), x.to_exact());
            let defined = if name == "power 1.7" { inside.intersection(ordered(0.0, 1e9)) } else { inside };
            assert!(defined.subset(solutions), "{name} {} {}", c.to_exact(), x.to_exact());
            for (end, inner, own) in [
                (solutions.lo(), solutions.lo().next_up(), solutions.lo() == x.lo()),
                (solutions.hi(), solutions.hi().next_down(), solutions.hi() == x.hi()),
            ] {
                if !own && end.is_finite() && end != 0.0 {
                    moved += 1;
                    let near = forward(ordered(end, inner));
                    assert!(!near.disjoint(c), "{name} {} {}: {}", c.to_exact(), x.to_exact(), solutions.to_exact());
                }
            }
        }
        assert!(moved > 1000, "{name}: only {moved} ends were put to the test");
    }
}

#[test]
fn what_has_no_solution_is_empty() {
    let (two, three) = (ordered(2.0, 2.0), ordered(3.0, 3.1));
    assert!(two.sin_rev(Interval::ENTIRE).is_empty());
    assert!((-two).sqr_rev(Interval::ENTIRE).is_empty());
    assert!(ordered(0.9, 0.95).sin_rev(three).is_empty());
    assert!(ordered(0.0, 0.0).powi_rev(Interval::ENTIRE, -2).is_empty());
    assert!(two.mul_rev(three, ordered(0.0, 1.0)).is_empty());
    assert_eq!(ordered(1.0, 1.0).sin_rev(Interval::ENTIRE), Interval::ENTIRE);
}

#[test]
fn branches_far_from_zero_are_found() {
    for k in [1.0, 7.0, 1e3, 1e6, 1e9, 1e15] {
        let x = ordered(k, k + 7.0);
        let crests = ordered(1.0, 1.0).sin_rev(x);
        assert!(!crests.is_empty() && crests.subset(x));
        assert_eq!(crests.sin().hi(), 1.0, "{k}");
    }
    // Beyond 4e18 neighbouring doubles lie many turns apart: the operand itself encloses.
    let huge = ordered(1e19, 2e19);
    assert_eq!(ordered(0.0, 0.5).cos_rev(huge), huge);
}

/// A tiny exponent overflows the quotient of logarithms on the way.
#[test]
fn tiny_exponents_lose_no_solution() {
    let point = |x: f64| Interval::point(x).expect("finite");
    let operand = ordered(3.0, 7.0);
    assert_eq!(point(1e-309).pow_rev_base(ordered(0.5, 2.0), operand), operand);
    let two = point(2.0);
    assert_eq!(point(1e-320).pow_rev_base(two, Interval::ENTIRE).lo(), f64::MAX);
    assert_eq!(point(-1e-320).pow_rev_base(two, Interval::ENTIRE), ordered(0.0, 5e-324));
    let beyond = ordered(0.0, 1e-323).pow_rev_base(ordered(1.698e10, 2.7e272), Interval::ENTIRE);
    assert_eq!((beyond.lo(), beyond.hi()), (f64::MAX, f64::INFINITY));
}

#[test]
fn ends_are_found_one_by_one_and_points_are_decided() {
    let far = ordered(0.9, 1.0).sin_rev(ordered(-1e19, 5.0));
    assert_eq!(far.lo(), -1e19);
    assert!(far.hi() > 2.02 && far.hi() < 2.03);
    let falling = ordered(0.0, 0.1).tan_rev(ordered(-5.0, 1e300));
    assert_eq!(falling.lo(), -std::f64::consts::PI.next_up());
    // sin 1e19 = -0.927
    let point = ordered(1e19, 1e19);
    assert!(ordered(0.5, 0.6).sin_rev(point).is_empty());
    assert_eq!(ordered(-1.0, 0.0).sin_rev(point), point);
    let third = ordered(1.0 / 3.0, 1.0 / 3.0);
    assert!(ordered(3.0, 3.0).mul_rev(Interval::ONE, third).is_empty());
    let half_line = Interval::new(1.0, f64::INFINITY).expect("a half line");
    assert!(half_line.mul_rev(ordered(1.0, 2.0), ordered(-1.0, 0.0)).is_empty());
    assert_eq!(ordered(2.0, 4.0).mul_rev(ordered(1.0, 2.0), Interval::ENTIRE), ordered(0.25, 1.0));
}

/// Points of boxes of both signs, with angles about 0, quarter turns and pi: both reverses keep the point, and an end that
/// is not the operand's has the angle of a member within one double.
#[test]
fn reverses_of_atan2_keep_every_point_and_are_tight() {
    let mut random = Random(41);
    let mut moved = [0; 2];
    for case in 0..6_000 {
        let mut side = |zero: bool| {
            let (a, b) = (random.unit(), random.unit());
            if zero { ordered(0.0, 3.0 * a) } else { ordered(3.0 * a, 3.0 * b) }
        };
        let (x, y) = (side(case % 5 == 0), side(case % 7 == 0));
        let mut member = |of: Interval, axis: bool| {
            if axis && of.contains(0.0) { 0.0 } else { of.lo() + (0.5 + 0.5 * random.unit()) * (of.hi() - of.lo()) }
        };
        let (s, t) = (member(x, case % 11 == 0), member(y, case % 13 == 0));
        let (s, t) = (s.clamp(x.lo(), x.hi()), t.clamp(y.lo(), y.hi()));
        if s == 0.0 && t == 0.0 {
            continue;
        }
        let angle = ordered(t, t).atan2(ordered(s, s));
        // As tight as the angle itself, or with room on either side or on both.
        let room = [0.0, 0.3, 2.0][case % 3];
        let c = ordered(angle.lo() - room * random.unit().abs(), angle.hi() + room * random.unit().abs());
        let (rows, columns) = (x.atan2_rev_y(c, y), y.atan2_rev_x(c, x));
        let name = format!("{} {} {}", x.to_exact(), y.to_exact(), c.to_exact());
        assert!(rows.subset(y) && rows.contains(t), "y: {name}: {t:e} {}", rows.to_exact());
        assert!(columns.subset(x) && columns.contains(s), "x: {name}: {s:e} {}", columns.to_exact());
        for (k, (found, own)) in [(rows, y), (columns, x)].into_iter().enumerate() {
            for (end, inner, given) in
                [(found.lo(), found.lo().next_up(), own.lo()), (found.hi(), found.hi().next_down(), own.hi())]
            {
                if end != given && end != 0.0 {
                    moved[k] += 1;
                    let beside = ordered(end, inner);
                    let near = if k == 0 { beside.atan2(x) } else { y.atan2(beside) };
                    // Angles that c holds beyond a half turn are none.
                    assert!(!near.disjoint(c), "{k} {name}: {}", found.to_exact());
                }
            }
        }
    }
    assert!(moved.iter().all(|&count| count > 900), "{moved:?}");
}

#[test]
fn reverses_of_atan2_at_the_axes() {
    let point = |x: f64| Interval::point(x).expect("finite");
    let (positive, negative) = (ordered(1.0, 2.0), ordered(-2.0, -1.0));
    let (all, pi) = (Interval::ENTIRE, ordered(3.0, 4.0));
    // Angle 0 is the positive half of the axis alone, pi the negative one, and the origin has no angle.
    assert_eq!(positive.atan2_rev_y(point(0.0), all), point(0.0));
    assert!(negative.atan2_rev_y(point(0.0), all).is_empty());
    assert!(point(0.0).atan2_rev_y(point(0.0), all).is_empty());
    assert_eq!(
        point(0.0).atan2_rev_x(pi, all),
        ordered(-f64::MAX, 0.0).hull(Interval::new(f64::NEG_INFINITY, 0.0).expect("ordered"))
    );
    assert!(point(0.0).atan2_rev_x(pi, positive).is_empty());
    assert_eq!(point(0.0).atan2_rev_x(point(0.0), ordered(-1.0, 3.0)), ordered(0.0, 3.0));
    // No double is a right angle; both of its neighbours hold it.
    let right = ordered(std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2.next_up());
    assert_eq!(point(0.0).atan2_rev_y(right, ordered(-5.0, 5.0)), ordered(0.0, 5.0));
    assert!(point(0.0).atan2_rev_y(point(std::f64::consts::FRAC_PI_2), ordered(-5.0, 5.0)).is_empty());
    // Angles outside of a half turn either way are those of no point.
    assert!(all.atan2_rev_y(ordered(3.2, 9.0), all).is_empty() && all.atan2_rev_x(ordered(-9.0, -3.2), all).is_empty());
    assert_eq!(all.atan2_rev_y(all, all), all);
    // Tiny and huge operands.
    assert_eq!(point(5e-324).atan2_rev_y(point(5e-324), all), ordered(0.0, 5e-324));
    let huge = point(1e308).atan2_rev_x(point(1e-300), all);
    assert_eq!((huge.lo(), huge.hi()), (f64::MAX, f64::INFINITY));
    assert!(Interval::EMPTY.atan2_rev_y(all, all).is_empty() && all.atan2_rev_x(Interval::EMPTY, all).is_empty());
}
