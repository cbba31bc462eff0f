//! Exact hulls and tight enclosures: containment against exact members, tightness apart.
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "test data are small numbers")]

mod common;

use common::{Random, invert, q};
use interval_core::inverse::{
    Outcome, batch, exact, exact_batch, exact_by_vertices, hansen_bliek_rohn, krawczyk, kuttler, neumaier, partitioned,
};
use interval_core::{Error, Interval, IntervalMatrix, Status, exact as rationals, systems};
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

type Method = fn(&IntervalMatrix) -> Result<Outcome, Error>;

fn by_cells(a: &IntervalMatrix) -> Result<Outcome, Error> {
    partitioned(a, 512)
}

const METHODS: [(&str, Method); 6] = [
    ("exact", exact),
    ("partitioned", by_cells),
    ("hansen-bliek-rohn", hansen_bliek_rohn),
    ("krawczyk", krawczyk),
    ("neumaier", neumaier),
    ("kuttler", kuttler),
];

fn matrix(n: usize, centre: &[f64], radius: &[f64]) -> IntervalMatrix {
    let end = |sign: f64| centre.iter().zip(radius).map(|(c, r)| c + sign * r).collect();
    IntervalMatrix::new(n, n, end(-1.0), end(1.0)).expect("a good matrix")
}

fn relative(centre: &[f64], by: f64) -> Vec<f64> {
    centre.iter().map(|c| by * c.abs()).collect()
}

