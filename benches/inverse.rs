//! Inverses: the published sweep against N, n and threads; the exact hull; enclosures of large matrices.
//!
//! `python benches/throughput.py` turns the sweep's part into a figure, `python benches/inverse_peers.py` sets it
//! beside peers.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use interval_core::{IntervalMatrix, inverse};
use std::hint::black_box;
use std::time::Duration;

/// `n I + U(-1, 1)` with relative radii, from a fixed sequence.
fn dominant(n: usize, radius: f64, seed: u64) -> IntervalMatrix {
    let mut state = seed;
    let centre: Vec<f64> = (0..n * n)
        .map(|i| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let unit = f64::from(u32::try_from(state >> 33).unwrap_or(0)) / f64::from(1_u32 << 30) - 1.0;
            if i.is_multiple_of(n + 1) { unit + f64::from(u32::try_from(n).unwrap_or(0)) } else { unit }
        })
        .collect();
    let lo = centre.iter().map(|c| c - radius * c.abs()).collect();
    let hi = centre.iter().map(|c| c + radius * c.abs()).collect();
    IntervalMatrix::new(n, n, lo, hi).expect("a good matrix")
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads")
}

fn sweep(c: &mut Criterion) {
    for threads in [1, 2] {
        let pool = pool(threads);
        for (n, largest) in
            [(1, 8), (2, 8), (3, 8), (4, 7), (6, 7), (8, 6), (12, 6), (20, 5), (32, 4), (50, 4), (64, 4)]
        {
            let a = dominant(n, 0.01, 1);
            let mut group = c.benchmark_group(format!("sweep/n={n}/threads={threads}"));
            group.warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(800)).sample_size(10);
            for power in 3..=largest {
                let partitions = 10_u64.pow(power);
                group.throughput(Throughput::Elements(2 * partitions));
                group.bench_with_input(BenchmarkId::from_parameter(partitions), &partitions, |b, &p| {
                    pool.install(|| b.iter(|| inverse::published(black_box(&a), p)));
                });
            }
        }
    }
}

fn hull(c: &mut Criterion) {
    let mut group = c.benchmark_group("hull");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(20);
    let three = dominant(3, 0.01, 1);
    group.bench_function("exact n=3", |b| b.iter(|| inverse::exact(black_box(&three))));
    // Ends that are doubles, and ends that tie between vertices: an arrow around 0 with points in its corner.
    let of = |lo: [f64; 9], hi: [f64; 9]| IntervalMatrix::new(3, 3, lo.to_vec(), hi.to_vec()).expect("a good matrix");
    let diagonal = of([1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 4.0], [2.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 8.0]);
    group.bench_function("exact n=3, diagonal", |b| b.iter(|| inverse::exact(black_box(&diagonal))));
    let ties = of([4.0, -1.0, 0.0, -1.0, 4.0, -1.0, 0.0, -1.0, 4.0], [4.0, 1.0, 0.0, 1.0, 5.0, 1.0, 0.0, 1.0, 4.0]);
    group.bench_function("exact n=3, ties", |b| b.iter(|| inverse::exact(black_box(&ties))));
    let many: Vec<IntervalMatrix> = (0..1000).map(|seed| dominant(3, 0.01, seed)).collect();
    let join = |f: fn(&IntervalMatrix) -> &[f64]| many.iter().flat_map(|a| f(a).to_vec()).collect::<Vec<f64>>();
    let (lo, hi) = (join(IntervalMatrix::lo), join(IntervalMatrix::hi));
    group.throughput(Throughput::Elements(1000));
    let one = pool(1);
    group.bench_function("batch of 1000 n=3", |b| {
        one.install(|| b.iter(|| inverse::exact_batch(3, black_box(&lo), black_box(&hi))));
    });
    group.throughput(Throughput::Elements(1));
    for n in [4, 6, 8, 10] {
        // Signs vary: every sign vector counts.
        let a = dominant(n, 0.1, 1);
        group.bench_function(format!("exact n={n}"), |b| b.iter(|| inverse::exact(black_box(&a))));
    }
    group.bench_function("by vertices n=3", |b| b.iter(|| inverse::exact_by_vertices(black_box(&three))));
    group.bench_function("cramer n=3", |b| b.iter(|| inverse::cramer(black_box(&three))));
}

fn enclosure(c: &mut Criterion) {
    let mut group = c.benchmark_group("enclosure");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(10);
    let one = pool(1);
    for n in [3, 10, 50, 100, 200] {
        let a = dominant(n, 0.01, 1);
        group.bench_function(format!("hansen-bliek-rohn n={n}"), |b| {
            one.install(|| b.iter(|| inverse::hansen_bliek_rohn(black_box(&a))));
        });
        if n <= 10 {
            group.bench_function(format!("krawczyk n={n}"), |b| b.iter(|| inverse::krawczyk(black_box(&a))));
        }
    }
}

criterion_group!(benches, sweep, hull, enclosure);
criterion_main!(benches);
