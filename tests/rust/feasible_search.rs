//! The feasible set of many rows: the same bits everywhere, sets in several pieces, degenerate rows, wrong rows.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "test data are small numbers")]

mod common;

use common::rows::{Data, data, plain};
use common::{Random, integer, invert, q};
use interval_core::regression::{FeasibleOptions, FeasibleStatus, OrthantOutcome, Rows, feasible_rows, feasible_set};
use interval_core::rounding::slices::Backend;
use interval_core::{Interval, IntervalMatrix};
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;

fn at(lo: f64, hi: f64) -> Interval {
    Interval::new(lo, hi).expect("ordered")
}

#[test]
fn back_ends_and_threads_give_the_same_bits() {
    for (seed, m, n, radius) in [(1, 20_000, 3, 0.02), (2, 9_000, 6, 0.01), (3, 700, 2, 0.3)] {
        let data = data(seed, m, n, radius, 0.5, 8.0);
        let first = data.set(&plain());
        assert_eq!(first.status, FeasibleStatus::Enclosed);
        assert!(first.parameters.iter().zip(&data.truth).all(|(x, t)| x.contains(*t)));
        for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
            let options = FeasibleOptions { backend: Some(backend), ..plain() };
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                assert_eq!(pool.install(|| data.set(&options)), first, "{backend:?}, {threads} threads");
            }
        }
    }
}

/// True if some member of every row holds at `x`, exactly (Oettli-Prager).
fn consistent(data: &Data, x: &[BigRational]) -> bool {
    (0..data.count()).all(|i| {
        let (mut least, mut most) = (BigRational::zero(), BigRational::zero());
        for (j, v) in x.iter().enumerate() {
            let (p, r) = (q(data.lower[i * data.n + j]) * v, q(data.upper[i * data.n + j]) * v);
            least += p.clone().min(r.clone());
            most += p.max(r);
        }
        least <= q(data.high[i]) && q(data.low[i]) <= most
    })
}

/// The exact hull: every vertex of every orthant's polyhedron, tried out.
fn oracle(data: &Data) -> Option<Vec<(BigRational, BigRational)>> {
    let n = data.n;
    let mut hull: Option<Vec<(BigRational, BigRational)>> = None;
    for signs in 0..1_usize << n {
        let negative = |j: usize| signs >> j & 1 == 1;
        let mut planes: Vec<(Vec<BigRational>, BigRational)> = Vec::new();
        for i in 0..data.count() {
            let pick = |upper: bool| {
                (0..n)
                    .map(|j| q(if negative(j) == upper { data.lower[i * n + j] } else { data.upper[i * n + j] }))
                    .collect::<Vec<_>>()
            };
            planes.push((pick(false), q(data.high[i])));
            planes.push((pick(true), q(data.low[i])));
        }
        for j in 0..n {
            planes.push(((0..n).map(|k| integer(i64::from(k == j))).collect(), BigRational::zero()));
        }
        let mut choice: Vec<usize> = (0..n).collect();
        loop {
            let square: Vec<BigRational> = choice.iter().flat_map(|&p| planes[p].0.clone()).collect();
            if let Some(inverse) = invert(&square, n).1 {
                let x: Vec<BigRational> = (0..n)
                    .map(|i| (0..n).fold(BigRational::zero(), |s, k| s + &inverse[i * n + k] * &planes[choice[k]].1))
                    .collect();
                let inside =
                    x.iter().enumerate().all(|(j, v)| if negative(j) { !v.is_positive() } else { !v.is_negative() });
                if inside && consistent(data, &x) {
                    hull = Some(match hull {
                        None => x.into_iter().map(|v| (v.clone(), v)).collect(),
                        Some(h) => h.into_iter().zip(x).map(|((l, u), v)| (l.min(v.clone()), u.max(v))).collect(),
                    });
                }
            }
            // The next subset in order.
            let Some(at) = (0..n).rev().find(|&k| choice[k] < planes.len() - n + k) else { break };
            choice[at] += 1;
            for k in at + 1..n {
                choice[k] = choice[k - 1] + 1;
            }
        }
    }
    hull
}

/// Rows whose set is bounded by `|x_j| <= 4` and otherwise wide: often in several orthants, and in pieces.
fn wide(seed: u64, m: usize, n: usize) -> Data {
    let mut random = Random(seed);
    let mut made = Data { n, lower: vec![], upper: vec![], low: vec![], high: vec![], truth: vec![0.0; n] };
    for i in 0..m {
        for j in 0..n {
            let (centre, radius) =
                if i < n { (f64::from(u8::from(i == j)), 0.0) } else { (random.unit(), 0.8 * random.unit().abs()) };
            made.lower.push(centre - radius);
            made.upper.push(centre + radius);
        }
        let (centre, radius) = if i < n { (0.0, 4.0) } else { (2.0 * random.unit(), 0.3) };
        made.low.push(centre - radius);
        made.high.push(centre + radius);
    }
    made
}

