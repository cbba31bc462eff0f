//! Change of parameters: windows and rates prove a jump, never change where there is none, and hold a drift.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
mod common;

use common::Random;
use onboard::{Bounds, Follower, Refusal, State, Windows};

/// A sample of two parameters: force of a mass and a drag, with errors up to the bounds.
fn sample(random: &mut Random, truth: [f64; 2]) -> ([Bounds; 2], Bounds) {
    let a = [0.5 * random.unit(), 2.0 * random.unit()];
    let force = a[0] * truth[0] + a[1] * truth[1] + 0.999 * random.unit();
    let read = a.map(|x| x + 0.000_999 * random.unit());
    let wide = 1.0 + 0.001 * (truth[0].abs() + truth[1].abs());
    (read.map(|x| Bounds::reading(x, 0.001)), Bounds::reading(force, wide))
}

const START: [Bounds; 2] = [Bounds::new(-1e3, 1e3), Bounds::new(-1e3, 1e3)];

#[test]
fn a_jump_is_proved_and_a_constant_is_no_change() {
    for seed in 0..20 {
        let mut random = Random(100 + seed);
        let mut windows = Windows::<2, 24>::new(START, 20.0).expect("a good window");
        let jump = 2000 + 100 * u32::try_from(seed).expect("small");
        let (mut changes, mut truth) = (Vec::new(), [60.0, 20.0]);
        for k in 0..6000 {
            if k == jump {
                truth = if seed % 2 == 0 { [60.0, 23.0] } else { [75.0, 20.0] };
            }
            let (a, y) = sample(&mut random, truth);
            let change = windows.row(0.1 * f64::from(k), &a, y).expect("a good row");
            if let Some(change) = change {
                changes.push(change);
            } else if k < jump {
                assert!(windows.together().iter().zip(truth).all(|(x, t)| x.contains(t)), "row {k}");
            }
        }
        // Rows of a mixed window contradict one another or the windows before; what follows is constant again.
        let [first, rest @ ..] = changes.as_slice() else { panic!("seed {seed}: a jump and no proof") };
        let at = 0.1 * f64::from(jump);
        assert!(first.time >= at && first.time < at + 60.0, "seed {seed}: {first:?}");
        assert!(rest.is_empty(), "seed {seed}: {rest:?}");
        assert!(windows.bounds().iter().zip(truth).all(|(x, t)| x.contains(t)), "seed {seed}");
    }
}

#[test]
fn a_drift_within_the_rates_is_held_and_one_beyond_them_is_refuted() {
    for seed in 0..10 {
        let mut random = Random(200 + seed);
        let rates = [0.0, 0.01];
        let mut slow = Follower::<2, 24>::drifting(START, rates).expect("good rates");
        let mut constant = Follower::<2, 24>::new(START).expect("a good start");
        let mut strict = Follower::<2, 24>::drifting(START, [0.0, 0.001]).expect("good rates");
        let (mut constant_empty, mut strict_empty) = (false, false);
        for k in 0..9000 {
            let time = 0.1 * f64::from(k);
            let drag = 20.0 + 0.0099 * if k < 5000 { time } else { 1000.0 - time };
            let (a, y) = sample(&mut random, [60.0, drag]);
            assert_eq!(slow.row(time, &a, y), Ok(State::Bounded), "row {k}");
            let [m, d] = slow.bounds();
            assert!(m.contains(60.0) && d.contains(drag), "row {k}: {m:?} {d:?} {drag}");
            constant_empty |= constant.row(time, &a, y) != Ok(State::Bounded);
            strict_empty |= strict.row(time, &a, y) != Ok(State::Bounded);
        }
        assert!(constant_empty && strict_empty, "seed {seed}: the drift is beyond these");
        // The forgetting is worth its rate: the bounds are as wide as the drift of half a minute or so.
        assert!(slow.bounds()[1].width() < 2.5, "seed {seed}: {:?}", slow.bounds());
    }
}

#[test]
fn a_pause_without_rows_widens_by_the_rate() {
    let mut random = Random(300);
    let mut follower = Follower::<2, 24>::drifting(START, [0.1, 0.01]).expect("good rates");
    for k in 0..2000 {
        let (a, y) = sample(&mut random, [60.0, 20.0]);
        follower.row(0.1 * f64::from(k), &a, y).expect("a good row");
    }
    let before = *follower.bounds();
    follower.advance(300.0).expect("a later time");
    for ((x, b), rate) in follower.bounds().iter().zip(before).zip([0.1, 0.01]) {
        let moved = rate * (300.0 - 199.9);
        assert!(x.lo <= b.lo - moved && x.hi >= b.hi + moved, "{x:?} {b:?}");
        assert!(x.width() < b.width() + 2.001 * moved, "{x:?} {b:?}");
    }
    assert_eq!(follower.advance(299.0), Err(Refusal::Time));
    // A drift beyond every start that is taken, and beyond the doubles, still loses nothing.
    let mut far = Follower::<2, 4>::drifting([Bounds::new(-1e100, 1e100); 2], [1e99; 2]).expect("good rates");
    let row = [Bounds::new(1.0, 1.5), Bounds::new(-0.5, 0.5)];
    for (time, most) in [(0.0, 1e100), (100.0, 1.09e101), (1e300, f64::MAX)] {
        assert_eq!(far.row(time, &row, Bounds::new(0.0, 1.0)), Ok(State::Bounded));
        assert!(far.bounds().iter().all(|x| x.contains(0.0)) && far.bounds()[1].hi >= most, "{time}");
    }
    assert_eq!(Windows::<2, 8>::new(START, 0.0).map(|_| ()), Err(Refusal::Window));
}
