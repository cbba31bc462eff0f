//! Guaranteed simulation: bounds of every trajectory of `M(theta) nu' + sum theta_j c_j(nu) = F(t)` for all `theta` of a
//! polytope, all starts of a box, and all forces that stay inside their interval of each step, as any measurable function
//! of time.
//!
//! One file a theorem: `enclosure` (existence, and a box over each step), `comparison` (the ends after it), `integrated`
//! (the row of yaw over all steps since the start), `momentum` (which no turn changes), `cells` (of the yaw rate), `pose`
//! (heading and position).
//! [`program`] and [`model`] are the equations; [`members`] simulates single members in plain floats, which bound nothing
//! from outside.

mod cells;
mod comparison;
mod enclosure;
mod integrated;
pub mod members;
pub mod model;
mod momentum;
mod pose;
pub mod program;
mod step;

use crate::error::Error;
use crate::interval::Interval;
use cells::Cell;
pub use enclosure::{Enclosure, Given};
use integrated::{Integrals, Row};
use model::Work;
pub use model::{Entry, Model, Three};
use momentum::Momentum;
pub use program::Op;
use step::{Over, Since};

/// The course of the inputs, one entry a step.
#[derive(Debug, Clone)]
pub struct Inputs<'a> {
    /// Lengths \[s\].
    pub h: &'a [Interval],
    /// Forces X, Y \[N\] and moments N \[N m\]: all values over the step.
    pub force: [&'a [Interval]; 3],
    /// Velocities of components that are not free: all values over the step. Empty where all are free.
    pub given: &'a [Given],
}

/// State of knowledge at a sample.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// Velocities u, v [m/s], r [rad/s].
    pub nu: Three,
    /// Heading \[rad\], position north and east \[m\].
    pub pose: Three,
}

/// One part of a step as a certificate: the box at its start, and the accelerations over it.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    /// Number of the step.
    pub step: usize,
    /// Number of the cell of the yaw rate, by rising rates.
    pub cell: usize,
    /// Share of the step: it is cut into so many equal parts.
    pub parts: u32,
    /// Velocities at the start.
    pub start: Three,
    /// Accelerations over the part.
    pub rates: Three,
    /// Velocities at the end.
    pub end: Three,
}

/// A tube: the nodes at the samples, as far as they are proved.
#[derive(Debug, Clone)]
pub struct Tube {
    /// One node a sample; fewer where a step has no proved box.
    pub nodes: Vec<Node>,
    /// The parts of all steps, where asked for.
    pub parts: Vec<Part>,
}

/// Cells of the yaw rate.
#[derive(Debug, Clone, Copy)]
pub struct Cutting {
    /// Number of cells, at most.
    pub most: usize,
    /// Steps after which the yaw rates are cut into cells anew.
    pub every: usize,
    /// Width of the narrowest cell \[rad/s\].
    pub narrowest: f64,
}

/// Follows a box over the steps.
///
/// # Arguments
/// `parts` is the number of equal parts into which every step is cut; `certify` keeps them. `cutting` follows cells of the
/// yaw rate by themselves, where all components are free.
///
/// # Errors
/// Inputs of unequal lengths, or none, or steps that are not positive.
pub fn follow(
    model: &Model,
    start: Node,
    inputs: &Inputs,
    parts: u32,
    cutting: Option<Cutting>,
    certify: bool,
) -> Result<Tube, Error> {
    let n = inputs.h.len();
    for column in inputs.force {
        if column.len() != n {
            return Err(Error::Shape { what: "a force of the tube", given: column.len(), needed: n });
        }
    }
    let all_free = model.free == [true; 3];
    if !all_free && inputs.given.len() != n {
        return Err(Error::Shape { what: "the given velocities", given: inputs.given.len(), needed: n });
    }
    if parts == 0 {
        return Err(Error::Zero { what: "the number of parts of a step" });
    }
    if cutting.is_some_and(|c| c.every == 0 || c.most == 0 || c.narrowest.is_nan() || c.narrowest <= 0.0) {
        return Err(Error::Zero { what: "a number or width of cells of the yaw rate" });
    }
    if let Some(index) = inputs.h.iter().position(|h| !(h.lo() > 0.0 && h.hi().is_finite())) {
        return Err(Error::NoFinitePoint { index });
    }
    let mut work = Work::default();
    let mut tube = Tube { nodes: Vec::with_capacity(n + 1), parts: Vec::new() };
    let (momentum, rows) = if all_free { (Momentum::of(model), Row::all(model)) } else { (None, Vec::new()) };
    let since =
        Since { integrals: Integrals::new(&start.nu), rows: &rows, momentum: momentum.as_ref(), size: f64::INFINITY };
    let mut cells = vec![Cell { node: start, since }];
    tube.nodes.push(start);
    for k in 0..n {
        if let Some(cutting) = cutting.filter(|c| all_free && k % c.every == 0) {
            cells = cells::cut(&cells, &cutting);
        }
        let force = inputs.force.map(|f| f[k]);
        let given = if all_free { None } else { Some(inputs.given[k]) };
        let over = Over { model, step: k, h: inputs.h[k], force, given, parts, certify };
        let found = cells.iter().enumerate().map(|(number, cell)| over.after(number, cell, &mut work));
        let Some(found) = found.collect::<Option<Vec<_>>>() else { break };
        cells.clear();
        for (cell, kept) in found {
            cells.push(cell);
            tube.parts.extend(kept);
        }
        tube.nodes.push(cells::hull(&cells));
    }
    Ok(tube)
}
