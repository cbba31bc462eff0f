//! The feasible set: the truth inside, the hull of an exact oracle inside, tightness apart, proofs of emptiness.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::items_after_statements,
    reason = "test data are small numbers"
)]

mod common;

use common::{Random, invert, q};
use interval_core::regression::{FeasibleStatus, OrthantOutcome, feasible_set, normal_equations};
use interval_core::{Interval, IntervalMatrix, Status, inverse};
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;

fn rows(m: usize, n: usize, lo: &[f64], hi: &[f64]) -> IntervalMatrix {
    IntervalMatrix::new(m, n, lo.to_vec(), hi.to_vec()).expect("good rows")
}

fn at(lo: f64, hi: f64) -> Interval {
    Interval::new(lo, hi).expect("ordered")
}

/// True if some member of every row holds at `x`, exactly (Oettli-Prager).
fn consistent(a: &IntervalMatrix, y: &[Interval], x: &[BigRational]) -> bool {
    (0..a.rows()).all(|i| {
        let (mut least, mut most) = (BigRational::zero(), BigRational::zero());
        for (j, v) in x.iter().enumerate() {
            let (p, r) = (q(a.get(i, j).lo()) * v, q(a.get(i, j).hi()) * v);
            least += p.clone().min(r.clone());
            most += p.max(r);
        }
        least <= q(y[i].hi()) && q(y[i].lo()) <= most
    })
}

/// The exact hull for few rows: every vertex of every orthant's polyhedron, tried out. `None` where there is none.
fn oracle(a: &IntervalMatrix, y: &[Interval]) -> Option<Vec<(BigRational, BigRational)>> {
    let n = a.columns();
    let mut hull: Option<Vec<(BigRational, BigRational)>> = None;
    for signs in 0..1_usize << n {
        let negative = |j: usize| signs >> j & 1 == 1;
        let mut planes: Vec<(Vec<BigRational>, BigRational)> = Vec::new();
        for i in 0..a.rows() {
            let pick = |upper: bool| {
                (0..n)
                    .map(|j| q(if negative(j) == upper { a.get(i, j).lo() } else { a.get(i, j).hi() }))
                    .collect::<Vec<_>>()
            };
            planes.push((pick(false), q(y[i].hi())));
            planes.push((pick(true), q(y[i].lo())));
        }
        for j in 0..n {
            planes.push(((0..n).map(|k| common::integer(i64::from(k == j))).collect(), BigRational::zero()));
        }
        for choice in subsets(planes.len(), n) {
            let square: Vec<BigRational> = choice.iter().flat_map(|&p| planes[p].0.clone()).collect();
            let Some(inverse) = invert(&square, n).1 else { continue };
            let x: Vec<BigRational> = (0..n)
                .map(|i| {
                    choice
                        .iter()
                        .enumerate()
                        .fold(BigRational::zero(), |s, (k, &p)| s + &inverse[i * n + k] * &planes[p].1)
                })
                .collect();
            let inside =
                x.iter().enumerate().all(|(j, v)| if negative(j) { !v.is_positive() } else { !v.is_negative() });
            if inside && consistent(a, y, &x) {
                hull = Some(match hull {
                    None => x.into_iter().map(|v| (v.clone(), v)).collect(),
                    Some(h) => h.into_iter().zip(x).map(|((l, u), v)| (l.min(v.clone()), u.max(v))).collect(),
                });
            }
        }
    }
    hull
}

fn subsets(count: usize, size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![Vec::new()];
    }
    (0..count)
        .flat_map(|first| {
            subsets(first, size - 1).into_iter().map(move |mut rest| {
                rest.push(first);
                rest
            })
        })
        .collect()
}