#[test]
fn sets_in_several_orthants_have_their_exact_hull() {
    let (mut met, mut empty) = (0, 0);
    for seed in 0..60 {
        let n = 1 + (seed % 2) as usize + usize::from(seed % 20 == 7);
        let data = wide(seed, n + 3, n);
        let set = data.set(&plain());
        match oracle(&data) {
            None => {
                assert_eq!(set.status, FeasibleStatus::Empty, "seed {seed}");
                empty += 1;
            }
            Some(hull) => {
                assert_eq!(set.status, FeasibleStatus::Enclosed, "seed {seed}");
                met += set.orthants.iter().filter(|o| matches!(*o.outcome, OrthantOutcome::Bounded(_))).count();
                for (x, (least, most)) in set.parameters.iter().zip(&hull) {
                    assert!(q(x.lo()) <= *least && *most <= q(x.hi()), "seed {seed}: the hull sticks out");
                    assert!(least - q(x.lo()) < q(1e-12) && q(x.hi()) - most < q(1e-12), "seed {seed}: too wide");
                }
            }
        }
    }
    assert!(met > 60 && empty > 3, "{met} {empty}");
}

#[test]
fn degenerate_families() {
    // All rows equal: one direction is determined, the other is free.
    let equal = Data {
        n: 2,
        lower: [1.0, 2.0].repeat(5000),
        upper: [1.0, 2.0].repeat(5000),
        low: vec![3.0; 5000],
        high: vec![4.0; 5000],
        truth: vec![],
    };
    let set = equal.set(&plain());
    assert_eq!(set.status, FeasibleStatus::Unbounded);
    assert_eq!(set.directions, [vec![1.0, -0.5]]);
    // Fewer rows than unknowns, and a column that stands in none of them: a basis of the null space, with exact zeros.
    let few = Data {
        n: 4,
        lower: vec![1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0],
        upper: vec![1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0],
        low: vec![1.0, 2.0],
        high: vec![1.5, 2.5],
        truth: vec![],
    };
    let set = few.set(&plain());
    assert_eq!(set.parameters[1], at(2.0, 2.5));
    assert_eq!(set.directions, [vec![1.0, 0.0, 0.0, -1.0], vec![0.0, 0.0, 1.0, 0.0]]);
    // One point, by equalities in twice as many rows.
    let point = Data {
        n: 2,
        lower: vec![1.0, 1.0, 1.0, -1.0, 2.0, 1.0, 0.0, 3.0],
        upper: vec![1.0, 1.0, 1.0, -1.0, 2.0, 1.0, 0.0, 3.0],
        low: vec![3.0, 1.0, 5.0, 3.0],
        high: vec![3.0, 1.0, 5.0, 3.0],
        truth: vec![],
    };
    let set = point.set(&plain());
    assert_eq!(
        (set.status, set.parameters[0], set.parameters[1]),
        (FeasibleStatus::Enclosed, at(2.0, 2.0), at(1.0, 1.0))
    );
    // Empty by one unit in the last place, in two unknowns and between other rows.
    let mut off = point.clone();
    (off.low[2], off.high[2]) = (5.0_f64.next_up(), 5.0_f64.next_up());
    let set = off.set(&plain());
    assert_eq!(set.status, FeasibleStatus::Empty);
    let OrthantOutcome::Empty { rows } = &*set.orthants[0].outcome else { panic!("a proof") };
    assert!(rows.iter().any(|r| r.0 == 2) && rows.len() == 3, "{rows:?}");
    // The same point in scales that lie three hundred powers of ten apart, exactly.
    let (small, large) = (2.0_f64.powi(-500), 2.0_f64.powi(500));
    let mut spread = point.clone();
    for (at, x) in spread.lower.iter_mut().chain(&mut spread.upper).enumerate() {
        *x *= if at % 2 == 0 { small } else { large };
    }
    let set = spread.set(&plain());
    assert_eq!(*set.parameters, [at(2.0 / small, 2.0 / small), at(1.0 / large, 1.0 / large)]);
    // A zero row that says no among many that say nothing.
    let mut zero = data(9, 3000, 2, 0.0, 0.5, 3.0);
    zero.lower[2 * 1777..2 * 1778].fill(0.0);
    zero.upper[2 * 1777..2 * 1778].fill(0.0);
    (zero.low[1777], zero.high[1777]) = (0.25, 0.5);
    assert_eq!(zero.set(&plain()).status, FeasibleStatus::Empty);
}

#[test]
fn stated_signs_narrow_and_are_checked() {
    let both = Data {
        n: 1,
        lower: vec![-1.0, 1.0],
        upper: vec![1.0, 1.0],
        low: vec![1.0, -2.0],
        high: vec![1.0, 2.0],
        truth: vec![],
    };
    let positive = both.set(&FeasibleOptions { signs: Some(vec![1]), ..plain() });
    assert_eq!(*positive.parameters, [at(1.0, 2.0)]);
    let negative = both.set(&FeasibleOptions { signs: Some(vec![-1]), ..plain() });
    assert_eq!(*negative.parameters, [at(-2.0, -1.0)]);
    assert!(feasible_rows(&both.rows(), &FeasibleOptions { signs: Some(vec![1, 1]), ..plain() }).is_err());
}

