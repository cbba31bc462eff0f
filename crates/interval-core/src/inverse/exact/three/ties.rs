//! Ends that more than one vertex may attain: the least of the tight bounds of all that may.

use super::entries::{Ends, PADDED, Vertices, vertex_entries};
use super::extremes::{All, SIGNS, VERTICES, invert};
use super::residual::settle;
use super::{Hull, Regular, Square};
use crate::lanes::{Vector, backends};
use crate::rounding::slices::Backend;

/// The rivals of each end, at least one: vertices that may attain it, without those that differ only in entries on which
/// it does not depend.
struct Rivals {
    vertices: [[usize; VERTICES]; 18],
    count: [usize; 18],
}

impl Rivals {
    fn find(lo: &Square, hi: &Square, zero: &[bool; 9]) -> Option<Self> {
        let mut all = All::NONE;
        if !invert(Backend::chosen(), lo, hi, &mut all) {
            return None;
        }
        let mut found = Self { vertices: [[0; VERTICES]; 18], count: [1; 18] };
        let wide = wide(lo, hi);
        for lane in (0..18).filter(|lane| !zero[lane % 9]) {
            let (q, mirror) = (lane % 9, if lane < 9 { 1.0 } else { -1.0 });
            let (value, error) = (&all.value[q], &all.error[q]);
            let reached = (0..VERTICES).map(|v| mirror * value[v] + error[v]).fold(f64::INFINITY, f64::min);
            let counts = wide & relevant(q, zero);
            let mut kinds = [0; VERTICES];
            let mut count = 0;
            for v in (0..VERTICES).filter(|&v| mirror * value[v] - error[v] <= reached) {
                let kind = raised(v) & counts;
                if !kinds[..count].contains(&kind) {
                    kinds[count] = kind;
                    found.vertices[lane][count] = v;
                    count += 1;
                }
            }
            found.count[lane] = count.max(1);
        }
        Some(found)
    }

    fn rounds(&self) -> usize {
        self.count.into_iter().max().unwrap_or(1)
    }

    /// One rival of each end in turn; the last of those that are fewer stays.
    fn chosen(&self, round: usize) -> Vertices {
        let mut chosen = Vertices { rows: [[0.0; PADDED]; 3], columns: [[0.0; PADDED]; 3] };
        for lane in 0..18 {
            let v = self.vertices[lane][round.min(self.count[lane] - 1)];
            for k in 0..3 {
                chosen.rows[k][lane] = -SIGNS.rows[(lane + k) % 3][v];
                chosen.columns[k][lane] = SIGNS.columns[k][v];
            }
        }
        chosen
    }
}

/// Entries with two different ends, by bit.
fn wide(lo: &Square, hi: &Square) -> u16 {
    (0..9).filter(|&at| lo[at] < hi[at]).fold(0, |mask, at| mask | 1 << at)
}

/// Entries `kl` of the matrix on which entry `ij` of the inverse `B` depends, by bit: its derivative is `-B_ik B_lj`.
fn relevant(q: usize, zero: &[bool; 9]) -> u16 {
    let (i, j) = (q / 3, q % 3);
    (0..9).filter(|at| !zero[3 * i + at / 3] && !zero[3 * (at % 3) + j]).fold(0, |mask, at| mask | 1 << at)
}

/// Entries that a vertex takes from above, by bit.
fn raised(v: usize) -> u16 {
    (0..9).filter(|at| SIGNS.rows[at / 3][v] * SIGNS.columns[at % 3][v] < 0.0).fold(0, |mask, at| mask | 1 << at)
}

/// The hull where an end is a double, or where more than one vertex may attain it.
#[cold]
#[inline(never)]
pub(super) fn hull(lo: &Square, hi: &Square) -> Option<Hull> {
    hull_on(Backend::chosen(), lo, hi)
}

backends!(fn hull_on(lo: &Square, hi: &Square) -> Option<Hull> = hull_lanes);

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn hull_lanes<V: Vector>(lo: &Square, hi: &Square) -> Option<Hull> {
    let Regular { r, zero, signs } = Regular::prove(lo, hi)?;
    let mut least = [f64::INFINITY; PADDED];
    let rivals = match signs {
        Some(_) => None,
        None => Some(Rivals::find(lo, hi, &zero)?),
    };
    for round in 0..rivals.as_ref().map_or(1, Rivals::rounds) {
        let chosen = match (&rivals, &signs) {
            (None, Some(signs)) => Vertices::of_signs(signs),
            (rivals, _) => rivals.as_ref()?.chosen(round),
        };
        let mut ends = Ends::NONE;
        if !vertex_entries::<V>(lo, hi, &chosen, &mut ends) || !settle(lo, hi, &chosen, &zero, &mut ends) {
            return None;
        }
        for (x, bits) in least.iter_mut().zip(ends.bound) {
            *x = x.min(f64::from_bits(bits));
        }
    }
    // Lanes from 9 on hold ends with the other sign, and no zero is negative.
    let end = |at: usize, x: f64| if zero[at] { 0.0 } else { x };
    let (lower, upper) =
        (std::array::from_fn(|at| end(at, least[at])), std::array::from_fn(|at| end(at, 0.0 - least[9 + at])));
    Some((lower, upper, r))
}
