//! The extremes of the sweep at fewer members. Every entry of `(A_c + tau Delta)^-1` is a rational function of `tau`,
//! so over the members `tau = j / N` its extremes stand at the ends and beside stationary points.
//!
//! About a centre `c` with `B = (A_c + c Delta)^-1` and `E = B Delta` the inverse is `sum_k (-s E)^k B`, `s = tau - c`.
//! On segments where `|s| ||E|| <= 1/4` thirty terms reach the last bit. There each entry's derivative is bounded away
//! from zero, or the piece is halved, down to pieces with a few members, which are all candidates. The best candidates
//! of every entry are then inverted as in the sweep, so that the result has the bits of members of the sweep. The work
//! does not depend on `N` but for the logarithmic halving.

use super::{Extremes, Form, Members};
use crate::approximate;
use crate::regularity::split;
use std::collections::BTreeSet;

/// Terms of the series: `4^-30` is below the unit roundoff.
const TERMS: usize = 30;
/// Members that are inverted directly: so few cost less than a further cut.
const FEW: u64 = 24;

/// Extremes over both sets; `None` at a singular member.
pub(super) fn find(members: &Members<'_>, form: Form) -> Option<Extremes> {
    let n = members.a.rows();
    let search = Search::new(members);
    let mut found = Extremes::none(n * n);
    for side in [-1.0, 1.0] {
        let mut wanted = BTreeSet::new();
        search.side(side, &mut wanted);
        let mut sorted: Vec<u64> = wanted.into_iter().collect();
        sorted.dedup();
        for run in sorted.chunk_by(|a, b| a + 1 == *b) {
            found = found.merge(&members.extremes(form, run[0]..run[run.len() - 1] + 1)?);
        }
    }
    Some(found)
}

struct Search {
    n: usize,
    partitions: u64,
    middle: Vec<f64>,
    spread: Vec<f64>,
}

/// The best candidate so far of one entry: its value by the series, and the member.
type Best = Option<(f64, u64)>;

impl Search {
    fn new(members: &Members<'_>) -> Self {
        let (middle, spread) = split(members.a);
        Self { n: members.a.rows(), partitions: members.partitions, middle, spread }
    }

    #[expect(clippy::cast_precision_loss, reason = "partitions stay below 2^53")]
    fn tau(&self, j: u64) -> f64 {
        j as f64 / self.partitions as f64
    }

    /// Members of one set, `tau = side j / N`, that may be extreme for some entry.
    fn side(&self, side: f64, wanted: &mut BTreeSet<u64>) {
        let mut open = vec![(1, self.partitions)];
        let mut best: Vec<[Best; 2]> = vec![[None; 2]; self.n * self.n];
        wanted.extend([1, self.partitions]);
        while let Some((first, last)) = open.pop() {
            if last - first < FEW {
                wanted.extend(first..=last);
            } else if !self.segment(side, first, last, &mut best) {
                let middle = first.midpoint(last);
                open.extend([(first, middle), (middle, last)]);
            }
        }
        // The neighbours as well: the series and the sweep round differently.
        let last = self.partitions;
        wanted
            .extend(best.iter().flatten().flatten().flat_map(|&(_, j)| j.saturating_sub(1).max(1)..=(j + 1).min(last)));
    }

    /// Looks for extremes between two members; false where the series does not converge fast enough.
    fn segment(&self, side: f64, first: u64, last: u64, best: &mut [[Best; 2]]) -> bool {
        let n = self.n;
        let (from, to) = (self.tau(first), self.tau(last));
        let (centre, half) = (side * 0.5 * (from + to), 0.5 * (to - from));
        let member: Vec<f64> = self.middle.iter().zip(&self.spread).map(|(m, r)| m + centre * r).collect();
        let Some(b) = approximate::inverse(&member, n) else { return false };
        // Powers of -h E, so that the series runs over [-1, 1].
        let factor: Vec<f64> = approximate::product(&b, &self.spread, n, n, n).into_iter().map(|x| -half * x).collect();
        let norm = factor.chunks_exact(n).map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
        if norm.is_nan() || norm > 0.25 {
            return false;
        }
        let mut terms = vec![b];
        while terms.len() < TERMS {
            terms.push(approximate::product(&factor, &terms[terms.len() - 1], n, n, n));
        }
        for (at, best) in best.iter_mut().enumerate() {
            let series: [f64; TERMS] = std::array::from_fn(|k| terms[k][at]);
            self.pieces(&Piece { side, centre, half, series }, first, last, best);
        }
        true
    }

    /// Follows one entry over a segment: pieces on which its derivative keeps its sign end in candidates.
    fn pieces(&self, piece: &Piece, first: u64, last: u64, best: &mut [Best; 2]) {
        let mut note = |j: u64| {
            let x = piece.value(self.tau(j));
            if best[0].is_none_or(|(least, _)| x < least) {
                best[0] = Some((x, j));
            }
            if best[1].is_none_or(|(most, _)| x > most) {
                best[1] = Some((x, j));
            }
        };
        let curvature: f64 = piece.series.iter().zip(WEIGHTS).map(|(c, (_, second))| second * c.abs()).sum();
        let mut open = vec![(first, last)];
        while let Some((a, b)) = open.pop() {
            let (x, y) = (piece.local(self.tau(a)), piece.local(self.tau(b)));
            let (middle, reach) = (0.5 * (x + y), 0.5 * (x - y).abs());
            if b - a <= 3 {
                (a..=b).for_each(&mut note);
            } else if piece.slope(middle).abs() > curvature * reach {
                note(a);
                note(b);
            } else {
                let cut = a.midpoint(b);
                open.extend([(a, cut), (cut, b)]);
            }
        }
    }
}

/// The factors of the first and of the second derivative.
const WEIGHTS: [(f64, f64); TERMS] = weights();

#[expect(clippy::cast_precision_loss, reason = "small integers")]
const fn weights() -> [(f64, f64); TERMS] {
    let mut weights = [(0.0, 0.0); TERMS];
    let mut k = 1;
    while k < TERMS {
        weights[k] = (k as f64, (k * (k - 1)) as f64);
        k += 1;
    }
    weights
}

/// One entry over one segment, as a series in `[-1, 1]`.
struct Piece {
    side: f64,
    centre: f64,
    half: f64,
    series: [f64; TERMS],
}

impl Piece {
    fn local(&self, tau: f64) -> f64 {
        (self.side * tau - self.centre) / self.half
    }

    fn value(&self, tau: f64) -> f64 {
        let x = self.local(tau);
        self.series.iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    fn slope(&self, x: f64) -> f64 {
        self.series.iter().zip(WEIGHTS).skip(1).rev().fold(0.0, |sum, (c, (first, _))| sum * x + first * c)
    }
}