/// Every subset of `count` rows of this size.
fn subsets(count: usize, size: usize) -> Vec<Vec<usize>> {
    (0..1_usize << count)
        .filter(|b| b.count_ones() as usize == size)
        .map(|b| (0..count).filter(|i| b >> i & 1 == 1).collect())
        .collect()
}

#[test]
fn wrong_rows_against_every_subset() {
    let mut found = [0; 4];
    for seed in 0..30 {
        let n = 1 + (seed % 2) as usize;
        let m = 7;
        let mut data = data(seed, m, n, 0.02, 0.4, 3.0);
        let mut random = Random(seed + 1000);
        for _ in 0..seed % 4 {
            let i = (random.bits() % m as u64) as usize;
            let by = 4.0 * random.unit();
            data.low[i] += by;
            data.high[i] += by;
        }
        let allowed = 1 + (seed % 3) as usize % 2;
        let set = data.set(&FeasibleOptions { outliers: allowed, ..plain() });
        let mut hull = vec![Interval::EMPTY; n];
        let (mut fewest, mut sets) = (None, Vec::new());
        for size in 0..=allowed {
            for dropped in subsets(m, size) {
                let rest: Vec<usize> = (0..m).filter(|i| !dropped.contains(i)).collect();
                let part = data.take(&rest).set(&plain());
                if part.status == FeasibleStatus::Empty {
                    continue;
                }
                if fewest.is_none_or(|k| k == size) {
                    fewest = Some(size);
                    sets.push(dropped);
                }
                hull.iter_mut().zip(part.parameters.iter()).for_each(|(h, x)| *h = h.hull(*x));
            }
        }
        let outliers = set.outliers.as_ref().expect("outliers were allowed");
        sets.sort_unstable();
        assert_eq!((outliers.fewest, &outliers.sets), (fewest, &sets), "seed {seed}");
        found[fewest.map_or(3, |k| k)] += 1;
        assert_eq!(set.status == FeasibleStatus::Empty, fewest.is_none(), "seed {seed}");
        for (x, h) in set.parameters.iter().zip(&hull) {
            let same = |a: f64, b: f64| a == b || (a - b).abs() <= 1e-12 * (1.0 + b.abs());
            assert!(
                h.is_empty() == x.is_empty() && (h.is_empty() || (same(x.lo(), h.lo()) && same(x.hi(), h.hi()))),
                "seed {seed}: {x} {h}"
            );
        }
    }
    assert!(found.iter().all(|&k| k > 1), "{found:?}");
}

#[test]
fn matrices_and_borrowed_rows_agree() {
    let data = data(4, 50, 3, 0.05, 0.5, 3.0);
    let a = IntervalMatrix::new(50, 3, data.lower.clone(), data.upper.clone()).expect("good rows");
    let y: Vec<Interval> = data.low.iter().zip(&data.high).map(|(&l, &h)| at(l, h)).collect();
    assert_eq!(feasible_set(&a, &y).expect("good rows"), data.set(&plain()));
    let nan = [f64::NAN; 3];
    assert!(Rows::new(3, &nan, &nan, &[0.0], &[1.0]).is_err());
    assert!(Rows::new(3, &data.lower[..3], &data.upper[..3], &[1.0], &[0.0]).is_err());
    assert!(Rows::new(3, &data.upper[..3], &data.lower[..3], &[0.0], &[1.0]).is_err());
    assert!(Rows::new(2, &data.lower[..3], &data.upper[..3], &[0.0], &[1.0]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn wider_rows_never_narrow_and_order_does_not_matter(seed in any::<u64>(), n in 1_usize..5) {
        let data = data(seed, 60, n, 0.02, 0.5, 4.0);
        let first = data.set(&plain());
        let mut random = Random(seed.wrapping_add(77));
        let mut wider = data.clone();
        for i in 0..60 {
            match random.bits() % 4 {
                0 => wider.low[i] -= random.unit().abs(),
                1 => wider.high[i] += random.unit().abs(),
                2 => wider.lower[i * n] -= 0.1 * random.unit().abs(),
                _ => {}
            }
        }
        let mut order: Vec<usize> = (0..60).collect();
        for i in 0..60 {
            order.swap(i, (random.bits() % 60) as usize);
        }
        let (loose, again) = (wider.set(&plain()), data.take(&order).set(&plain()));
        let fewer = data.take(&order[..50]).set(&plain());
        for j in 0..n {
            let x = first.parameters[j];
            let slack = 1e-12 * (1.0 + x.magnitude());
            for w in [loose.parameters[j], fewer.parameters[j]] {
                prop_assert!(w.lo() <= x.lo() + slack && w.hi() >= x.hi() - slack);
            }
            let p = again.parameters[j];
            prop_assert!((p.lo() - x.lo()).abs() <= slack && (p.hi() - x.hi()).abs() <= slack);
        }
    }
}
