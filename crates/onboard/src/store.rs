//! The rows that are kept, column by column, so that a product with all of them goes through memory in order.

use crate::bounds::Bounds;
use crate::half_space::{HalfSpace, Side, later, shares, slope};

/// At most `ROWS` sides of rows, and what their half-spaces over one box are.
#[derive(Debug, Clone)]
pub(crate) struct Store<const N: usize, const ROWS: usize> {
    pub(crate) count: usize,
    /// The box for which the half-spaces were made, and the shares of its slopes.
    pub(crate) region: [Bounds; N],
    shares: [f64; N],
    lower: [[f64; ROWS]; N],
    span: [[f32; ROWS]; N],
    right: [f64; ROWS],
    drift: [f64; ROWS],
    h: [f64; ROWS],
    size: [f64; ROWS],
    pub(crate) time: [f64; ROWS],
    /// The distance to the vertices, in units of their spread: small for rows that may cut soon.
    value: [f32; ROWS],
    /// The vertex to which each row is closest, by column and side.
    nearest: [u16; ROWS],
    /// The number of rows that are closest to each vertex.
    shared: [[u16; 2]; N],
}

impl<const N: usize, const ROWS: usize> Store<N, ROWS> {
    /// No rows.
    pub(crate) const NONE: Self = Self {
        count: 0,
        region: [Bounds::ZERO; N],
        shares: [0.0; N],
        lower: [[0.0; ROWS]; N],
        span: [[0.0; ROWS]; N],
        right: [0.0; ROWS],
        drift: [0.0; ROWS],
        h: [0.0; ROWS],
        size: [1.0; ROWS],
        time: [0.0; ROWS],
        value: [0.0; ROWS],
        nearest: [0; ROWS],
        shared: [[0; 2]; N],
    };

    fn side(&self, k: usize) -> Side<N> {
        let (mut lower, mut span) = ([0.0; N], [0.0; N]);
        for j in 0..N {
            (lower[j], span[j]) = (self.lower[j][k], self.span[j][k]);
        }
        Side { lower, span, right: self.right[k], time: self.time[k], drift: self.drift[k] }
    }

    /// Makes all half-spaces over a box.
    pub(crate) fn make(&mut self, region: &[Bounds; N]) {
        self.region = *region;
        self.shares = shares(region);
        for k in 0..self.count {
            let made = self.side(k).over(&self.region, &self.shares);
            (self.h[k], self.size[k]) = (made.h, made.size);
        }
    }

    /// The half-space of a row that is not kept yet.
    pub(crate) fn half_space_of(&self, side: &Side<N>) -> HalfSpace<N> {
        side.over(&self.region, &self.shares)
    }

    /// Half-space `k` at a time, whose right-hand side is rounded up.
    #[inline]
    pub(crate) fn half_space(&self, k: usize, now: f64) -> HalfSpace<N> {
        let mut g = [0.0; N];
        for j in 0..N {
            g[j] = slope(self.lower[j][k], self.span[j][k], self.shares[j]);
        }
        HalfSpace { g, h: later(self.h[k], self.drift[k], self.time[k], now), size: self.size[k] }
    }

    /// Forgets every row.
    pub(crate) fn clear(&mut self) {
        (self.count, self.shared) = (0, [[0; 2]; N]);
    }

    /// The number of rows that are closest to each vertex.
    pub(crate) fn shared(&self) -> &[u16] {
        self.shared.as_flattened()
    }

    /// Value and nearest vertex of every row.
    pub(crate) fn appraisals(&self) -> impl Iterator<Item = (f32, u16)> {
        self.value[..self.count].iter().copied().zip(self.nearest.iter().copied())
    }

    /// Gives a row another value and vertex.
    pub(crate) fn appraise(&mut self, k: usize, value: f32, nearest: u16) {
        let shared = self.shared.as_flattened_mut();
        shared[usize::from(self.nearest[k])] -= 1;
        shared[usize::from(nearest)] += 1;
        (self.value[k], self.nearest[k]) = (value, nearest);
    }

    /// Puts a side and its half-space at a place, the first free one or that of another row.
    pub(crate) fn put(&mut self, k: usize, side: &Side<N>, half_space: &HalfSpace<N>, value: f32, nearest: u16) {
        if k == self.count {
            self.count += 1;
            self.nearest[k] = nearest;
            self.shared.as_flattened_mut()[usize::from(nearest)] += 1;
        }
        self.appraise(k, value, nearest);
        for j in 0..N {
            (self.lower[j][k], self.span[j][k]) = (side.lower[j], side.span[j]);
        }
        (self.right[k], self.time[k], self.drift[k]) = (side.right, side.time, side.drift);
        (self.h[k], self.size[k]) = (half_space.h, half_space.size);
    }

    /// By how much each row is violated at a point, in plain floats.
    fn excesses(&self, x: &[f64; N], now: f64) -> [f64; ROWS] {
        let mut excess = [0.0; ROWS];
        let rows = &mut excess[..self.count];
        for (k, e) in rows.iter_mut().enumerate() {
            *e = -self.h[k];
            if self.drift[k] != 0.0 {
                *e -= self.drift[k] * (now - self.time[k]);
            }
        }
        for j in 0..N {
            let (x, y) = (x[j], x[j] * self.shares[j]);
            if self.shares[j] == 0.0 {
                for (e, p) in rows.iter_mut().zip(&self.lower[j]) {
                    *e += p * x;
                }
            } else {
                for ((e, p), d) in rows.iter_mut().zip(&self.lower[j]).zip(&self.span[j]) {
                    *e += p * x + f64::from(*d) * y;
                }
            }
        }
        excess
    }

    /// The row that the point violates most, in units of its size, of those above a share and not refused.
    pub(crate) fn most_violated(
        &self,
        x: &[f64; N],
        now: f64,
        above: f64,
        refused: impl Fn(usize) -> bool,
    ) -> Option<(usize, f64, f64)> {
        let excess = self.excesses(x, now);
        let (mut worst, mut found) = (above, None);
        for (k, (e, size)) in excess[..self.count].iter().zip(&self.size).enumerate() {
            if *e > worst * size && !refused(k) {
                (worst, found) = (e / size, Some((k, *e, e / size)));
            }
        }
        found
    }
}
