//! The published sweep: members, vectors, threads and the short way by extrema say the same; it can be stopped.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "test data are small numbers")]

mod common;

use common::Random;
use interval_core::inverse::{Form, Method, Monitor, Options, Outcome, Sweep, published_hull, published_with};
use interval_core::rounding::slices::Backend;
use interval_core::{IntervalMatrix, Status};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

fn matrix(n: usize, relative: f64, seed: u64) -> IntervalMatrix {
    let mut random = Random(seed);
    let centre: Vec<f64> = (0..n * n)
        .map(|at| random.unit() + if at.is_multiple_of(n + 1) { 1.0 + 0.6 * n as f64 } else { 0.0 })
        .collect();
    let ends = |sign: f64| centre.iter().map(|c| c + sign * relative * c.abs()).collect();
    IntervalMatrix::new(n, n, ends(-1.0), ends(1.0)).expect("a good matrix")
}

fn run(a: &IntervalMatrix, partitions: u64, form: Form, sweep: Sweep, backend: Backend) -> Outcome {
    published_with(a, partitions, (form, sweep), backend, &Monitor::default()).expect("a square matrix")
}

fn ends(outcome: &Outcome) -> (Vec<f64>, Vec<f64>) {
    let (lower, upper) = outcome.bounds().unwrap_or_else(|| panic!("no value: {:?}", outcome.reason));
    (lower.to_vec(), upper.to_vec())
}

/// Gauss-Jordan elimination with partial pivoting, row by row, as a textbook has it.
fn inverse(a: &[f64], n: usize) -> Vec<f64> {
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let unit = (0..n).map(|j| f64::from(u8::from(i == j)));
            a[i * n..(i + 1) * n].iter().copied().chain(unit).collect()
        })
        .collect();
    for p in 0..n {
        let pivot = (p..n).max_by(|&i, &j| rows[i][p].abs().total_cmp(&rows[j][p].abs())).expect("a row");
        rows.swap(p, pivot);
        let scale = rows[p][p];
        rows[p].iter_mut().for_each(|x| *x /= scale);
        let row = rows[p].clone();
        for (i, target) in rows.iter_mut().enumerate() {
            if i != p {
                let factor = target[p];
                target.iter_mut().zip(&row).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    rows.into_iter().flat_map(|row| row[n..].to_vec()).collect()
}

/// Eq. 11-13 as they stand, one matrix after the other.
fn literal(a: &IntervalMatrix, partitions: u64, form: Form) -> (Vec<f64>, Vec<f64>) {
    let n = a.rows();
    let (mut lower, mut upper) = (vec![f64::INFINITY; n * n], vec![f64::NEG_INFINITY; n * n]);
    for k in 0..partitions {
        for (from, sign) in [(a.lo(), 1.0), (a.hi(), -1.0)] {
            let member: Vec<f64> = (0..n * n)
                .map(|at| from[at] + sign * k as f64 * (0.5 * (a.hi()[at] - a.lo()[at]) / partitions as f64))
                .collect();
            for (at, x) in inverse(&member, n).into_iter().enumerate() {
                if form == Form::Hull || sign > 0.0 {
                    lower[at] = lower[at].min(x);
                }
                if form == Form::Hull || sign < 0.0 {
                    upper[at] = upper[at].max(x);
                }
            }
        }
    }
    (lower, upper)
}

fn close(x: &[f64], y: &[f64], tolerance: f64) -> bool {
    let size = y.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    x.iter().zip(y).all(|(a, b)| (a - b).abs() <= tolerance * size)
}

#[test]
fn members_follow_the_equations_and_back_ends_agree_to_the_bit() {
    for n in [1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 13, 20, 21, 24, 33, 64] {
        for partitions in [1, 2, 7, 8, 9, 67] {
            let a = matrix(n, 0.02, n as u64);
            for form in [Form::Literal, Form::Hull] {
                let reference = run(&a, partitions, form, Sweep::Members, Backend::Portable);
                assert_eq!(reference.status, Status::NotProved);
                let (lower, upper) = ends(&reference);
                let expected = literal(&a, partitions, form);
                assert!(close(&lower, &expected.0, 1e-12), "n = {n}, N = {partitions}");
                assert!(close(&upper, &expected.1, 1e-12), "n = {n}, N = {partitions}");
                for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
                    let found = run(&a, partitions, form, Sweep::Members, backend);
                    let bits = |x: &[f64]| x.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                    let other = ends(&found);
                    assert_eq!(bits(&lower), bits(&other.0), "n = {n}, N = {partitions}, {}", backend.name());
                    assert_eq!(bits(&upper), bits(&other.1), "n = {n}, N = {partitions}, {}", backend.name());
                }
            }
        }
    }
}

/// Columns whose largest magnitudes tie, so that the first of them has to be the pivot; the number is of a search one by one.
#[test]
fn the_first_of_equal_pivots_is_taken() {
    for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        for n in [21, 24, 33, 50, 63, 64] {
            let mut random = Random(7 + n as u64);
            let centre: Vec<f64> = (0..n * n).map(|_| if random.unit() > 0.0 { 1.0 } else { -1.0 }).collect();
            let ends = |sign: f64| centre.iter().map(|c| c + sign / 1024.0).collect();
            let a = IntervalMatrix::new(n, n, ends(-1.0), ends(1.0)).expect("a good matrix");
            let (lower, upper) = self::ends(&run(&a, 3, Form::Hull, Sweep::Members, backend));
            for x in lower.iter().chain(&upper) {
                hash = (hash ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3);
            }
        }
        assert_eq!(hash, 14_917_091_582_653_191_009, "{}", backend.name());
    }
}

