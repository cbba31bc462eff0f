//! The hull of the inverse for order 3, where the signs of all entries of the inverse are fixed: 18 entries of vertex inverses
//! in twice the working precision, all at once.
//!
//! Steps, each with its proof:
//! 1. `R` approximates the inverse of the midpoint, `G >= |I - R A|` for every member by an a-priori bound of the rounding
//!    errors; `||G|| <= beta < 1` proves every member regular.
//! 2. With `B = R + (I - R A) B`: `|B - R| <= G |R| + G^2 |R| + beta^3 / (1 - beta) max_i |R_ij|`. An entry larger than that keeps
//!    its sign; an entry whose cofactor is zero for every member is zero.
//! 3. An entry of the inverse falls while `a_kl` grows where `B_ik B_lj > 0`, so with fixed signs its extremes stand at two
//!    known vertices (METHODS 4.2 S). There the cofactor and the determinant are evaluated by error-free transformations; the
//!    quotient is rounded outward, and is the tightest bound where the error cannot change the rounding.

use crate::lanes::{Vector, backends, two_product, two_sum};
use crate::rounding::slices::Backend;

/// Bounds by row.
pub(super) type Square = [f64; 9];

/// Entries outside are left to the general method: between them nothing over- or underflows.
const SMALLEST: f64 = f64::from_bits((1023 - 200) << 52);
const LARGEST: f64 = f64::from_bits((1023 + 200) << 52);
const UNIT: f64 = f64::EPSILON / 2.0;

/// The tightest bounds of every entry of the inverse, and an approximate inverse `R` with `|I - R A| (1, 1, 1)' < (1, 1, 1)'`;
/// `None` where one of the steps does not decide.
pub(super) fn hull(lo: &Square, hi: &Square) -> Option<(Square, Square, Square)> {
    let (r, signs) = regular_with_signs(lo, hi)?;
    let mut bounds = Bounds { lower: [0.0; PADDED], upper: [0.0; PADDED], tight: true };
    vertices(Backend::chosen(), lo, hi, &signs, &mut bounds);
    if !bounds.tight {
        return None;
    }
    let (mut lower, mut upper) = ([0.0; 9], [0.0; 9]);
    for at in 0..9 {
        if signs[at] != 0.0 {
            (lower[at], upper[at]) = (bounds.lower[at], bounds.upper[at]);
        }
    }
    Some((lower, upper, r))
}

/// An approximate inverse that proves regularity, and the signs of all entries of every member's inverse.
fn regular_with_signs(lo: &Square, hi: &Square) -> Option<(Square, Square)> {
    let mut middle = [0.0; 9];
    let mut spread = [0.0; 9];
    for at in 0..9 {
        let (l, h) = (lo[at], hi[at]);
        let moderate = |x: f64| x == 0.0 || (x.abs() >= SMALLEST && x.abs() <= LARGEST);
        if !(moderate(l) && moderate(h) && l <= h) {
            return None;
        }
        let m = 0.5 * (l + h);
        middle[at] = m;
        // The radius, and what the rounding of a product with the midpoint may add.
        spread[at] = (h - m).max(m - l) * (1.0 + 4.0 * UNIT) + 6.0 * UNIT * m.abs();
    }
    let r = adjugate_over_determinant(&middle)?;
    let mut g = [0.0; 9];
    let mut beta = 0.0_f64;
    for i in 0..3 {
        for j in 0..3 {
            let delta = if i == j { 1.0 } else { 0.0 };
            let (x, y, z) = (r[3 * i], r[3 * i + 1], r[3 * i + 2]);
            let error = delta - (x * middle[j] + y * middle[3 + j] + z * middle[6 + j]);
            let reach = x.abs() * spread[j] + y.abs() * spread[3 + j] + z.abs() * spread[6 + j];
            g[3 * i + j] = (error.abs() + 6.0 * UNIT * delta + reach) * (1.0 + 16.0 * UNIT);
        }
        beta = beta.max((g[3 * i] + g[3 * i + 1] + g[3 * i + 2]) * (1.0 + 4.0 * UNIT));
    }
    if beta.is_nan() || beta >= 0.9 {
        return None;
    }
    let size = r.map(f64::abs);
    let first = product(&g, &size);
    let second = product(&g, &first);
    let tail = beta * beta * beta / (1.0 - beta) * (1.0 + 16.0 * UNIT);
    let mut signs = [0.0; 9];
    for i in 0..3 {
        for j in 0..3 {
            let at = 3 * i + j;
            if is_zero_cofactor(lo, hi, j, i) {
                continue;
            }
            let largest = size[j].max(size[3 + j]).max(size[6 + j]);
            let reach = (first[at] + second[at] + tail * largest) * (1.0 + 64.0 * UNIT);
            if size[at] <= reach {
                return None;
            }
            signs[at] = r[at].signum();
        }
    }
    Some((r, signs))
}

#[inline]
fn product(a: &Square, b: &Square) -> Square {
    let mut c = [0.0; 9];
    for i in 0..3 {
        for j in 0..3 {
            c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
        }
    }
    c
}

/// The inverse in plain floats.
fn adjugate_over_determinant(m: &Square) -> Option<Square> {
    let c = [
        m[4] * m[8] - m[5] * m[7],
        m[2] * m[7] - m[1] * m[8],
        m[1] * m[5] - m[2] * m[4],
        m[5] * m[6] - m[3] * m[8],
        m[0] * m[8] - m[2] * m[6],
        m[2] * m[3] - m[0] * m[5],
        m[3] * m[7] - m[4] * m[6],
        m[1] * m[6] - m[0] * m[7],
        m[0] * m[4] - m[1] * m[3],
    ];
    let reciprocal = 1.0 / (m[0] * c[0] + m[1] * c[3] + m[2] * c[6]);
    let r = c.map(|x| x * reciprocal);
    r.iter().all(|x| x.is_finite()).then_some(r)
}

