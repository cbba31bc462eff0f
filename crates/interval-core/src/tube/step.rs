//! One step of one cell: cut into parts until a box over each is proved, with what all steps since the start say of it.

use super::cells::Cell;
use super::enclosure::{self, Enclosure, Given};
use super::integrated::{Integrals, Row};
use super::model::{Model, Three, Work};
use super::momentum::Momentum;
use super::{Part, comparison, pose};
use crate::interval::Interval;

/// A step without a box over it is cut into twice as many parts, up to this power of two.
const HALVINGS: u32 = 6;

/// A step, which is the same for all cells.
pub struct Over<'a> {
    /// Equations of motion.
    pub model: &'a Model,
    /// Its number.
    pub step: usize,
    /// Its length.
    pub h: Interval,
    /// All forces over it.
    pub force: Three,
    /// Components that are not free; None where all are.
    pub given: Option<Given>,
    /// Parts into which it is cut at least.
    pub parts: u32,
    /// Whether the parts are kept.
    pub certify: bool,
}

impl Over<'_> {
    /// A cell after the step, and its parts if they are kept; None where no box is proved over it.
    pub fn after<'s>(&self, number: usize, cell: &Cell<'s>, work: &mut Work) -> Option<(Cell<'s>, Vec<Part>)> {
        let Self { model, force, .. } = self;
        let given = self.given.unwrap_or(Given { nu: cell.node.nu, rates: [Interval::ZERO; 3] });
        (0..=HALVINGS).find_map(|power| {
            let count = self.parts << power;
            let mut kept = Vec::new();
            let h = self.h / Interval::raw(f64::from(count), f64::from(count));
            let Cell { node: mut now, since: mut reached } = cell.clone();
            for _ in 0..count {
                let mut step = enclosure::enclose(model, &now.nu, h, force, &given, work)?;
                reached.over(model, &now.nu, &mut step, force, h, work)?;
                let mut end = after(model, &now.nu, &step, force, h, work);
                if self.given.is_none() {
                    now.pose = pose::advance(&now.pose, &now.nu, &step, h);
                    reached.at_end(model, &step, force, h, &mut end, work);
                }
                if self.certify {
                    let (step_number, rates) = (self.step, step.rates);
                    kept.push(Part { step: step_number, cell: number, parts: count, start: now.nu, rates, end });
                }
                now.nu = end;
            }
            now.nu.iter().all(|x| x.is_common()).then_some((Cell { node: now, since: reached }, kept))
        })
    }
}

/// What is known from all steps since the start, where all components are free.
#[derive(Debug, Clone)]
pub struct Since<'a> {
    /// Integrals of columns and forces.
    pub integrals: Integrals,
    /// Rows of yaw.
    pub rows: &'a [Row],
    /// Columns of surge and sway, where no turn changes their momentum.
    pub momentum: Option<&'a Momentum>,
    /// The bound of the momentum.
    pub size: f64,
}

impl Since<'_> {
    /// What is true of the solutions of both.
    pub fn join(&mut self, other: &Self) {
        self.integrals.join(&other.integrals);
        self.size = self.size.max(other.size);
    }

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
            let cut = end[2].intersection(self.integrals.yaw(row, end));
            // A cell that no solution reaches keeps its box: nothing has to be proved of what is not there.
            if !cut.is_empty() {
                end[2] = cut;
            }
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
