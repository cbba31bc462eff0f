//! Guaranteed simulation: bounds of every trajectory of `M(theta) nu' + sum theta_j c_j(nu) = F(t)` for all `theta` of a
//! polytope, all starts of a box, and all forces that stay inside their interval of each step, as any measurable function
//! of time.
//!
//! One file a theorem: `enclosure` (existence, and a box over each step), `comparison` (the ends after it), `integrated`
//! (the row of yaw over all steps since the start), `momentum` (which no turn changes), `pose` (heading and position).
//! [`program`] and [`model`] are the equations; [`members`] simulates single members in plain floats, which bound nothing
//! from outside.

mod comparison;
mod enclosure;
mod integrated;
pub mod members;
pub mod model;
mod momentum;
mod pose;
pub mod program;

use crate::error::Error;
use crate::interval::Interval;
pub use enclosure::{Enclosure, Given};
use integrated::{Integrals, Row};
use model::Work;
pub use model::{Entry, Model, Three};
use momentum::Momentum;
pub use program::Op;

/// A step without a box over it is cut into twice as many parts, up to this power of two.
const HALVINGS: u32 = 6;

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

/// Follows a box over the steps.
///
/// # Arguments
/// `parts` is the number of equal parts into which every step is cut; `certify` keeps them.
///
/// # Errors
/// Inputs of unequal lengths, or none, or steps that are not positive.
pub fn follow(model: &Model, start: Node, inputs: &Inputs, parts: u32, certify: bool) -> Result<Tube, Error> {
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
    if let Some(index) = inputs.h.iter().position(|h| !(h.lo() > 0.0 && h.hi().is_finite())) {
        return Err(Error::NoFinitePoint { index });
    }
    let mut work = Work::default();
    let mut tube = Tube { nodes: Vec::with_capacity(n + 1), parts: Vec::new() };
    let mut node = start;
    let (momentum, rows) = if all_free { (Momentum::of(model), Row::all(model)) } else { (None, Vec::new()) };
    let mut since =
        Since { integrals: Integrals::new(&start.nu), rows: &rows, momentum: momentum.as_ref(), size: f64::INFINITY };
    tube.nodes.push(node);
    for k in 0..n {
        let force = inputs.force.map(|f| f[k]);
        let given = if all_free { Given { nu: start.nu, rates: [Interval::ZERO; 3] } } else { inputs.given[k] };
        let found = (0..=HALVINGS).find_map(|power| {
            let count = parts << power;
            let mut kept = Vec::new();
            let h = inputs.h[k] / Interval::raw(f64::from(count), f64::from(count));
            let (mut now, mut reached) = (node, since.clone());
            for _ in 0..count {
                let mut step = enclosure::enclose(model, &now.nu, h, &force, &given, &mut work)?;
                reached.over(model, &now.nu, &mut step, &force, h, &mut work)?;
                let mut end = after(model, &now.nu, &step, &force, h, &mut work);
                if all_free {
                    now.pose = pose::advance(&now.pose, &now.nu, &step, h);
                    reached.at_end(model, &step, &force, h, &mut end, &mut work);
                }
                if certify {
                    kept.push(Part { step: k, parts: count, start: now.nu, rates: step.rates, end });
                }
                now.nu = end;
            }
            now.nu.iter().all(|x| x.is_common()).then_some((now, reached, kept))
        });
        let Some((now, reached, kept)) = found else { break };
        (node, since) = (now, reached);
        tube.nodes.push(node);
        tube.parts.extend(kept);
    }
    Ok(tube)
}

/// What is known from all steps since the start, where all components are free.
#[derive(Debug, Clone)]
struct Since<'a> {
    integrals: Integrals,
    rows: &'a [Row],
    momentum: Option<&'a Momentum>,
    /// The bound of the momentum.
    size: f64,
}

impl Since<'_> {
    /// Cuts a step to the bound of the momentum; None where a proved set would be empty.
    fn over(
        &mut self,
        model: &Model,
        start: &Three,
        step: &mut Enclosure,
        force: &Three,
        h: Interval,
        work: &mut Work,
    ) -> Option<()> {
        let Some(momentum) = self.momentum else { return Some(()) };
        // The box of the start may say more than the bound so far.
        self.size = momentum.after(model, self.size.min(Momentum::size(model, start)), &step.nu, force, h, work);
        let cut = Momentum::within(model, self.size, &step.nu);
        if (0..3).any(|i| cut[i] != step.nu[i]) {
            // Every solution exists over the step by its own box, and stays in the part of it that is left.
            step.nu = cut;
            step.rates = model.accelerations(&cut, force, &[Interval::ZERO; 3], work)?;
        }
        Some(())
    }

    /// Cuts the yaw rate after a step.
    fn at_end(
        &mut self,
        model: &Model,
        step: &Enclosure,
        force: &Three,
        h: Interval,
        end: &mut Three,
        work: &mut Work,
    ) {
        self.integrals.add(model, step, force, h, work);
        for row in self.rows {
            end[2] = end[2].intersection(self.integrals.yaw(row, end));
        }
    }
}

/// Both ends of every free component after a part of a step; given components keep their range.
fn after(model: &Model, start: &Three, step: &Enclosure, force: &Three, h: Interval, work: &mut Work) -> Three {
    std::array::from_fn(|i| {
        if !model.free[i] {
            return step.nu[i];
        }
        let [lo, hi] = [false, true]
            .map(|up| comparison::after(&comparison::End { model, i, up, start, step, force: force[i], h }, work));
        // Both are bounds of the same non-empty set.
        Interval::raw(lo, hi)
    })
}