/// Whether the cofactor of `a_kl` is zero for every member: each of its two products has a factor that is.
fn is_zero_cofactor(lo: &Square, hi: &Square, k: usize, l: usize) -> bool {
    let [p, q] = OTHERS[k];
    let [s, t] = OTHERS[l];
    let zero = |i: usize, j: usize| lo[3 * i + j] == 0.0 && hi[3 * i + j] == 0.0;
    (zero(p, s) || zero(q, t)) && (zero(p, t) || zero(q, s))
}

const OTHERS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];

/// Nine lower ends and nine upper ones, and room for whole vectors.
const PADDED: usize = 24;

struct Bounds {
    lower: [f64; PADDED],
    upper: [f64; PADDED],
    tight: bool,
}

backends!(fn vertices(lo: &Square, hi: &Square, signs: &Square, bounds: &mut Bounds) = vertex_entries);

/// A value and its error term, and the sum of the magnitudes of what was added.
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

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn vertex_entries<V: Vector>(lo: &Square, hi: &Square, signs: &Square, bounds: &mut Bounds) {
    let mut tight = true;
    // Lane q < 9 holds the vertex of the lower end of entry q, lane 9 + q that of the upper end.
    let mut row_signs = [[0.0; PADDED]; 3];
    let mut column_signs = [[0.0; PADDED]; 3];
    for i in 0..3 {
        for j in 0..3 {
            for k in 0..3 {
                let at = 3 * i + j;
                row_signs[k][at] = signs[3 * i + k];
                row_signs[k][at + 9] = -signs[3 * i + k];
                column_signs[k][at] = signs[3 * k + j];
                column_signs[k][at + 9] = signs[3 * k + j];
            }
        }
    }
    let mut start = 0;
    while start < 18 {
        let entry = |k: usize, l: usize| {
            let falls = V::load(&row_signs[k][start..]) * V::load(&column_signs[l][start..]);
            falls.choose(V::splat(hi[3 * k + l]), V::splat(lo[3 * k + l]))
        };
        let m: [V; 9] = std::array::from_fn(|at| entry(at / 3, at % 3));
        // The adjugate, row by row.
        let c = [
            minor(m[4], m[8], m[5], m[7]),
            minor(m[2], m[7], m[1], m[8]),
            minor(m[1], m[5], m[2], m[4]),
            minor(m[5], m[6], m[3], m[8]),
            minor(m[0], m[8], m[2], m[6]),
            minor(m[2], m[3], m[0], m[5]),
            minor(m[3], m[7], m[4], m[6]),
            minor(m[1], m[6], m[0], m[7]),
            minor(m[0], m[4], m[1], m[3]),
        ];
        let (p0, t0) = scaled(m[0], c[0]);
        let (p1, t1) = scaled(m[1], c[3]);
        let (p2, t2) = scaled(m[2], c[6]);
        let (s, e) = two_sum(p0, p1);
        let (s, e2) = two_sum(s, p2);
        let tail = (e + e2) + ((t0 + t1) + t2);
        let det = s + tail;
        let det_low = tail - (det - s);
        // The determinant is right within 64 u^2 of this.
        let size = m[0].abs() * c[0].size + m[1].abs() * c[3].size + m[2].abs() * c[6].size;
        // Each lane's own cofactor.
        let (mut all, mut all_low, mut all_size) = ([0.0; 72], [0.0; 72], [0.0; 72]);
        for (at, minor) in c.iter().enumerate() {
            minor.hi.store(&mut all[8 * at..]);
            minor.lo.store(&mut all_low[8 * at..]);
            minor.size.store(&mut all_size[8 * at..]);
        }
        let own_of = |from: &[f64; 72]| V::from_fn(|lane| from[8 * ((start + lane) % 9) + lane]);
        let (own, own_low, own_size) = (own_of(&all), own_of(&all_low), own_of(&all_size));
        let q1 = own / det;
        let (p, p_error) = two_product(q1, det);
        let rest = (((own - p) - p_error) + own_low) - q1 * det_low;
        let q2 = rest / det;
        // 64 u^2 = 2^-100; four times that holds the rounding of the quotient and of this bound as well.
        let error = V::splat(f64::from_bits((1023 - 98) << 52)) * ((own_size + q1.abs() * size) / det.abs());
        let (low, low_error) = two_sum(q1, q2 - error);
        let (high, high_error) = two_sum(q1, q2 + error);
        let (low, low_error, high, high_error) = (low.array(), low_error.array(), high.array(), high_error.array());
        let (low, low_error, high, high_error) = (low.as_ref(), low_error.as_ref(), high.as_ref(), high_error.as_ref());
        let (size, det) = (size.array(), det.array());
        for lane in 0..V::N {
            let q = start + lane;
            if q >= 18 || signs[q % 9] == 0.0 {
                continue;
            }
            // Both ends of the enclosure have to round to the same bound, and the determinant to be far from zero.
            let well = size.as_ref()[lane] < det.as_ref()[lane].abs() * 1e12;
            if q < 9 {
                let a = if low_error[lane] < 0.0 { low[lane].next_down() } else { low[lane] };
                let b = if high_error[lane] < 0.0 { high[lane].next_down() } else { high[lane] };
                tight &= well && a == b;
                bounds.lower[q] = a;
            } else {
                let a = if low_error[lane] > 0.0 { low[lane].next_up() } else { low[lane] };
                let b = if high_error[lane] > 0.0 { high[lane].next_up() } else { high[lane] };
                tight &= well && a == b;
                bounds.upper[q - 9] = b;
            }
        }
        start += V::N;
    }
    bounds.tight = tight;
}
