//! A polytope of bounded size around the feasible set, and the proved ends of every parameter in it.

use crate::bounds::{Bounds, Refusal};
use crate::half_space::Side;
use crate::store::Store;
use crate::vertex::{Problem, Vertex};
use interval_core::rounding::{add_up, environment_is_default, mul_up, sub_down, sub_up};

/// The largest bound of a start: no product of two of them overflows.
pub const START_LIMIT: f64 = 1e100;
/// The proof that no parameters explain the rows: multipliers of these rows, or two ends that have passed one another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contradiction {
    /// Time of the row at which it was proved \[s\].
    pub time: f64,
    /// Time of the oldest row that the proof names \[s\]. Older rows stand in it by the bounds that they have proved.
    pub oldest: f64,
    /// Number of half-spaces that the proof names.
    pub rows: usize,
    /// The parameter whose ends have passed one another; `None` for a combination of rows.
    pub column: Option<usize>,
}

/// What is known after a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum State {
    /// Every consistent parameter lies within [`Follower::bounds`].
    Bounded,
    /// No parameters explain the rows, with a proof.
    Empty(Contradiction),
}

/// Bounds of `N` parameters from rows that come one by one, of which at most `ROWS` half-spaces are kept.
///
/// At every moment the bounds hold each parameter that all rows so far allow (and the start). They are proved at every
/// row, in directed rounding. Nothing is allocated, and a call takes a bounded number of steps.
#[derive(Debug, Clone)]
pub struct Follower<const N: usize, const ROWS: usize> {
    start: [Bounds; N],
    pub(crate) rates: [f64; N],
    pub(crate) drifts: bool,
    pub(crate) now: Option<f64>,
    pub(crate) bounds: [Bounds; N],
    pub(crate) widths: [f64; N],
    /// The rows that are kept; the box of their half-spaces holds `bounds`.
    pub(crate) rows: Store<N, ROWS>,
    /// The search for the lower and the upper end of each parameter.
    pub(crate) vertices: [[Vertex<N>; 2]; N],
    pub(crate) turn: usize,
    pub(crate) revalued: usize,
    pub(crate) contradiction: Option<Contradiction>,
}

impl<const N: usize, const ROWS: usize> Follower<N, ROWS> {
    /// A place for a follower, which [`Follower::start`] sets going: for a `static`, where no stack could hold it.
    pub const IDLE: Self = Self {
        start: [Bounds::ZERO; N],
        rates: [0.0; N],
        drifts: false,
        now: None,
        bounds: [Bounds::ZERO; N],
        widths: [1.0; N],
        rows: Store::NONE,
        vertices: [const { [Vertex::NONE, Vertex::NONE] }; N],
        turn: 0,
        revalued: 0,
        contradiction: None,
    };

    /// A follower of constant parameters that lie within `start`.
    ///
    /// # Errors
    /// As [`Follower::start`].
    pub fn new(start: [Bounds; N]) -> Result<Self, Refusal> {
        Self::drifting(start, [0.0; N])
    }

    /// A follower of parameters that lie within `start` at the first row, and move by at most `rates` \[1/s\].
    ///
    /// # Errors
    /// As [`Follower::start`].
    pub fn drifting(start: [Bounds; N], rates: [f64; N]) -> Result<Self, Refusal> {
        let mut follower = Self::IDLE;
        follower.start(start, rates)?;
        Ok(follower)
    }

    /// Forgets everything and begins within `start`, in place. With a rate above zero, rows have to hold at one instant.
    ///
    /// # Errors
    /// A start that is not finite and ordered, a rate below zero, and a processor that rounds otherwise than to nearest.
    pub fn start(&mut self, start: [Bounds; N], rates: [f64; N]) -> Result<(), Refusal> {
        if !environment_is_default() {
            return Err(Refusal::Environment);
        }
        if let Some(column) = start.iter().position(|x| !(x.is_good() && x.lo >= -START_LIMIT && x.hi <= START_LIMIT)) {
            return Err(Refusal::Start { column });
        }
        if let Some(column) = rates.iter().position(|r| !(*r >= 0.0 && *r <= START_LIMIT)) {
            return Err(Refusal::Rate { column });
        }
        (self.start, self.rates) = (start, rates);
        self.drifts = rates.iter().any(|r| *r > 0.0);
        self.restart();
        Ok(())
    }

