//! Exact hulls and tight enclosures: containment against exact members, tightness apart.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "test data are small numbers")]

mod common;

use common::matrices::{METHODS, Method, by_cells, families, is_tight, matrix, relative, vertex_hull};
use common::{Random, columns_of_inverse, invert, q};
use interval_core::inverse::{
    Certificate, Outcome, batch, exact, exact_batch, exact_by_vertices, hansen_bliek_rohn, kuttler, partitioned,
};
use interval_core::regularity::Witness;
use interval_core::{Error, Interval, IntervalMatrix, Status, systems};
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// A member with every entry at an end or between them.
fn member(a: &IntervalMatrix, random: &mut Random) -> Vec<f64> {
    a.entries()
        .map(|e| match random.bits() % 3 {
            0 => e.lo(),
            1 => e.hi(),
            _ => e.midpoint(),
        })
        .collect()
}

/// Columns of exact inverses of members lie inside every enclosure; no method encloses where a member is singular.
#[test]
fn enclosures_hold_exact_members() {
    let mut random = Random(11);
    let mut enclosed = [0; METHODS.len()];
    // IVSID_CASES asks for the long run: more seeds and all families of order 50.
    let long = std::env::var("IVSID_CASES").is_ok();
    for n in [1, 2, 3, 4, 5, 7, 10, 13, 20, 50] {
        for seed in 0..if n > 10 {
            1
        } else if long {
            20
        } else {
            1
        } {
            for (name, a) in families(n, seed) {
                if n > 13 && !long && !["diagonally dominant", "singular", "badly scaled"].contains(&name) {
                    continue;
                }
                let outcomes: Vec<Option<Outcome>> = (METHODS.iter())
                    .map(|(method, run)| {
                        // The cost of three methods grows fast; one case of the order 10 is a test of its own.
                        let heavy = n > 20 && ["exact", "partitioned", "krawczyk"].contains(method);
                        let slowest = n == 10 && (name, *method) == SLOWEST && !long;
                        (!heavy && !slowest).then(|| run(&a).expect("square"))
                    })
                    .collect();
                for (count, proved) in enclosed.iter_mut().zip(certified(name, &a, &outcomes)) {
                    *count += usize::from(proved);
                }
                for _ in 0..if n < 10 { 6 } else { 1 } {
                    holds(name, &a, &outcomes, &mut random);
                }
            }
        }
    }
    assert!(enclosed.iter().all(|&count| count > 5), "{enclosed:?}");
}

/// The family and the method that take longest at the order 10.
const SLOWEST: (&str, &str) = ("wide", "partitioned");

#[test]
#[ignore = "nine seconds on two cores: make nightly"]
fn the_slowest_enclosure_holds_exact_members() {
    let (family, wanted) = SLOWEST;
    let (name, a) = families(10, 0).into_iter().find(|(name, _)| *name == family).expect("a family");
    let outcomes: Vec<Option<Outcome>> =
        METHODS.iter().map(|(method, run)| (*method == wanted).then(|| run(&a).expect("square"))).collect();
    certified(name, &a, &outcomes);
    holds(name, &a, &outcomes, &mut Random(11));
}

/// Which outcomes are proved; those have an enclosure, and certificates of small orders verify.
fn certified(name: &str, a: &IntervalMatrix, outcomes: &[Option<Outcome>]) -> Vec<bool> {
    let n = a.rows();
    let mut proved = vec![false; outcomes.len()];
    for (k, outcome) in outcomes.iter().enumerate() {
        let Some(outcome) = outcome else { continue };
        proved[k] = outcome.status == Status::Enclosed;
        assert_eq!(proved[k], outcome.enclosure().is_some(), "{name}, n = {n}");
        assert_eq!(outcome.status == Status::Singular || proved[k], outcome.certificate.is_some());
        if n <= 10
            && let Some(certificate) = &outcome.certificate
        {
            assert!(certificate.verify(a), "{name}, n = {n}, {}", METHODS[k].0);
        }
    }
    proved
}

