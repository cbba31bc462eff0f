//! The hull of the inverse for order 3: 18 entries of vertex inverses in twice the working precision, all at once.
//!
//! Steps, each with its proof:
//! 1. `R` approximates the inverse of the midpoint, `G >= |I - R A|` for every member by an a-priori bound of the
//!    rounding errors. The norm `||G|| <= beta < 1` proves every member regular.
//! 2. With `B = R + (I - R A) B`: `|B - R| <= G |R| + G^2 |R| + beta^3 / (1 - beta) max_i |R_ij|`. An entry larger than
//!    that keeps its sign; an entry whose cofactor is zero for every member is zero.
//! 3. An entry of the inverse falls while `a_kl` grows where `B_ik B_lj > 0`, so with fixed signs its extremes stand at
//!    two known vertices (docs/theory.md, "Inverses", fixed signs). Otherwise all 32 vertices are inverted in floats
//!    with bounds of their errors, and an end is known where one vertex alone can attain it
//!    (docs/theory.md, "Inverses", all vertices). Where several may, the least of their bounds is the end's ([`ties`]).
//! 4. At these vertices the cofactor and the determinant are evaluated by error-free transformations. The quotient is
//!    rounded outward, and is the tightest bound where the error cannot change the rounding. Elsewhere the end is a double
//!    or close to one: the sign of `cofactor - bound determinant`, without error, tells on which side it lies ([`residual`]).

mod contraction;
mod entries;
mod extremes;
mod group;
mod residual;
mod ties;

use crate::lanes::{One, Vector, backends};
use crate::rounding::slices::Backend;
use contraction::{Contraction, product};
use entries::{Ends, Vertices, vertex_entries};

/// Bounds by row.
pub(super) type Square = [f64; 9];

/// 2^-150: entries below it in size are left to the general method, so that nothing underflows here: bounds of errors are
/// at least 2^-98 2^-300 / 2^453.
const SMALLEST: f64 = f64::from_bits((1023 - 150) << 52);
/// 2^150: entries above it in size are left to the general method, so that nothing overflows here.
const LARGEST: f64 = f64::from_bits((1023 + 150) << 52);
/// The largest norm of `G` that is taken: near 1 the bounds that follow from it say nothing.
const LARGEST_NORM: f64 = 0.9;
/// The unit roundoff of a double, 2^-53.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Lower and upper bounds, and `R`.
type Hull = (Square, Square, Square);

/// The tightest bounds of every entry of the inverse, and an approximate inverse `R` with
/// `|I - R A| (1, 1, 1)' < (1, 1, 1)'`. The value is `None` if one of the steps does not decide.
pub(super) fn hull(lo: &Square, hi: &Square) -> Option<Hull> {
    // Ties are looked for only after the first try, whose code knows nothing of them: they cost ordinary matrices no time.
    let found = hull_on(Backend::chosen(), lo, hi);
    if found.is_some() { found } else { ties::hull(lo, hi) }
}

/// The hulls of matrices that follow each other, row-major, where those of several are found side by side: `solved` tells
/// for each whether its hull was written.
pub(super) fn hulls(lo: &[f64], hi: &[f64], lower: &mut [f64], upper: &mut [f64], solved: &mut [bool]) {
    group::hulls_on(Backend::chosen(), lo, hi, lower, upper, solved);
}

backends!(fn hull_on(lo: &Square, hi: &Square) -> Option<Hull> = hull_lanes);

/// All steps, compiled for one back end: the first two cost as much as the last, and gain from its registers.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn hull_lanes<V: Vector>(lo: &Square, hi: &Square) -> Option<Hull> {
    let proved = Regular::prove(lo, hi)?;
    let chosen = match proved.signs {
        Some(signs) => Vertices::of_signs(&signs),
        None => extremes::find(Backend::chosen(), lo, hi, &proved.zero)?,
    };
    let mut ends = Ends::NONE;
    if !vertex_entries::<V>(lo, hi, &chosen, &mut ends) {
        return None;
    }
    let (mut lower, mut upper) = ([0.0; 9], [0.0; 9]);
    let mut tight = true;
    for at in 0..9 {
        let zero = proved.zero[at];
        tight &= zero || (ends.bound[at] == ends.other[at] && ends.bound[9 + at] == ends.other[9 + at]);
        lower[at] = if zero { 0.0 } else { f64::from_bits(ends.bound[at]) };
        upper[at] = if zero { 0.0 } else { -f64::from_bits(ends.bound[9 + at]) };
    }
    tight.then_some((lower, upper, proved.r))
}

/// The result of the first two steps.
struct Regular {
    r: Square,
    /// Entries that are zero for every member.
    zero: [bool; 9],
    /// The signs of all entries of every member's inverse, 0 for those, where all of them are fixed.
    signs: Option<Square>,
}

impl Regular {
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
    fn prove(lo: &Square, hi: &Square) -> Option<Self> {
        let mut moderate = true;
        for at in 0..9 {
            let (l, h) = (lo[at], hi[at]);
            let (x, y) = (l.abs(), h.abs());
            moderate &= x <= LARGEST && y <= LARGEST && l <= h;
            moderate &= (x >= SMALLEST || l == 0.0) && (y >= SMALLEST || h == 0.0);
        }
        if !moderate {
            return None;
        }
        let Contraction { r, g, sums } = Contraction::of(&lo.map(One), &hi.map(One));
        // Each sum by itself: NaN must not hide behind a larger one.
        if !sums.iter().all(|sum| sum.0 < LARGEST_NORM) {
            return None;
        }
        let beta = sums.iter().fold(0.0, |most: f64, sum| most.max(sum.0));
        let size = r.map(Vector::abs);
        let first = product(&g, &size);
        let growth = 1.0 + 64.0 * UNIT;
        // G^2 |R| is at most beta^2 max |R| by columns, and entry by entry where that does not do.
        let mut second = None;
        let (quick, tail) = (beta * beta / (1.0 - beta) * growth, beta * beta * beta / (1.0 - beta) * growth);
        let (mut signs, mut zero, mut fixed) = ([0.0; 9], [false; 9], true);
        for i in 0..3 {
            for j in 0..3 {
                let at = 3 * i + j;
                zero[at] = is_zero_cofactor(lo, hi, j, i);
                if zero[at] {
                    continue;
                }
                let largest = size[j].0.max(size[3 + j].0).max(size[6 + j].0);
                // Comparisons that NaN fails: it must not pass for a sign.
                let clear = size[at].0 > (first[at].0 + quick * largest) * growth;
                if !clear {
                    let second = second.get_or_insert_with(|| product(&g, &first));
                    fixed &= size[at].0 > (first[at].0 + second[at].0 + tail * largest) * growth;
                }
                signs[at] = r[at].0.signum();
            }
        }
        Some(Self { r: r.map(|x| x.0), zero, signs: fixed.then_some(signs) })
    }
}

/// True if the cofactor of `a_kl` is zero for every member: each of its two products has a factor that is.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn is_zero_cofactor(lo: &Square, hi: &Square, k: usize, l: usize) -> bool {
    let [p, q] = OTHERS[k];
    let [s, t] = OTHERS[l];
    let zero = |i: usize, j: usize| lo[3 * i + j] == 0.0 && hi[3 * i + j] == 0.0;
    (zero(p, s) || zero(q, t)) && (zero(p, t) || zero(q, s))
}

/// The other two indices beside each of 0, 1 and 2: the rows or columns of a minor.
const OTHERS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];