/// Random rows; with `radius` 0 the columns are points. Bounded by construction: unit rows for every unknown.
fn random_rows(random: &mut Random, m: usize, n: usize, radius: f64, slack: f64) -> (IntervalMatrix, Vec<Interval>) {
    let truth: Vec<f64> = (0..n).map(|_| 5.0 * random.unit()).collect();
    let (mut lo, mut hi, mut y) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..m {
        let centre: Vec<f64> =
            (0..n).map(|j| if i < n { f64::from(u8::from(i == j)) } else { random.unit() }).collect();
        let value: f64 = centre.iter().zip(&truth).map(|(c, t)| c * t).sum();
        for c in centre {
            lo.push(c - radius * random.unit().abs());
            hi.push(c + radius * random.unit().abs());
        }
        let shift = slack * 1.3 * random.unit();
        y.push(at(value + shift - slack, value + shift + slack));
    }
    (rows(m, n, &lo, &hi), y)
}

#[test]
fn the_exact_hull_is_inside_and_nearly_equal() {
    let mut random = Random(21);
    let (mut enclosed, mut empty) = (0, 0);
    for trial in 0..160 {
        let n = 1 + trial % 2;
        let m = 2 + trial % 5 + n;
        let radius = [0.0, 1e-9, 0.01, 0.1][trial % 4];
        let (a, y) = random_rows(&mut random, m, n, radius, 0.5);
        let found = feasible_set(&a, &y).expect("good rows");
        match oracle(&a, &y) {
            None => {
                assert_eq!(found.status, FeasibleStatus::Empty, "trial {trial}");
                assert!(found.inflation.is_none_or(|k| k > 1.0 - 1e-9), "trial {trial}");
                empty += 1;
            }
            Some(hull) => {
                assert_eq!(found.status, FeasibleStatus::Enclosed, "trial {trial}");
                assert!(found.inflation.is_some_and(|k| k <= 1.0 + 1e-9), "trial {trial}: {:?}", found.inflation);
                for (x, (least, most)) in found.parameters.iter().zip(&hull) {
                    assert!(q(x.lo()) <= *least && *most <= q(x.hi()), "trial {trial}: the hull sticks out");
                    let slack = 1e-9 * (1.0 + x.magnitude());
                    assert!(
                        least.clone() - q(x.lo()) < q(slack) && q(x.hi()) - most < q(slack),
                        "trial {trial}: too wide"
                    );
                }
                enclosed += 1;
            }
        }
    }
    assert!(enclosed > 60 && empty > 20, "{enclosed} {empty}");
}

#[test]
fn three_unknowns_against_the_oracle() {
    let mut random = Random(22);
    for trial in 0..6 {
        let (a, y) = random_rows(&mut random, 5, 3, 0.05, 0.6);
        let found = feasible_set(&a, &y).expect("good rows");
        match oracle(&a, &y) {
            None => assert_eq!(found.status, FeasibleStatus::Empty, "trial {trial}"),
            Some(hull) => {
                for (x, (least, most)) in found.parameters.iter().zip(&hull) {
                    assert!(q(x.lo()) <= *least && *most <= q(x.hi()), "trial {trial}");
                    assert!(least.clone() - q(x.lo()) < q(1e-9) && q(x.hi()) - most < q(1e-9), "trial {trial}");
                }
            }
        }
    }
}

#[test]
fn a_set_in_two_pieces_is_covered() {
    let a = rows(2, 1, &[-1.0, 1.0], &[1.0, 1.0]);
    let found = feasible_set(&a, &[at(1.0, 1.0), at(-2.0, 2.0)]).unwrap();
    assert_eq!(found.status, FeasibleStatus::Enclosed);
    assert!(
        found.parameters[0].contains(-2.0)
            && found.parameters[0].contains(2.0)
            && found.parameters[0].width() < 4.000_000_1
    );
}