/// Midpoints whose pivots vanish in other members: these are eliminated with pivots of their own, in any lane.
#[test]
fn small_pivots() {
    for n in [4, 6, 20] {
        let mut random = Random(90 + n as u64);
        // A permutation with noise: no pivot stands on the diagonal.
        let centre: Vec<f64> =
            (0..n * n).map(|at| 0.1 * random.unit() + if (at / n + 1) % n == at % n { 1.0 } else { 0.0 }).collect();
        let mut radius = vec![0.01; n * n];
        // The first pivot of the midpoint runs through zero.
        let mut shifted = centre.clone();
        (shifted[0], radius[0]) = (3.0, 3.0);
        let lo: Vec<f64> = shifted.iter().zip(&radius).map(|(c, r)| c - r).collect();
        let hi: Vec<f64> = shifted.iter().zip(&radius).map(|(c, r)| c + r).collect();
        let a = IntervalMatrix::new(n, n, lo, hi).expect("a good matrix");
        let expected = literal(&a, 200, Form::Hull);
        let mut bits: Option<Vec<u64>> = None;
        for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
            let found = ends(&run(&a, 200, Form::Hull, Sweep::Members, backend));
            assert!(close(&found.0, &expected.0, 1e-10) && close(&found.1, &expected.1, 1e-10), "n = {n}");
            let these = found.0.iter().chain(&found.1).map(|v| v.to_bits()).collect();
            assert_eq!(bits.get_or_insert_with(|| Vec::clone(&these)), &these, "n = {n}, {}", backend.name());
        }
    }
}

#[test]
fn extrema_are_those_of_the_sweep() {
    let backend = Backend::chosen();
    for n in [1, 2, 3, 4, 6, 10, 25] {
        for relative in [0.001, 0.05, 0.4] {
            for seed in 0..4 {
                let a = matrix(n, relative, 100 * seed + n as u64);
                for partitions in [1, 3, 40, 1000, 4097] {
                    for form in [Form::Literal, Form::Hull] {
                        let sweep = ends(&run(&a, partitions, form, Sweep::Members, backend));
                        let short = ends(&run(&a, partitions, form, Sweep::Extrema, backend));
                        let name = format!("n = {n}, {relative}, seed {seed}, N = {partitions}");
                        assert!(close(&short.0, &sweep.0, 1e-13) && close(&short.1, &sweep.1, 1e-13), "{name}");
                        // They are extremes over fewer members.
                        if form == Form::Hull {
                            assert!(short.0.iter().zip(&sweep.0).all(|(x, y)| x >= y), "{name}");
                            assert!(short.1.iter().zip(&sweep.1).all(|(x, y)| x <= y), "{name}");
                        }
                    }
                }
            }
        }
    }
}

