//! Products of interval matrices: every back end the bits of the scalar loop, the fast one around the exact product.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::cast_possible_truncation, reason = "random bits are cut on purpose")]

mod common;

use common::{Random, q};
use interval_core::rounding::slices::Backend;
use interval_core::{Interval, IntervalMatrix};
use num_rational::BigRational;
use num_traits::Zero;

/// Entries that are moderate, or of all sizes and signs, with points and zeros among them.
fn random_matrix(random: &mut Random, rows: usize, columns: usize, spicy: bool) -> IntervalMatrix {
    let (lo, hi) = (0..rows * columns)
        .map(|_| {
            let mut number = || if spicy { random.spicy() } else { random.unit() };
            let (a, b) = (number(), number());
            match random.bits() % 8 {
                0 => (a, a),
                1 => (0.0, b.abs()),
                2 => (0.0, 0.0),
                _ => (a.min(b), a.max(b)),
            }
        })
        .unzip();
    IntervalMatrix::new(rows, columns, lo, hi).expect("ordered")
}

fn by_entries(a: &IntervalMatrix, b: &IntervalMatrix) -> Vec<(u64, u64)> {
    let mut entries = Vec::new();
    for i in 0..a.rows() {
        for j in 0..b.columns() {
            let sum = (0..a.columns()).fold(Interval::ZERO, |sum, k| sum + a.get(i, k) * b.get(k, j));
            entries.push((sum.lo().to_bits(), sum.hi().to_bits()));
        }
    }
    entries
}

fn bits(a: &IntervalMatrix) -> Vec<(u64, u64)> {
    a.lo().iter().zip(a.hi()).map(|(l, h)| (l.to_bits(), h.to_bits())).collect()
}

#[test]
fn every_back_end_gives_the_bits_of_the_scalar_loop() {
    let mut random = Random(21);
    for (m, k, n) in [(1, 1, 1), (1, 7, 1), (3, 3, 3), (5, 2, 17), (16, 16, 16), (2, 40, 33), (20, 31, 50)] {
        for spicy in [false, true] {
            let (a, b) = (random_matrix(&mut random, m, k, spicy), random_matrix(&mut random, k, n, spicy));
            let expected = by_entries(&a, &b);
            for backend in Backend::ALL.into_iter().filter(|b| b.is_available()) {
                let product = a.multiply_on(backend, &b).expect("shapes fit");
                assert_eq!(bits(&product), expected, "{backend:?} {m} {k} {n} {spicy}");
            }
        }
    }
}

#[test]
fn large_products_do_not_depend_on_threads() {
    let mut random = Random(22);
    let (a, b) = (random_matrix(&mut random, 70, 80, false), random_matrix(&mut random, 80, 90, false));
    assert_eq!(bits(&a.multiply(&b).expect("shapes fit")), by_entries(&a, &b));
}

#[test]
fn unbounded_entries_are_products_too() {
    let inf = f64::INFINITY;
    let a = IntervalMatrix::new(2, 2, vec![0.0, -inf, 1.0, 2.0], vec![0.0, 1.0, inf, 3.0]).expect("ordered");
    assert_eq!(bits(&a.multiply(&a).expect("shapes fit")), by_entries(&a, &a));
    assert!(a.multiply(&IntervalMatrix::identity(3)).is_err());
    let (tall, flat) = (IntervalMatrix::new(3, 0, vec![], vec![]), IntervalMatrix::new(0, 3, vec![], vec![]));
    let (tall, flat) = (tall.expect("empty"), flat.expect("empty"));
    for product in [tall.multiply(&flat), tall.multiply_fast(&flat)] {
        assert_eq!(product.expect("shapes fit"), IntervalMatrix::new(3, 3, vec![0.0; 9], vec![0.0; 9]).expect("zeros"));
    }
    assert_eq!(flat.multiply(&tall).expect("shapes fit").rows(), 0);
}

/// Least and greatest value of an entry of the product, exactly.
fn exact_entry(a: &IntervalMatrix, b: &IntervalMatrix, i: usize, j: usize) -> (BigRational, BigRational) {
    let mut ends = (BigRational::zero(), BigRational::zero());
    for k in 0..a.columns() {
        let (x, y) = (a.get(i, k), b.get(k, j));
        let corners =
            [(x.lo(), y.lo()), (x.lo(), y.hi()), (x.hi(), y.lo()), (x.hi(), y.hi())].map(|(p, r)| q(p) * q(r));
        ends.0 += corners.iter().min().expect("four corners");
        ends.1 += corners.iter().max().expect("four corners");
    }
    ends
}

#[test]
fn both_products_enclose_and_the_fast_one_is_not_much_wider() {
    let mut random = Random(23);
    for (m, k, n) in [(4, 4, 4), (3, 20, 5), (12, 6, 9)] {
        for spicy in [false, true] {
            let (a, b) = (random_matrix(&mut random, m, k, spicy), random_matrix(&mut random, k, n, spicy));
            let (tight, fast) = (a.multiply(&b).expect("shapes fit"), a.multiply_fast(&b).expect("shapes fit"));
            for i in 0..m {
                for j in 0..n {
                    let (lo, hi) = exact_entry(&a, &b, i, j);
                    for (name, x) in [("tight", tight.get(i, j)), ("fast", fast.get(i, j))] {
                        assert!(x.lo() == f64::NEG_INFINITY || q(x.lo()) <= lo, "{name} {i} {j} {spicy}");
                        assert!(x.hi() == f64::INFINITY || q(x.hi()) >= hi, "{name} {i} {j} {spicy}");
                    }
                }
            }
            if !spicy {
                let ratio = fast.radius().iter().sum::<f64>() / tight.radius().iter().sum::<f64>();
                assert!(ratio < 1.5, "{ratio}");
            }
        }
    }
}

#[test]
fn norms_and_vectors() {
    let a = IntervalMatrix::new(2, 2, vec![2.0, -2.0, -1.5, -2.0], vec![4.0, 2.0, 4.5, 3.5]).expect("ordered");
    assert_eq!((a.norm(), a.norm_one()), (8.0, 8.5));
    assert!((a.norm_frobenius() - (16.0 + 4.0 + 20.25 + 12.25_f64).sqrt()).abs() < 1e-14);
    assert_eq!(a.mignitude(), [2.0, 0.0, 0.0, 0.0]);
    let x = [Interval::ONE, Interval::point(2.0).expect("finite")];
    let y = a.multiply_vector(&x).expect("shapes fit");
    assert_eq!(y, [Interval::new(-2.0, 8.0).expect("ordered"), Interval::new(-5.5, 11.5).expect("ordered")]);
    assert!(a.multiply_vector(&x[..1]).is_err());
}

#[cfg(feature = "serde")]
#[test]
fn intervals_survive_json() {
    for x in [Interval::ONE, Interval::EMPTY, Interval::ENTIRE, Interval::new(0.1, f64::INFINITY).expect("ordered")] {
        let text = serde_json::to_string(&x).expect("serializable");
        assert_eq!(serde_json::from_str::<Interval>(&text).expect("an interval"), x, "{text}");
    }
    assert!(serde_json::from_str::<Interval>("[2.0, 1.0]").is_err());
    assert!(serde_json::from_str::<Interval>("[2.0]").is_err());
}
