//! What a follower does with a row: which half-spaces it keeps, which vertices move, and the proof of their ends.

use crate::bounds::Bounds;
use crate::follower::{Contradiction, Follower};
use crate::half_space::{HalfSpace, Side};
use crate::proof::Combination;
use crate::vertex::{Found, Member, Problem, Vertex};

/// Vertices looked at and exchanges of one call at most, which cost about the same: a bound of its time. Ends that need
/// more go on at the next row.
const STEPS: usize = 24;
/// Kept rows whose value is computed again at every row: values drift as slowly as the set shrinks.
const REVALUED: usize = 4;
/// Half-spaces are made again once the box has narrowed to this share of the one that they were made for.
const NARROWED: f64 = 0.8;
/// The same for a parameter without a sign, whose half-spaces are the tighter the narrower the box is.
const NARROWED_WITHOUT_SIGN: f64 = 0.98;
/// Share of the width by which the box of drifting parameters is made wider, so that it serves for a while.
const AHEAD: f64 = 0.05;
/// An end of the box that moves by this share of the width moves the vertices that lie on it.
const MOVED: f64 = 1e-3;
/// Violations of a vertex below this share of a row's change across the box do not cut it.
const CUT: f64 = 1e-9;

impl<const N: usize, const ROWS: usize> Follower<N, ROWS> {
    /// Makes all half-spaces for the present box, or one a little wider where parameters drift.
    pub(crate) fn make_half_spaces(&mut self) {
        let mut region = self.bounds;
        if self.drifts {
            for x in &mut region {
                let more = AHEAD * x.width();
                *x = Bounds::new(x.lo - more, x.hi + more);
            }
        }
        self.measure();
        self.rows.make(&region);
        self.vertices.iter_mut().flatten().for_each(|v| v.pending = true);
    }

    fn measure(&mut self) {
        for (w, x) in self.widths.iter_mut().zip(&self.bounds) {
            *w = x.width().max(1e-12 * x.lo.abs().max(x.hi.abs())).max(1e-200);
        }
    }

