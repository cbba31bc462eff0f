//! Interval arithmetic on slices: millions of intervals a second in cache (1,024 elements) and from memory (1e6), each
//! back end beside plain unrounded loops that are vectorised by the compiler for the same processor features.
//!
//! `cargo bench --bench interval -- --quick` for a first look; `python benches/ratios.py` prints the table, with what
//! Python and python-flint (where it is installed) give beside it.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use interval_core::rounding::slices::{Backend, Binary, Bounds, BoundsMut, Unary, binary_with, unary_with};
use interval_core::{Error, Interval, IntervalMatrix};
use std::hint::black_box;

/// Bounds of random signs between -4 and 4, of which divisors are kept away from zero by `positive`.
fn operands(n: usize, seed: u64, positive: bool) -> (Vec<f64>, Vec<f64>) {
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(state >> 33).unwrap_or(0)) / f64::from(1_u32 << 31)
    };
    (0..n)
        .map(|_| {
            let centre = if positive { 1.0 + 3.0 * uniform() } else { 8.0 * uniform() - 4.0 };
            let radius = 0.5 * uniform();
            (centre - radius, centre + radius)
        })
        .unzip()
}

type Plain = fn(&[f64], &[f64], &[f64], &[f64], &mut [f64], &mut [f64]);

/// A loop without directed rounding: no special cases, round to nearest.
macro_rules! plain_loops {
    ($module:ident, $(#[$feature:meta])*) => {
        mod $module {
            $(#[$feature])*
            pub fn add(a: &[f64], b: &[f64], c: &[f64], d: &[f64], lo: &mut [f64], hi: &mut [f64]) {
                for i in 0..lo.len().min(a.len()).min(b.len()).min(c.len()).min(d.len()).min(hi.len()) {
                    lo[i] = a[i] + c[i];
                    hi[i] = b[i] + d[i];
                }
            }
            $(#[$feature])*
            pub fn mul(a: &[f64], b: &[f64], c: &[f64], d: &[f64], lo: &mut [f64], hi: &mut [f64]) {
                for i in 0..lo.len().min(a.len()).min(b.len()).min(c.len()).min(d.len()).min(hi.len()) {
                    let (p, q, r, s) = (a[i] * c[i], a[i] * d[i], b[i] * c[i], b[i] * d[i]);
                    let least = |x: f64, y: f64| if x < y { x } else { y };
                    let most = |x: f64, y: f64| if x > y { x } else { y };
                    lo[i] = least(least(p, q), least(r, s));
                    hi[i] = most(most(p, q), most(r, s));
                }
            }
            $(#[$feature])*
            pub fn div(a: &[f64], b: &[f64], c: &[f64], d: &[f64], lo: &mut [f64], hi: &mut [f64]) {
                for i in 0..lo.len().min(a.len()).min(b.len()).min(c.len()).min(d.len()).min(hi.len()) {
                    let (x, y) = (if a[i] < 0.0 { c[i] } else { d[i] }, if b[i] < 0.0 { d[i] } else { c[i] });
                    lo[i] = a[i] / x;
                    hi[i] = b[i] / y;
                }
            }
            $(#[$feature])*
            pub fn sqrt(a: &[f64], b: &[f64], _: &[f64], _: &[f64], lo: &mut [f64], hi: &mut [f64]) {
                for i in 0..lo.len().min(a.len()).min(b.len()).min(hi.len()) {
                    lo[i] = a[i].sqrt();
                    hi[i] = b[i].sqrt();
                }
            }
        }
    };
}

plain_loops!(baseline,);
#[cfg(target_arch = "x86_64")]
plain_loops!(with_avx2, #[target_feature(enable = "avx2,fma")]);
#[cfg(target_arch = "x86_64")]
plain_loops!(with_avx512, #[target_feature(enable = "avx512f,avx2,fma")]);

/// The unrounded loop compiled for the features of a back end.
fn plain(backend: Backend, name: &str) -> Option<Plain> {
    macro_rules! choose {
        ($module:ident) => {
            match name {
                "add" => |a, b, c, d, lo, hi| unsafe_call!($module::add, a, b, c, d, lo, hi),
                "mul" => |a, b, c, d, lo, hi| unsafe_call!($module::mul, a, b, c, d, lo, hi),
                "div" => |a, b, c, d, lo, hi| unsafe_call!($module::div, a, b, c, d, lo, hi),
                "sqrt" => |a, b, c, d, lo, hi| unsafe_call!($module::sqrt, a, b, c, d, lo, hi),
                _ => return None,
            }
        };
    }
    macro_rules! unsafe_call {
        ($f:expr, $($x:expr),*) => {{
            #[allow(unused_unsafe, unsafe_code, reason = "called only where the features were detected")]
            unsafe { $f($($x),*) }
        }};
    }
    let found: Plain = match backend {
        Backend::Portable => choose!(baseline),
        #[cfg(target_arch = "x86_64")]
        Backend::Avx2 => choose!(with_avx2),
        #[cfg(target_arch = "x86_64")]
        Backend::Avx512 => choose!(with_avx512),
        _ => return None,
    };
    Some(found)
}

/// An operation by its name, of one operand or two.
fn run(backend: Backend, name: &str, x: Bounds<'_>, y: Bounds<'_>, out: BoundsMut<'_>) -> Result<(), Error> {
    match (Unary::from_name(name), Binary::from_name(name)) {
        (Some(op), _) => unary_with(backend, op, black_box(x), out),
        (_, Some(op)) => binary_with(backend, op, black_box(x), black_box(y), out),
        _ => unreachable!("a known operation"),
    }
}

fn arithmetic(criterion: &mut Criterion) {
    for (size, n) in [("cache", 1_024), ("memory", 1_000_000)] {
        for op in ["add", "sub", "mul", "div", "square", "sqrt"] {
            let mut group = criterion.benchmark_group(format!("{op}-{size}"));
            group.throughput(Throughput::Elements(n as u64));
            let (a, b) = operands(n, 1, op == "sqrt");
            let (c, d) = operands(n, 2, op == "div");
            let (mut lo, mut hi) = (vec![0.0; n], vec![0.0; n]);
            for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
                let (x, y) = (Bounds::new(&a, &b).expect("sound"), Bounds::new(&c, &d).expect("sound"));
                group.bench_function(BenchmarkId::from_parameter(backend.name()), |bencher| {
                    bencher.iter(|| {
                        let out = BoundsMut { lo: black_box(&mut lo), hi: black_box(&mut hi) };
                        run(backend, op, x, y, out)
                    });
                });
                if let Some(f) = plain(backend, op) {
                    group.bench_function(BenchmarkId::from_parameter(format!("plain-{}", backend.name())), |bencher| {
                        bencher.iter(|| f(black_box(&a), &b, &c, &d, black_box(&mut lo), black_box(&mut hi)));
                    });
                }
            }
            group.finish();
        }
    }
}

fn elementary(criterion: &mut Criterion) {
    let n = 1_024;
    for op in ["exp", "ln", "sin", "cos", "tan", "atan", "tanh", "atan2", "pow"] {
        let mut group = criterion.benchmark_group(op);
        group.throughput(Throughput::Elements(n as u64));
        let (a, b) = operands(n, 3, matches!(op, "ln" | "pow"));
        let (c, d) = operands(n, 4, false);
        let (mut lo, mut hi) = (vec![0.0; n], vec![0.0; n]);
        for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
            let (x, y) = (Bounds::new(&a, &b).expect("sound"), Bounds::new(&c, &d).expect("sound"));
            group.bench_function(BenchmarkId::from_parameter(backend.name()), |bencher| {
                bencher.iter(|| {
                    let out = BoundsMut { lo: black_box(&mut lo), hi: black_box(&mut hi) };
                    run(backend, op, x, y, out)
                });
            });
        }
        group.finish();
    }
}

fn scalars(criterion: &mut Criterion) {
    let (a, b) = operands(1_024, 5, false);
    let x: Vec<Interval> = a.iter().zip(&b).map(|(&l, &h)| Interval::new(l, h).expect("ordered")).collect();
    let mut group = criterion.benchmark_group("scalar");
    group.throughput(Throughput::Elements(1_023));
    group.bench_function("x*y+x", |bencher| {
        bencher.iter(|| x.windows(2).map(|w| (w[0] * w[1] + w[0]).hi()).sum::<f64>());
    });
    group.bench_function("sin", |bencher| bencher.iter(|| x[1..].iter().map(|v| v.sin().hi()).sum::<f64>()));
    group.finish();
}

fn matrices(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("matrix-product");
    for n in [10, 100] {
        let (lo, hi) = operands(n * n, 6, false);
        let a = IntervalMatrix::new(n, n, lo, hi).expect("ordered");
        for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
            group.bench_function(BenchmarkId::new(backend.name(), n), |bencher| {
                bencher.iter(|| black_box(&a).multiply_on(backend, black_box(&a)));
            });
        }
        group.bench_function(BenchmarkId::new("fast", n), |bencher| {
            bencher.iter(|| black_box(&a).multiply_fast(black_box(&a)));
        });
    }
    group.finish();
}

criterion_group!(benches, arithmetic, elementary, scalars, matrices);
criterion_main!(benches);
