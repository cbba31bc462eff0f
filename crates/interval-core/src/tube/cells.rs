//! Cells of the yaw rate: what surge and sway can be where the vehicle turns at one rate, and not at any.
//!
//! **Lemma (cover).** Let every state of a time lie in one of the boxes `E_i`. Let boxes `N_j` have yaw rates that cover those
//! of each `E_i`, and let each `N_j` whose yaw rates meet those of `E_i` hold its u and v. Then every state lies in an `N_j`.
//! (Its yaw rate lies in some `N_j` that meets `E_i`, which holds its u and v.) What was true since the start of every
//! solution in each `E_i` that meets `N_j`, their hull is true of every solution in `N_j`.
//!
//! Turns couple surge and sway by products with the yaw rate, and the yaw rate changes slowly. A box of all three takes the
//! largest product of ranges that belong to different turns. Each cell is followed by itself for some steps; then the
//! yaw rates that are left are cut anew.

use super::step::Since;
use super::{Cutting, Node};
use crate::interval::Interval;

/// Share of the yaw rate by which a cell may be wide: far out, surge and sway change with its logarithm.
const SHARE: f64 = 0.125;
/// Halvings of the search for the width of the innermost cell.
const HALVINGS: u32 = 30;

/// States of one cell, and what is known of them since the start.
#[derive(Debug, Clone)]
pub struct Cell<'a> {
    /// Where they are.
    pub node: Node,
    /// What is known.
    pub since: Since<'a>,
}

/// Cuts the yaw rates of some cells anew.
pub fn cut<'a>(cells: &[Cell<'a>], &Cutting { most, narrowest, .. }: &Cutting) -> Vec<Cell<'a>> {
    let (lo, hi) = cells
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), c| (a.min(c.node.nu[2].lo()), b.max(c.node.nu[2].hi())));
    let next = |x: f64, width: f64| x + width + SHARE * x.abs();
    let count = |width: f64| {
        let (mut n, mut x) = (0, lo);
        while x < hi && n <= most {
            (n, x) = (n + 1, next(x, width));
        }
        n
    };
    let mut width = narrowest;
    if count(width) > most {
        let mut many = narrowest;
        width = narrowest.max(hi - lo);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (width + many);
            if count(middle) > most { many = middle } else { width = middle }
        }
    }
    let mut made = Vec::new();
    let mut from = lo;
    while from < hi {
        let to = next(from, width).min(hi);
        let range = Interval::raw(from, to);
        if let Some(cell) = within(cells, range) {
            made.push(cell);
        }
        from = to;
    }
    // A single yaw rate is not cut.
    if made.is_empty() { cells.to_vec() } else { made }
}

/// The cell of a range of yaw rates; None where none of the old ones meets it.
fn within<'a>(cells: &[Cell<'a>], range: Interval) -> Option<Cell<'a>> {
    let mut meeting = cells.iter().filter(|c| !c.node.nu[2].intersection(range).is_empty());
    let mut made = meeting.next()?.clone();
    for other in meeting {
        for i in 0..3 {
            made.node.nu[i] = made.node.nu[i].hull(other.node.nu[i]);
            made.node.pose[i] = made.node.pose[i].hull(other.node.pose[i]);
        }
        made.since.join(&other.since);
    }
    made.node.nu[2] = made.node.nu[2].intersection(range);
    Some(made)
}

/// The hull of all cells.
pub fn hull(cells: &[Cell<'_>]) -> Node {
    let mut found = cells[0].node;
    for cell in cells {
        for i in 0..3 {
            found.nu[i] = found.nu[i].hull(cell.node.nu[i]);
            found.pose[i] = found.pose[i].hull(cell.node.pose[i]);
        }
    }
    found
}