#[test]
fn open_ends_are_infinite_and_their_directions_named() {
    let a = rows(1, 2, &[1.0, 1.0], &[1.0, 1.0]);
    let found = feasible_set(&a, &[at(1.0, 2.0)]).unwrap();
    assert_eq!(found.status, FeasibleStatus::Unbounded);
    assert!(found.parameters.iter().all(|x| *x == Interval::ENTIRE));
    assert!(found.directions.iter().any(|d| (d[0] + d[1]).abs() < 1e-12));
    // A column that stands in no row leaves its own unknown open, and only that.
    let a = rows(3, 2, &[1.0, 0.0, 2.0, 0.0, 3.0, 0.0], &[1.0, 0.0, 2.0, 0.0, 3.0, 0.0]);
    let found = feasible_set(&a, &[at(1.0, 1.1), at(2.0, 2.2), at(3.0, 3.3)]).unwrap();
    assert_eq!(found.status, FeasibleStatus::Unbounded);
    assert_eq!(found.parameters[1], Interval::ENTIRE);
    assert_eq!((found.parameters[0].lo(), found.parameters[0].hi()), (1.0, 1.1));
    // One half-line: x >= 1 only.
    let found = feasible_set(&rows(1, 1, &[1.0], &[1.0]), &[at(1.0, f64::INFINITY)]).unwrap();
    assert_eq!(found.parameters[0], at(1.0, f64::INFINITY));
    assert_eq!(found.status, FeasibleStatus::Unbounded);
}

#[test]
fn regressors_that_may_vanish_leave_ends_open() {
    let found = feasible_set(&rows(1, 1, &[0.0], &[1.0]), &[at(1.0, 1.0)]).unwrap();
    assert_eq!(found.status, FeasibleStatus::Unbounded);
    assert_eq!(found.parameters[0], at(1.0, f64::INFINITY));
}

#[test]
fn empty_sets_are_proved_by_few_rows() {
    let a = rows(4, 1, &[1.0; 4], &[1.0; 4]);
    let y = [at(0.0, 1.0), at(0.5, 2.0), at(1.0 + f64::EPSILON, 3.0), at(-1.0, 4.0)];
    let found = feasible_set(&a, &y).unwrap();
    assert_eq!(found.status, FeasibleStatus::Empty, "empty by one unit in the last place");
    let OrthantOutcome::Empty { rows } = &*found.orthants[0].outcome else { panic!("a proof") };
    let mut named: Vec<usize> = rows.iter().map(|r| r.0).collect();
    named.sort_unstable();
    assert_eq!(named, [0, 2]);
    let touching = [at(0.0, 1.0), at(0.5, 2.0), at(1.0, 3.0), at(-1.0, 4.0)];
    let found = feasible_set(&a, &touching).unwrap();
    assert_eq!((found.status, found.parameters[0]), (FeasibleStatus::Enclosed, at(1.0, 1.0)));
}

