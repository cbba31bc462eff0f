//! One end of one component after a step, by a parabola that no solution can cross.
//!
//! **Theorem (scalar comparison; Müller 1927, Walter, Differential and Integral Inequalities, 1970, section 12).** Let
//! `x_i' = g(t, x_i)` almost everywhere, where `g` also depends on the other components, parameters and inputs along the
//! solution, all inside known ranges. Let `Z(0) = 0` and `Z'(t) >= g(t, b + Z(t))` for every choice in these ranges. If
//! `x_i(0) <= b`, then `x_i(t) <= b + Z(t)` over the step. (The difference `e = x_i - b - Z` satisfies `e' <= L e`
//! wherever it is positive, because the supremum of g over the ranges is Lipschitz in `x_i`; Gronwall's lemma.)
//!
//! **Corollary (parabola).** `Z(t) = gamma t + kappa t^2 / 2` serves, if
//!
//! - gamma bounds `x_i'` on the face `x_i = b` of the box at the start of the step, under all inputs of the step and
//!   all other accelerations of the step;
//! - delta bounds the rate at which that bound moves while the other components run through the step at their
//!   accelerations (mean value theorem);
//! - `[a]` holds the slopes of `x_i'` in `x_i` over `b + Z([0, H])` and all other components of the step;
//! - `kappa >= delta + sup [a] (gamma + kappa [0, H / 2])`.
//!
//! Then `Z' = gamma + kappa t >= gamma + delta t + a Z`, because `Z = t (gamma + kappa t / 2)`. The other components thus
//! keep their time: a step costs only its square in width, and damping (`a < 0`, the logarithmic norm of one component)
//! contracts what is there. A lower end is the upper end of `-x_i`.

use super::enclosure::Enclosure;
use super::model::{Model, Three, Work};
use crate::interval::Interval;
use crate::rounding::{add_up, mul_up};

/// Attempts to find kappa: each repeats the inequality with the last one's right-hand side.
const ATTEMPTS: usize = 4;

/// An end of a component, and what is known of the step over which it moves.
#[derive(Clone, Copy)]
pub struct End<'a> {
    /// Equations of motion.
    pub model: &'a Model,
    /// The component.
    pub i: usize,
    /// Whether it is the upper end.
    pub up: bool,
    /// The box at the start.
    pub start: &'a Three,
    /// Velocities and accelerations over the step.
    pub step: &'a Enclosure,
    /// Force of row i.
    pub force: Interval,
    /// Length of the step.
    pub h: Interval,
}

/// The end after the step, never outside of the enclosure of the step.
pub fn after(end: &End<'_>, work: &mut Work) -> f64 {
    let nu = end.step.nu[end.i];
    let found = parabola(end, work);
    if end.up { found.map_or(nu.hi(), |x| x.min(nu.hi())) } else { found.map_or(nu.lo(), |x| x.max(nu.lo())) }
}

fn parabola(&End { model, i, up, start, step, force, h }: &End<'_>, work: &mut Work) -> Option<f64> {
    let b = if up { start[i].hi() } else { start[i].lo() };
    let at = Interval::raw(b, b);
    // The upper bound of x_i', or of that of -x_i.
    let largest = |x: Interval| if up { x.hi() } else { -x.lo() };
    let mut face = *start;
    for k in 0..3 {
        if !model.free[k] {
            face[k] = step.nu[k];
        }
    }
    face[i] = at;
    let gamma = largest(model.on_face(i, &face, force, &step.rates, work));
    let mut over = step.nu;
    over[i] = at;
    let mut rates = step.rates;
    rates[i] = Interval::ZERO;
    for k in 0..3 {
        if !model.free[k] {
            // A given component is everywhere in its range at every time: the face already holds its motion.
            rates[k] = Interval::ZERO;
        }
    }
    let delta = largest(model.drift(i, &over, &rates, work));
    if !gamma.is_finite() || !delta.is_finite() {
        return None;
    }
    // Z stays within [0, H] times this slope, which kappa has to confirm.
    let (gamma_at, half) = (Interval::raw(gamma, gamma), h * Interval::raw(0.5, 0.5));
    let span = Interval::raw(0.0, h.hi());
    let guess =
        gamma_at + Interval::raw(0.0, half.hi()) * Interval::raw(-spread(step, i, gamma), spread(step, i, gamma));
    let reach = span * guess;
    over[i] = if up { at + reach } else { at - reach };
    let unit: Three = std::array::from_fn(|k| if k == i { Interval::ONE } else { Interval::ZERO });
    let slopes = model.drift(i, &over, &unit, work);
    if !slopes.is_common() {
        return None;
    }
    let half_span = Interval::raw(0.0, half.hi());
    let needed = |kappa: f64| {
        let slope = gamma_at + Interval::raw(kappa, kappa) * half_span;
        (slope, add_up(delta, (slopes * slope).hi()))
    };
    let mut kappa = needed(0.0).1;
    for _ in 0..ATTEMPTS {
        if !kappa.is_finite() {
            return None;
        }
        let (slope, least) = needed(kappa);
        if kappa >= least && slope.subset(guess) {
            let k = Interval::raw(kappa, kappa);
            let moved = gamma_at * h + k * h.square() * Interval::raw(0.5, 0.5);
            let found = if up { at + moved } else { at - moved };
            let end = if up { found.hi() } else { found.lo() };
            return end.is_finite().then_some(end);
        }
        // A little above what the inequality asked for, so that it holds for the new kappa, too.
        kappa = add_up(least, mul_up(1e-3, (least - kappa).abs() + 1e-9 * least.abs()));
    }
    None
}

/// A size of kappa that leaves room: what the slope of Z may change by over the step, in units of its half.
fn spread(step: &Enclosure, i: usize, gamma: f64) -> f64 {
    16.0 * (step.rates[i].magnitude() + gamma.abs()) + f64::MIN_POSITIVE
}
