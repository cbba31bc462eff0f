//! Twins of known truth, followed at 10 Hz: violations, widths beside those of the batch, time of a sample.
//!
//! `cargo run --release -p onboard --example twins -- TWINS HOURS [SEED [GROUP]]` prints a line for each twin, and `twins
//! table` makes the table from such lines. Every twin's rows go to the follower one by one; the batch then takes all of
//! them at once.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
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

/// The four groups of the study: name, and the start of every parameter.
const GROUPS: [(&str, Kind, f64); 4] = [
    ("five parameters, signs known", Kind::Five, 0.0),
    ("nine parameters, signs known", Kind::Nine, 0.0),
    ("five parameters, signs unknown", Kind::Five, -1e4),
    ("nine parameters, signs unknown", Kind::Nine, -1e4),
];

/// A line of a twin: group, seed, hours, and the numbers of its outcome.
fn follow(group: usize, seed: u64, hours: f64) -> String {
    let samples = (36_000.0 * hours) as u32;
    let (_, kind, least) = GROUPS[group];
    let o = match kind {
        Kind::Five => twin::<5, 304>(kind, samples, seed, least),
        Kind::Nine => twin::<9, 304>(kind, samples, seed + 1000, least),
    };
    let late = o.sorted[((o.sorted.len() - 1) as f64 * 0.9999) as usize];
    let times = [o.sample, late, o.longest, o.batch].map(|t| format!("{:.2}", 1e6 * t)).join(" ");
    format!("{group} {seed} {hours} {} {} {:.6} {:.6} {times}", o.violations, u8::from(o.empty), o.mean, o.worst)
}

/// The table of the lines of twins.
fn table(lines: &[Vec<f64>]) {
    println!(
        "| vessel | twins | hours | violations | proved empty | mean width ratio | largest width ratio | us a sample | 99.99 % | longest | batch, us a sample |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for (group, (name, ..)) in GROUPS.iter().enumerate() {
        let of: Vec<&Vec<f64>> = lines.iter().filter(|l| l[0] == group as f64).collect();
        let sum = |k: usize| of.iter().map(|l| l[k]).sum::<f64>();
        let (mean, largest) = (|k| sum(k) / of.len() as f64, |k: usize| of.iter().map(|l| l[k]).fold(0.0, f64::max));
        println!(
            "| {name} | {} | {} | {} | {} | {:.4} | {:.4} | {:.1} | {:.0} | {:.0} | {:.1} |",
            of.len(),
            sum(2),
            sum(3),
            sum(4),
            mean(5),
            largest(6),
            mean(7),
            mean(8),
            largest(9),
            mean(10),
        );
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.first().is_some_and(|a| a == "table") {
        let text = std::io::read_to_string(std::io::stdin()).expect("lines of twins");
        let numbers = |l: &str| l.split(' ').map(|x| x.parse().expect("a number")).collect();
        return table(&text.lines().map(numbers).collect::<Vec<_>>());
    }
    let number = |k: usize, usual: f64| arguments.get(k).map_or(usual, |a| a.parse().expect("a number"));
    let (twins, hours, seed) = (number(0, 2.0) as u64, number(1, 1.0), number(2, 1.0) as u64);
    let groups = arguments.get(3).map_or(0..4, |a| a.parse().map(|g| g..g + 1).expect("the number of a group"));
    for k in 0..twins {
        for group in groups.clone() {
            println!("{}", follow(group, seed + k, hours));
        }
    }
}
