//! Matrices and systems at the ends of the range of doubles.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "test data are small numbers")]

mod common;

use common::matrices::{METHODS, by_cells, from_entries};
use common::q;
use interval_core::inverse::{exact, partitioned};
use interval_core::{Interval, Status, exact as rationals, systems};

/// Residuals that overflow or vanish are no residuals of zero.
#[test]
fn the_ends_of_the_range() {
    // A member has x_0 = -2^1024, beyond any double.
    let t = 2.0_f64.powi(1020);
    let a = from_entries(2, &[(0.875, 0.875), (-1.0, 0.375), (-0.375, -0.375), (0.5, 0.5)]);
    let b = [Interval::new(-6.0 * t, -5.5 * t).expect("good"), Interval::new(2.0 * t, 2.0 * t).expect("good")];
    for solve in [systems::exact, systems::gauss_seidel, systems::hansen_bliek_rohn, systems::krawczyk, systems::cramer]
    {
        let outcome = solve(&a, &b).expect("shapes fit");
        assert!(outcome.enclosure().is_none_or(|v| v.get(0, 0).lo() < -1.7e308), "{outcome:?}");
    }
    // Products that vanish: x = (2^-1020, -2^-1020).
    let tiny = 2.0_f64.powi(-60);
    let a = from_entries(2, &[(1.0, 1.0), (0.0, 0.0), (tiny, tiny), (tiny, tiny)]);
    for exponent in [-1020, -1022, -1060] {
        let x = 2.0_f64.powi(exponent);
        let b = [Interval::new(x, x).expect("good"), Interval::ZERO];
        for solve in
            [systems::exact, systems::gauss_seidel, systems::hansen_bliek_rohn, systems::krawczyk, systems::cramer]
        {
            if let Some(value) = solve(&a, &b).expect("shapes fit").enclosure() {
                assert!(value.get(0, 0).contains(x) && value.get(1, 0).contains(-x), "2^{exponent}: {value:?}");
            }
        }
    }
    let a = from_entries(2, &[(-1e200, -1e200), (5e-324, 5e-324), (5e-324, 5e-324), (-1.15e-308, -1.15e-308)]);
    let b = [Interval::new(2.0, 2.0).expect("good"), Interval::ZERO];
    if let Some(value) = systems::exact(&a, &b).expect("shapes fit").enclosure() {
        assert!(value.get(1, 0).lo() <= -8.59e-216, "{value:?}");
    }
    // An inverse whose sign vectors overflow one by one.
    let (e, f) = (2.0_f64.powi(511), 2.0_f64.powi(-511));
    let p = |x: f64| (x, x);
    let entries = [
        [p(0.375 * e), p(0.625 * e), p(-0.6875 * e), p(f), p(0.0)],
        [p(-0.5625 * e), p(-0.125 * e), p(-e), p(f), p(0.0)],
        [(-0.09375 * f, 0.96875 * f), p(-0.5 * f), p(0.6875 * f), p(0.0), p(e)],
        [p(0.0), p(0.0), p(0.0), p(e), p(f)],
        [p(0.0), p(0.0), p(0.0), p(f), p(e)],
    ];
    let a = from_entries(5, entries.as_flattened());
    let mut member: Vec<f64> = a.lo().to_vec();
    for (_, method) in METHODS {
        let outcome = method(&a).expect("square");
        let Some(value) = outcome.enclosure() else { continue };
        for end in [a.lo()[10], a.hi()[10]] {
            member[10] = end;
            let column = rationals::solve(&member, &[0.0, 0.0, 1.0, 0.0, 0.0], 5).expect("regular");
            assert!(q(value.get(0, 2).lo()) <= column[0] && column[0] <= q(value.get(0, 2).hi()));
        }
    }
}

/// Bounds and gaps of badly scaled matrices are in the units of the matrix, and their certificates hold.
#[test]
fn scaled_matrices_keep_their_units_and_certificates() {
    let n = 13;
    let scale = 1e-100;
    let entries: Vec<(f64, f64)> = (0..n * n)
        .map(|at: usize| if at.is_multiple_of(n + 1) { (scale, 1.2 * scale) } else { (-0.06 * scale, 0.055 * scale) })
        .collect();
    let outcome = partitioned(&from_entries(n, &entries), 3).expect("square");
    assert!(outcome.gap.expect("stated") > 1e90, "{:?}", outcome.gap);
    for entries in [
        [(5.5625e306, 5.5625e306), (0.0, 0.0), (-8e-323, -8e-323), (-1.28e202, -6.4e201)],
        [(-f64::MAX, -f64::MAX), (1e-200, 1e-200), (0.0, 0.0), (4.45e307, 4.45e307)],
        [(2.0_f64.powi(600), 2.0_f64.powi(600)), (0.0, 0.0), (0.0, 0.0), (2.0_f64.powi(600), 2.0_f64.powi(600))],
    ] {
        let a = from_entries(2, &entries);
        for (name, method) in METHODS {
            let outcome = method(&a).expect("square");
            assert!(outcome.certificate.is_none_or(|c| c.verify(&a)), "{name}: {entries:?}");
        }
        let cramer = interval_core::inverse::cramer(&a).expect("square");
        assert!(cramer.certificate.is_none_or(|c| c.verify(&a)), "{entries:?}");
    }
    let powers: Vec<(f64, f64)> = (0..25)
        .map(|at| if at % 6 == 0 { (2.0_f64.powi(1000 - 75 * at), 2.0_f64.powi(1000 - 75 * at)) } else { (0.0, 0.0) })
        .collect();
    for method in [exact, by_cells] {
        assert_eq!(method(&from_entries(5, &powers)).expect("square").status, Status::Enclosed);
    }
}