/// The first entry of the inverse of `[[2, 1 + 2 t], [t, 4 + 3 t]]` has its minimum at `t = -0.279`.
#[test]
fn an_extremum_inside_is_found_at_any_number_of_partitions() {
    let a = IntervalMatrix::new(2, 2, vec![1.0, -3.0, -3.0, 1.0], vec![1.0, 3.0, 3.0, 1.0]).expect("a good matrix");
    // Both off-diagonal entries move together, so this member is [[1, t], [t, 1]], singular at t = 1: not applicable.
    let singular = run(&a, 3, Form::Hull, Sweep::Members, Backend::chosen());
    assert_eq!(singular.status, Status::NotApplicable);
    let a = IntervalMatrix::new(2, 2, vec![2.0, -1.0, -1.0, 1.0], vec![2.0, 3.0, 1.0, 7.0]).expect("a good matrix");
    for partitions in [10, 1_000_000, 1_000_000_000_000] {
        let start = Instant::now();
        let short = run(&a, partitions, Form::Hull, Sweep::Extrema, Backend::chosen());
        assert!(start.elapsed() < Duration::from_secs(2), "{partitions}");
        let (lower, upper) = ends(&short);
        // Dense sampling as the judge.
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for j in -20_000..=20_000 {
            let t = f64::from(j) / 20_000.0;
            let x = (4.0 + 3.0 * t) / (8.0 + 5.0 * t - 2.0 * t * t);
            (least, most) = (least.min(x), most.max(x));
        }
        assert!(least < 0.4905 && most > 0.99);
        let tolerance = if partitions == 10 { 0.01 } else { 1e-8 };
        assert!((lower[0] - least).abs() < tolerance && (upper[0] - most).abs() < tolerance, "{partitions}");
    }
}

#[test]
fn a_sweep_ends_when_it_is_stopped() {
    for n in [3, 8, 64] {
        let a = matrix(n, 0.01, 5);
        let monitor = Monitor::default();
        std::thread::scope(|scope| {
            let backend = Backend::chosen();
            let (a, monitor) = (&a, &monitor);
            let sweep = scope.spawn(move || {
                published_with(a, 1 << 44, (Form::Literal, Sweep::Members), backend, monitor).expect("square")
            });
            let deadline = Instant::now() + Duration::from_secs(20);
            while monitor.done() == 0 && Instant::now() < deadline {
                std::thread::sleep(Duration::from_millis(5));
            }
            monitor.stop();
            let asked = Instant::now();
            let outcome = sweep.join().expect("no panic");
            assert!(asked.elapsed() < Duration::from_millis(200), "n = {n}: {:?}", asked.elapsed());
            assert!(outcome.value.is_none() && outcome.status == Status::NotProved);
            assert!(outcome.reason.is_some_and(|r| r.starts_with("stopped after")));
        });
        assert!(monitor.done() > 0);
    }
}

#[test]
fn a_watched_sweep_reports_and_ends_when_the_watcher_says_so() {
    let a = matrix(4, 0.01, 5);
    let mut told = Vec::new();
    let mut watch = |done: u64| {
        told.push(done);
        if told.len() < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let options = Options { partitions: 1 << 44, ..Options::default() };
    let outcome = Method::Published.inverse_watched(&a, &options, Some(&mut watch)).expect("square");
    assert!(outcome.value.is_none() && outcome.status == Status::NotProved);
    assert!(outcome.reason.is_some_and(|r| r.starts_with("stopped after")));
    assert!(told.len() >= 3 && told.is_sorted(), "{told:?}");
    // A short one asks nobody, and gives the bits of the one that nobody watches.
    let options = Options { partitions: 50, ..Options::default() };
    let mut watch = |_| panic!("a sweep of some microseconds");
    let watched = Method::PublishedHull.inverse_watched(&a, &options, Some(&mut watch)).expect("square");
    assert_eq!(watched, published_hull(&a, 50).expect("square"));
}

#[test]
fn orders_beyond_the_limit_and_singular_members_are_refused_in_words() {
    let large = matrix(65, 0.01, 1);
    let outcome = run(&large, 3, Form::Literal, Sweep::Members, Backend::chosen());
    assert_eq!(outcome.status, Status::NotApplicable);
    for n in [1, 3, 5, 30] {
        let (least, most) = if n == 1 { (0.0, 0.0) } else { (1.0, 2.0) };
        let equal = IntervalMatrix::new(n, n, vec![least; n * n], vec![most; n * n]).expect("a good matrix");
        for sweep in [Sweep::Members, Sweep::Extrema] {
            let outcome = run(&equal, 4, Form::Hull, sweep, Backend::chosen());
            assert_eq!(outcome.status, Status::NotApplicable, "n = {n}");
        }
    }
}
