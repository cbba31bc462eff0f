//! Twins of known truth, followed at 10 Hz: violations, widths beside those of the batch, time of a sample.
//!
//! `cargo run --release -p onboard --example twins -- TWINS HOURS [SEED]` prints a table. Every twin's rows go to the
//! follower one by one; the batch then takes all of them at once.
#![allow(
    clippy::print_stdout,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "an example prints counts and times"
)]

mod vessel;

use interval_core::regression::{FeasibleOptions, FeasibleStatus, Rows, feasible_rows};
use onboard::{Bounds, Follower, State};
use std::time::Instant;
use vessel::{Kind, Vessel};

/// Samples whose times are looked at one by one: the first hour, in which the set narrows most.
const WATCHED: u32 = 36_000;

/// What one twin gave.
struct Outcome {
    violations: u64,
    empty: bool,
    /// Largest and mean ratio of a follower's width to the batch's.
    worst: f64,
    mean: f64,
    /// Seconds of a sample: mean and largest; of the batch, spread over the samples.
    sample: f64,
    longest: f64,
    batch: f64,
    sorted: Vec<f64>,
}

fn twin<const N: usize, const ROWS: usize>(kind: Kind, samples: u32, seed: u64, least: f64) -> Outcome {
    let mut vessel = Vessel::new(kind, seed);
    let truth: [f64; N] = vessel.parameters();
    let mut follower = Box::new(Follower::<N, ROWS>::new([Bounds::new(least, 1e4); N]).expect("a good start"));
    let (mut violations, mut empty, mut busy, mut longest) = (0, false, 0.0, 0.0_f64);
    let mut again = follower.clone();
    let mut times = Vec::new();
    let mut kept: [Vec<f64>; 4] = Default::default();
    for k in 0..samples {
        let (rows, count) = vessel.sample::<N>();
        let before = (k < WATCHED).then(|| follower.clone());
        let begin = Instant::now();
        for row in &rows[..count] {
            let state = follower.row(0.1 * f64::from(k), &row.a, row.y).expect("a good row");
            empty |= state != State::Bounded;
        }
        let spent = begin.elapsed().as_secs_f64();
        busy += spent;
        if let Some(before) = before {
            // Other programs take the processor now and then: the least of several runs is the follower's own time.
            let mut least = spent;
            for _ in 0..if spent > 2e-5 { 8 } else { 0 } {
                again.clone_from(&before);
                let begin = Instant::now();
                for row in &rows[..count] {
                    again.row(0.1 * f64::from(k), &row.a, row.y).expect("a good row");
                }
                least = least.min(begin.elapsed().as_secs_f64());
            }
            longest = longest.max(least);
            times.push(least);
        }
        violations += u64::from(follower.bounds().iter().zip(truth).any(|(x, t)| !x.contains(t)));
        for row in &rows[..count] {
            row.a.iter().for_each(|x| {
                kept[0].push(x.lo);
                kept[1].push(x.hi);
            });
            kept[2].push(row.y.lo);
            kept[3].push(row.y.hi);
        }
    }
    let begin = Instant::now();
    let options = FeasibleOptions { signs: (least == 0.0).then(|| vec![1; N]), ..FeasibleOptions::default() };
    let rows = Rows::new(N, &kept[0], &kept[1], &kept[2], &kept[3]).expect("good rows");
    let set = feasible_rows(&rows, &options).expect("good options");
    let batch = begin.elapsed().as_secs_f64();
    assert_eq!(set.status, FeasibleStatus::Enclosed);
    let ratios: Vec<f64> =
        follower.bounds().iter().zip(set.parameters.iter()).map(|(x, b)| x.width() / b.width()).collect();
    // The follower holds the batch's set, whose proved hull may exceed it by roundings.
    for (x, b) in follower.bounds().iter().zip(set.parameters.iter()) {
        let slack = 1e-9 * b.width();
        violations += u64::from(x.lo > b.lo() + slack || x.hi < b.hi() - slack);
    }
    times.sort_by(f64::total_cmp);
    Outcome {
        violations,
        empty,
        worst: ratios.iter().copied().fold(0.0, f64::max),
        mean: ratios.iter().sum::<f64>() / N as f64,
        sample: busy / f64::from(samples),
        longest,
        batch: batch / f64::from(samples),
        sorted: times,
    }
}

fn line(name: &str, outcomes: &[Outcome], hours: f64) {
    let n = outcomes.len() as f64;
    let largest = |f: fn(&Outcome) -> f64| outcomes.iter().map(f).fold(0.0, f64::max);
    let mean = |f: fn(&Outcome) -> f64| outcomes.iter().map(f).sum::<f64>() / n;
    let quantile =
        |q: f64| outcomes.iter().map(|o| o.sorted[((o.sorted.len() - 1) as f64 * q) as usize]).sum::<f64>() / n;
    println!(
        "| {name} | {} | {hours} | {} | {} | {:.4} | {:.4} | {:.1} | {:.1} | {:.0} | {:.1} |",
        outcomes.len(),
        outcomes.iter().map(|o| o.violations).sum::<u64>(),
        outcomes.iter().filter(|o| o.empty).count(),
        mean(|o| o.mean),
        largest(|o| o.worst),
        1e6 * mean(|o| o.sample),
        1e6 * quantile(0.9999),
        1e6 * largest(|o| o.longest),
        1e6 * mean(|o| o.batch),
    );
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |usual: f64| arguments.next().map_or(usual, |a| a.parse().expect("a number"));
    let (twins, hours, seed) = (number(2.0) as u64, number(1.0), number(1.0) as u64);
    let samples = (36_000.0 * hours) as u32;
    println!(
        "| vessel | twins | hours | violations | empty | mean width ratio | largest | us a sample | 99.99 % | longest | batch, us a sample |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for (signs, least) in [("known", 0.0), ("unknown", -1e4)] {
        let outcomes: Vec<Outcome> = (0..twins).map(|k| twin::<5, 160>(Kind::Five, samples, seed + k, least)).collect();
        line(&format!("five parameters, signs {signs}"), &outcomes, hours);
        let outcomes: Vec<Outcome> =
            (0..twins).map(|k| twin::<9, 160>(Kind::Nine, samples, seed + 1000 + k, least)).collect();
        line(&format!("nine parameters, signs {signs}"), &outcomes, hours);
    }
}