    /// Forgets every row and begins again within the same start.
    pub fn restart(&mut self) {
        self.rows.clear();
        (self.now, self.turn, self.revalued, self.contradiction) = (None, 0, 0, None);
        self.bounds = self.start;
        self.make_half_spaces();
        let problem = Problem { rows: &self.rows, region: &self.bounds, widths: &self.widths, now: 0.0 };
        for (column, pair) in self.vertices.iter_mut().enumerate() {
            for (vertex, direction) in pair.iter_mut().zip([1.0, -1.0]) {
                vertex.start_at_corner::<ROWS>(column, direction);
                vertex.refresh(&problem, column, direction);
                vertex.pending = false;
            }
        }
    }

    /// The proved bounds of every parameter at the time of the last row. After [`State::Empty`] they mean nothing.
    #[must_use]
    pub const fn bounds(&self) -> &[Bounds; N] {
        &self.bounds
    }

    /// What is known so far.
    #[must_use]
    pub fn state(&self) -> State {
        self.contradiction.map_or(State::Bounded, State::Empty)
    }

    /// The number of half-spaces that are kept.
    #[must_use]
    pub const fn kept(&self) -> usize {
        self.rows.count
    }

    /// Takes the row `sum a_j x_j = y`, which holds at `time` \[s\] for some member of each interval.
    ///
    /// # Errors
    /// Bounds that are NaN or reversed, and a time before that of the last row.
    pub fn row(&mut self, time: f64, a: &[Bounds; N], y: Bounds) -> Result<State, Refusal> {
        self.check(time, a, y)?;
        self.advance(time)?;
        if self.contradiction.is_none() {
            for least in [false, true] {
                if let Some(side) = Side::of_row(a, y, least, time, &self.rates) {
                    self.consider(&side);
                }
            }
            self.work();
        }
        Ok(self.state())
    }

    /// Refuses what no row may be.
    pub(crate) fn check(&self, time: f64, a: &[Bounds; N], y: Bounds) -> Result<(), Refusal> {
        if let Some(entry) = a.iter().chain([&y]).position(|x| !x.is_good()) {
            return Err(Refusal::Row { entry });
        }
        if !(time.is_finite() && self.now.is_none_or(|last| time >= last)) {
            return Err(Refusal::Time);
        }
        if environment_is_default() { Ok(()) } else { Err(Refusal::Environment) }
    }

    /// Takes one sample: readings of the regressors and of the right-hand side, each within its accuracy of the truth.
    ///
    /// # Errors
    /// As [`Follower::row`].
    pub fn sample(
        &mut self,
        time: f64,
        readings: &[f64; N],
        accuracies: &[f64; N],
        right: f64,
        accuracy: f64,
    ) -> Result<State, Refusal> {
        let mut a = [Bounds::ZERO; N];
        for j in 0..N {
            a[j] = Bounds::reading(readings[j], accuracies[j]);
        }
        self.row(time, &a, Bounds::reading(right, accuracy))
    }

    /// Goes on to a time without a row: drifting parameters may have moved since.
    ///
    /// # Errors
    /// A time that is NaN, infinite, or before that of the last row.
    pub fn advance(&mut self, time: f64) -> Result<(), Refusal> {
        let last = self.now.unwrap_or(time);
        if !(time >= last && time.is_finite()) {
            return Err(Refusal::Time);
        }
        self.now = Some(time);
        if self.drifts && time > last {
            let step = sub_up(time, last);
            for (x, &rate) in self.bounds.iter_mut().zip(&self.rates) {
                let moved = mul_up(rate, step);
                *x = Bounds::new(sub_down(x.lo, moved), add_up(x.hi, moved));
            }
            if self.bounds.iter().zip(&self.rows.region).any(|(x, r)| x.lo < r.lo || x.hi > r.hi) {
                self.make_half_spaces();
            }
        }
        Ok(())
    }
}