/// Three columns of the exact inverse of a member lie inside every enclosure.
fn holds(name: &str, a: &IntervalMatrix, outcomes: &[Option<Outcome>], random: &mut Random) {
    let n = a.rows();
    let wanted = [0, n / 2, n - 1];
    let exactly: Vec<BigRational> = member(a, random).into_iter().map(q).collect();
    let columns = columns_of_inverse(&exactly, n, &wanted).1;
    for (k, outcome) in outcomes.iter().enumerate() {
        let Some(value) = outcome.as_ref().and_then(Outcome::enclosure) else { continue };
        let method = METHODS[k].0;
        let columns = columns.as_ref().unwrap_or_else(|| panic!("{method}, {name}: a singular member"));
        for (at, x) in columns.iter().enumerate() {
            let e = value.get(at / wanted.len(), wanted[at % wanted.len()]);
            assert!(q(e.lo()) <= *x && *x <= q(e.hi()), "{method}, {name}, n = {n}");
        }
    }
}

#[test]
fn exact_and_partitioned_are_the_hull() {
    let mut met = 0;
    for n in 1..=5 {
        for seed in 30..if n < 4 { 33 } else { 31 } {
            for (name, a) in families(n, seed) {
                if n == 5 && !["mass", "random", "sign-mixed", "wide", "permuted"].contains(&name) {
                    continue;
                }
                let truth = vertex_hull(&a);
                for method in [exact, by_cells] {
                    let outcome = method(&a).expect("square");
                    match (&truth, outcome.status) {
                        (Some(truth), Status::Enclosed) => {
                            met += 1;
                            let value = outcome.enclosure().expect("a value");
                            let size = value.magnitude().into_iter().fold(0.0, f64::max);
                            assert!(
                                outcome.gap.is_none_or(|g| g <= 1e-13 * size),
                                "{name}, n = {n}: {:?}",
                                outcome.gap
                            );
                            assert!(is_tight(outcome.enclosure().expect("a value"), truth), "{name}, n = {n}");
                        }
                        (Some(_), status) => panic!("{name}, n = {n}: {status:?}, though the hull exists"),
                        (None, status) => assert_ne!(status, Status::Enclosed, "{name}, n = {n}"),
                    }
                }
            }
        }
    }
    assert!(met > 150, "{met}");
}

/// Regular, but not strongly: the class that no preconditioned method encloses.
#[test]
fn regular_but_not_strongly_regular() {
    let mut random = Random(77);
    let mut met = 0;
    while met < 40 {
        let n = 2 + met % 3;
        let centre: Vec<f64> = (0..n * n).map(|_| random.unit()).collect();
        let radius: Vec<f64> = (0..n * n).map(|_| 0.5 * random.unit().abs()).collect();
        let exactly: Vec<BigRational> = centre.iter().map(|&c| q(c)).collect();
        let Some(inverse) = invert(&exactly, n).1 else { continue };
        let product: Vec<f64> = (0..n * n)
            .map(|at| {
                (0..n).map(|k| inverse[(at / n) * n + k].to_f64().unwrap_or(0.0).abs() * radius[k * n + at % n]).sum()
            })
            .collect();
        let mut v = vec![1.0; n];
        let mut rho = 0.0;
        for _ in 0..200 {
            let image: Vec<f64> = (0..n).map(|i| (0..n).map(|k| product[i * n + k] * v[k]).sum()).collect();
            rho = image.iter().fold(0.0_f64, |m, x| m.max(*x));
            v = image.iter().map(|x| x / rho).collect();
        }
        let a = matrix(n, &centre, &radius);
        if !(1.05..1.6).contains(&rho) || exact_by_vertices(&a).expect("square").status != Status::Enclosed {
            continue;
        }
        met += 1;
        let truth = vertex_hull(&a).expect("regular");
        for method in [exact, by_cells] {
            let outcome = method(&a).expect("square");
            assert_eq!(outcome.status, Status::Enclosed, "n = {n}, rho = {rho}: {:?}", outcome.reason);
            assert!(is_tight(outcome.enclosure().expect("a value"), &truth), "n = {n}, rho = {rho}");
            assert!(outcome.certificate.expect("a proof").verify(&a));
        }
        assert_eq!(hansen_bliek_rohn(&a).expect("square").status, Status::NotApplicable);
    }
}