/// The families of the specification, of any order.
fn families(n: usize, seed: u64) -> Vec<(&'static str, IntervalMatrix)> {
    let mut random = Random(seed.wrapping_mul(1000) + n as u64);
    let mut noise = |scale: f64| -> Vec<f64> { (0..n * n).map(|_| scale * random.unit()).collect() };
    let plus = |mut m: Vec<f64>, diagonal: f64| {
        (0..n).for_each(|i| m[i * (n + 1)] += diagonal);
        m
    };
    let order = n as f64;
    let mass: Vec<f64> = noise(3.0).iter().enumerate().map(|(at, x)| if at % 3 == 1 { 0.0 } else { *x }).collect();
    let mass = plus(mass, 20.0 * order);
    let dominant = plus(noise(1.0), order);
    let any = noise(1.0);
    let thin = noise(1.0);
    let wide = plus(noise(1.0), order);
    let nearly = plus(vec![1.0; n * n], 1e-6);
    let scales: Vec<f64> = noise(150.0)[..n].iter().map(|e| 10.0_f64.powi(*e as i32)).collect();
    let scaled: Vec<f64> = dominant.iter().enumerate().map(|(at, x)| x * scales[at / n] / scales[at % n]).collect();
    let permuted: Vec<f64> = (0..n * n).map(|at| dominant[((at / n + 1) % n) * n + at % n]).collect();
    let transposed: Vec<f64> = (0..n * n).map(|at| any[(at % n) * n + at / n]).collect();
    let unit = plus(vec![0.0; n * n], 1.0);
    vec![
        ("mass", matrix(n, &mass, &relative(&mass, 0.01))),
        ("diagonally dominant", matrix(n, &dominant, &relative(&dominant, 0.01))),
        ("random", matrix(n, &any, &relative(&any, 0.05 / order))),
        ("sign-mixed", matrix(n, &dominant, &vec![0.2; n * n])),
        ("nearly singular", matrix(n, &nearly, &vec![1e-9 / order; n * n])),
        ("singular", matrix(n, &vec![1.0; n * n], &vec![0.01; n * n])),
        ("wide", matrix(n, &wide, &relative(&wide, 0.5))),
        ("badly scaled", matrix(n, &scaled, &relative(&scaled, 0.01))),
        ("thin", matrix(n, &thin, &relative(&thin, 1e-13))),
        ("huge radii", matrix(n, &thin, &vec![1e100; n * n])),
        ("zero radii", matrix(n, &dominant, &vec![0.0; n * n])),
        ("permuted", matrix(n, &permuted, &relative(&permuted, 0.02))),
        ("transposed", matrix(n, &transposed, &relative(&transposed, 0.02 / order))),
        ("unit midpoint", matrix(n, &unit, &vec![0.25 / order; n * n])),
    ]
}

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
                        // Two methods whose cost is not that of a bench for every order.
                        let heavy = n > 10 && ["exact", "partitioned", "krawczyk"].contains(method) && n > 20;
                        (!heavy).then(|| run(&a).expect("square"))
                    })
                    .collect();
                for (k, outcome) in outcomes.iter().enumerate() {
                    let Some(outcome) = outcome else { continue };
                    let proved = outcome.status == Status::Enclosed;
                    enclosed[k] += usize::from(proved);
                    assert_eq!(proved, outcome.enclosure().is_some(), "{name}, n = {n}");
                    assert_eq!(outcome.status == Status::Singular || proved, outcome.certificate.is_some());
                    if n <= 10
                        && let Some(certificate) = &outcome.certificate
                    {
                        assert!(certificate.verify(&a), "{name}, n = {n}, {}", METHODS[k].0);
                    }
                }
                for _ in 0..if n < 10 { 6 } else { 1 } {
                    let point = member(&a, &mut random);
                    for j in [0, n / 2, n - 1] {
                        let unit: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == j))).collect();
                        let column = rationals::solve(&point, &unit, n);
                        for (k, outcome) in outcomes.iter().enumerate() {
                            let Some(value) = outcome.as_ref().and_then(Outcome::enclosure) else { continue };
                            let method = METHODS[k].0;
                            let column =
                                column.as_ref().unwrap_or_else(|| panic!("{method}, {name}: a singular member"));
                            for i in 0..n {
                                let e = value.get(i, j);
                                assert!(q(e.lo()) <= column[i] && column[i] <= q(e.hi()), "{method}, {name}, n = {n}");
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(enclosed.iter().all(|&count| count > 5), "{enclosed:?}");
}

/// The hull by another way: all vertex matrices in rationals, once for each pair of sign vectors.
fn hull(a: &IntervalMatrix) -> Option<Vec<(BigRational, BigRational)>> {
    let n = a.rows();
    let mut found: Option<Vec<(BigRational, BigRational)>> = None;
    let mut positive = None;
    for bits in 0..1_usize << (2 * n - 1) {
        let (y, z) = (bits >> n, bits & ((1 << n) - 1));
        let vertex: Vec<BigRational> = (0..n * n)
            .map(|at| if ((y >> (at / n)) ^ (z >> (at % n))) & 1 == 1 { q(a.hi()[at]) } else { q(a.lo()[at]) })
            .collect();
        let (determinant, inverse) = invert(&vertex, n);
        let inverse = inverse?;
        if *positive.get_or_insert(determinant.is_positive()) != determinant.is_positive() {
            return None;
        }
        found = Some(match found {
            None => inverse.into_iter().map(|x| (x.clone(), x)).collect(),
            Some(f) => f.into_iter().zip(inverse).map(|((l, h), x)| (l.min(x.clone()), h.max(x))).collect(),
        });
    }
    found
}

/// The widest a bound may be beyond the exact one, relative to the width of the hull and to the size of the entry.
fn is_tight(value: &IntervalMatrix, hull: &[(BigRational, BigRational)]) -> bool {
    value.entries().zip(hull).all(|(e, (least, most))| {
        let width = (most - least).to_f64().expect("a number");
        let size = most.abs().max(least.abs()).to_f64().expect("a number");
        let excess = |d: BigRational| d.to_f64().expect("a number");
        let allowed = 1e-12 * width + 4.0 * f64::EPSILON * size;
        q(e.lo()) <= *least
            && *most <= q(e.hi())
            && excess(least - q(e.lo())) <= allowed
            && excess(q(e.hi()) - most) <= allowed
    })
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
                let truth = hull(&a);
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
                        (Some(_), status) => assert!(name == "badly scaled" || n == 5, "{name}, n = {n}: {status:?}"),
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
        let truth = hull(&a).expect("regular");
        for method in [exact, by_cells] {
            let outcome = method(&a).expect("square");
            assert_eq!(outcome.status, Status::Enclosed, "n = {n}, rho = {rho}: {:?}", outcome.reason);
            assert!(is_tight(outcome.enclosure().expect("a value"), &truth), "n = {n}, rho = {rho}");
            assert!(outcome.certificate.expect("a proof").verify(&a));
        }
        assert_eq!(hansen_bliek_rohn(&a).expect("square").status, Status::NotApplicable);
    }
}