    /// The distance of a half-space to the vertex that is closest to it, in units of the vertices' spread along it, and
    /// that vertex.
    #[expect(clippy::cast_possible_truncation, reason = "a value needs no more digits, and vertices are few")]
    fn appraise(&self, row: &HalfSpace<N>) -> (f32, u16) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut nearest = 0;
        for (vertex, at) in self.vertices.as_flattened().iter().map(|v| row.at(&v.x)).enumerate() {
            low = low.min(at);
            if at > high {
                (nearest, high) = (vertex, at);
            }
        }
        (((row.h - high) / (high - low).max(1e-12 * row.size)) as f32, nearest as u16)
    }

    /// Keeps a half-space if it cuts a vertex, or may sooner than one that is kept.
    pub(crate) fn consider(&mut self, side: &Side<N>) {
        let row = self.rows.half_space_of(side);
        let (value, nearest) = self.appraise(&row);
        let Some(place) = self.place(value, nearest) else { return };
        let limit = row.h + CUT * row.size;
        for vertex in self.vertices.as_flattened_mut() {
            vertex.pending |= row.at(&vertex.x) > limit;
        }
        self.rows.put(place, side, &row, value, nearest);
    }

    /// The place of a row: a free one, or that of the row furthest from its vertex among those of the vertex that has most.
    fn place(&self, value: f32, nearest: u16) -> Option<usize> {
        if self.rows.count < ROWS {
            return Some(self.rows.count);
        }
        let shared = self.rows.shared();
        let most = shared.iter().copied().fold(0, u16::max);
        let own = shared[usize::from(nearest)] + 1 >= most;
        let mut found = None;
        let mut furthest = if own { value } else { f32::NEG_INFINITY };
        for (k, (far, other)) in self.rows.appraisals().enumerate() {
            let crowded = if own { other == nearest } else { shared[usize::from(other)] == most };
            if crowded && far > furthest && !self.is_in_a_basis(k) {
                (found, furthest) = (Some(k), far);
            }
        }
        found
    }

    fn is_in_a_basis(&self, k: usize) -> bool {
        self.vertices.iter().flatten().any(|v| v.basis.iter().any(|&m| usize::from(m) == k))
    }

    /// Moves the vertices that are cut, and proves their ends.
    pub(crate) fn work(&mut self) {
        let mut steps = STEPS;
        let now = self.now.unwrap_or(0.0);
        for _ in 0..REVALUED.min(self.rows.count) {
            let k = (self.revalued + 1) % self.rows.count;
            let (value, nearest) = self.appraise(&self.rows.half_space(k, now));
            self.rows.appraise(k, value, nearest);
            self.revalued = k;
        }
        let turn = self.turn;
        self.turn = (turn + 1) % (2 * N);
        if self.drifts {
            self.vertices[turn / 2][turn % 2].pending = true;
        }
        for k in 0..2 * N {
            let at = (turn + k) % (2 * N);
            let (column, upper) = (at / 2, at % 2 == 1);
            if self.vertices[column][usize::from(upper)].pending {
                steps -= 1;
                self.move_vertex(column, upper, now, &mut steps);
                if self.contradiction.is_some() || steps == 0 {
                    return;
                }
            }
        }
        let narrowed = self.bounds.iter().zip(&self.rows.region).any(|(x, r)| {
            let without_sign = !self.drifts && r.lo < 0.0 && r.hi > 0.0;
            let share = if without_sign { NARROWED_WITHOUT_SIGN } else { NARROWED };
            x.width() < share * r.width() || (without_sign && (x.lo >= 0.0 || x.hi <= 0.0))
        });
        if narrowed {
            self.make_half_spaces();
        }
    }

    fn move_vertex(&mut self, column: usize, upper: bool, now: f64, steps: &mut usize) {
        let problem = Problem { rows: &self.rows, region: &self.bounds, widths: &self.widths, now };
        let direction = if upper { -1.0 } else { 1.0 };
        let vertex = &mut self.vertices[column][usize::from(upper)];
        let found = vertex.search(&problem, column, direction, steps);
        vertex.pending = found == Found::Open && *steps == 0;
        let mut objective = [0.0; N];
        if let Found::Contradiction(entering) = found {
            let mut weights = [0.0; N];
            let alpha = vertex.coefficients(&problem.half_space(entering).0);
            weights.iter_mut().zip(alpha).for_each(|(w, a)| *w = -a);
            let (sum, members) = combination(&problem, objective, &vertex.basis, &weights, Some(entering));
            if sum.least(&self.bounds) > 0.0 {
                self.contradiction = Some(members.contradiction(now, None));
                return;
            }
        }
        let end = Problem::<N, ROWS>::end(column, upper);
        objective[column] = direction;
        let (sum, members) = combination(&problem, objective, &vertex.basis, &vertex.multipliers, None);
        let bound = direction * sum.least(&self.bounds);
        let x = &mut self.bounds[column];
        let moved = if upper { x.hi - bound } else { bound - x.lo };
        if moved > 0.0 {
            *(if upper { &mut x.hi } else { &mut x.lo }) = bound;
            if x.lo > x.hi {
                self.contradiction = Some(members.contradiction(now, Some(column)));
            } else if moved > MOVED * self.widths[column] {
                let touched = |v: &&mut Vertex<N>| v.basis.contains(&end);
                self.vertices.iter_mut().flatten().filter(touched).for_each(|v| v.pending = true);
                self.measure();
            }
        }
    }
}

/// The rows of a proof.
struct Members {
    oldest: f64,
    rows: usize,
}

impl Members {
    fn contradiction(&self, time: f64, column: Option<usize>) -> Contradiction {
        Contradiction { time, oldest: self.oldest.min(time), rows: self.rows, column }
    }
}

/// The objective and the weighted half-spaces of a basis, with the entering one once. Ends of the box are left to the
/// residual.
fn combination<const N: usize, const ROWS: usize>(
    problem: &Problem<'_, N, ROWS>,
    objective: [f64; N],
    basis: &[Member; N],
    weights: &[f64; N],
    entering: Option<Member>,
) -> (Combination<N>, Members) {
    let mut sum = Combination::new(objective);
    let mut members = Members { oldest: f64::INFINITY, rows: 0 };
    let parts = basis.iter().copied().zip(weights.iter().copied()).chain(entering.map(|m| (m, 1.0)));
    for (member, weight) in parts {
        let k = usize::from(member);
        if k < ROWS && weight > 0.0 {
            let row = problem.rows.half_space(k, problem.now);
            sum.add(weight, &row.g, row.h);
            members = Members { oldest: members.oldest.min(problem.rows.time[k]), rows: members.rows + 1 };
        }
    }
    (sum, members)
}