/// The closed form in rationals: `G = |P| Delta`, `M = (I - G)^-1`, docs/theory.md, "Inverses".
fn closed_form(a: &IntervalMatrix) -> Option<(Vec<(BigRational, BigRational)>, f64)> {
    let n = a.rows();
    let half = BigRational::new(1.into(), 2.into());
    let bounds: Vec<(BigRational, BigRational)> = a.lo().iter().zip(a.hi()).map(|(&l, &h)| (q(l), q(h))).collect();
    let centre: Vec<BigRational> = bounds.iter().map(|(l, h)| (l + h) * &half).collect();
    let radius: Vec<BigRational> = bounds.iter().map(|(l, h)| (h - l) * &half).collect();
    let p = invert(&centre, n).1?;
    let product = |x: &[BigRational], y: &[BigRational]| -> Vec<BigRational> {
        (0..n * n)
            .map(|at| (0..n).fold(BigRational::zero(), |s, k| s + &x[(at / n) * n + k] * &y[k * n + at % n]))
            .collect()
    };
    let size: Vec<BigRational> = p.iter().map(BigRational::abs).collect();
    let g = product(&size, &radius);
    let one = |at: usize| if at.is_multiple_of(n + 1) { BigRational::one() } else { BigRational::zero() };
    let m = invert(&g.iter().enumerate().map(|(at, x)| one(at) - x).collect::<Vec<_>>(), n).1?;
    if m.iter().any(BigRational::is_negative) {
        return None;
    }
    let spread = product(&m, &size);
    let growth = m.iter().map(|x| x.to_f64().unwrap_or(f64::NAN)).sum();
    Some((
        (0..n * n)
            .map(|at| {
                let mu = &m[(at / n) * (n + 1)];
                let nu = (mu + mu - BigRational::one()).recip();
                let lower = mu * (&p[at] + &size[at]) - &spread[at];
                let upper = &spread[at] + mu * (&p[at] - &size[at]);
                let (scaled_lower, scaled_upper) = (&lower * &nu, &upper * &nu);
                (lower.min(scaled_lower), upper.max(scaled_upper))
            })
            .collect(),
        growth,
    ))
}

#[test]
fn hansen_bliek_rohn_is_its_closed_form() {
    let mut met = 0;
    for n in 1..=5 {
        for seed in 60..63 {
            for (name, a) in families(n, seed) {
                if ["badly scaled", "nearly singular", "thin", "zero radii"].contains(&name) {
                    continue;
                }
                let outcome = hansen_bliek_rohn(&a).expect("square");
                let (Some(value), Some((formula, growth))) = (outcome.enclosure(), closed_form(&a)) else { continue };
                met += 1;
                let sizes = formula.iter().map(|(l, m)| m.abs().max(l.abs()).to_f64().expect("a number"));
                let size = sizes.fold(0.0, f64::max);
                for (e, (least, most)) in value.entries().zip(&formula) {
                    let width = (most - least).to_f64().expect("a number");
                    // The inverse of the midpoint is rounded to doubles, which (I - G)^-1 magnifies where rho is near
                    // 1.
                    let allowed = 1e-12 * width * (growth / n as f64).max(1.0) + 4.0 * f64::EPSILON * size;
                    assert!(e.hi() - e.lo() <= width + allowed, "{name}, n = {n}: {} beside {width}", e.hi() - e.lo());
                }
            }
        }
    }
    assert!(met > 50, "{met}");
}