/// The closed form in rationals: `G = |P| Delta`, `M = (I - G)^-1`, METHODS 4.2 (H).
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
                    // The inverse of the midpoint is rounded to doubles, which (I - G)^-1 magnifies where rho is near 1.
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
fn systems_are_enclosed_and_exact_ones_are_attained() {
    let mut random = Random(5);
    let mut met = 0;
    for n in 1..=4 {
        for seed in 80..83 {
            for (name, a) in families(n, seed) {
                let b: Vec<Interval> =
                    (0..n).map(|_| random.unit()).map(|c| Interval::new(c - 0.2, c + 0.1).expect("good")).collect();
                let outcome = systems::exact(&a, &b).expect("shapes fit");
                let Some(value) = outcome.enclosure() else { continue };
                met += 1;
                // The hull by all end points of A and b that the theory names.
                let (mut least, mut most) = (vec![None; n], vec![None; n]);
                for bits in 0..1_usize << (2 * n) {
                    let (y, z) = (bits >> n, bits & ((1 << n) - 1));
                    let vertex: Vec<BigRational> = (0..n * n)
                        .map(|at| q(if ((y >> (at / n)) ^ (z >> (at % n))) & 1 == 1 { a.hi()[at] } else { a.lo()[at] }))
                        .collect();
                    let inverse = invert(&vertex, n).1.expect("regular");
                    for i in 0..n {
                        let x = (0..n).fold(BigRational::zero(), |s, k| {
                            s + &inverse[i * n + k] * q(if y >> k & 1 == 0 { b[k].hi() } else { b[k].lo() })
                        });
                        if least[i].as_ref().is_none_or(|l| x < *l) {
                            least[i] = Some(x.clone());
                        }
                        if most[i].as_ref().is_none_or(|m| x > *m) {
                            most[i] = Some(x);
                        }
                    }
                }
                let truth: Vec<(BigRational, BigRational)> =
                    least.into_iter().zip(most).map(|(l, m)| (l.expect("met"), m.expect("met"))).collect();
                for (e, (l, m)) in value.entries().zip(&truth) {
                    assert!(q(e.lo()) <= *l && *m <= q(e.hi()), "{name}, n = {n}");
                }
                assert!(is_tight(value, &truth), "{name}, n = {n}");
                let wider = systems::gauss_seidel(&a, &b).expect("shapes fit");
                if let Some(wider) = wider.enclosure() {
                    let slack = |x: f64| 4.0 * f64::EPSILON * x.abs();
                    let inside =
                        |w: Interval, e: Interval| w.lo() <= e.lo() + slack(e.lo()) && e.hi() - slack(e.hi()) <= w.hi();
                    assert!(wider.entries().zip(value.entries()).all(|(w, e)| inside(w, e)), "{name}, n = {n}");
                }
            }
        }
    }
    assert!(met > 60, "{met}");
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

fn from_entries(n: usize, entries: &[(f64, f64)]) -> IntervalMatrix {
    let (lo, hi) = entries.iter().copied().unzip();
    IntervalMatrix::new(n, n, lo, hi).expect("a good matrix")
}

/// Residuals that overflow or vanish are no residuals of zero.
#[test]
fn the_ends_of_the_range() {
    // A member has x_0 = -2^1024, beyond any double.
    let t = 2.0_f64.powi(1020);
    let a = from_entries(2, &[(0.875, 0.875), (-1.0, 0.375), (-0.375, -0.375), (0.5, 0.5)]);
    let b = [Interval::new(-6.0 * t, -5.5 * t).expect("good"), Interval::new(2.0 * t, 2.0 * t).expect("good")];
    for solve in [systems::exact, systems::gauss_seidel, systems::hansen_bliek_rohn, systems::krawczyk, systems::cramer]
    {
        let outcome = solve(&a, &b).expect("shapes fit");
        assert!(outcome.enclosure().is_none_or(|v| v.get(0, 0).lo() < -1.7e308), "{outcome:?}");
    }
    // Products that vanish: x = (2^-1020, -2^-1020).
    let tiny = 2.0_f64.powi(-60);
    let a = from_entries(2, &[(1.0, 1.0), (0.0, 0.0), (tiny, tiny), (tiny, tiny)]);
    for exponent in [-1020, -1022, -1060] {
        let x = 2.0_f64.powi(exponent);
        let b = [Interval::new(x, x).expect("good"), Interval::ZERO];
        for solve in
            [systems::exact, systems::gauss_seidel, systems::hansen_bliek_rohn, systems::krawczyk, systems::cramer]
        {
            if let Some(value) = solve(&a, &b).expect("shapes fit").enclosure() {
                assert!(value.get(0, 0).contains(x) && value.get(1, 0).contains(-x), "2^{exponent}: {value:?}");
            }
        }
    }
    let a = from_entries(2, &[(-1e200, -1e200), (5e-324, 5e-324), (5e-324, 5e-324), (-1.15e-308, -1.15e-308)]);
    let b = [Interval::new(2.0, 2.0).expect("good"), Interval::ZERO];
    if let Some(value) = systems::exact(&a, &b).expect("shapes fit").enclosure() {
        assert!(value.get(1, 0).lo() <= -8.59e-216, "{value:?}");
    }
    // An inverse whose sign vectors overflow one by one.
    let (e, f) = (2.0_f64.powi(511), 2.0_f64.powi(-511));
    let p = |x: f64| (x, x);
    let entries = [
        [p(0.375 * e), p(0.625 * e), p(-0.6875 * e), p(f), p(0.0)],
        [p(-0.5625 * e), p(-0.125 * e), p(-e), p(f), p(0.0)],
        [(-0.09375 * f, 0.96875 * f), p(-0.5 * f), p(0.6875 * f), p(0.0), p(e)],
        [p(0.0), p(0.0), p(0.0), p(e), p(f)],
        [p(0.0), p(0.0), p(0.0), p(f), p(e)],
    ];
    let a = from_entries(5, entries.as_flattened());
    let mut member: Vec<f64> = a.lo().to_vec();
    for (_, method) in METHODS {
        let outcome = method(&a).expect("square");
        let Some(value) = outcome.enclosure() else { continue };
        for end in [a.lo()[10], a.hi()[10]] {
            member[10] = end;
            let column = rationals::solve(&member, &[0.0, 0.0, 1.0, 0.0, 0.0], 5).expect("regular");
            assert!(q(value.get(0, 2).lo()) <= column[0] && column[0] <= q(value.get(0, 2).hi()));
        }
    }
}

/// Bounds and gaps of badly scaled matrices are in the units of the matrix, and their certificates hold.
#[test]
fn scaled_matrices_keep_their_units_and_certificates() {
    let n = 13;
    let scale = 1e-100;
    let entries: Vec<(f64, f64)> = (0..n * n)
        .map(|at: usize| if at.is_multiple_of(n + 1) { (scale, 1.2 * scale) } else { (-0.06 * scale, 0.055 * scale) })
        .collect();
    let outcome = partitioned(&from_entries(n, &entries), 3).expect("square");
    assert!(outcome.gap.expect("stated") > 1e90, "{:?}", outcome.gap);
    for entries in [
        [(5.5625e306, 5.5625e306), (0.0, 0.0), (-8e-323, -8e-323), (-1.28e202, -6.4e201)],
        [(-f64::MAX, -f64::MAX), (1e-200, 1e-200), (0.0, 0.0), (4.45e307, 4.45e307)],
        [(2.0_f64.powi(600), 2.0_f64.powi(600)), (0.0, 0.0), (0.0, 0.0), (2.0_f64.powi(600), 2.0_f64.powi(600))],
    ] {
        let a = from_entries(2, &entries);
        for (name, method) in METHODS {
            let outcome = method(&a).expect("square");
            assert!(outcome.certificate.is_none_or(|c| c.verify(&a)), "{name}: {entries:?}");
        }
        let cramer = interval_core::inverse::cramer(&a).expect("square");
        assert!(cramer.certificate.is_none_or(|c| c.verify(&a)), "{entries:?}");
    }
    let powers: Vec<(f64, f64)> = (0..25)
        .map(|at| if at % 6 == 0 { (2.0_f64.powi(1000 - 75 * at), 2.0_f64.powi(1000 - 75 * at)) } else { (0.0, 0.0) })
        .collect();
    for method in [exact, by_cells] {
        assert_eq!(method(&from_entries(5, &powers)).expect("square").status, Status::Enclosed);
    }
}
