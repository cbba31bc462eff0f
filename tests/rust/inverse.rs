//! Inverses and square systems: soundness against exact vertex inverses, tightness apart, honest refusals.
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::items_after_statements,
    reason = "test data are small numbers"
)]

mod common;

use common::matrices::extremes;
use common::{Random, invert, is_down, is_up, q};
use interval_core::inverse::{
    Method, Options, Outcome, Sweep, cramer, exact, hansen_bliek_rohn, krawczyk, kuttler, neumaier, partitioned,
    published, published_hull,
};
use interval_core::regularity::{Regularity, SingularMember, regularity};
use interval_core::{Interval, IntervalMatrix, Status, systems};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

fn matrix(n: usize, lo: &[f64], hi: &[f64]) -> IntervalMatrix {
    IntervalMatrix::new(n, n, lo.to_vec(), hi.to_vec()).expect("a good matrix")
}

/// All matrices of end points: a superset of the vertex matrices that the theory needs.
fn corners(a: &IntervalMatrix) -> Vec<Vec<f64>> {
    let size = a.rows() * a.columns();
    let count = if size <= 9 { 1_usize << size } else { 512 };
    let mut random = Random(size as u64);
    (0..count)
        .map(|k| {
            let bits = if size <= 9 { k as u64 } else { random.bits() };
            (0..size).map(|i| if bits >> i & 1 == 0 { a.lo()[i] } else { a.hi()[i] }).collect()
        })
        .collect()
}

/// Exact extremes of each entry of the inverse over the corners; `None` where one is singular or signs differ.
fn hull(a: &IntervalMatrix) -> Option<Vec<(BigRational, BigRational)>> {
    let exactly = |corner: Vec<f64>| corner.into_iter().map(q).collect();
    extremes(corners(a).into_iter().map(exactly), a.rows())
}

fn families(n: usize, seed: u64) -> Vec<(&'static str, IntervalMatrix)> {
    let mut random = Random(seed);
    let mut made = Vec::new();
    let mut add = |name, centre: Vec<f64>, radius: Vec<f64>| {
        let lo: Vec<f64> = centre.iter().zip(&radius).map(|(c, r)| c - r).collect();
        let hi: Vec<f64> = centre.iter().zip(&radius).map(|(c, r)| c + r).collect();
        made.push((name, matrix(n, &lo, &hi)));
    };
    let size = n * n;
    let diagonal = |i: usize| i.is_multiple_of(n + 1);
    let dominant: Vec<f64> =
        (0..size).map(|i| random.unit() + if diagonal(i) { 2.0 * n as f64 } else { 0.0 }).collect();
    add("diagonally dominant", dominant.clone(), dominant.iter().map(|x| 0.05 * x.abs()).collect());
    add("thin", dominant.clone(), dominant.iter().map(|x| 1e-14 * x.abs()).collect());
    add("points", dominant.clone(), vec![0.0; size]);
    let mass: Vec<f64> = (0..size).map(|i| if diagonal(i) { 60.0 } else { 3.0 * random.unit() }).collect();
    add("mass", mass, vec![1.5; size]);
    let random_centre: Vec<f64> = (0..size).map(|_| random.unit()).collect();
    add("random", random_centre.clone(), vec![0.01; size]);
    add("wide", random_centre, vec![0.3; size]);
    let mixed: Vec<f64> = (0..size).map(|i| if diagonal(i) { 1.0 } else { 0.0 }).collect();
    add("unit midpoint", mixed.clone(), vec![0.2 / n as f64; size]);
    add("zero inside", mixed, vec![1.5; size]);
    let scaled: Vec<f64> =
        dominant.iter().enumerate().map(|(i, x)| x * 10.0_f64.powi(if i / n == 0 { -150 } else { 100 })).collect();
    add("badly scaled", scaled.clone(), scaled.iter().map(|x| 0.01 * x.abs()).collect());
    let nearly: Vec<f64> = (0..size).map(|i| 1.0 + if diagonal(i) { 1e-7 } else { 0.0 }).collect();
    add("nearly singular", nearly, vec![1e-12; size]);
    add("singular", vec![1.0; size], vec![0.1; size]);
    made
}

