//! A box that holds every solution over a whole step, and the proof that all exist that long.
//!
//! **Theorem (Picard and Lindelöf).** Let `X + [0, h] f(B)` lie in the bounded box `B`. Then each solution that starts in
//! `X` exists over the step, is unique, and stays in `X + [0, h] f(B)`. (The Picard operator maps the continuous
//! functions into `B` with start in `X` into themselves, and a polynomial is Lipschitz on a bounded box. Source: Moore
//! 1979, section 8.1; Nedialkov, Jackson and Corliss, Appl. Math. Comput. 105 (1999), section 4.)

use super::system::{Boxes, System};
use crate::interval::Interval;

/// Attempts to inflate a box that does not yet contain its own image.
const ATTEMPTS: usize = 8;

/// The box over a step of length within `[0, h]`; None where none is proved.
pub fn enclose(system: &System, start: &[Interval], h: f64) -> Option<Vec<Interval>> {
    let span = Interval::raw(0.0, h);
    let image = |over: &[Interval]| -> Vec<Interval> {
        let rates = system.series(&Boxes, over, 1).swap_remove(1);
        start.iter().zip(rates).map(|(&x, rate)| x + span * rate).collect()
    };
    let mut over = start.to_vec();
    let mut inflation = 0.125;
    for _ in 0..ATTEMPTS {
        let reached = image(&over);
        if !reached.iter().all(|x| x.is_common()) {
            return None;
        }
        if reached.iter().zip(&over).all(|(inner, outer)| inner.subset(*outer)) {
            // Solutions stay in the image, so that the image of the image holds them too.
            return Some(image(&reached));
        }
        for (outer, inner) in over.iter_mut().zip(reached) {
            let reach = inner.width() * inflation + f64::MIN_POSITIVE;
            *outer = outer.hull(inner) + Interval::raw(-reach, reach);
        }
        inflation *= 2.0;
    }
    None
}
