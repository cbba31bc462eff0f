//! Entry points of matrices, systems and the linear programmes with any numbers: no panic, and what must be inside is inside.
//!
//! `IVSID_CASES` sets how many cases are drawn (60 by default).

#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

mod common;

use common::corners::corners;
use common::{invert, q};
use interval_core::inverse::{Outcome, cramer, exact, hansen_bliek_rohn, krawczyk, kuttler, neumaier};
use interval_core::regression::{FeasibleStatus, feasible_set};
use interval_core::{Error, Interval, IntervalMatrix, Status};
use num_rational::BigRational;
use proptest::prelude::*;

type Inverse = fn(&IntervalMatrix) -> Result<Outcome, Error>;
const INVERSES: [(&str, Inverse); 6] = [
    ("krawczyk", krawczyk),
    ("cramer", cramer),
    ("exact", exact),
    ("hansen-bliek-rohn", hansen_bliek_rohn),
    ("kuttler", kuttler),
    ("neumaier", neumaier),
];

/// Moderate numbers, any bits of a double, and the ends of its range.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -4.0..4.0_f64,
        2 => any::<u64>().prop_map(f64::from_bits),
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(f64::MAX), Just(f64::MIN_POSITIVE), Just(5e-324), Just(f64::INFINITY), Just(f64::NAN)],
    ]
}

/// Ends in their order, mostly close to each other; as they come in one case of eight.
fn entry() -> impl Strategy<Value = (f64, f64)> {
    (number(), number(), 0..8_u8).prop_map(|(a, b, how)| match how {
        0 => (a, b),
        1 => (a.min(b), a.max(b)),
        2 | 3 => (a, a),
        _ => (a, a + (a * 1e-3).abs()),
    })
}

fn square() -> impl Strategy<Value = (usize, Vec<(f64, f64)>)> {
    (1..=3_usize).prop_flat_map(|n| (Just(n), prop::collection::vec(entry(), n * n)))
}

fn tall() -> impl Strategy<Value = (usize, Vec<(f64, f64)>, Vec<i8>)> {
    (1..=3_usize, 1..=7_usize)
        .prop_flat_map(|(n, m)| (Just(n), prop::collection::vec(entry(), m * n), prop::collection::vec(-3..=3_i8, n)))
}

fn cases() -> ProptestConfig {
    let given = std::env::var("IVSID_CASES").ok().and_then(|s| s.parse().ok());
    ProptestConfig::with_cases(given.unwrap_or(60))
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn an_inverse_of_any_matrix_holds_those_of_its_corners((n, entries) in square()) {
        let (lo, hi): (Vec<f64>, Vec<f64>) = entries.into_iter().unzip();
        let Ok(a) = IntervalMatrix::new(n, n, lo.clone(), hi.clone()) else {
            prop_assert!(lo.iter().zip(&hi).any(|(l, h)| l.is_nan() || h.is_nan() || l > h || l.is_infinite() || h.is_infinite()));
            return Ok(());
        };
        let finite = lo.iter().chain(&hi).all(|x| x.is_finite());
        let mut exactly: Option<Vec<Option<Vec<BigRational>>>> = None;
        for (name, inverse) in INVERSES {
            let outcome = inverse(&a).expect("a square matrix");
            if outcome.status != Status::Enclosed {
                prop_assert!(outcome.value.is_none(), "{}: a value without a proof", name);
                continue;
            }
            prop_assert!(finite, "{}: an enclosure of a matrix without ends", name);
            let (lower, upper) = outcome.bounds().expect("a value");
            let members = exactly.get_or_insert_with(|| {
                corners(&a).iter().map(|c| invert(&c.iter().map(|&x| q(x)).collect::<Vec<_>>(), n).1).collect()
            });
            for found in members {
                let Some(found) = found else {
                    return Err(TestCaseError::fail(format!("{name}: an enclosure around a singular member")));
                };
                for (k, x) in found.iter().enumerate() {
                    let low = lower[k] == f64::NEG_INFINITY || q(lower[k]) <= *x;
                    let high = upper[k] == f64::INFINITY || *x <= q(upper[k]);
                    prop_assert!(low && high, "{}: entry {} is outside", name, k);
                }
            }
        }
    }

    #[test]
    fn the_linear_programmes_keep_what_every_row_allows((n, entries, truth) in tall()) {
        let (lo, hi): (Vec<f64>, Vec<f64>) = entries.into_iter().unzip();
        let m = lo.len() / n;
        let Ok(a) = IntervalMatrix::new(m, n, lo, hi) else { return Ok(()) };
        let point = |x: i8| Interval::new(f64::from(x), f64::from(x)).expect("a number");
        let y: Vec<Interval> =
            (0..m).map(|i| (0..n).fold(Interval::ZERO, |sum, j| sum + a.get(i, j) * point(truth[j]))).collect();
        let Ok(found) = feasible_set(&a, &y) else { return Ok(()) };
        prop_assert!(found.status != FeasibleStatus::Empty, "a set that holds {:?} is called empty", truth);
        if found.status == FeasibleStatus::Enclosed {
            for (p, x) in found.parameters.iter().zip(&truth) {
                prop_assert!(p.lo() <= f64::from(*x) && f64::from(*x) <= p.hi(), "{:?} does not hold {}", p, x);
            }
        }
    }
}