fn check(name: &str, outcome: &Outcome, hull: Option<&Vec<(BigRational, BigRational)>>) -> bool {
    if outcome.status != Status::Enclosed {
        assert!(outcome.value.is_none(), "{name}: a value without a proof");
        return false;
    }
    let hull = hull.unwrap_or_else(|| panic!("{name}: a finite answer for a singular interval matrix"));
    let (lower, upper) = outcome.bounds().expect("a value");
    for (k, (least, most)) in hull.iter().enumerate() {
        assert!(q(lower[k]) <= *least && *most <= q(upper[k]), "{name}: entry {k} is not enclosed");
    }
    true
}

#[test]
fn every_enclosure_holds_all_vertex_inverses() {
    let mut counts = [0; 4];
    for n in 1..=4 {
        for seed in 0..if n < 4 { 6 } else { 1 } {
            for (name, a) in families(n, seed) {
                let exactly = hull(&a);
                let name = format!("{name}, n = {n}, seed {seed}");
                for (k, method) in [krawczyk, cramer, exact, hansen_bliek_rohn].into_iter().enumerate() {
                    let outcome = method(&a).expect("a square matrix");
                    counts[k] += usize::from(check(&name, &outcome, exactly.as_ref()));
                }
            }
        }
    }
    assert!(counts.iter().all(|&c| c > 60), "each method must succeed often enough to be tested: {counts:?}");
}

#[test]
fn exact_is_the_hull_rounded_once() {
    for n in 1..=3 {
        for seed in 0..3 {
            for (name, a) in families(n, seed) {
                let outcome = exact(&a).expect("square");
                match hull(&a) {
                    Some(exactly) => {
                        let (lower, upper) = outcome.bounds().unwrap_or_else(|| panic!("{name}: the hull exists"));
                        for (k, (least, most)) in exactly.iter().enumerate() {
                            assert!(is_down(lower[k], least), "{name}, n = {n}: entry {k} from below");
                            assert!(is_up(upper[k], most), "{name}, n = {n}: entry {k} from above");
                        }
                    }
                    None => assert_eq!(outcome.status, Status::Singular, "{name}, n = {n}"),
                }
            }
        }
    }
}

