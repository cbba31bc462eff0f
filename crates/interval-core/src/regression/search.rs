//! Constraint generation: linear programs over all rows by a working set of few.
//!
//! All polyhedra (orthants) share one pool of rows. Each round solves every pending program on the pool, then one scan over the rows
//! tries all pending vertices and adds the rows that they violate most. The first rounds look at a part of the rows only.

use super::orthant::Orthant;
use super::rows::Rows;
use super::scan::{Pass, Vertex, column_scale, scan};
use crate::linear_program::{HalfSpaces, Outcome, Program, Search};
use crate::parallel;
use crate::rounding::slices::Backend;
use std::collections::HashSet;

/// Rounds of one search, more than any has needed.
const ROUNDS: usize = 400;

/// The rows that any working set holds, as half-spaces of an orthant.
#[derive(Debug, Clone)]
pub(crate) struct Pool {
    pub(crate) members: Vec<usize>,
    known: HashSet<usize>,
    pub(crate) scale: Vec<f64>,
    backend: Backend,
}

impl Pool {
    /// A sample of the rows, evenly spaced.
    pub(crate) fn new(rows: &Rows<'_>, backend: Backend) -> Self {
        let (m, n) = (rows.count(), rows.columns());
        let mut pool = Self { members: Vec::new(), known: HashSet::new(), scale: column_scale(rows), backend };
        let wanted = 8 * n;
        let step = (m / wanted).max(1);
        (0..m).step_by(step).take(2 * wanted).for_each(|i| {
            pool.insert(i);
            pool.insert(i + m);
        });
        pool
    }

    pub(crate) fn insert(&mut self, index: usize) -> bool {
        let new = self.known.insert(index);
        if new {
            self.members.push(index);
        }
        new
    }

    pub(crate) fn known(&self) -> &HashSet<usize> {
        &self.known
    }

    pub(crate) fn backend(&self) -> Backend {
        self.backend
    }
}

/// One objective of one polyhedron.
#[derive(Debug, Clone)]
pub(crate) struct Goal {
    pub(crate) column: usize,
    /// 1 for the least value of the unknown, -1 for the largest.
    pub(crate) direction: f64,
    pub(crate) search: Search,
    pub(crate) outcome: Outcome,
    settled: bool,
}

impl Goal {
    fn is_contradicted(&self) -> bool {
        matches!(self.outcome, Outcome::Contradiction(_))
    }

    /// Goes on after the working set has grown, or from where it stood.
    fn advance(&mut self, program: &Program, grown: bool) {
        if (!grown && self.settled) || self.is_contradicted() {
            return;
        }
        let (before, was) = (self.search.point(program), self.outcome);
        self.outcome = self.search.run(program);
        if self.outcome != was || self.search.point(program) != before {
            self.settled = false;
        }
    }
}

/// A polyhedron with its working set and its objectives.
#[derive(Debug, Clone)]
pub(crate) struct Piece<'a> {
    pub(crate) orthant: Orthant<'a>,
    pub(crate) program: Program,
    pub(crate) goals: Vec<Goal>,
    /// The goal whose search met a contradiction.
    pub(crate) contradiction: Option<(usize, usize)>,
    /// Whether a contradiction ends only its own goal: the last basis before it proves a bound all the same.
    pub(crate) persistent: bool,
    taken: usize,
}

impl<'a> Piece<'a> {
    /// Minimises `direction * x[column]` for each of the goals.
    pub(crate) fn new(orthant: Orthant<'a>, pool: &Pool, goals: &[(usize, f64)]) -> Self {
        let n = orthant.dimension();
        let mut program = Program::new(pool.scale.clone());
        let mut g = vec![0.0; n];
        let m = orthant.rows.count();
        for index in 2 * m..2 * m + n {
            let h = orthant.half_space(index, &mut g);
            program.push(index, &g, h);
        }
        let goals = goals
            .iter()
            .map(|&(column, direction)| {
                let mut objective = vec![0.0; n];
                objective[column] = direction;
                let search = Search::new(&program, &objective);
                Goal { column, direction, search, outcome: Outcome::Failed, settled: false }
            })
            .collect();
        Self { orthant, program, goals, contradiction: None, persistent: false, taken: 0 }
    }

    /// Takes in what is new in the pool and goes on with every search. The first contradiction ends them all.
    fn advance(&mut self, pool: &Pool) {
        let mut g = vec![0.0; self.orthant.dimension()];
        let grown = self.taken < pool.members.len();
        for &index in &pool.members[self.taken..] {
            let h = self.orthant.half_space(index, &mut g);
            self.program.push(index, &g, h);
        }
        self.taken = pool.members.len();
        // An empty orthant shows at its first goal, so the others wait for it.
        let program = &self.program;
        let persistent = self.persistent;
        let one = self.goals.len().min(1);
        let (first, others) = self.goals.split_at_mut(one);
        for goal in first.iter_mut() {
            goal.advance(program, grown);
        }
        if persistent || first.iter().all(|goal| !goal.is_contradicted()) {
            parallel::for_each(others, program.dimension() > 6, |goal| goal.advance(program, grown));
        }
        if !persistent {
            self.contradiction = self.goals.iter().enumerate().find_map(|(k, goal)| match goal.outcome {
                Outcome::Contradiction(entering) => Some((k, entering)),
                _ => None,
            });
        }
    }

    fn vertex(&self, goal: &Goal) -> Vertex<Orthant<'a>> {
        let ray = (goal.outcome == Outcome::Unbounded).then(|| goal.search.ray(&self.program));
        let point = goal.search.point(&self.program);
        Vertex { polyhedron: self.orthant.clone(), signs: self.orthant.signs.clone(), point, ray }
    }
}

/// Solves every goal of every piece over all rows; pieces that meet a contradiction stop there.
pub(crate) fn solve(rows: &Rows<'_>, pool: &mut Pool, pieces: &mut [Piece<'_>]) {
    let count = Pass::pieces(rows.count());
    let strides: &[usize] = if count >= 64 { &[64, 8, 1] } else { &[1] };
    for &stride in strides {
        pieces.iter_mut().flat_map(|p| &mut p.goals).for_each(|g| g.settled = false);
        for _ in 0..ROUNDS {
            parallel::for_each(pieces, pieces.len() >= 16, |piece| {
                if piece.contradiction.is_none() {
                    piece.advance(pool);
                }
            });
            let mut vertices = Vec::new();
            let mut places = Vec::new();
            for (p, piece) in pieces.iter().enumerate().filter(|(_, p)| p.contradiction.is_none()) {
                for (k, goal) in piece.goals.iter().enumerate() {
                    if !goal.settled && matches!(goal.outcome, Outcome::Vertex | Outcome::Unbounded) {
                        vertices.push(piece.vertex(goal));
                        places.push((p, k));
                    }
                }
            }
            if vertices.is_empty() {
                break;
            }
            let found = scan(rows, &pool.scale, &vertices, &pool.known, Pass::new(rows.count(), stride), pool.backend);
            let mut grown = false;
            for ((p, k), indices) in places.into_iter().zip(found) {
                pieces[p].goals[k].settled = indices.is_empty();
                for index in indices {
                    grown |= pool.insert(index);
                }
            }
            if !grown {
                break;
            }
        }
    }
}
