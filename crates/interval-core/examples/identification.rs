//! Mass and quadratic drag of a vehicle in surge from a log: every pair that `m u' + d u |u| = X` allows, proved.
//!
//! Each row is an equation between intervals: the acceleration and the velocity within the bounds of their sensors, the
//! force within the accuracy of the thrust.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::print_stdout, reason = "an example prints")]

use interval_core::regression::{FeasibleStatus, feasible_set};
use interval_core::{Error, Interval, IntervalMatrix};

fn main() -> Result<(), Error> {
    let (mass, drag, step) = (245.0, 31.0, 0.1);
    let (mut u, mut entries, mut forces) = (0.0_f64, Vec::new(), Vec::new());
    for k in 0..2000 {
        let demand = 60.0 * (f64::from(k) * 0.011).sin() + 25.0 * (f64::from(k) * 0.0037).cos();
        let rate = (demand - drag * u * u.abs()) / mass;
        // Readings that are wrong by up to their bounds: 0.01 m/s^2, 0.02 m/s, and 3 % of the force.
        let wrong = (f64::from(k) * 7.3).sin();
        let (a, v, x) = (rate + 0.01 * wrong, u - 0.02 * wrong, demand * (1.0 + 0.03 * wrong));
        let around = |value: f64, bound: f64| Interval::new(value - bound, value + bound);
        entries.extend([around(a, 0.0101)?, around(v, 0.0201)?.signed_square()]);
        forces.push(around(x, 0.032 * x.abs() + 1e-9)?);
        u += step * rate;
    }
    let (lower, upper) = entries.iter().map(|x: &Interval| (x.lo(), x.hi())).unzip();
    let rows = IntervalMatrix::new(forces.len(), 2, lower, upper)?;
    let set = feasible_set(&rows, &forces)?;
    for (name, bounds, truth) in [("mass [kg]", 0, mass), ("drag [kg/m]", 1, drag)] {
        println!("{name}: {} ({:?}), hidden {truth}", set.parameters[bounds], set.status);
        assert!(set.status == FeasibleStatus::Enclosed && set.parameters[bounds].contains(truth));
    }
    Ok(())
}
