//! inari and this crate on the same operands, in the same process, in interleaved rounds.
//!
//! Prints `operation  peer  ours  ratio` in millions of intervals a second: medians of nine rounds, 1,024 intervals in
//! cache and 1e6 from memory for arithmetic.

use interval_core::rounding::slices::{Backend, Binary, Bounds, BoundsMut, Unary, binary_with, unary_with};
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 9;

/// Bounds of random signs; `positive` keeps them away from zero.
fn operands(n: usize, seed: u64, positive: bool) -> (Vec<f64>, Vec<f64>) {
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((state >> 33) as u32) / f64::from(1_u32 << 31)
    };
    (0..n)
        .map(|_| {
            let centre = if positive { 1.0 + 3.0 * uniform() } else { 8.0 * uniform() - 4.0 };
            let radius = 0.5 * uniform();
            (centre - radius, centre + radius)
        })
        .unzip()
}

/// Millions a second of one run of `work` on `n` intervals, repeated for at least ten milliseconds.
fn rate(n: usize, mut work: impl FnMut()) -> f64 {
    let start = Instant::now();
    let mut runs = 0;
    while runs < 1 || start.elapsed().as_secs_f64() < 0.01 {
        work();
        runs += 1;
    }
    (n * runs) as f64 / start.elapsed().as_secs_f64() / 1e6
}

fn median(mut x: Vec<f64>) -> f64 {
    x.sort_by(f64::total_cmp);
    x[x.len() / 2]
}

type Peer = fn(inari::Interval, inari::Interval) -> inari::Interval;

fn main() {
    println!("inari built for {}; here the back end is chosen at run time", if cfg!(target_feature = "avx512f") { "this machine" } else { "haswell" });
    let table: [(&str, Peer); 15] = [
        ("add", |x, y| x + y),
        ("sub", |x, y| x - y),
        ("mul", |x, y| x * y),
        ("div", |x, y| x / y),
        ("square", |x, _| x.sqr()),
        ("sqrt", |x, _| x.sqrt()),
        ("exp", |x, _| x.exp()),
        ("ln", |x, _| x.ln()),
        ("sin", |x, _| x.sin()),
        ("cos", |x, _| x.cos()),
        ("tan", |x, _| x.tan()),
        ("atan", |x, _| x.atan()),
        ("tanh", |x, _| x.tanh()),
        ("atan2", |x, y| x.atan2(y)),
        ("pow", |x, y| x.pow(y)),
    ];
    for (name, peer) in table {
        let arithmetic = matches!(name, "add" | "sub" | "mul" | "div" | "square" | "sqrt");
        for n in if arithmetic { vec![1_024, 1_000_000] } else { vec![1_024] } {
            let (a, b) = operands(n, 1, matches!(name, "sqrt" | "ln" | "pow"));
            let (c, d) = operands(n, 2, name == "div");
            let boxed = |lo: &[f64], hi: &[f64]| -> Vec<inari::Interval> {
                lo.iter().zip(hi).map(|(&l, &h)| inari::Interval::try_from((l, h)).expect("ordered")).collect()
            };
            let (x, y) = (boxed(&a, &b), boxed(&c, &d));
            let mut peer_out = x.clone();
            let (mut lo, mut hi) = (vec![0.0; n], vec![0.0; n]);
            let backends: Vec<Backend> = Backend::ALL.into_iter().filter(|b| b.is_available()).collect();
            let mut peers = Vec::new();
            let mut ours = vec![Vec::new(); backends.len()];
            for _ in 0..ROUNDS {
                peers.push(rate(n, || {
                    for ((out, &x), &y) in peer_out.iter_mut().zip(black_box(&x)).zip(black_box(&y)) {
                        *out = peer(x, y);
                    }
                    black_box(&mut peer_out);
                }));
                for (&backend, rates) in backends.iter().zip(&mut ours) {
                    let (x, y) = (Bounds::new(&a, &b).expect("equal"), Bounds::new(&c, &d).expect("equal"));
                    rates.push(rate(n, || {
                        let out = BoundsMut { lo: black_box(&mut lo), hi: black_box(&mut hi) };
                        match (Unary::from_name(name), Binary::from_name(name)) {
                            (Some(op), _) => unary_with(backend, op, black_box(x), out),
                            (_, Some(op)) => binary_with(backend, op, black_box(x), black_box(y), out),
                            _ => unreachable!("a known operation"),
                        }
                        .expect("sound bounds");
                    }));
                }
            }
            for (i, out) in peer_out.iter().enumerate() {
                assert_eq!((out.inf() + 0.0, out.sup() + 0.0), (lo[i], hi[i]), "{name} of {} and {}", x[i], y[i]);
            }
            let peer_rate = median(peers);
            let shown: Vec<String> = backends
                .iter()
                .zip(ours)
                .map(|(backend, rates)| {
                    let rate = median(rates);
                    format!("{} {rate:8.2} ({:.1} x)", backend.name(), rate / peer_rate)
                })
                .collect();
            println!("{name:7} {n:8}  inari {peer_rate:8.2}   {}", shown.join("   "));
        }
    }
}
