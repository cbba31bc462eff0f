//! The feasible set against the number of rows, and interval arithmetic against a plain loop.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use interval_core::regression::{FeasibleOptions, Rows, feasible_rows, feasible_set, least_squares};
use interval_core::{Interval, IntervalMatrix};
use std::hint::black_box;
use std::time::Duration;

fn unit(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    f64::from(u32::try_from(*state >> 33).unwrap_or(0)) / f64::from(1_u32 << 30) - 1.0
}

fn rows(m: usize) -> (IntervalMatrix, Vec<Interval>) {
    let truth = [60.0, 255.0, 20.0];
    let mut state = 7;
    let (mut lo, mut hi, mut y) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..m {
        let exact = [unit(&mut state), unit(&mut state), unit(&mut state)];
        let value: f64 = exact.iter().zip(truth).map(|(a, t)| a * t).sum();
        let slack = 0.05 * (truth[0] + truth[1] + truth[2]);
        for a in exact {
            let shift = 0.04 * unit(&mut state);
            lo.push(a + shift - 0.05);
            hi.push(a + shift + 0.05);
        }
        y.push(Interval::new(value - slack, value + slack).expect("ordered"));
    }
    (IntervalMatrix::new(m, 3, lo, hi).expect("good rows"), y)
}

fn feasible(c: &mut Criterion) {
    let mut group = c.benchmark_group("feasible 3 parameters");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2)).sample_size(10);
    for m in [300, 3_000, 30_000] {
        let (a, y) = rows(m);
        group.throughput(Throughput::Elements(m as u64));
        group.bench_with_input(BenchmarkId::from_parameter(m), &m, |b, _| b.iter(|| feasible_set(black_box(&a), &y)));
    }
}

/// Rows with radii of 0.01 and parameters of either sign, as four arrays.
fn bounds(m: usize, n: usize) -> [Vec<f64>; 4] {
    let mut state = 11;
    let truth: Vec<f64> = (0..n).map(|_| 50.0 * unit(&mut state)).collect();
    let mut made = [vec![], vec![], vec![], vec![]];
    for _ in 0..m {
        let mut value = unit(&mut state);
        for t in &truth {
            let exact = unit(&mut state);
            let shift = 0.01 * unit(&mut state);
            made[0].push(exact + shift - 0.01);
            made[1].push(exact + shift + 0.01);
            value += exact * t;
        }
        made[2].push(value - 1.1);
        made[3].push(value + 1.1);
    }
    made
}

fn many_rows(c: &mut Criterion) {
    let mut group = c.benchmark_group("many rows");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(5)).sample_size(10);
    for (m, n) in [(12_000, 9), (1_000_000, 3), (100_000, 12)] {
        let [lower, upper, low, high] = bounds(m, n);
        group.throughput(Throughput::Elements(m as u64));
        let name = format!("{m} x {n}");
        group.bench_function(BenchmarkId::new("feasible", &name), |b| {
            b.iter(|| {
                let rows = Rows::new(n, black_box(&lower), &upper, &low, &high).expect("good rows");
                feasible_rows(&rows, &FeasibleOptions::default())
            });
        });
        group.bench_function(BenchmarkId::new("least squares", &name), |b| {
            b.iter(|| least_squares(&Rows::new(n, black_box(&lower), &upper, &low, &high).expect("good rows")));
        });
    }
}

type Operation = fn(Interval, Interval) -> Interval;

fn arithmetic(c: &mut Criterion) {
    let mut state = 3;
    let x: Vec<Interval> = (0..4096).map(|_| Interval::point(unit(&mut state)).expect("finite")).collect();
    let y: Vec<Interval> = x.iter().rev().copied().collect();
    let mut group = c.benchmark_group("4096 intervals");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(20);
    group.throughput(Throughput::Elements(4096));
    group.bench_function("plain f64 product, one bound", |b| {
        b.iter(|| x.iter().zip(&y).map(|(a, b)| a.lo() * b.lo()).fold(0.0, f64::max));
    });
    let operations: [(&str, Operation); 3] = [("add", |a, b| a + b), ("mul", |a, b| a * b), ("div", |a, b| a / b)];
    for (name, f) in operations {
        group.bench_function(name, |b| {
            b.iter(|| x.iter().zip(&y).map(|(&a, &b)| f(a, b).hi()).fold(0.0, f64::max));
        });
    }
}

criterion_group!(benches, feasible, many_rows, arithmetic);
criterion_main!(benches);
