//! Constraint generation: linear programs over all rows by a working set of few.
//!
//! All polyhedra (orthants) share one pool of rows. Each round solves every pending program on the pool, then one scan
//! over the rows tries all pending vertices and adds the rows that they violate most. The first rounds look at a part
//! of the rows only.

use super::orthant::Orthant;
use super::rows::Rows;
use super::scan::{Pass, Vertex, column_scale, scan};
use crate::linear_program::{HalfSpaces, Outcome, Program, Search};
use crate::parallel;
use crate::rounding::slices::Backend;
use std::collections::{HashMap, HashSet};

/// Rounds of one search at most: a bound of the time, and more than any search has needed.
const ROUNDS: usize = 400;
/// Open vertices of one kind that are tried at once where one decides for all.
const OPEN: usize = 2;

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
    /// No longer asked for: the objective is unbounded in another piece of the same union.
    pub(crate) retired: bool,
}

impl Goal {
    fn is_contradicted(&self) -> bool {
        matches!(self.outcome, Outcome::Contradiction(_))
    }

    /// Goes on after the working set has grown, or from where it stood.
    fn advance(&mut self, program: &Program, grown: bool) {
        if (!grown && self.settled) || self.retired || self.is_contradicted() {
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
    /// True if a contradiction ends only its own goal: the last basis before it proves a bound all the same.
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
                Goal { column, direction, search, outcome: Outcome::Failed, settled: false, retired: false }
            })
            .collect();
        Self { orthant, program, goals, contradiction: None, persistent: false, taken: 0 }
    }

    /// Takes in the new rows of the pool and goes on with every search. The first contradiction ends them all.
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
        let one = self.goals.iter().position(|g| !g.retired).map_or(self.goals.len(), |k| k + 1);
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
        let ray = (!goal.search.is_bounded()).then(|| goal.search.ray(&self.program));
        let point = goal.search.point(&self.program);
        Vertex { polyhedron: self.orthant.clone(), signs: self.orthant.signs.clone(), point, ray }
    }
}

/// The choice of goals for each piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    /// Every goal of every piece.
    Each,
    /// The union of the pieces, which all have the same goals: one that is unbounded somewhere is looked for nowhere
    /// else.
    Union,
}

/// Solves the goals of the pieces over all rows; pieces that meet a contradiction stop there.
pub(crate) fn solve(rows: &Rows<'_>, pool: &mut Pool, pieces: &mut [Piece<'_>], asked: Asked) {
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
            let places = pending(pieces, asked);
            if places.is_empty() {
                break;
            }
            let vertices: Vec<_> = places.iter().map(|&(p, k)| pieces[p].vertex(&pieces[p].goals[k])).collect();
            let found = scan(rows, &pool.scale, &vertices, &pool.known, Pass::new(rows.count(), stride), pool.backend);
            for ((p, k), indices) in places.into_iter().zip(found) {
                let goal = &mut pieces[p].goals[k];
                goal.settled = indices.is_empty();
                let everywhere = goal.settled && goal.outcome == Outcome::Unbounded && !goal.retired;
                for index in indices {
                    pool.insert(index);
                }
                if everywhere && asked == Asked::Union && stride == 1 {
                    pieces.iter_mut().enumerate().filter(|(q, _)| *q != p).for_each(|(_, q)| q.goals[k].retired = true);
                }
            }
        }
    }
}

/// The goals whose vertices have to be tried on the rows: all that are finite, and a few open ones of each kind where
/// one will do.
fn pending(pieces: &[Piece<'_>], asked: Asked) -> Vec<(usize, usize)> {
    let mut open: HashMap<usize, usize> = HashMap::new();
    let mut places = Vec::new();
    for (p, piece) in pieces.iter().enumerate().filter(|(_, p)| p.contradiction.is_none()) {
        for (k, goal) in piece.goals.iter().enumerate().filter(|(_, g)| !g.settled && !g.retired) {
            match goal.outcome {
                Outcome::Unbounded if asked == Asked::Union => {
                    let count = open.entry(k).or_insert(0);
                    *count += 1;
                    if *count <= OPEN {
                        places.push((p, k));
                    }
                }
                Outcome::Vertex | Outcome::Unbounded => places.push((p, k)),
                _ => {}
            }
        }
    }
    places
}
