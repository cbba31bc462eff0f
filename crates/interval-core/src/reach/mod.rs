//! Bounds of every solution of `x' = f(x)` with polynomial `f` that starts in a box, without options.
//!
//! One file a theorem: `enclosure` (existence, and a box over each step), `system` (Taylor coefficients), `step` (the
//! remainder in time), `form` (functions of the start as polynomials), `reduction` (generators of a fixed number); `basis`
//! is the table of monomials. Unknown constants are components with derivative 0.

mod basis;
mod enclosure;
mod form;
mod reduction;
mod step;
mod system;

use crate::error::Error;
use crate::interval::Interval;
use basis::Basis;
use form::{Form, Forms};
use step::{ORDER, advance};
pub use system::{System, Term};

/// Degree of the polynomials in the symbols of the start.
const DEGREE: usize = 4;

/// Share of the widest component, a unit of time, that a remainder may add.
const SHARE: f64 = 1e-4;

/// The same of the largest value, for starts that are points.
const POINT_SHARE: f64 = 1e-11;

/// Steps shorter than this share of the horizon end the tube.
const SHORTEST: f64 = 1e-7;

/// Knowledge at the end of a step.
#[derive(Debug, Clone)]
pub struct Node {
    /// Time at the end of the step.
    pub time: f64,
    /// Every state at that time.
    pub state: Vec<Interval>,
    /// Every state since the node before.
    pub over: Vec<Interval>,
    /// The remainder in time that `state` holds.
    pub remainder: Vec<Interval>,
}

/// A tube from time 0.
#[derive(Debug, Clone)]
pub struct Tube {
    /// Nodes by time.
    pub nodes: Vec<Node>,
    /// Whether the last node stands at the horizon; else no step further was proved.
    pub complete: bool,
}

/// Bounds of all solutions that start in a box at time 0, until `horizon`.
///
/// # Errors
/// A start of another number of components, unbounded or empty components, and a horizon that is negative or no
/// finite number are refused.
pub fn follow(system: &System, start: &[Interval], horizon: f64) -> Result<Tube, Error> {
    let needed = system.dimension();
    if start.len() != needed {
        return Err(Error::Shape { what: "start", given: start.len(), needed });
    }
    if let Some(index) = start.iter().position(|x| !x.is_common()) {
        return Err(Error::NoFinitePoint { index });
    }
    Interval::new(0.0, horizon).and_then(|_| Interval::point(horizon))?;
    let wide: Vec<usize> = (0..needed).filter(|&i| !start[i].is_singleton()).collect();
    let basis = Basis::new(wide.len(), DEGREE);
    let mut state = symbols(&basis, start, &wide);
    let (mut time, mut length) = (0.0_f64, horizon / 64.0);
    let mut nodes = Vec::new();
    while time < horizon {
        let generators = state.first().map_or(0, |form| form.generators.len());
        let forms = Forms { basis: &basis, generators };
        let Some(ranges) = state.iter().map(|form| forms.range(form)).collect::<Option<Vec<_>>>() else { break };
        let allowed = allowance(&ranges);
        let taken = loop {
            if length.is_nan() || length < SHORTEST * horizon {
                break None;
            }
            // The last two steps are of one length: none is tiny.
            let left = horizon - time;
            let next = if length >= left { horizon } else { time + length.min(left / 2.0) };
            let h = Interval::raw(next, next) - Interval::raw(time, time);
            let Some(step) = advance(system, &forms, &state, &ranges, h) else {
                length *= 0.5;
                continue;
            };
            let largest = step.remainder.iter().map(|r| r.magnitude()).fold(0.0, f64::max);
            let ratio = largest / (allowed * h.hi());
            #[allow(clippy::cast_precision_loss, reason = "the order is small")]
            let factor = (0.9 * ratio.powf(-1.0 / (ORDER as f64 - 1.0))).clamp(0.2, 1.5);
            length = if factor.is_nan() { f64::NAN } else { h.hi() * factor };
            if ratio <= 1.0 {
                break Some((next, step));
            }
        };
        let Some((next, step)) = taken else { break };
        let states = step.end.iter().map(|form| forms.range(form)).collect::<Option<Vec<_>>>();
        let Some(states) = states else { break };
        time = next;
        nodes.push(Node { time, state: states, over: step.over, remainder: step.remainder });
        state = step.end;
        reduction::reduce(&mut state);
    }
    Ok(Tube { complete: time >= horizon, nodes })
}

/// The box as forms: one symbol for each component that is not a point.
fn symbols(basis: &Basis, start: &[Interval], wide: &[usize]) -> Vec<Form> {
    let form = |(i, x): (usize, &Interval)| {
        let mut polynomial = vec![0.0; basis.len()];
        polynomial[0] = x.midpoint();
        if let Some(place) = wide.iter().position(|&j| j == i) {
            polynomial[1 + place] = x.radius();
        }
        Form { polynomial, generators: Vec::new(), error: 0.0 }
    };
    start.iter().enumerate().map(form).collect()
}

/// What the remainder of a step may add to a component in a unit of time.
fn allowance(ranges: &[Interval]) -> f64 {
    let widest = ranges.iter().map(|x| x.width()).fold(0.0, f64::max);
    let largest = ranges.iter().map(|x| x.magnitude()).fold(0.0, f64::max);
    SHARE * widest + POINT_SHARE * largest + f64::MIN_POSITIVE
}
