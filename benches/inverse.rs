//! Inverses: the published sweep against the number of partitions, and the rigorous methods.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use interval_core::{IntervalMatrix, inverse};
use std::hint::black_box;
use std::time::Duration;

/// `n I + U(-1, 1)` with radii of 1 %, from a fixed sequence.
fn dominant(n: usize) -> IntervalMatrix {
    let mut state = 1_u64;
    let centre: Vec<f64> = (0..n * n)
        .map(|i| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let unit = f64::from(u32::try_from(state >> 33).unwrap_or(0)) / f64::from(1_u32 << 30) - 1.0;
            if i.is_multiple_of(n + 1) { unit + f64::from(u32::try_from(n).unwrap_or(0)) } else { unit }
        })
        .collect();
    let lo = centre.iter().map(|c| c - 0.01 * c.abs()).collect();
    let hi = centre.iter().map(|c| c + 0.01 * c.abs()).collect();
    IntervalMatrix::new(n, n, lo, hi).expect("a good matrix")
}

fn sweep(c: &mut Criterion) {
    for n in [3, 6] {
        let a = dominant(n);
        let mut group = c.benchmark_group(format!("published n={n}"));
        group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(10);
        for partitions in [1_000_u64, 10_000, 100_000, 1_000_000] {
            group.throughput(Throughput::Elements(2 * partitions));
            group.bench_with_input(BenchmarkId::from_parameter(partitions), &partitions, |b, &p| {
                b.iter(|| inverse::published(black_box(&a), p));
            });
        }
    }
}

fn rigorous(c: &mut Criterion) {
    let mut group = c.benchmark_group("rigorous");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(20);
    group.bench_function("exact n=3", |b| b.iter(|| inverse::exact(black_box(&dominant(3)))));
    group.bench_function("cramer n=3", |b| b.iter(|| inverse::cramer(black_box(&dominant(3)))));
    for n in [3, 10] {
        let a = dominant(n);
        group.bench_function(format!("krawczyk n={n}"), |b| b.iter(|| inverse::krawczyk(black_box(&a))));
    }
}

criterion_group!(benches, sweep, rigorous);
criterion_main!(benches);
