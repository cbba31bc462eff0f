//! Inverses: soundness against exact vertex inverses, tightness apart, honest refusals.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::items_after_statements,
    reason = "test data are small numbers"
)]

mod common;

use common::corners::{families, hull, matrix};
use common::{Random, is_down, is_up, q};
use interval_core::inverse::{
    Form, Method, Options, Outcome, Sweep, cell_answers, cramer, exact, hansen_bliek_rohn, krawczyk, kuttler, neumaier,
    partitioned, partitioned_shared, published, published_hull, published_of_parts, published_part,
};
use interval_core::{Interval, IntervalMatrix, Status, systems};
use num_rational::BigRational;

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

/// The determinant of the first rows in the given columns as the formula stands: products with 1 and sums from 0 too.
fn by_last_row(a: &IntervalMatrix, rows: &[usize], columns: &[usize]) -> Interval {
    let Some((&row, above)) = rows.split_last() else { return Interval::ONE };
    let mut sum = Interval::ZERO;
    for k in 0..columns.len() {
        let others = [&columns[..k], &columns[k + 1..]].concat();
        let term = a.get(row, columns[k]) * by_last_row(a, above, &others);
        sum = if (columns.len() - 1 - k).is_multiple_of(2) { sum + term } else { sum - term };
    }
    sum
}

#[test]
fn cramer_has_the_bits_of_its_formula() {
    let mut enclosed = 0;
    for n in 1..=5 {
        for (name, a) in families(n, 3) {
            let outcome = cramer(&a).expect("square");
            let Some((lower, upper)) = outcome.bounds() else { continue };
            enclosed += 1;
            let every: Vec<usize> = (0..n).collect();
            let det = by_last_row(&a, &every, &every);
            for (at, (&l, &u)) in lower.iter().zip(upper).enumerate() {
                let (i, j) = (at / n, at % n);
                let without = |skip: usize| every.iter().copied().filter(|&k| k != skip).collect::<Vec<_>>();
                let cofactor = by_last_row(&a, &without(j), &without(i));
                let entry = if (i + j).is_multiple_of(2) { cofactor / det } else { -cofactor / det };
                assert_eq!((l, u), (entry.lo(), entry.hi()), "{name}, n = {n}: entry {at}");
            }
        }
    }
    assert!(enclosed > 15, "{enclosed}");
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
fn shared_partitions_have_the_bits_of_one_machine() {
    for (name, a) in families(3, 1) {
        for (form, whole) in [(Form::Literal, published(&a, 1000)), (Form::Hull, published_hull(&a, 1000))] {
            let parts = [0..1, 1..300, 300..1000].map(|range| published_part(&a, 1000, form, range).unwrap());
            assert_eq!(published_of_parts(&a, 1000, form, parts).unwrap(), whole.unwrap(), "{name}");
        }
        assert!(published_part(&a, 1000, Form::Hull, 900..1001).is_err(), "{name}");
    }
    // So wide that its cells are halved until their number ends.
    let middle =
        |k: usize| f64::from((7 * (k / 6) + 3 * (k % 6)) as u32 % 11) / 20.0 - 0.25 + f64::from(k.is_multiple_of(7));
    let (low, high): (Vec<f64>, Vec<f64>) = (0..36).map(|k| (middle(k) - 0.12, middle(k) + 0.12)).unzip();
    let wide = matrix(6, &low, &high);
    let mut asked = 0;
    let mut ask = |n: usize, lower: Vec<f64>, upper: Vec<f64>| {
        asked += 1;
        Some(cell_answers(n, &lower, &upper).unwrap())
    };
    assert_eq!(partitioned_shared(&wide, 500, &mut ask).unwrap(), partitioned(&wide, 500).unwrap());
    assert!(asked > 0, "no level had cells enough to be shared");
    for (name, a) in families(5, 1) {
        let mut ask = |n: usize, lower: Vec<f64>, upper: Vec<f64>| cell_answers(n, &lower, &upper).ok();
        assert_eq!(partitioned_shared(&a, 500, &mut ask).unwrap(), partitioned(&a, 500).unwrap(), "{name}");
    }
    // Whoever answers nothing ends the search without a claim.
    assert_eq!(partitioned_shared(&wide, 500, &mut |_, _, _| None).unwrap().status, Status::NotProved);
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
fn unbounded_matrices_are_not_applicable() {
    let a = matrix(2, &[f64::NEG_INFINITY, 0.0, 0.0, 1.0], &[1.0, 0.0, 0.0, 1.0]);
    for outcome in [krawczyk(&a), cramer(&a), hansen_bliek_rohn(&a), exact(&a), published(&a, 5), published_hull(&a, 5)]
    {
        assert_eq!(outcome.unwrap().status, Status::NotApplicable);
    }
}
