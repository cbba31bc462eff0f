//! The follower: at every step the exact hull is inside, emptiness is the exact oracle's, widths are those of the batch.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::items_after_statements,
    reason = "test data are small numbers"
)]

mod common;

use common::{Random, invert, q};
use interval_core::regression::{FeasibleOptions, FeasibleStatus, Rows, feasible_rows};
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use onboard::{Bounds, Follower, Refusal, State};

type Exact = BigRational;

/// True if some member of every row holds at `x`, and `x` lies within the start, exactly (Oettli and Prager).
fn consistent<const N: usize>(rows: &[([Bounds; N], Bounds)], start: &[Bounds; N], x: &[Exact]) -> bool {
    let inside = start.iter().zip(x).all(|(s, v)| q(s.lo) <= *v && *v <= q(s.hi));
    inside
        && rows.iter().all(|(a, y)| {
            let (mut least, mut most) = (Exact::zero(), Exact::zero());
            for (b, v) in a.iter().zip(x) {
                let (p, r) = (q(b.lo) * v, q(b.hi) * v);
                least += p.clone().min(r.clone());
                most += p.max(r);
            }
            (y.hi.is_infinite() || least <= q(y.hi)) && (y.lo.is_infinite() || q(y.lo) <= most)
        })
}

/// The exact hull: the candidates are all vertices of all orthants. The value is `None` for an empty set.
fn oracle<const N: usize>(rows: &[([Bounds; N], Bounds)], start: &[Bounds; N]) -> Option<Vec<(Exact, Exact)>> {
    let mut hull: Option<Vec<(Exact, Exact)>> = None;
    for signs in 0..1_usize << N {
        let mut planes: Vec<(Vec<Exact>, Exact)> = Vec::new();
        for (a, y) in rows {
            for (upper, right) in [(false, y.hi), (true, y.lo)] {
                let pick = |j: usize| if (signs >> j & 1 == 1) == upper { q(a[j].lo) } else { q(a[j].hi) };
                if right.is_finite() {
                    planes.push(((0..N).map(pick).collect(), q(right)));
                }
            }
        }
        for j in 0..N {
            let unit: Vec<Exact> = (0..N).map(|k| common::integer(i64::from(k == j))).collect();
            for right in [q(start[j].lo), q(start[j].hi), Exact::zero()] {
                planes.push((unit.clone(), right));
            }
        }
        for choice in subsets(planes.len(), N) {
            let square: Vec<Exact> = choice.iter().flat_map(|&p| planes[p].0.clone()).collect();
            let Some(inverse) = invert(&square, N).1 else { continue };
            let x: Vec<Exact> = (0..N)
                .map(|i| (0..N).fold(Exact::zero(), |s, k| s + &inverse[i * N + k] * &planes[choice[k]].1))
                .collect();
            let here = (0..N).all(|j| if signs >> j & 1 == 1 { !x[j].is_positive() } else { !x[j].is_negative() });
            if here && consistent(rows, start, &x) {
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
    let with_last = |last: usize| {
        subsets(last, size - 1).into_iter().map(move |mut rest| {
            rest.push(last);
            rest
        })
    };
    (0..count).flat_map(with_last).collect()
}

/// A row about a truth; every few rows it is false, so that sets become empty.
fn random_row<const N: usize>(
    random: &mut Random,
    truth: &[f64; N],
    radius: f64,
    wrong: bool,
) -> ([Bounds; N], Bounds) {
    let a: [f64; N] = std::array::from_fn(|_| random.unit());
    let value: f64 = a.iter().zip(truth).map(|(a, t)| a * t).sum();
    let bounds =
        a.map(|x| Bounds::new(x - radius * (0.5 + 0.5 * random.unit()), x + radius * (0.5 + 0.5 * random.unit())));
    let shift = if wrong { 2.0 + random.unit() } else { 0.25 * random.unit() };
    (bounds, Bounds::new(value + shift - 0.3, value + shift + 0.3))
}

/// Follows rows and asks the oracle after each of them.
fn follow_beside_the_oracle<const N: usize, const ROWS: usize>(seed: u64, trials: usize, rows: usize) -> [usize; 3] {
    let mut random = Random(seed);
    let (mut compared, mut empty, mut proved) = (0, 0, 0);
    for trial in 0..trials {
        let radius = [0.0, 1e-6, 0.02, 0.2][trial % 4];
        let truth: [f64; N] =
            std::array::from_fn(|_| if trial % 3 == 0 { 0.1 * random.unit() } else { 2.0 * random.unit() });
        let start = [Bounds::new(-3.0, 2.5); N];
        let mut follower = Follower::<N, ROWS>::new(start).expect("a good start");
        let mut given = Vec::new();
        for k in 0..rows {
            let row = random_row(&mut random, &truth, radius, trial % 2 == 1 && k > 2);
            given.push(row);
            let state = follower.row(k as f64, &row.0, row.1).expect("a good row");
            match oracle(&given, &start) {
                None => {
                    empty += 1;
                    proved += usize::from(state != State::Bounded);
                }
                Some(hull) => {
                    assert_eq!(state, State::Bounded, "trial {trial}, row {k}: not empty");
                    for (x, (least, most)) in follower.bounds().iter().zip(&hull) {
                        assert!(q(x.lo) <= *least && *most <= q(x.hi), "trial {trial}, row {k}: the hull sticks out");
                    }
                    compared += 1;
                }
            }
        }
    }
    [compared, empty, proved]
}

#[test]
fn the_exact_hull_is_inside_at_every_step() {
    let [compared, empty, proved] = follow_beside_the_oracle::<2, 8>(31, 40, 6);
    assert!(compared > 120 && empty > 30, "{compared} {empty}");
    // Emptiness is owed only where a combination of the kept half-spaces shows it; almost everywhere here.
    assert!(10 * proved >= 9 * empty, "{proved} of {empty}");
    let [compared, empty, proved] = follow_beside_the_oracle::<3, 6>(32, 4, 3);
    assert!(compared > 8 && proved <= empty, "{compared} {empty} {proved}");
}

/// Multipliers that are powers of two leave no residual, so that each rounding of the proof decides by itself.
#[test]
fn one_unit_in_the_last_place_is_not_lost() {
    let mut random = Random(36);
    for trial in 0..80 {
        let start: [Bounds; 2] = std::array::from_fn(|_| Bounds::new(-2.0 + random.unit(), 2.0 + random.unit()));
        let mut follower = Follower::<2, 6>::new(start).expect("a good start");
        let mut given = Vec::new();
        for k in 0..2 {
            let mut entry = || [-1.0, -0.5, 0.0, 0.5, 1.0, 2.0][random.bits() as usize % 6];
            let a: [Bounds; 2] = std::array::from_fn(|_| entry()).map(|x| Bounds::new(x, x));
            let (middle, scale) = (0.5 * random.unit(), [1.0, 1e-3][trial % 2]);
            given
                .push((a, Bounds::new(middle - scale * (1.0 + random.unit()), middle + scale * (1.1 + random.unit()))));
            let state = follower.row(f64::from(k), &given.last().expect("a row").0, given.last().expect("a row").1);
            let Some(hull) = oracle(&given, &start) else { break };
            assert_eq!(state, Ok(State::Bounded), "trial {trial}");
            for (x, (least, most)) in follower.bounds().iter().zip(&hull) {
                assert!(q(x.lo) <= *least && *most <= q(x.hi), "trial {trial}, row {k}: the hull sticks out");
            }
        }
    }
}

#[test]
fn rows_in_any_unit_say_the_same() {
    // The truth (1, -2) under both sides of rows with radii, and multiples of them by powers of two.
    let bounds = |scale: f64| {
        let mut random = Random(37);
        let mut follower = Follower::<2, 12>::new([Bounds::new(-4.0, 3.0); 2]).expect("a good start");
        for k in 0..60 {
            let (a, y) = random_row(&mut random, &[1.0, -2.0], 0.01, false);
            let a = a.map(|x| Bounds::new(scale * x.lo, scale * x.hi));
            let y = Bounds::new(scale * (y.lo - 0.06), scale * (y.hi + 0.06));
            assert_eq!(follower.row(f64::from(k), &a, y), Ok(State::Bounded));
        }
        *follower.bounds()
    };
    let plain = bounds(1.0);
    assert!(plain.iter().zip([1.0, -2.0]).all(|(x, t)| x.contains(t) && x.width() < 0.5), "{plain:?}");
    for power in [-250, -3, 40, 300] {
        assert_eq!(bounds(f64::powi(2.0, power)), plain, "2^{power}");
    }
}

#[test]
fn the_truth_stays_inside_whatever_the_numbers() {
    let mut random = Random(33);
    let limit = |x: f64| x.clamp(-1e60, 1e60);
    for trial in 0..300 {
        let truth: [f64; 3] = std::array::from_fn(|_| limit(random.spicy()));
        let start = truth.map(|t| Bounds::new(t - 1.0 - t.abs(), t + 1.0 + 2.0 * t.abs()));
        let mut follower = Follower::<3, 6>::new(start).expect("a good start");
        for k in 0..30 {
            let mut exact = Exact::zero();
            let mut magnitude = 0.0;
            let mut a = [Bounds::ZERO; 3];
            for j in 0..3 {
                let x = if trial % 2 == 0 { limit(random.spicy()) } else { random.unit() };
                exact += q(x) * q(truth[j]);
                magnitude += (x * truth[j]).abs();
                let more = if k % 3 == 0 { 0.0 } else { x.abs() * 1e-3 };
                a[j] = Bounds::new(x - more, x + more);
            }
            // A right-hand side around the exact value; often the nearest doubles.
            let share = [1e-15, 1e-6, 0.1][k % 3];
            let middle = a.iter().zip(truth).map(|(x, t)| 0.5 * (x.lo + x.hi) * t).sum::<f64>();
            let y = Bounds::new(middle - share * magnitude - 1e-300, middle + share * magnitude + 1e-300);
            if !(q(y.lo) <= exact && exact <= q(y.hi)) {
                continue;
            }
            let state = follower.row(0.0, &a, y).expect("a good row");
            assert_eq!(state, State::Bounded, "trial {trial}, row {k}: the truth is consistent");
            assert!(follower.bounds().iter().zip(truth).all(|(x, t)| x.contains(t)), "trial {trial}, row {k}");
        }
    }
}

#[test]
fn widths_are_those_of_the_batch() {
    let mut random = Random(34);
    for (radius, start) in [(0.0, 1e6), (0.01, 1e6), (0.02, 20.0)] {
        let truth = [3.0, -7.0, 0.02, 11.0, 5.0];
        let mut follower = Follower::<5, 100>::new([Bounds::new(-start, start); 5]).expect("a good start");
        let [mut lower, mut upper, mut low, mut high] = [(); 4].map(|()| Vec::new());
        for k in 0..4000 {
            let (a, y) = random_row(&mut random, &truth, radius, false);
            // The radii are shifted so that the truth stays inside: its share of the right-hand side is 0.05 at least.
            let more = radius * 27.0;
            let y = Bounds::new(y.lo - more, y.hi + more);
            assert_eq!(follower.row(0.1 * f64::from(k), &a, y), Ok(State::Bounded));
            assert!(follower.bounds().iter().zip(truth).all(|(x, t)| x.contains(t)), "row {k}");
            lower.extend(a.map(|x| x.lo));
            upper.extend(a.map(|x| x.hi));
            low.push(y.lo);
            high.push(y.hi);
        }
        let rows = Rows::new(5, &lower, &upper, &low, &high).expect("good rows");
        let batch = feasible_rows(&rows, &FeasibleOptions::default()).expect("good options");
        assert_eq!(batch.status, FeasibleStatus::Enclosed);
        for (x, b) in follower.bounds().iter().zip(batch.parameters.iter()) {
            let ratio = x.width() / b.width();
            assert!((1.0 - 1e-9..1.05).contains(&ratio), "radius {radius}: {ratio}");
        }
    }
}

#[test]
fn an_overdetermined_contradiction_is_proved_once_and_stays() {
    let mut follower = Follower::<2, 8>::new([Bounds::new(-10.0, 10.0); 2]).expect("a good start");
    let point = |x: f64| Bounds::new(x, x);
    for (k, (a, y)) in [([1.0, 1.0], 1.0), ([1.0, -1.0], 0.0), ([1.0, 2.0], 1.5)].into_iter().enumerate() {
        let state = follower.row(k as f64, &a.map(point), Bounds::new(y - 0.1, y + 0.1)).expect("a good row");
        assert_eq!(state, State::Bounded, "row {k}");
    }
    let State::Empty(proof) = follower.row(3.0, &[point(1.0), point(0.0)], Bounds::new(2.0, 3.0)).expect("a good row")
    else {
        panic!("the rows contradict each other")
    };
    assert!(proof.time == 3.0 && proof.oldest <= 3.0 && proof.rows >= 1, "{proof:?}");
    assert_eq!(follower.row(4.0, &[point(1.0), point(0.0)], Bounds::ENTIRE), Ok(State::Empty(proof)));
    follower.restart();
    assert_eq!(follower.row(0.0, &[point(1.0), point(0.0)], Bounds::new(2.0, 3.0)), Ok(State::Bounded));
    // A row without any parameter contradicts by itself.
    let zero = [Bounds::ZERO; 2];
    assert_eq!(follower.row(1.0, &zero, Bounds::new(-1.0, 1.0)), Ok(State::Bounded));
    assert!(matches!(follower.row(2.0, &zero, Bounds::new(1.0, 2.0)), Ok(State::Empty(_))));
}

#[test]
fn misuse_is_refused_and_changes_nothing() {
    let good = [Bounds::new(-1.0, 1.0); 2];
    let refused = |start| Follower::<2, 4>::new(start).map(|_| ());
    assert_eq!(refused([good[0], Bounds::ENTIRE]), Err(Refusal::Start { column: 1 }));
    assert_eq!(refused([Bounds::new(1.0, -1.0), good[0]]), Err(Refusal::Start { column: 0 }));
    assert_eq!(Follower::<2, 4>::drifting(good, [0.0, -1.0]).map(|_| ()), Err(Refusal::Rate { column: 1 }));
    let mut follower = Follower::<2, 4>::new(good).expect("a good start");
    let nan = Bounds::new(f64::NAN, 1.0);
    assert_eq!(follower.row(0.0, &[good[0], nan], good[0]), Err(Refusal::Row { entry: 1 }));
    assert_eq!(follower.row(0.0, &good, nan), Err(Refusal::Row { entry: 2 }));
    assert_eq!(follower.row(f64::NAN, &good, good[0]), Err(Refusal::Time));
    follower.row(5.0, &good, good[0]).expect("a good row");
    assert_eq!(follower.row(4.9, &good, good[0]), Err(Refusal::Time));
    assert_eq!(*follower.bounds(), good);
    for refusal in [Refusal::Time, Refusal::Window, Refusal::Environment, Refusal::Start { column: 1 }] {
        assert!(refusal.to_string().contains("; "), "{refusal}");
    }
}