/// A unit midpoint beyond the orders of sign accord, against the closed form in rationals.
#[test]
fn unit_midpoint() {
    for n in [2, 6, 14] {
        let mut random = Random(n as u64);
        let radius: Vec<f64> = (0..n * n).map(|_| (random.bits() % 64) as f64 / (70.0 * 64.0 * n as f64)).collect();
        let radius: Vec<f64> = radius.iter().map(|r| (r * 1024.0).round() / 1024.0).collect();
        let unit: Vec<f64> = (0..n * n).map(|at: usize| f64::from(u8::from(at.is_multiple_of(n + 1)))).collect();
        let a = matrix(n, &unit, &radius);
        let outcome = exact(&a).expect("square");
        let value = outcome.enclosure().unwrap_or_else(|| panic!("{:?}", outcome.reason));
        let one = |at: usize| if at.is_multiple_of(n + 1) { BigRational::one() } else { BigRational::zero() };
        let m =
            invert(&radius.iter().enumerate().map(|(at, r)| one(at) - q(*r)).collect::<Vec<_>>(), n).1.expect("small");
        let truth: Vec<(BigRational, BigRational)> = (m.iter().enumerate())
            .map(|(at, x)| {
                let two = x + x - BigRational::one();
                if at.is_multiple_of(n + 1) { (x / two, x.clone()) } else { (-x.clone(), x.clone()) }
            })
            .collect();
        assert!(is_tight(value, &truth), "n = {n}");
    }
}

/// Signs that vary beyond the order of sign accord: an enclosure with a stated gap, which more cells make smaller.
#[test]
fn a_budget_that_ends_is_said() {
    let n = 14;
    let mut random = Random(3);
    let centre: Vec<f64> =
        (0..n * n).map(|at: usize| 0.3 * random.unit() + if at.is_multiple_of(n + 1) { 4.0 } else { 0.0 }).collect();
    let a = matrix(n, &centre, &vec![0.02; n * n]);
    assert_eq!(exact(&a).expect("square").status, Status::NotApplicable);
    let few = partitioned(&a, 3).expect("square");
    let more = partitioned(&a, 40).expect("square");
    let (small, large) = (few.gap.expect("stated"), more.gap.expect("stated"));
    assert!(few.status == Status::Enclosed && small > 0.0 && large <= small, "{small} {large}");
    assert!(few.reason.expect("said").contains("budget"));
    let wide = hansen_bliek_rohn(&a).expect("square");
    let (inner, outer) = (more.enclosure().expect("a value"), wide.enclosure().expect("a value"));
    assert!(inner.entries().zip(outer.entries()).all(|(x, y)| x.hi() - x.lo() <= (y.hi() - y.lo()) * (1.0 + 1e-12)));
}

#[test]
fn larger_orders_with_fixed_signs_are_exact() {
    for n in [13, 30] {
        let mut random = Random(n as u64);
        let centre: Vec<f64> = (0..n * n)
            .map(|at: usize| if at.is_multiple_of(n + 1) { 2.0 * n as f64 } else { -1.0 - 0.5 * random.unit() })
            .collect();
        let a = matrix(n, &centre, &relative(&centre, 0.01));
        // An M-matrix: Kuttler's hull is another proof of the same numbers.
        let (one, other) = (exact(&a).expect("square"), kuttler(&a).expect("square"));
        let (one, other) = (one.enclosure().expect("fixed signs"), other.enclosure().expect("an M-matrix"));
        for (x, y) in one.entries().zip(other.entries()) {
            assert!((x.lo() - y.lo()).abs() <= 1e-12 * y.hi() && (x.hi() - y.hi()).abs() <= 1e-12 * y.hi());
        }
    }
}

