//! The vertex that attains each end: all of them are inverted in floats with bounds of their errors.

use super::Square;
use super::entries::{PADDED, Vertices};
use crate::lanes::{Vector, backends};
use crate::rounding::slices::Backend;

/// Vertex matrices `A_c - T_y Delta T_z` with `y_1 = 1`: `2^(2n-1)` of them.
pub(super) const VERTICES: usize = 32;
/// The unit roundoff of a double, 2^-53.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Approximate entries of all vertex inverses and bounds of their errors.
pub(super) struct All {
    pub value: [[f64; VERTICES]; 9],
    pub error: [[f64; VERTICES]; 9],
}

impl All {
    pub(super) const NONE: Self = Self { value: [[0.0; VERTICES]; 9], error: [[0.0; VERTICES]; 9] };
}

/// The vertex of each end. The value is `None` if more than one may attain it.
pub(super) fn find(backend: Backend, lo: &Square, hi: &Square, zero: &[bool; 9]) -> Option<Vertices> {
    let mut all = All::NONE;
    if !invert(backend, lo, hi, &mut all) {
        return None;
    }
    let mut found = Vertices { rows: [[0.0; PADDED]; 3], columns: [[0.0; PADDED]; 3] };
    for q in 0..9 {
        if zero[q] {
            continue;
        }
        let (value, error) = (&all.value[q], &all.error[q]);
        for (lane, mirror) in [(q, 1.0), (q + 9, -1.0)] {
            let mut reached = f64::INFINITY;
            for v in 0..VERTICES {
                reached = reached.min(mirror * value[v] + error[v]);
            }
            let mut candidates = (0..VERTICES).filter(|&v| mirror * value[v] - error[v] <= reached);
            let (first, None) = (candidates.next()?, candidates.next()) else { return None };
            for k in 0..3 {
                found.rows[k][lane] = -SIGNS.rows[(q + k) % 3][first];
                found.columns[k][lane] = SIGNS.columns[k][first];
            }
        }
    }
    Some(found)
}

/// `y` and `z` of each vertex.
pub(super) struct Signs {
    pub rows: [[f64; VERTICES]; 3],
    pub columns: [[f64; VERTICES]; 3],
}

pub(super) const SIGNS: Signs = {
    let mut signs = Signs { rows: [[1.0; VERTICES]; 3], columns: [[1.0; VERTICES]; 3] };
    let mut v = 0;
    while v < VERTICES {
        let mut k = 0;
        while k < 3 {
            // Bits 0 to 2 are z, bits 3 and 4 the second and the third entry of y.
            if v >> k & 1 == 1 {
                signs.columns[k][v] = -1.0;
            }
            if k > 0 && v >> (k + 2) & 1 == 1 {
                signs.rows[k][v] = -1.0;
            }
            k += 1;
        }
        v += 1;
    }
    signs
};

backends!(pub(super) fn invert(lo: &Square, hi: &Square, all: &mut All) -> bool = invert_lanes);

/// Cofactors are right within `2 u` of the magnitudes of their two products, the determinant within `6 u` of those of
/// its six. The bound takes twice that. The result is false if a determinant is not far from zero.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn invert_lanes<V: Vector>(lo: &Square, hi: &Square, all: &mut All) -> bool {
    let mut nearest = V::splat(f64::INFINITY);
    let mut start = 0;
    while start < VERTICES {
        let mut m = [V::splat(0.0); 9];
        for (at, entry) in m.iter_mut().enumerate() {
            let lowest = V::load(&SIGNS.rows[at / 3][start..]) * V::load(&SIGNS.columns[at % 3][start..]);
            *entry = lowest.choose(V::splat(lo[at]), V::splat(hi[at]));
        }
        let mut adjugate = [(V::splat(0.0), V::splat(0.0)); 9];
        for (entry, [a, e, b, d]) in adjugate.iter_mut().zip(MINORS) {
            let (p, q) = (m[a] * m[e], m[b] * m[d]);
            *entry = (p - q, p.abs() + q.abs());
        }
        let [c0, _, _, c3, _, _, c6, _, _] = adjugate;
        let det = m[0] * c0.0 + m[1] * c3.0 + m[2] * c6.0;
        let size = m[0].abs() * c0.1 + m[1].abs() * c3.1 + m[2].abs() * c6.1;
        let scale = V::splat(1.0) / det;
        let relative = V::splat(16.0 * UNIT) * size * scale.abs();
        for (at, (cofactor, own_size)) in adjugate.into_iter().enumerate() {
            let x = cofactor * scale;
            let error = V::splat(8.0 * UNIT) * own_size * scale.abs() + x.abs() * relative;
            x.store(&mut all.value[at][start..]);
            error.store(&mut all.error[at][start..]);
        }
        nearest = nearest.least(det.abs() * V::splat(1e9) - size);
        start += V::N;
    }
    nearest.array().as_ref().iter().all(|&x| x > 0.0)
}

/// Positions of `a e - b d` for the entries of the adjugate, row by row.
const MINORS: [[usize; 4]; 9] = [
    [4, 8, 5, 7],
    [2, 7, 1, 8],
    [1, 5, 2, 4],
    [5, 6, 3, 8],
    [0, 8, 2, 6],
    [2, 3, 0, 5],
    [3, 7, 4, 6],
    [1, 6, 0, 7],
    [0, 4, 1, 3],
];
