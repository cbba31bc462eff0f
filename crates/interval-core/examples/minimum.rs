//! The global minimum of a function of two numbers with many local ones, proved, by branch and bound.
//!
//! A box whose least value lies above a value that is attained holds no global minimum (Hansen and Walster, *Global
//! Optimization Using Interval Analysis*, 2004, chapter 12).
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::print_stdout, reason = "an example prints")]

use interval_core::{Error, Interval};

/// Rastrigin's function: `20 + x^2 - 10 cos 2 pi x + y^2 - 10 cos 2 pi y`, with 121 local minima in the box.
fn f([x, y]: [Interval; 2]) -> Interval {
    let ten = Interval::point(10.0).expect("a number");
    let part = |v: Interval| v.square() - ten * (v + v).cos_pi();
    ten + ten + part(x) + part(y)
}

fn main() -> Result<(), Error> {
    let side = Interval::new(-5.3, 5.1)?;
    let (mut boxes, mut attained, mut tried) = (vec![[side, side]], f64::INFINITY, 0);
    while let Some(at) = boxes.iter().position(|b| b[0].width().max(b[1].width()) > 1e-9) {
        let b = boxes.swap_remove(at);
        let cut = usize::from(b[1].width() > b[0].width());
        let m = b[cut].midpoint();
        for part in [Interval::new(b[cut].lo(), m)?, Interval::new(m, b[cut].hi())?] {
            let mut half = b;
            half[cut] = part;
            let centre = [Interval::point(half[0].midpoint())?, Interval::point(half[1].midpoint())?];
            attained = attained.min(f(centre).hi());
            tried += 1;
            boxes.push(half);
        }
        boxes.retain(|b| f(*b).lo() <= attained);
    }
    let least = boxes.iter().map(|b| f(*b).lo()).fold(attained, f64::min);
    let place = boxes.iter().copied().reduce(|a, b| [a[0].hull(b[0]), a[1].hull(b[1])]).expect("a minimum");
    println!("minimum between {least:e} and {attained:e} at {} and {}, {tried} boxes", place[0], place[1]);
    assert!(least <= 0.0 && 0.0 <= attained && place.iter().all(|x| x.contains(0.0)));
    Ok(())
}