#[test]
fn a_batch_is_one_after_the_other() {
    let n = 3;
    let all: Vec<IntervalMatrix> = (0..120).flat_map(|seed| families(n, seed)).map(|(_, a)| a).collect();
    let join = |f: fn(&IntervalMatrix) -> &[f64]| all.iter().flat_map(|a| f(a).to_vec()).collect::<Vec<f64>>();
    let (lo, hi) = (join(IntervalMatrix::lo), join(IntervalMatrix::hi));
    let bits = |x: &[f64]| x.iter().map(|v| v.to_bits()).collect::<Vec<u64>>();
    for (found, method) in [
        (exact_batch(n, &lo, &hi).expect("good"), exact as Method),
        (batch(n, &lo, &hi, hansen_bliek_rohn).expect("good"), hansen_bliek_rohn),
    ] {
        for (k, a) in all.iter().enumerate() {
            let one = method(a).expect("square");
            assert_eq!(one.status, found.status[k]);
            let (lower, upper) = (&found.lower[9 * k..][..9], &found.upper[9 * k..][..9]);
            match one.bounds() {
                Some((l, u)) => assert_eq!((bits(l), bits(u)), (bits(lower), bits(upper))),
                None => assert!(lower.iter().all(|x| x.is_nan())),
            }
        }
    }
    let mut bad = hi.clone();
    bad[22] = f64::NAN;
    assert_eq!(exact_batch(n, &lo, &bad), Err(Error::NotANumber { index: 22 }));
    assert!(exact_batch(n, &lo[1..], &hi[1..]).is_err());
}

/// One column at a time takes the general form; the inverse of order 3 at once has one of its own.
#[test]
fn hansen_bliek_rohn_of_order_3_has_the_bits_of_its_columns() {
    let mut random = Random(5);
    let usual = (0..2000).map(|k| {
        let centre: Vec<f64> = (0..9).map(|at| 2.0 * random.unit() + if at % 4 == 0 { 4.0 } else { 0.0 }).collect();
        matrix(3, &centre, &relative(&centre, 10_f64.powi(-(k % 17))))
    });
    let drawn = (0..60).flat_map(|seed| families(3, seed)).map(|(_, a)| a);
    let ties = (0..400).map(|kind| three_with_ties(kind, &mut Random(kind)));
    let mut enclosed = 0;
    for a in usual.collect::<Vec<_>>().into_iter().chain(drawn).chain(ties) {
        let whole = hansen_bliek_rohn(&a).expect("square");
        for j in 0..3 {
            let unit: Vec<Interval> = (0..3).map(|i| if i == j { Interval::ONE } else { Interval::ZERO }).collect();
            let column = systems::hansen_bliek_rohn(&a, &unit).expect("it fits");
            assert_eq!(whole.status, column.status, "{a:?}");
            let (Some(x), Some(y)) = (whole.enclosure(), column.enclosure()) else { continue };
            for i in 0..3 {
                let (x, y) = (x.get(i, j), y.get(i, 0));
                assert_eq!((x.lo().to_bits(), x.hi().to_bits()), (y.lo().to_bits(), y.hi().to_bits()), "{a:?}");
            }
        }
        assert!(whole.certificate.is_none_or(|proof| proof.verify(&a)), "{a:?}");
        enclosed += usize::from(whole.status == Status::Enclosed);
    }
    assert!(enclosed > 2500, "{enclosed}");
}

