//! The hull where a few rows may be wrong, and the fewest rows that have to be (docs/theory.md, "The feasible set"), by
//! search trees over certificates.
//!
//! A certificate uses at most `n + 1` rows. Its proof for the set without the rows `D` stands for every larger `D` that
//! leaves its rows alone. So only sets that lose one of them are looked at further. At an empty orthant that is a row
//! of the contradiction, at a bound a row of its basis. With at most `q` wrong rows the trees are `q` deep, and every
//! set of wrong rows is covered by one of their nodes.

use super::feasible::{BoundCertificate, OrthantOutcome, OrthantResult};
use super::orthant::Orthant;
use super::prove::prove;
use super::rows::Rows;
use super::search::{Asked, Piece, Pool, solve};
use crate::certified::Certified;
use crate::interval::Interval;
use crate::parallel;
use std::collections::{BTreeMap, BTreeSet};

/// Nodes of all trees together at most: a bound of the time.
pub const NODE_LIMIT: usize = 50_000;

/// The effect of the rows that may be wrong on the set.
#[derive(Debug, Clone, PartialEq)]
pub struct Outliers {
    /// The number of rows that may be wrong.
    pub allowed: usize,
    /// The fewest rows without which a parameter is consistent. The value is `None` if that takes more than are
    /// allowed.
    pub fewest: Option<usize>,
    /// The sets of this number of rows, each in ascending order.
    pub sets: Vec<Vec<usize>>,
}

/// Bounds of every unknown over all nodes, the nodes with their proofs, and the open directions.
pub(crate) struct Trees {
    pub(crate) parameters: Certified<Vec<Interval>>,
    pub(crate) nodes: Vec<OrthantResult>,
    pub(crate) rays: Vec<Vec<f64>>,
    pub(crate) outliers: Outliers,
}

/// A node: an orthant without some rows, and the ends that are asked of it.
type Level = BTreeMap<(usize, Vec<usize>), BTreeSet<usize>>;

/// Searches every orthant. The value is `None` if the trees would have too many nodes.
pub(crate) fn trees(rows: &Rows<'_>, pool: &mut Pool, leaves: &[Vec<i8>], allowed: usize) -> Option<Trees> {
    let n = rows.columns();
    let mut level: Level = (0..leaves.len()).map(|z| ((z, Vec::new()), (0..2 * n).collect())).collect();
    let mut found = Trees {
        parameters: Certified::proved(vec![Interval::ENTIRE; n]),
        nodes: Vec::new(),
        rays: Vec::new(),
        outliers: Outliers { allowed, fewest: None, sets: Vec::new() },
    };
    let mut best: Option<Vec<(f64, f64)>> = None;
    for depth in 0..=allowed {
        if found.nodes.len() + level.len() > NODE_LIMIT {
            return None;
        }
        let mut pieces: Vec<Piece<'_>> = level
            .iter()
            .map(|((z, dropped), goals)| {
                let mut orthant = Orthant::new(rows, leaves[*z].clone());
                orthant.dropped.clone_from(dropped);
                let goals: Vec<(usize, f64)> =
                    goals.iter().map(|g| (g / 2, if g % 2 == 0 { 1.0 } else { -1.0 })).collect();
                Piece::new(orthant, pool, &goals)
            })
            .collect();
        solve(rows, pool, &mut pieces, Asked::Each);
        let proofs = parallel::map(pieces.len(), pieces.len() >= 16, |k| prove(rows, pool, &pieces[k]));
        let mut next = Level::new();
        for (((z, dropped), goals), (outcome, rays)) in level.into_iter().zip(proofs) {
            found.rays.extend(rays);
            let mut descend = |row: usize, goals: &mut dyn Iterator<Item = usize>| {
                let mut more = dropped.clone();
                more.push(row);
                more.sort_unstable();
                next.entry((z, more)).or_default().extend(goals);
            };
            match &*outcome {
                OrthantOutcome::Empty { rows } => {
                    for row in rows {
                        descend(row.0, &mut goals.iter().copied());
                    }
                }
                OrthantOutcome::Bounded(ends) => {
                    let best = best.get_or_insert_with(|| vec![(f64::INFINITY, f64::NEG_INFINITY); n]);
                    for end in ends {
                        include(&mut best[end.column], end);
                        let goal = 2 * end.column + usize::from(end.upper);
                        end.rows.iter().filter(|r| r.2 != 0.0).for_each(|r| descend(r.0, &mut [goal].into_iter()));
                    }
                    if found.outliers.fewest.is_none_or(|k| k == depth) {
                        found.outliers.fewest = Some(depth);
                        if !found.outliers.sets.contains(&dropped) {
                            found.outliers.sets.push(dropped.clone());
                        }
                    }
                }
            }
            found.nodes.push(OrthantResult { signs: leaves[z].clone(), dropped, outcome });
        }
        level = next;
    }
    found.outliers.sets.sort_unstable();
    // Every set of wrong rows is covered by a node, and every node is proved.
    found.parameters = Certified::proved(best.map_or_else(
        || vec![Interval::EMPTY; n],
        |ends| ends.into_iter().map(|(least, most)| Interval::raw(least, most)).collect(),
    ));
    Some(found)
}

fn include((least, most): &mut (f64, f64), end: &BoundCertificate) {
    if end.upper {
        *most = most.max(end.bound);
    } else {
        *least = least.min(end.bound);
    }
}
