//! What a follower does with a row: which half-spaces it keeps, which vertices move, and the proof of their ends.

use crate::bounds::Bounds;
use crate::follower::{Contradiction, Follower};
use crate::half_space::HalfSpace;
use crate::proof::Combination;
use crate::vertex::{Found, Member, Problem, Vertex};

/// Vertices looked at and exchanges of one call at most, which cost about the same: a bound of its time. Ends that need
/// more go on at the next row.
const STEPS: usize = 32;
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
        self.region = self.bounds;
        if self.drifts {
            for x in &mut self.region {
                let more = AHEAD * x.width();
                *x = Bounds::new(x.lo - more, x.hi + more);
            }
        }
        self.measure();
        self.rows[..self.count].iter_mut().for_each(|row| row.derive(&self.region));
        self.vertices.iter_mut().flatten().for_each(|v| v.pending = true);
    }

    fn measure(&mut self) {
        for (w, x) in self.widths.iter_mut().zip(&self.bounds) {
            *w = x.width().max(1e-12 * x.lo.abs().max(x.hi.abs())).max(1e-200);
        }
    }

    /// Computes the distance of a half-space to the vertex that is closest to it, in units of the vertices' spread along it.
    fn appraise(&self, row: &mut HalfSpace<N>, now: f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (column, pair) in self.vertices.iter().enumerate() {
            for (vertex, upper) in pair.iter().zip([false, true]) {
                let at = row.at(&vertex.x);
                low = low.min(at);
                if at > high {
                    high = at;
                    row.nearest = (u8::try_from(column).unwrap_or(u8::MAX), upper);
                }
            }
        }
        row.value = (row.right(now) - high) / (high - low).max(1e-12 * row.size);
    }

    /// Keeps a half-space if it cuts a vertex, or may sooner than one that is kept.
    pub(crate) fn consider(&mut self, mut row: HalfSpace<N>) {
        let now = self.now.unwrap_or(0.0);
        self.appraise(&mut row, now);
        let Some(place) = self.place(&row) else { return };
        let limit = row.right(now) + CUT * row.size;
        for vertex in self.vertices.iter_mut().flatten() {
            vertex.pending |= row.at(&vertex.x) > limit;
        }
        self.rows[place] = row;
        self.count = self.count.max(place + 1);
    }

    /// The place of a row: a free one, or that of the row furthest from its vertex among those of the vertex that has most.
    fn place(&self, new: &HalfSpace<N>) -> Option<usize> {
        if self.count < ROWS {
            return Some(self.count);
        }
        let mut counts = [[0_u16; 2]; N];
        let at = |(column, upper): (u8, bool)| (usize::from(column).min(N - 1), usize::from(upper));
        for row in self.rows.iter().chain([new]) {
            let (column, side) = at(row.nearest);
            counts[column][side] += 1;
        }
        let most = counts.iter().flatten().copied().max()?;
        let own = {
            let (column, side) = at(new.nearest);
            counts[column][side]
        };
        let crowded = |row: &HalfSpace<N>| {
            let (column, side) = at(row.nearest);
            if own == most { row.nearest == new.nearest } else { counts[column][side] == most }
        };
        let mut found = None;
        let mut furthest = if own == most { new.value } else { f64::NEG_INFINITY };
        for (k, row) in self.rows.iter().enumerate() {
            if crowded(row) && row.value > furthest && !self.is_in_a_basis(k) {
                (found, furthest) = (Some(k), row.value);
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
        for _ in 0..REVALUED.min(self.count) {
            self.revalued = (self.revalued + 1) % self.count;
            let mut row = self.rows[self.revalued];
            self.appraise(&mut row, now);
            self.rows[self.revalued] = row;
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
        let narrowed = self.bounds.iter().zip(&self.region).any(|(x, r)| {
            let without_sign = !self.drifts && r.lo < 0.0 && r.hi > 0.0;
            let share = if without_sign { NARROWED_WITHOUT_SIGN } else { NARROWED };
            x.width() < share * r.width() || (without_sign && (x.lo >= 0.0 || x.hi <= 0.0))
        });
        if narrowed {
            self.make_half_spaces();
        }
    }

    fn move_vertex(&mut self, column: usize, upper: bool, now: f64, steps: &mut usize) {
        let problem =
            Problem { rows: &self.rows[..self.count], region: &self.bounds, widths: &self.widths, capacity: ROWS, now };
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
        let end = problem.end(column, upper);
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
fn combination<const N: usize>(
    problem: &Problem<'_, N>,
    objective: [f64; N],
    basis: &[Member; N],
    weights: &[f64; N],
    entering: Option<Member>,
) -> (Combination<N>, Members) {
    let mut sum = Combination::new(objective);
    let mut members = Members { oldest: f64::INFINITY, rows: 0 };
    let parts = basis.iter().copied().zip(weights.iter().copied()).chain(entering.map(|m| (m, 1.0)));
    for (member, weight) in parts {
        if usize::from(member) < problem.capacity && weight > 0.0 {
            let row = &problem.rows[usize::from(member)];
            sum.add(weight, &row.g, row.right(problem.now));
            members = Members { oldest: members.oldest.min(row.time), rows: members.rows + 1 };
        }
    }
    (sum, members)
}
