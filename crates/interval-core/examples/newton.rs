//! All roots of `f(x) = e^x - 3 x^2` between -2 and 5, each proved, by the interval Newton operator.
//!
//! `N(X) = m - f(m) / f'(X)`: every root in X lies in N(X), and if N(X) lies inside X there is exactly one (Moore 1966).
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::print_stdout, reason = "an example prints")]

use interval_core::{Error, Interval};

fn number(x: f64) -> Interval {
    Interval::point(x).expect("a finite number")
}

/// Roots of X, each with the answer whether it is proved to be the only one there.
fn roots(x: Interval, proved: bool, found: &mut Vec<(Interval, bool)>) {
    let (f, slope) = (x.exp() - number(3.0) * x.square(), x.exp() - number(6.0) * x);
    if !f.contains(0.0) {
        return;
    }
    let m = number(x.midpoint());
    let newton = m - (m.exp() - number(3.0) * m.square()) / slope;
    let next = newton.intersection(x);
    if next.is_empty() {
        return;
    }
    let proved = proved || newton.interior(x);
    if next.width() < 0.9 * x.width() {
        return roots(next, proved, found);
    }
    if next.width() < 1e-12 {
        return found.push((next, proved));
    }
    for half in [Interval::new(x.lo(), m.lo()), Interval::new(m.lo(), x.hi())] {
        roots(half.expect("ordered bounds"), proved, found);
    }
}

fn main() -> Result<(), Error> {
    let mut found = Vec::new();
    roots(Interval::new(-2.0, 5.0)?, false, &mut found);
    for (root, proved) in &found {
        println!("{root}: {}", if *proved { "exactly one root" } else { "not proved" });
    }
    assert!(found.len() == 3 && found.iter().all(|r| r.1));
    Ok(())
}
