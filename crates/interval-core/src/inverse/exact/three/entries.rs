//! Entries of vertex inverses in twice the working precision, one in each lane.

use super::Square;
use crate::lanes::{Vector, two_product, two_sum};

/// Nine lower ends and nine upper ones, and room for whole vectors.
pub(super) const PADDED: usize = 24;

/// The vertices of all lanes: entry `kl` of lane `q` is the upper bound where `rows[k][q] columns[l][q] > 0` and else
/// the lower one, `k` counted from the lane's own row `j` on.
pub(super) struct Vertices {
    pub rows: [[f64; PADDED]; 3],
    pub columns: [[f64; PADDED]; 3],
}

impl Vertices {
    /// Those at which entries with these signs attain their ends.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
    pub(super) fn of_signs(signs: &Square) -> Self {
        let mut found = Self { rows: [[0.0; PADDED]; 3], columns: [[0.0; PADDED]; 3] };
        for k in 0..3 {
            for q in 0..9 {
                let sign = signs[3 * (q / 3) + (q + k) % 3];
                found.rows[k][q] = sign;
                found.rows[k][q + 9] = -sign;
                let sign = signs[3 * k + q % 3];
                found.columns[k][q] = sign;
                found.columns[k][q + 9] = sign;
            }
        }
        found
    }
}

/// By lane the bits of a bound, and those of the bound if the error had the other sign: equal where it cannot matter.
/// Lane `q < 9` is the lower end of entry `q`, lane `9 + q` minus its upper end.
pub(super) struct Ends {
    pub bound: [u64; PADDED],
    pub other: [u64; PADDED],
}

impl Ends {
    pub(super) const NONE: Self = Self { bound: [0; PADDED], other: [0; PADDED] };
}

/// The double below where the error is negative, by its bits: entries are neither zero nor infinite where that counts.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn rounded_down(x: f64, error: f64) -> u64 {
    let step = if x > 0.0 { u64::MAX } else { 1 };
    x.to_bits().wrapping_add(if error < 0.0 { step } else { 0 })
}

/// 1 in the lanes of lower ends, -1 in those of upper ones.
const MIRROR: [f64; PADDED] = {
    let mut mirror = [1.0; PADDED];
    let mut q = 9;
    while q < PADDED {
        mirror[q] = -1.0;
        q += 1;
    }
    mirror
};

/// A value and its error term, and the sum of the magnitudes of the summands.
#[derive(Clone, Copy)]
struct Minor<V> {
    hi: V,
    lo: V,
    size: V,
}

/// `a e - b d` within `4 u^2 size`.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn minor<V: Vector>(a: V, e: V, b: V, d: V) -> Minor<V> {
    let (p, p_error) = two_product(a, e);
    let (q, q_error) = two_product(b, d);
    let (s, s_error) = two_sum(p, -q);
    let tail = s_error + (p_error - q_error);
    let hi = s + tail;
    Minor { hi, lo: tail - (hi - s), size: p.abs() + q.abs() }
}

/// `x c` as a product and its tail, within `4 u^2 |x| size`.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn scaled<V: Vector>(x: V, c: Minor<V>) -> (V, V) {
    let (p, p_error) = two_product(x, c.hi);
    (p, p_error + x * c.lo)
}

/// The enclosures of the entries, by lane.
///
/// Lane `q` is entry `ij` with `i = (q % 9) / 3`, `j = q % 3`; its matrix has row `j` first and the others behind it in
/// turn, an even permutation, so its determinant is expanded along row `j` and its own cofactor is one of the three
/// needed for that. Values that depend on `j` alone repeat with period 3. The result is false if a determinant is not
/// far from zero.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
pub(super) fn vertex_entries<V: Vector>(lo: &Square, hi: &Square, chosen: &Vertices, ends: &mut Ends) -> bool {
    let mut lower = [[0.0; PERIODIC]; 3];
    let mut upper = [[0.0; PERIODIC]; 3];
    for l in 0..3 {
        for t in 0..PERIODIC {
            lower[l][t] = lo[3 * (t % 3) + l];
            upper[l][t] = hi[3 * (t % 3) + l];
        }
    }
    let mut sums = [[0.0; PADDED]; 4];
    let mut nearest = V::splat(f64::INFINITY);
    let mut start = 0;
    while start < 18 {
        let mut m = [[V::splat(0.0); 3]; 3];
        for (k, row) in m.iter_mut().enumerate() {
            let (from, row_sign) = ((start + k) % 3, V::load(&chosen.rows[k][start..]));
            for (l, entry) in row.iter_mut().enumerate() {
                let falls = row_sign * V::load(&chosen.columns[l][start..]);
                *entry = falls.choose(V::load(&upper[l][from..]), V::load(&lower[l][from..]));
            }
        }
        let [[a, b, c], [d, e, f], [g, h, i]] = m;
        let (first, second, third) = (minor(e, i, f, h), minor(f, g, d, i), minor(d, h, e, g));
        let ((p0, t0), (p1, t1), (p2, t2)) = (scaled(a, first), scaled(b, second), scaled(c, third));
        let (s, s_error) = two_sum(p0, p1);
        let (s, last_error) = two_sum(s, p2);
        let tail = (s_error + last_error) + ((t0 + t1) + t2);
        let det = s + tail;
        let det_low = tail - (det - s);
        // The determinant is right within 64 u^2 of this.
        let size = a.abs() * first.size + b.abs() * second.size + c.abs() * third.size;
        let (is_first, is_second) = (V::load(&ROWS[0][start..]), V::load(&ROWS[1][start..]));
        let value = is_first.choose(first.hi, is_second.choose(second.hi, third.hi));
        let low = is_first.choose(first.lo, is_second.choose(second.lo, third.lo));
        let own_size = is_first.choose(first.size, is_second.choose(second.size, third.size));
        let q1 = value / det;
        let (p, p_error) = two_product(q1, det);
        let rest = (((value - p) - p_error) + low) - q1 * det_low;
        let q2 = rest / det;
        // 64 u^2 = 2^-100; four times that holds the rounding of the quotient and of this bound as well.
        let error = V::splat(f64::from_bits((1023 - 98) << 52)) * ((own_size + q1.abs() * size) / det.abs());
        let mirror = V::load(&MIRROR[start..]);
        let (q1, q2) = (q1 * mirror, q2 * mirror);
        let (low, low_error) = two_sum(q1, q2 - error);
        let (high, high_error) = two_sum(q1, q2 + error);
        low.store(&mut sums[0][start..]);
        low_error.store(&mut sums[1][start..]);
        high.store(&mut sums[2][start..]);
        high_error.store(&mut sums[3][start..]);
        // NaN, which the later operand passes on, is not far from zero.
        nearest = nearest.least(det.abs() * V::splat(1e12) - size);
        start += V::N;
    }
    for q in 0..PADDED {
        ends.bound[q] = rounded_down(sums[0][q], sums[1][q]);
        ends.other[q] = rounded_down(sums[2][q], sums[3][q]);
    }
    nearest.array().as_ref().iter().all(|&x| x > 0.0)
}

/// A period of 3 from any of its places on, for the widest vector.
const PERIODIC: usize = 10;

/// 1 in the lanes of row 0 and of row 1 of the inverse.
const ROWS: [[f64; PADDED]; 2] = {
    let mut rows = [[0.0; PADDED]; 2];
    let mut q = 0;
    while q < PADDED {
        let row = (q % 9) / 3;
        if row < 2 {
            rows[row][q] = 1.0;
        }
        q += 1;
    }
    rows
};
