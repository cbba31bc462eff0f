//! Proof that parameters have changed: windows of time that no constant parameters explain together.
//!
//! Each window is followed from the start, by its own rows. If parameters were constant, they would lie in the bounds of
//! every window. Bounds of two windows that do not meet, or a window that contradicts what earlier windows prove, refute
//! that, as long as every row's bounds hold.

use crate::bounds::{Bounds, Refusal};
use crate::follower::{Contradiction, Follower, State};

/// A proof that no constant parameters explain all rows since the last change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Time of the row at which it was proved \[s\].
    pub time: f64,
    /// Begin of the window in which it was proved \[s\].
    pub window: f64,
    /// The parameter whose bounds do not meet those of earlier windows; `None` for rows that contradict one another.
    pub column: Option<usize>,
    /// Contradiction of the window's own rows, if they need no earlier window.
    pub contradiction: Option<Contradiction>,
}

/// A follower that begins anew every so often, and compares.
#[derive(Debug, Clone)]
pub struct Windows<const N: usize, const ROWS: usize> {
    follower: Follower<N, ROWS>,
    length: f64,
    begin: Option<f64>,
    /// What the windows since the last change prove together.
    earlier: [Bounds; N],
    start: [Bounds; N],
}

impl<const N: usize, const ROWS: usize> Windows<N, ROWS> {
    /// Windows of `length` \[s\] for parameters within `start`.
    ///
    /// # Errors
    /// As [`Follower::new`], and a length that is not positive.
    pub fn new(start: [Bounds; N], length: f64) -> Result<Self, Refusal> {
        if !(length > 0.0 && length.is_finite()) {
            return Err(Refusal::Window);
        }
        Ok(Self { follower: Follower::new(start)?, length, begin: None, earlier: start, start })
    }

    /// Bounds from the present window's rows alone.
    #[must_use]
    pub const fn bounds(&self) -> &[Bounds; N] {
        self.follower.bounds()
    }

    /// Bounds that constant parameters would have, from every window since the last change.
    #[must_use]
    pub fn together(&self) -> [Bounds; N] {
        let mut both = self.earlier;
        for (x, own) in both.iter_mut().zip(self.follower.bounds()) {
            *x = Bounds::new(x.lo.max(own.lo), x.hi.min(own.hi));
        }
        both
    }

    /// Takes a row; the value is the proof of a change, after which everything begins anew.
    ///
    /// # Errors
    /// As [`Follower::row`].
    pub fn row(&mut self, time: f64, a: &[Bounds; N], y: Bounds) -> Result<Option<Change>, Refusal> {
        self.follower.check(time, a, y)?;
        let mut begin = self.begin.unwrap_or(time);
        if time - begin >= self.length {
            self.earlier = self.together();
            self.follower.restart();
            begin = time;
        }
        let state = self.follower.row(time, a, y)?;
        self.begin = Some(begin);
        let contradiction = match state {
            State::Bounded => None,
            State::Empty(proof) => Some(proof),
        };
        let column = self.together().iter().position(|x| x.lo > x.hi);
        if contradiction.is_none() && column.is_none() {
            return Ok(None);
        }
        let column = if contradiction.is_some() { None } else { column };
        self.follower.restart();
        (self.begin, self.earlier) = (None, self.start);
        Ok(Some(Change { time, window: begin, column, contradiction }))
    }
}