/// Matrices of order 3 whose ends are doubles, tie between vertices or are zero: diagonal, symmetric, in blocks, with
/// entries that are points, with small numbers, and with any; each kind in turn.
fn three_with_ties(kind: u64, random: &mut Random) -> IntervalMatrix {
    let small = kind.is_multiple_of(2);
    let mut pick = |scale: f64| if small { (scale * 8.0 * random.unit()).round() / 8.0 } else { scale * random.unit() };
    let mut centre: [f64; 9] = std::array::from_fn(|at| pick(1.0) + if at % 4 == 0 { 4.0 } else { 0.0 });
    let mut radius: [f64; 9] = std::array::from_fn(|_| pick(0.6).abs());
    for i in 0..3 {
        for j in 0..3 {
            let (at, other) = (3 * i + j, 3 * j + i);
            let apart = match kind / 2 % 5 {
                // A diagonal, two blocks, a symmetric matrix, few entries with a radius, off-diagonal entries around 0.
                0 => i != j,
                1 => (i == 0) != (j == 0),
                2 => {
                    if i < j {
                        (centre[at], radius[at]) = (centre[other], radius[other]);
                    }
                    false
                }
                3 => {
                    if !(at as u64 + kind).is_multiple_of(3) {
                        radius[at] = 0.0;
                    }
                    false
                }
                _ => {
                    if i != j {
                        centre[at] = 0.0;
                    }
                    false
                }
            };
            if apart {
                (centre[at], radius[at]) = (0.0, 0.0);
            }
        }
    }
    let rotate = (kind / 10 % 3) as usize;
    let end = |sign: f64| (0..9).map(|at| (at + 3 * rotate) % 9).map(|at| centre[at] + sign * radius[at]).collect();
    IntervalMatrix::new(3, 3, end(-1.0), end(1.0)).expect("a good matrix")
}

#[test]
fn ends_that_are_doubles_or_tie_are_those_of_rationals_to_the_bit() {
    // The long run has fifty times as many.
    let cases = if std::env::var("IVSID_CASES").is_ok() { 40_000 } else { 800 };
    let (mut random, mut scales) = (Random(77), Random(78));
    let (mut enclosed, mut quick) = (0, 0);
    let (mut lo, mut hi, mut truths) = (Vec::new(), Vec::new(), Vec::new());
    let bits = |(lower, upper): (&[f64], &[f64])| -> Vec<u64> {
        lower.iter().chain(upper).map(|x| (x + 0.0).to_bits()).collect()
    };
    for kind in 0..cases {
        let a = three_with_ties(kind, &mut random);
        let (found, truth) = (exact(&a).expect("square"), exact_by_vertices(&a).expect("square"));
        assert_eq!(found.status, truth.status, "{a:?}");
        assert_eq!(found.bounds().map(bits), truth.bounds().map(bits), "{a:?}");
        enclosed += u64::from(found.status == Status::Enclosed);
        // The path of order 3 states this vector.
        let of_three = |c: &Certificate| matches!(c, Certificate::Regular(Witness::ScaledContraction { vector, .. }) if vector == &[1.0; 3]);
        quick += u64::from(found.certificate.as_ref().is_some_and(of_three));
        // In the batch as it is, and with every row times a power of two, up to numbers that the forms for order 3 refuse.
        let mut powers = [1.0; 3];
        for scaled in [false, true] {
            if scaled {
                powers = std::array::from_fn(|_| 2_f64.powi((scales.bits() % 321) as i32 - 160));
            }
            lo.extend(a.lo().iter().enumerate().map(|(at, x)| x * powers[at / 3]));
            hi.extend(a.hi().iter().enumerate().map(|(at, x)| x * powers[at / 3]));
            let of = |x: &[f64]| x.iter().enumerate().map(|(at, x)| x / powers[at % 3]).collect::<Vec<f64>>();
            truths.push((truth.status, truth.bounds().map(|(lower, upper)| bits((&of(lower), &of(upper))))));
        }
    }
    let batch = exact_batch(3, &lo, &hi).expect("good matrices");
    for (k, (status, truth)) in truths.into_iter().enumerate() {
        assert_eq!(batch.status[k], status, "matrix {k}");
        let of = 9 * k..9 * (k + 1);
        let found = bits((&batch.lower[of.clone()], &batch.upper[of.clone()]));
        assert!(truth.is_none_or(|truth| truth == found), "{:?}, {:?}", &lo[of.clone()], &hi[of]);
    }
    assert!(10 * enclosed > 9 * cases && 10 * quick > 9 * enclosed, "{enclosed}, {quick} of {cases}");
}
