//! One step: the Taylor polynomial in time, and its remainder over the box of the step.
//!
//! **Theorem (Taylor's with Lagrange's remainder).** Let the solution through `x` stay in `B` over \[0, h\]. Then component
//! `i` at `t` of \[0, h\] is `sum_{k < K} (x_i)_k t^k + r t^K` with `r` a value of the Taylor coefficient `(x_i)_K` over `B`.
//! (Source: Moore 1979, section 8.2; Nedialkov, Jackson and Corliss, Appl. Math. Comput. 105 (1999), section 2.)

use super::enclosure::enclose;
use super::form::{Form, Forms};
use super::system::{Boxes, Enclosing, System};
use crate::interval::Interval;

/// Order of the remainder: the polynomial in time has one degree less.
pub const ORDER: usize = 9;

/// What is known after one step.
#[derive(Debug, Clone)]
pub struct Step {
    /// Forms at the end.
    pub end: Vec<Form>,
    /// Boxes over the whole step.
    pub over: Vec<Interval>,
    /// Remainders at the end, which `end` holds.
    pub remainder: Vec<Interval>,
}

/// A step of a length inside `h` from `start`, whose ranges are `ranges`; None where existence is not proved.
pub fn advance(system: &System, forms: &Forms<'_>, start: &[Form], ranges: &[Interval], h: Interval) -> Option<Step> {
    let picard = enclose(system, ranges, h.hi())?;
    let last = system.series(&Boxes, &picard, ORDER).swap_remove(ORDER);
    let series = system.series(forms, start, ORDER - 1);
    let at = |time: Interval| -> (Vec<Form>, Vec<Interval>) {
        let powers = powers(time);
        let remainder: Vec<Interval> = last.iter().map(|&r| r * powers[ORDER]).collect();
        let one = forms.constant(Interval::ONE);
        let reached = remainder.iter().enumerate().map(|(i, &r)| {
            let mut sum = series[0][i].clone();
            for (coefficients, &power) in series.iter().zip(&powers).skip(1) {
                forms.accumulate(&mut sum, power, &coefficients[i]);
            }
            forms.accumulate(&mut sum, r, &one);
            sum
        });
        (reached.collect(), remainder)
    };
    let (end, remainder) = at(h);
    let within = at(Interval::raw(0.0, h.hi())).0;
    let over = within.iter().zip(&picard).map(|(form, &outer)| Some(forms.range(form)?.intersection(outer)));
    Some(Step { over: over.collect::<Option<_>>()?, end, remainder })
}

/// Powers 0 to [`ORDER`] of a time.
fn powers(time: Interval) -> Vec<Interval> {
    let next = |power: &Interval| Some(*power * time);
    std::iter::successors(Some(Interval::ONE), next).take(ORDER + 1).collect()
}
