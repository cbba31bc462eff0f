//! Filters against the sums that define them, and the same bits for any company, width of vectors and number of
//! threads.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

use filter_core::{Group, Layout, respond, whiten};
use proptest::prelude::*;

fn signal(n: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0, n)
}

fn close(x: f64, y: f64) -> bool {
    (x - y).abs() <= 1e-11 * (1.0 + x.abs().max(y.abs()))
}

proptest! {
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
