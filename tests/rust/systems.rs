//! Square interval systems: containment in every method, the exact hull of the solution set attained.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "test data are small numbers")]

mod common;

use common::corners::{corners, families as small_families, matrix};
use common::matrices::{families, is_tight};
use common::{Random, invert, q};
use interval_core::{Interval, systems};
use num_rational::BigRational;
use num_traits::Zero;

#[test]
fn systems_are_enclosed_and_exact_ones_are_attained() {
    let mut random = Random(5);
    let mut met = 0;
    for n in 1..=4 {
        for seed in 80..83 {
            for (name, a) in families(n, seed) {
                let b: Vec<Interval> =
                    (0..n).map(|_| random.unit()).map(|c| Interval::new(c - 0.2, c + 0.1).expect("good")).collect();
                let outcome = systems::exact(&a, &b).expect("shapes fit");
                let Some(value) = outcome.enclosure() else { continue };
                met += 1;
                // The hull by all end points of A and b that the theory names.
                let (mut least, mut most) = (vec![None; n], vec![None; n]);
                for bits in 0..1_usize << (2 * n) {
                    let (y, z) = (bits >> n, bits & ((1 << n) - 1));
                    let vertex: Vec<BigRational> = (0..n * n)
                        .map(|at| q(if ((y >> (at / n)) ^ (z >> (at % n))) & 1 == 1 { a.hi()[at] } else { a.lo()[at] }))
                        .collect();
                    let inverse = invert(&vertex, n).1.expect("regular");
                    for i in 0..n {
                        let x = (0..n).fold(BigRational::zero(), |s, k| {
                            s + &inverse[i * n + k] * q(if y >> k & 1 == 0 { b[k].hi() } else { b[k].lo() })
                        });
                        if least[i].as_ref().is_none_or(|l| x < *l) {
                            least[i] = Some(x.clone());
                        }
                        if most[i].as_ref().is_none_or(|m| x > *m) {
                            most[i] = Some(x);
                        }
                    }
                }
                let truth: Vec<(BigRational, BigRational)> =
                    least.into_iter().zip(most).map(|(l, m)| (l.expect("met"), m.expect("met"))).collect();
                for (e, (l, m)) in value.entries().zip(&truth) {
                    assert!(q(e.lo()) <= *l && *m <= q(e.hi()), "{name}, n = {n}");
                }
                assert!(is_tight(value, &truth), "{name}, n = {n}");
                let wider = systems::gauss_seidel(&a, &b).expect("shapes fit");
                if let Some(wider) = wider.enclosure() {
                    let slack = |x: f64| 4.0 * f64::EPSILON * x.abs();
                    let inside =
                        |w: Interval, e: Interval| w.lo() <= e.lo() + slack(e.lo()) && e.hi() - slack(e.hi()) <= w.hi();
                    assert!(wider.entries().zip(value.entries()).all(|(w, e)| inside(w, e)), "{name}, n = {n}");
                }
            }
        }
    }
    assert!(met > 60, "{met}");
}

#[test]
fn systems_hold_the_solutions_of_their_corners() {
    let mut solved = 0;
    for n in 1..=3 {
        for seed in 20..24 {
            for (name, a) in small_families(n, seed) {
                let b: Vec<Interval> =
                    (0..n).map(|i| Interval::new(i as f64 - 0.5, i as f64 + 0.5).expect("good")).collect();
                for method in [systems::krawczyk, systems::cramer, systems::hansen_bliek_rohn] {
                    let outcome = method(&a, &b).expect("good");
                    let Some((lower, upper)) = outcome.bounds() else { continue };
                    solved += 1;
                    for corner in corners(&a).iter().step_by(11) {
                        let entries: Vec<BigRational> = corner.iter().map(|&x| q(x)).collect();
                        let inverse = invert(&entries, n).1.unwrap_or_else(|| panic!("{name} is singular but solved"));
                        for ends in 0..1_usize << n {
                            for i in 0..n {
                                let x = (0..n).fold(BigRational::zero(), |sum, j| {
                                    let y = if ends >> j & 1 == 0 { b[j].lo() } else { b[j].hi() };
                                    sum + &inverse[i * n + j] * q(y)
                                });
                                assert!(q(lower[i]) <= x && x <= q(upper[i]), "{name}, n = {n}");
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(solved > 100, "{solved}");
    assert!(systems::krawczyk(&matrix(1, &[1.0], &[2.0]), &[]).is_err());
}
