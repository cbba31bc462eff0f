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
pub(super) fn rounded_down(x: f64, error: f64) -> u64 {
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
pub(super) struct Minor<V> {
    pub hi: V,
    pub lo: V,
    pub size: V,
}

/// `a e - b d` within `4 u^2 size`: the rounding errors of `p_error - q_error` and of `lo`, below `u^2 size` and
/// `2.1 u^2 size`. `lo` is at most `2.1 u size`; after a cancellation it may be larger than `hi`.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn minor<V: Vector>(a: V, e: V, b: V, d: V) -> Minor<V> {
    let (p, p_error) = two_product(a, e);
    let (q, q_error) = two_product(b, d);
    let (hi, error) = two_sum(p, -q);
    Minor { hi, lo: error + (p_error - q_error), size: p.abs() + q.abs() }
}

/// `x c` as a product and its tail, at most `3.2 u |x| size`, within `10 u^2 |x| size`.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn scaled<V: Vector>(x: V, c: &Minor<V>) -> (V, V) {
    let (p, p_error) = two_product(x, c.hi);
    (p, p_error + x * c.lo)
}

/// The minors of the first row of a matrix and its determinant.
pub(super) struct Expanded<V> {
    pub minors: [Minor<V>; 3],
    /// The determinant and its error term, within `25 u^2` of the sum of the magnitudes of its six products: `10 u^2` of
    /// the products with minors, and the roundings of sums of tails below `2 u`, `3.3 u`, `3.3 u` and `5.4 u` of that sum.
    /// The error term is exact where the determinant exceeds `12 u` of it.
    pub determinant: V,
    pub tail: V,
}

impl<V: Vector> Expanded<V> {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
    pub(super) fn of([[a, b, c], [d, e, f], [g, h, i]]: [[V; 3]; 3]) -> Self {
        let minors = [minor(e, i, f, h), minor(f, g, d, i), minor(d, h, e, g)];
        let ((p0, t0), (p1, t1), (p2, t2)) = (scaled(a, &minors[0]), scaled(b, &minors[1]), scaled(c, &minors[2]));
        let (s, s_error) = two_sum(p0, p1);
        let (s, last_error) = two_sum(s, p2);
        let tail = (s_error + last_error) + ((t0 + t1) + t2);
        let determinant = s + tail;
        Self { minors, determinant, tail: tail - (determinant - s) }
    }
}

/// The cofactor `hi + lo` over the determinant, `own_size` and `size` the magnitudes of their products: an approximation,
/// its error term, and a bound of the distance of both from the quotient. `size` is at most 1e12 determinants.
///
/// Against the exact quotient the error term misses at most `23 u^2 own_size / det` by the four roundings of `rest`,
/// `26 u^2 own_size / det` by those of the reciprocal and of its product (`|rest| <= 8.3 u own_size`), and
/// `(4 u^2 own_size + 25 u^2 q size) / det` by the errors of the cofactor and of the determinant. The bound takes 256 u^2
/// for the largest sum, 54 u^2, so that it holds its own roundings as well.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
pub(super) fn divided<V: Vector>((hi, lo): (V, V), own_size: V, (determinant, tail): (V, V), size: V) -> [V; 3] {
    let reciprocal = V::splat(1.0) / determinant;
    let quotient = hi * reciprocal;
    // hi - p is exact, since the quotient is right within 3 u.
    let (p, p_error) = two_product(quotient, determinant);
    let rest = (((hi - p) - p_error) + lo) - quotient * tail;
    let error = V::splat(f64::from_bits((1023 - 98) << 52)) * ((own_size + quotient.abs() * size) * reciprocal.abs());
    [quotient, rest * reciprocal, error]
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
        let [[a, b, c], _, _] = m;
        let Expanded { minors: [first, second, third], determinant, tail } = Expanded::of(m);
        let size = a.abs() * first.size + b.abs() * second.size + c.abs() * third.size;
        let (is_first, is_second) = (V::load(&ROWS[0][start..]), V::load(&ROWS[1][start..]));
        let own = |of: fn(&Minor<V>) -> V| is_first.choose(of(&first), is_second.choose(of(&second), of(&third)));
        let (value, own_size) = ((own(|m| m.hi), own(|m| m.lo)), own(|m| m.size));
        let [q1, q2, error] = divided(value, own_size, (determinant, tail), size);
        let mirror = V::load(&MIRROR[start..]);
        let (q1, q2) = (q1 * mirror, q2 * mirror);
        let (low, low_error) = two_sum(q1, q2 - error);
        let (high, high_error) = two_sum(q1, q2 + error);
        low.store(&mut sums[0][start..]);
        low_error.store(&mut sums[1][start..]);
        high.store(&mut sums[2][start..]);
        high_error.store(&mut sums[3][start..]);
        // Entries are below 2^150 in size: no determinant is NaN.
        nearest = nearest.least(determinant.abs() * V::splat(1e12) - size);
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