/// Widths against the exact hull: never narrower, and close to it where the preconditioned matrix is near the identity.
#[test]
fn hansen_bliek_rohn_is_close_to_the_hull() {
    let mut ratios = Vec::new();
    for n in 2..=4 {
        for seed in 40..44 {
            for (name, a) in families(n, seed) {
                let (value, hull) = (hansen_bliek_rohn(&a).expect("square"), exact(&a).expect("square"));
                let (Some(value), Some(hull)) = (value.enclosure(), hull.enclosure()) else { continue };
                let width = |e: &IntervalMatrix| -> f64 { e.hi().iter().zip(e.lo()).map(|(h, l)| h - l).sum() };
                if ["diagonally dominant", "mass", "random", "unit midpoint"].contains(&name) {
                    ratios.push(width(value) / width(hull));
                }
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    assert!(ratios.len() > 20 && ratios[0] >= 1.0 - 1e-12, "{ratios:?}");
    assert!(ratios[ratios.len() / 2] < 1.1 && ratios[ratios.len() - 1] < 2.0, "{ratios:?}");
}

/// The condition is that of strong regularity in any scaled norm, so it reaches further than a contraction by rows.
#[test]
fn a_scaled_norm_proves_more() {
    let a = matrix(2, &[1.0, 0.0, -0.001, 1.0], &[1.0, 900.0, 0.001, 1.0]);
    assert_eq!(krawczyk(&a).expect("square").status, Status::NotApplicable);
    let found = hansen_bliek_rohn(&a).expect("square");
    assert!(check("badly scaled rows", &found, hull(&a).as_ref()));
    assert!(exact(&a).expect("square").status == Status::Enclosed);
}

/// M-matrices: the hull, rounded once, and with the zeros of triangular ones; refused where a sign is missing.
#[test]
fn kuttler_gives_the_hull_of_m_matrices() {
    let mut random = Random(23);
    for n in 1..=3 {
        for triangular in [false, true] {
            for _ in 0..20 {
                let centre: Vec<f64> = (0..n * n)
                    .map(|at| {
                        let (i, j) = (at / n, at % n);
                        let off = if triangular && j > i { 0.0 } else { -random.unit().abs() };
                        if i == j { 4.0 } else { off }
                    })
                    .collect();
                let (lo, hi): (Vec<f64>, Vec<f64>) =
                    centre.iter().map(|c| (c - 0.1 * c.abs(), c + 0.1 * c.abs())).unzip();
                let a = matrix(n, &lo, &hi);
                let found = kuttler(&a).expect("square");
                let exactly = hull(&a).expect("regular");
                assert!(check("M-matrix", &found, Some(&exactly)));
                let (lower, upper) = found.bounds().expect("a value");
                for (k, (least, most)) in exactly.iter().enumerate() {
                    assert!(is_down(lower[k], least) && is_up(upper[k], most));
                }
            }
        }
    }
    for (_, a) in families(3, 5) {
        let _ = check("any family", &kuttler(&a).expect("square"), hull(&a).as_ref());
    }
    let large: Vec<f64> = (0..100).map(|at| if at % 11 == 0 { 4.0 } else { -0.1 }).collect();
    let wider: Vec<f64> = large.iter().map(|x| x + 0.01).collect();
    assert_eq!(kuttler(&matrix(10, &large, &wider)).expect("square").status, Status::Enclosed);
    assert_eq!(kuttler(&matrix(1, &[-2.0], &[-1.0])).expect("square").status, Status::NotApplicable);
}

/// Beyond the orders whose vertices are examined: regular by a scaled norm, and never for a matrix with a singular
/// member.
#[test]
fn regularity_of_larger_matrices() {
    let mut random = Random(17);
    let (mut proved, mut singular) = (0, 0);
    for _ in 0..200 {
        let n = 5 + (random.bits() % 8) as usize;
        let scale: Vec<f64> = (0..n).map(|_| 2.0_f64.powi((random.bits() % 40) as i32)).collect();
        let entry = |random: &mut Random, i: usize, j: usize| {
            (random.unit() + if i == j { 4.0 } else { 0.0 }) * scale[i] / scale[j]
        };
        let centre: Vec<f64> = (0..n * n).map(|at| entry(&mut random, at / n, at % n)).collect();
        let spread = 0.3 * random.unit().abs();
        let (lo, hi): (Vec<f64>, Vec<f64>) =
            centre.iter().map(|c| (c - spread * c.abs(), c + spread * c.abs())).unzip();
        match regularity(&matrix(n, &lo, &hi)).expect("square") {
            Regularity::Regular(_) => {
                proved += 1;
                // Members are as regular as it says: exactly nonsingular.
                let member: Vec<BigRational> =
                    lo.iter().zip(&hi).map(|(&l, &h)| q(if random.bits().is_multiple_of(2) { l } else { h })).collect();
                assert!(invert(&member, n).1.is_some());
            }
            Regularity::NotProved => {}
            Regularity::Singular(member) => {
                singular += 1;
                assert!(is_singular(&matrix(n, &lo, &hi), &member));
            }
        }
        // A member with two equal rows.
        let mut wide = (lo.clone(), hi.clone());
        for j in 0..n {
            let (a, b) = (centre[j], centre[n + j]);
            (wide.0[j], wide.1[j]) = (a.min(b), a.max(b));
            (wide.0[n + j], wide.1[n + j]) = (a.min(b), a.max(b));
        }
        assert!(!matches!(regularity(&matrix(n, &wide.0, &wide.1)), Ok(Regularity::Regular(_))));
    }
    assert!(proved > 40 && singular > 5, "{proved} regular, {singular} singular");
}

/// True if a certificate of a singular member holds, in rationals.
fn is_singular(a: &IntervalMatrix, member: &SingularMember) -> bool {
    let n = a.rows();
    let belongs = |m: &[f64]| m.iter().zip(a.entries()).all(|(&x, e)| e.contains(x));
    let determinant = |m: &[f64]| invert(&m.iter().map(|&x| q(x)).collect::<Vec<_>>(), n).0;
    match member {
        SingularMember::Member(m) => belongs(m) && determinant(m).is_zero(),
        SingularMember::OppositeSigns(m, o) => {
            belongs(m) && belongs(o) && (determinant(m) * determinant(o)).is_negative()
        }
        SingularMember::NullVector(x) => {
            let row = |i: usize| {
                let ends = (0..n).map(|j| {
                    let (l, h) = (q(a.get(i, j).lo()) * q(x[j]), q(a.get(i, j).hi()) * q(x[j]));
                    (l.clone().min(h.clone()), l.max(h))
                });
                ends.fold((BigRational::zero(), BigRational::zero()), |(s, t), (l, h)| (s + l, t + h))
            };
            x.iter().any(|&v| v != 0.0)
                && (0..n).map(row).all(|(least, most)| !least.is_positive() && !most.is_negative())
        }
    }
}

#[test]
fn regularity_agrees_with_exact_determinants() {
    let mut verdicts = [0; 2];
    let mut random = Random(3);
    for n in 1..=3 {
        for _ in 0..400 {
            let centre: Vec<f64> = (0..n * n).map(|_| random.unit()).collect();
            let r = 0.4 * random.unit().abs();
            let a = matrix(
                n,
                &centre.iter().map(|c| c - r).collect::<Vec<_>>(),
                &centre.iter().map(|c| c + r).collect::<Vec<_>>(),
            );
            match (regularity(&a).expect("square"), hull(&a).is_some()) {
                (Regularity::Regular(_), true) => verdicts[0] += 1,
                (Regularity::Singular(_), false) => verdicts[1] += 1,
                (verdict, truth) => panic!("{verdict:?} for an interval matrix whose regularity is {truth}"),
            }
        }
    }
    assert!(verdicts.iter().all(|&v| v > 50), "{verdicts:?}");
}

#[test]
fn regular_but_not_strongly_regular() {
    let mut random = Random(9);
    let mut met = 0;
    for _ in 0..3000 {
        let n = 2 + (random.bits() % 2) as usize;
        let centre: Vec<f64> = (0..n * n).map(|_| random.unit()).collect();
        let r = 0.35 * random.unit().abs();
        let a = matrix(
            n,
            &centre.iter().map(|c| c - r).collect::<Vec<_>>(),
            &centre.iter().map(|c| c + r).collect::<Vec<_>>(),
        );
        if krawczyk(&a).expect("square").status == Status::NotApplicable
            && exact(&a).expect("square").status == Status::Enclosed
        {
            assert!(check("not strongly regular", &exact(&a).expect("square"), hull(&a).as_ref()));
            met += 1;
        }
    }
    assert!(met >= 20, "only {met} such matrices were met");
}

#[test]
fn numbers_of_the_paper() {
    let q = matrix(2, &[2.0, -2.0, -1.5, -2.0], &[4.0, 2.0, 4.5, 3.5]);
    assert_eq!(q.norm(), 8.0);
    assert_eq!(q.radius()[3], 2.75);
    let one = matrix(1, &[1.0], &[2.0]);
    let ends = |o: Outcome| o.bounds().map(|(l, u)| (l[0], u[0])).expect("a value");
    assert_eq!(ends(exact(&one).unwrap()), (0.5, 1.0));
    assert_eq!(ends(published_hull(&one, 1000).unwrap()), (0.5, 1.0));
    let (low, high) = ends(published(&one, 1000).unwrap());
    let d = 0.0005;
    assert!((low - 1.0 / (1.5 - d)).abs() < 1e-12 && (high - 1.0 / (1.5 + d)).abs() < 1e-12 && low > high);
}

#[test]
fn methods_have_names_and_do_what_they_are_called() {
    let a = &families(3, 2)[0].1;
    let options = Options { partitions: 20, cells: 50, sweep: Sweep::Members };
    let by_function = [
        exact(a),
        partitioned(a, 50),
        hansen_bliek_rohn(a),
        krawczyk(a),
        cramer(a),
        kuttler(a),
        neumaier(a),
        published(a, 20),
        published_hull(a, 20),
    ];
    assert_eq!(by_function.len(), Method::ALL.len());
    for (k, (&method, outcome)) in Method::ALL.iter().zip(by_function).enumerate() {
        assert_eq!((usize::from(method.code()), method.name().parse()), (k, Ok(method)));
        assert_eq!(method.inverse(a, &options), outcome, "{method}");
        let batch = method.inverse_batch(3, a.lo(), a.hi(), &options).unwrap();
        let outcome = outcome.unwrap();
        assert_eq!(batch.status, [outcome.status], "{method}");
        if let Some(bounds) = outcome.bounds() {
            assert_eq!(bounds, (&batch.lower[..], &batch.upper[..]), "{method}");
        }
    }
    let b = vec![Interval::new(1.0, 1.5).unwrap(); 3];
    for &method in systems::Method::ALL {
        assert_eq!(method.name().parse(), Ok(method));
        assert!(method.solve(a, &b).unwrap().enclosure().is_some(), "{method}");
    }
    let refused = "gauss".parse::<Method>().unwrap_err().to_string();
    assert!(refused.starts_with("method 'gauss' is not available; choose one of exact, partitioned, "), "{refused}");
    assert!("Members".parse::<Sweep>().is_err());
}

#[test]
fn the_published_sweep_claims_nothing_and_does_not_depend_on_threads() {
    for (name, a) in families(3, 1) {
        for partitions in [1, 7, 4096, 10_000] {
            let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            let crowd = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
            for method in [published, published_hull] {
                let one = alone.install(|| method(&a, partitions)).unwrap();
                assert_eq!(one, crowd.install(|| method(&a, partitions)).unwrap(), "{name}");
                assert_ne!(one.status, Status::Enclosed, "{name}");
                assert!(one.certificate.is_none() && one.reason.is_some());
            }
        }
    }
    assert!(published(&matrix(1, &[1.0], &[2.0]), 0).is_err());
    assert!(published(&IntervalMatrix::new(1, 2, vec![1.0; 2], vec![1.0; 2]).unwrap(), 5).is_err());
}

#[test]
fn systems_hold_the_solutions_of_their_corners() {
    let mut solved = 0;
    for n in 1..=3 {
        for seed in 20..24 {
            for (name, a) in families(n, seed) {
                let b: Vec<Interval> = (0..n).map(|i| Interval::new(i as f64 - 0.5, i as f64 + 0.5).unwrap()).collect();
                for method in [systems::krawczyk, systems::cramer, systems::hansen_bliek_rohn] {
                    let outcome = method(&a, &b).unwrap();
                    let Some((lower, upper)) = outcome.bounds() else { continue };
                    solved += 1;
                    for corner in corners(&a).iter().step_by(11) {
                        let entries: Vec<BigRational> = corner.iter().map(|&x| q(x)).collect();
                        let inverse = invert(&entries, n).1.unwrap_or_else(|| panic!("{name} is singular but solved"));
                        for ends in 0..1_usize << n {
                            for i in 0..n {
                                let x = (0..n).fold(BigRational::zero(), |sum, j| {
                                    let y = if ends >> j & 1 == 0 { b[j].lo() } else { b[j].hi() };
                                    sum + &inverse[i * n + j] * q(y)
                                });
                                assert!(q(lower[i]) <= x && x <= q(upper[i]), "{name}, n = {n}");
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(solved > 100, "{solved}");
    assert!(systems::krawczyk(&matrix(1, &[1.0], &[2.0]), &[]).is_err());
}

#[test]
fn unbounded_matrices_are_not_applicable() {
    let a = matrix(2, &[f64::NEG_INFINITY, 0.0, 0.0, 1.0], &[1.0, 0.0, 0.0, 1.0]);
    for outcome in [krawczyk(&a), cramer(&a), hansen_bliek_rohn(&a), exact(&a), published(&a, 5), published_hull(&a, 5)]
    {
        assert_eq!(outcome.unwrap().status, Status::NotApplicable);
    }
}
