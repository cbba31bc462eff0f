//! Filters against the sums that define them, and the same bits for any company, width of vectors and number of
//! threads.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

use filter_core::{Curve, Error, Group, Layout, Line, respond, thrust, whiten};
use proptest::prelude::*;

fn signal(n: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0, n)
}

fn close(x: f64, y: f64) -> bool {
    (x - y).abs() <= 1e-11 * (1.0 + x.abs().max(y.abs()))
}

/// The piecewise linear function by its definition.
fn straight(knots: &[f64], values: &[f64], x: f64) -> f64 {
    match knots.iter().rposition(|&k| k <= x) {
        None => values[0],
        Some(k) if k + 1 == knots.len() => values[k],
        Some(k) => values[k] + (values[k + 1] - values[k]) * (x - knots[k]) / (knots[k + 1] - knots[k]),
    }
}

proptest! {
    #[test]
    fn a_thrust_is_the_formula_that_defines_it(
        n in prop_oneof![9 => 0usize..300, 1 => 16_384usize..17_000],
        gaps in prop::collection::vec(0.01f64..1.0, 1..12),
        pieces in prop::collection::vec(prop::array::uniform4(-2.0f64..2.0), 11),
        neutral in -1.0f64..1.0,
        values in signal(12),
        side in prop::option::of(signal(4)),
        steps in signal(977),
        accuracy in (0.0f64..0.5, 0.0f64..0.2),
    ) {
        let knots: Vec<f64> = gaps.iter().scan(-2.0, |at, gap| { *at += gap; Some(*at) }).chain([9.0]).collect();
        let curve = Curve { neutral, knots: &knots, pieces: &pieces[..knots.len() - 1] };
        let line = Line { knots: &knots, values: &values[..knots.len()] };
        let turns = [-1.0, 0.0, 0.5, 1.0];
        let branch = side.as_ref().map(|values| Line { knots: &turns, values });
        let error = Error { absolute: accuracy.0, relative: accuracy.1, curve: line, branch };
        // Stretches without a change, and demands beyond the knots.
        let demand: Vec<f64> = (0..n).map(|t| 4.0 * steps[t / 3 % steps.len()]).collect();
        let (mut bare, mut whole, mut alone) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        thrust(&demand, curve, None, 2, &mut bare);
        thrust(&demand, curve, Some(error), 2, &mut whole);
        thrust(&demand, curve, Some(error), 1, &mut alone);
        let mut risen = true;
        for t in 0..n {
            let d = demand[t].clamp(knots[0], 9.0);
            let k = knots.iter().rposition(|&k| k <= d).unwrap_or(0).min(knots.len() - 2);
            let (c, s) = (pieces[k], d - knots[k]);
            let push = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
            if t > 0 && demand[t] != demand[t - 1] {
                risen = demand[t] > demand[t - 1];
            }
            let beside = side.as_ref().map_or(0.0, |v| straight(&turns, v, demand[t]));
            let size = straight(&knots, line.values, demand[t]) + if risen { beside } else { -beside };
            let bound = accuracy.0 + accuracy.1 * push.abs();
            // At a knot a rounding decides between two pieces, which need not meet.
            let near = knots.iter().any(|k| (k - d).abs() < 1e-9);
            prop_assert!(near || close(bare[t], push) && close(whole[t], push + bound * size), "{t}");
            prop_assert_eq!(whole[t].to_bits(), alone[t].to_bits());
        }
    }

    #[test]
    fn a_recursion_is_the_sum_that_defines_it(
        n in 0usize..200,
        rows in 1usize..19,
        seed in signal(200 * 3),
        b in signal(19 * 3 * 4),
        poles in prop::collection::vec(-0.9..0.9, 19 * 3),
    ) {
        let inputs: Vec<Vec<f64>> = (0..3)
            .map(|i| if i == 1 && rows % 2 == 0 { vec![0.0; n] } else { seed[i * 200..i * 200 + n].to_vec() })
            .collect();
        let mut a: Vec<f64> = Vec::new();
        for r in 0..rows {
            let (p, q, s): (f64, f64, f64) = (poles[3 * r], poles[3 * r + 1], poles[3 * r + 2]);
            a.extend([1.0, -p - q - s, p * q + p * s + q * s, -p * q * s]);
        }
        let x: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
        let b = &b[..rows * 12];
        let mut out = vec![f64::NAN; rows * n];
        respond(&x, b, &a, 4, n, &mut out);
        for r in 0..rows {
            let mut y = vec![0.0; n];
            for t in 0..n {
                for k in 0..4usize.min(t + 1) {
                    for i in 0..3 {
                        y[t] += b[(r * 3 + i) * 4 + k] * inputs[i][t - k];
                    }
                    if k > 0 {
                        y[t] -= a[4 * r + k] * y[t - k];
                    }
                }
            }
            for t in 0..n {
                prop_assert!(close(out[r * n + t], y[t]), "{} {}", out[r * n + t], y[t]);
            }
            // A row alone has the bits that it has in company.
            let mut alone = vec![0.0; n];
            respond(&x, &b[r * 12..(r + 1) * 12], &a[4 * r..4 * r + 4], 4, n, &mut alone);
            prop_assert!(alone.iter().zip(&out[r * n..]).all(|(p, q)| p.to_bits() == q.to_bits()));
        }
    }

    #[test]
    fn whitening_is_the_sum_that_defines_it(
        n in 1usize..150,
        length in 1usize..60,
        lags in 0usize..13,
        seed in signal(150 * 5 * 3),
        taps in signal(13 * 9),
        other in signal(13),
        masked in any::<bool>(),
        unit in any::<bool>(),
    ) {
        let rows = 5;
        let columns: Vec<Vec<f64>> = (0..3).map(|c| seed[c * 750..c * 750 + rows * n].to_vec()).collect();
        let x: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let apart = [0, 3, 4];
        let groups = [
            Group { rows: &apart, taps: &taps[..(lags.min(12) + 1) * 9] },
            Group { rows: &[1], taps: &other[..1] },
            Group { rows: &[2], taps: &[0.0] },
        ];
        let weight: Vec<f64> = (0..n).map(|t| f64::from(t % 7 != 3)).collect();
        let layout = Layout { rows, n, length, weight: masked.then_some(weight.as_slice()), unit };
        let mut out = vec![f64::NAN; 3 * layout.numbers()];
        let lengths = whiten(&x, &groups, layout, 2, &mut out);
        let blocks = n / length;
        for (c, column) in columns.iter().enumerate() {
            let mut expected = vec![0.0; layout.numbers()];
            for (g, row) in [(0, 0), (1, 1), (0, 3), (0, 4)] {
                for t in 0..blocks * length {
                    let group = &groups[g];
                    let r = group.rows.len();
                    let i = group.rows.iter().position(|&q| q == row).unwrap();
                    let mut sum = 0.0;
                    for lag in 0..(group.taps.len() / (r * r)).min(t + 1) {
                        for (j, &from) in group.rows.iter().enumerate() {
                            sum += group.taps[(lag * r + i) * r + j] * column[from * n + t - lag];
                        }
                    }
                    let w = if masked { weight[t] } else { 1.0 };
                    expected[(t / length * rows + row) * length + t % length] = sum * w;
                }
            }
            let size = if unit { expected.iter().map(|v| v * v).sum::<f64>().max(1e-300).sqrt() } else { 1.0 };
            prop_assert!(close(size, lengths[c]));
            for (got, want) in out[c * layout.numbers()..].iter().zip(&expected) {
                prop_assert!(close(*got, want / size), "{got} {}", want / size);
            }
        }
        // Each column by itself: the same bits.
        let mut again = vec![0.0; layout.numbers()];
        whiten(&x[1..2], &groups, layout, 2, &mut again);
        prop_assert!(again.iter().zip(&out[layout.numbers()..]).all(|(p, q)| p.to_bits() == q.to_bits()));
    }
}

#[test]
fn threads_change_no_bit() {
    let (rows, n) = (8, 12_000);
    let columns: Vec<Vec<f64>> =
        (0..9).map(|c| (0..96_000).map(|i: u32| f64::from(i * 7919 % 1009 + c) / 500.0 - 1.0).collect()).collect();
    let x: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let taps: Vec<f64> = (0..13 * 4).map(|i| (f64::from(i) * 0.37).sin()).collect();
    let groups = [Group { rows: &[0, 1], taps: &taps }, Group { rows: &[2, 7], taps: &taps }];
    let layout = Layout { rows, n, length: 200, weight: None, unit: true };
    let mut found = Vec::new();
    for threads in [1, 2, 5] {
        let mut out = vec![0.0; 9 * layout.numbers()];
        let lengths = whiten(&x, &groups, layout, threads, &mut out);
        found.push((out, lengths));
    }
    assert!(found[0] == found[1] && found[0] == found[2]);
}