#[test]
fn degenerate_rows() {
    // Duplicate rows, equalities, a zero row that says nothing and one that says no.
    let a = rows(4, 2, &[1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0], &[1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let found = feasible_set(&a, &[at(2.0, 2.0), at(2.0, 2.0), at(3.0, 3.0), at(-1.0, 1.0)]).unwrap();
    assert_eq!(*found.parameters, [at(2.0, 2.0), at(3.0, 3.0)]);
    let found = feasible_set(&a, &[at(2.0, 2.0), at(2.0, 2.0), at(3.0, 3.0), at(0.5, 1.0)]).unwrap();
    assert_eq!(found.status, FeasibleStatus::Empty);
    // Of a row with an infinite bound only the finite side speaks: x >= 1 here.
    let a = rows(2, 1, &[1.0, f64::NEG_INFINITY], &[1.0, 1.0]);
    let found = feasible_set(&a, &[at(2.0, 3.0), at(1.0, 1.0)]).unwrap();
    assert!(found.parameters[0].contains(2.0) && found.parameters[0].contains(3.0));
    assert!(feasible_set(&a, &[at(1.0, 1.0)]).is_err());
    assert!(feasible_set(&a, &[at(1.0, 1.0), Interval::EMPTY]).is_err());
}

#[test]
fn hugely_different_scales() {
    let a = rows(3, 2, &[1e-150, 0.0, 0.0, 1e150, 1e-150, 1e150], &[1e-150, 0.0, 0.0, 1e150, 1e-150, 1e150]);
    let found = feasible_set(&a, &[at(1.0, 2.0), at(1.0, 2.0), at(2.5, 3.0)]).unwrap();
    assert_eq!(found.status, FeasibleStatus::Enclosed);
    for (x, (least, most)) in
        found.parameters.iter().zip(oracle(&a, &[at(1.0, 2.0), at(1.0, 2.0), at(2.5, 3.0)]).unwrap())
    {
        assert!(q(x.lo()) <= least && most <= q(x.hi()));
    }
}

/// Nine unknowns in three groups of rows as surge, sway and yaw have them; the last two groups cannot tell theirs
/// apart, so the set goes on for ever in many orthants, while the first group's unknowns are enclosed.
#[test]
fn a_set_that_is_open_in_many_orthants() {
    const GROUPS: [&[usize]; 3] = [&[0, 1, 3], &[0, 1, 4, 5], &[2, 5, 6, 7, 8]];
    const TRUTH: [f64; 9] = [80.0, 150.0, 45.0, 77.0, 160.0, 40.0, 43.0, 60.0, 12.0];
    let mut random = Random(9);
    let (m, n) = (1500, 9);
    let (mut lo, mut hi, mut y) = (vec![0.0; m * n], vec![0.0; m * n], Vec::new());
    for i in 0..m {
        let group = GROUPS[i % 3];
        let common = random.unit();
        let mut sum = 0.0;
        for &j in group {
            let own = if i % 3 > 0 { 0.05 } else { 1.0 };
            let x = common + own * random.unit();
            let radius = if i % 3 > 0 { 0.1 } else { 0.01 };
            (lo[i * n + j], hi[i * n + j]) = (x - radius, x + radius);
            sum += x * TRUTH[j];
        }
        y.push(at(sum - 2.0, sum + 2.0));
    }
    let found = feasible_set(&rows(m, n, &lo, &hi), &y).unwrap();
    assert_eq!(found.status, FeasibleStatus::Unbounded);
    assert!(found.orthants.len() > 64, "{}", found.orthants.len());
    for (j, (x, truth)) in found.parameters.iter().zip(TRUTH).enumerate() {
        assert!(x.contains(truth), "{j}: {x}");
        assert_eq!(x.is_bounded(), [0, 1, 3].contains(&j), "{j}: {x}");
    }
    // One ray for each open end is enough.
    assert!(!found.directions.is_empty() && found.directions.len() <= 2 * n, "{}", found.directions.len());
}

#[test]
fn inflation_of_an_open_set_is_looked_for_far_out() {
    // |x - 10| <= k (2 |x| + 1) and |x + 10| <= k (2 |x| + 1): the factor falls towards 1/2 for ever.
    let a = rows(2, 1, &[-1.0, -1.0], &[3.0, 3.0]);
    let found = feasible_set(&a, &[at(9.0, 11.0), at(-11.0, -9.0)]).unwrap();
    let factor = found.inflation.unwrap();
    assert_eq!(found.status, FeasibleStatus::Unbounded);
    assert!((0.5..0.5 + 1e-5).contains(&factor), "{factor}");
}

#[test]
fn inflation_is_the_least_factor() {
    // |x - 0| <= 1 k and |x - 4| <= 1 k: k = 2 at x = 2.
    let a = rows(2, 1, &[1.0, 1.0], &[1.0, 1.0]);
    let found = feasible_set(&a, &[at(-1.0, 1.0), at(3.0, 5.0)]).unwrap();
    assert_eq!(found.status, FeasibleStatus::Empty);
    assert!((found.inflation.unwrap() - 2.0).abs() < 1e-9 && (found.centre.unwrap()[0] - 2.0).abs() < 1e-9);
    // Equalities that contradict each other: no factor helps.
    let found = feasible_set(&a, &[at(0.0, 0.0), at(1.0, 1.0)]).unwrap();
    assert_eq!((found.status, found.inflation), (FeasibleStatus::Empty, None));
    // Against a fine search in one unknown with uncertain regressors.
    let a = rows(3, 1, &[0.9, 1.8, -1.2], &[1.1, 2.3, -0.7]);
    let y = [at(2.0, 2.2), at(3.0, 3.1), at(-4.0, -3.5)];
    let best = (-4000..8000)
        .map(|k| f64::from(k) * 1e-3)
        .map(|x| {
            (0..3)
                .map(|i| {
                    let (row, right) = (a.get(i, 0), y[i]);
                    (row.midpoint() * x - right.midpoint()).abs() / (row.radius() * x.abs() + right.radius())
                })
                .fold(0.0, f64::max)
        })
        .fold(f64::INFINITY, f64::min);
    let found = feasible_set(&a, &y).unwrap().inflation.unwrap();
    assert!(found <= best + 1e-9 && found > best - 1e-2, "{found} {best}");
}

#[test]
fn least_squares_holds_the_truth_where_it_is_proved() {
    let mut random = Random(31);
    let mut proved = 0;
    for _ in 0..60 {
        let n = 1 + (random.bits() % 3) as usize;
        let m = 12;
        let truth: Vec<f64> = (0..n).map(|_| 5.0 * random.unit()).collect();
        let (mut lo, mut hi, mut y) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..m {
            let exact: Vec<f64> = (0..n).map(|_| random.unit()).collect();
            let value = exact.iter().zip(&truth).fold(BigRational::zero(), |s, (a, t)| s + q(*a) * q(*t));
            for a in exact {
                lo.push(a - 0.02 * random.unit().abs());
                hi.push(a + 0.02 * random.unit().abs());
            }
            let (down, up) = (interval_core::exact::ratio_down(&value), interval_core::exact::ratio_up(&value));
            y.push(at(down - 0.05 * random.unit().abs(), up + 0.05 * random.unit().abs()));
        }
        let a = rows(m, n, &lo, &hi);
        let set = feasible_set(&a, &y).unwrap();
        assert!(set.parameters.iter().zip(&truth).all(|(x, t)| x.contains(*t)), "feasible");
        for method in [inverse::exact, inverse::krawczyk, inverse::cramer] {
            let fit = normal_equations(&a, &y, method).unwrap();
            if fit.status == Status::Enclosed {
                proved += 1;
                assert!(
                    fit.parameters.unwrap().certified().unwrap().iter().zip(&truth).all(|(x, t)| x.contains(*t)),
                    "least squares"
                );
            }
        }
        let sweep = normal_equations(&a, &y, |g| inverse::published(g, 100)).unwrap();
        assert_ne!(sweep.status, Status::Enclosed);
        assert!(sweep.parameters.is_none_or(|x| x.certified().is_none()));
    }
    assert!(proved > 60, "{proved}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn a_row_more_never_widens_and_their_order_does_not_matter(seed in any::<u64>()) {
        let mut random = Random(seed);
        let (a, y) = random_rows(&mut random, 9, 2, 0.03, 0.7);
        let whole = feasible_set(&a, &y).unwrap();
        let fewer = rows(8, 2, &a.lo()[..16], &a.hi()[..16]);
        let less = feasible_set(&fewer, &y[..8]).unwrap();
        if whole.status == FeasibleStatus::Enclosed {
            for (x, w) in whole.parameters.iter().zip(less.parameters.iter()) {
                prop_assert!(x.lo() >= w.lo() - 1e-12 * (1.0 + w.magnitude()) && x.hi() <= w.hi() + 1e-12 * (1.0 + w.magnitude()));
            }
            let mut order: Vec<usize> = (0..9).collect();
            for i in 0..9 {
                order.swap(i, (random.bits() % 9) as usize);
            }
            let lo: Vec<f64> = order.iter().flat_map(|&i| a.lo()[2 * i..2 * i + 2].to_vec()).collect();
            let hi: Vec<f64> = order.iter().flat_map(|&i| a.hi()[2 * i..2 * i + 2].to_vec()).collect();
            let shuffled: Vec<Interval> = order.iter().map(|&i| y[i]).collect();
            let again = feasible_set(&rows(9, 2, &lo, &hi), &shuffled).unwrap();
            for (x, w) in whole.parameters.iter().zip(again.parameters.iter()) {
                prop_assert!((x.lo() - w.lo()).abs() <= 1e-12 * (1.0 + w.magnitude()) && (x.hi() - w.hi()).abs() <= 1e-12 * (1.0 + w.magnitude()));
            }
        }
    }
}
