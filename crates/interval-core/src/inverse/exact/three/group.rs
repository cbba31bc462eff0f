//! Matrices side by side, one in each lane: most of a batch takes the steps of [`super`] this way, without a branch.
//!
//! A lane is solved where its matrix is regular by the norm of `G`, where the entries of its inverse keep their signs or
//! are zero for every member, and where no error could change a rounding. The others are left to the form for one matrix.
//! A solved hull is the tightest one, so its bits are those of every other form.

use super::contraction::{Contraction, product};
use super::entries::{Expanded, divided, rounded_down};
use super::{LARGEST, LARGEST_NORM, SMALLEST, UNIT};
use crate::lanes::{Vector, backends, two_sum};

/// The most lanes of a vector.
const LANES: usize = 8;
/// Nine lower and nine upper ends of each lane.
const ENDS: usize = 18 * LANES;
/// Rows and columns, so that three in turn follow each of the first three.
const TURNS: usize = 5;

backends!(
    /// Hulls of matrices that follow each other, row-major; `solved` tells for each whether its hull was written.
    pub(super) fn hulls_on(lo: &[f64], hi: &[f64], lower: &mut [f64], upper: &mut [f64], solved: &mut [bool]) = hulls_lanes
);

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn hulls_lanes<V: Vector>(lo: &[f64], hi: &[f64], lower: &mut [f64], upper: &mut [f64], solved: &mut [bool]) {
    let size = 9 * V::N;
    let (lower, upper) = (lower.chunks_exact_mut(size), upper.chunks_exact_mut(size));
    let (mut bounds, mut errors, mut bits) = ([0.0; ENDS], [0.0; ENDS], [0; ENDS]);
    let groups = lo.chunks_exact(size).zip(hi.chunks_exact(size)).zip(lower.zip(upper));
    for (((lo, hi), (lower, upper)), solved) in groups.zip(solved.chunks_exact_mut(V::N)) {
        let (lo, hi) = (transposed::<V>(lo), transposed::<V>(hi));
        let Some(known) = Proof::prove(&lo, &hi) else { continue };
        let clear = ends(&lo, &hi, &known, &mut bounds, &mut errors).array();
        for at in 0..18 * V::N {
            bits[at] = rounded_down(bounds[at], errors[at]);
        }
        for (lane, solved) in solved.iter_mut().enumerate() {
            if clear.as_ref()[lane] > 0.0 {
                *solved = true;
                for q in 0..9 {
                    lower[9 * lane + q] = f64::from_bits(bits[q * V::N + lane]);
                    upper[9 * lane + q] = -f64::from_bits(bits[(9 + q) * V::N + lane]);
                }
            }
        }
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn transposed<V: Vector>(entries: &[f64]) -> [V; 9] {
    // Loops here and below: closures of the library's functions on arrays are compiled without the instruction set.
    let mut found = [V::splat(0.0); 9];
    for (at, entry) in found.iter_mut().enumerate() {
        *entry = V::from_fn(|lane| entries[9 * lane + at]);
    }
    found
}

/// Rows and columns in turn.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn turning<V: Vector>(entries: &[V; 9]) -> [[V; TURNS]; TURNS] {
    let mut found = [[V::splat(0.0); TURNS]; TURNS];
    for k in 0..TURNS {
        for l in 0..TURNS {
            found[k][l] = entries[3 * (k % 3) + l % 3];
        }
    }
    found
}

/// The result of the first two steps.
struct Proof<V> {
    /// The signs of the inverse's entries.
    signs: [V; 9],
    /// Positive where regularity and all signs are proved.
    holds: V,
    /// Bounds of the magnitudes of the two products of each cofactor, zero where the cofactor is zero for every member.
    cofactors: [V; 9],
    /// A bound of the sum of the magnitudes of the determinant's six products.
    determinant: V,
}

impl<V: Vector> Proof<V> {
    /// The value is `None` where no lane is proved.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
    fn prove(lo: &[V; 9], hi: &[V; 9]) -> Option<Self> {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let mut magnitudes = [zero; 9];
        let (mut largest, mut smallest, mut order) = (zero, one, one);
        for at in 0..9 {
            let (l, h) = (lo[at], hi[at]);
            let (x, y) = (l.abs(), h.abs());
            magnitudes[at] = x.most(y);
            largest = largest.most(magnitudes[at]);
            smallest = smallest.least(x.choose(x, one)).least(y.choose(y, one));
            order = order.least(h - l);
        }
        let Contraction { r, g, sums } = Contraction::of(lo, hi);
        // NaN is lost above, but not in the sums below, and fails each of the comparisons.
        let mut proved = one;
        let mut demand = |positive: V| proved = positive.choose(proved, V::splat(-1.0));
        for sum in sums {
            demand(V::splat(LARGEST_NORM) - sum);
        }
        // Equality passes by the next double, and between bounds by a number below the distances of any such two.
        demand(V::splat(LARGEST * (1.0 + 2.0 * UNIT)) - largest);
        demand(smallest - V::splat(SMALLEST * (1.0 - UNIT)));
        demand(order + V::splat(SMALLEST * UNIT * UNIT));

        let beta = sums[0].most(sums[1]).most(sums[2]);
        let mut size = r;
        for x in &mut size {
            *x = x.abs();
        }
        let first = product(&g, &size);
        let second = product(&g, &first);
        let growth = V::splat(1.0 + 64.0 * UNIT);
        let tail = beta * beta * beta / (one - beta) * growth;
        let turned = turning(&magnitudes);
        let mut cofactors = [zero; 9];
        for k in 0..3 {
            for l in 0..3 {
                cofactors[3 * k + l] =
                    turned[k + 1][l + 1] * turned[k + 2][l + 2] + turned[k + 1][l + 2] * turned[k + 2][l + 1];
            }
        }
        let mut signs = [one; 9];
        for i in 0..3 {
            for j in 0..3 {
                let at = 3 * i + j;
                let largest = size[j].most(size[3 + j]).most(size[6 + j]);
                let clear = size[at] - (first[at] + second[at] + tail * largest) * growth;
                demand(cofactors[3 * j + i].choose(clear, one));
                signs[at] = r[at].choose(one, V::splat(-1.0));
            }
        }
        let determinant = magnitudes[0] * cofactors[0] + magnitudes[1] * cofactors[1] + magnitudes[2] * cofactors[2];
        let any = proved.array().as_ref().iter().any(|&x| x > 0.0);
        any.then_some(Self { signs, holds: proved, cofactors, determinant })
    }
}

/// The last two steps: by lane the lower ends, and the upper ones with the other sign, as doubles and the errors that
/// decide their rounding. The result is positive where all ends of a lane are decided.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn ends<V: Vector>(
    lo: &[V; 9],
    hi: &[V; 9],
    known: &Proof<V>,
    bounds: &mut [f64; ENDS],
    errors: &mut [f64; ENDS],
) -> V {
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    let (lo, hi, signs) = (turning(lo), turning(hi), turning(&known.signs));
    // Quotients come later, since one end's chain of operations is longer than what the processor looks ahead.
    let (mut cofactors, mut determinants) = ([(zero, zero); 18], [(zero, zero); 18]);
    let mut nearest = V::splat(f64::INFINITY);
    for i in 0..3 {
        for j in 0..3 {
            let (mut least, mut most) = ([[zero; 3]; 3], [[zero; 3]; 3]);
            for k in 0..3 {
                for l in 0..3 {
                    // The entry of the inverse falls while this one grows.
                    let falls = signs[i][j + k] * signs[i + l][j];
                    let (low, high) = (lo[j + k][i + l], hi[j + k][i + l]);
                    least[k][l] = falls.choose(high, low);
                    most[k][l] = falls.choose(low, high);
                }
            }
            // Rows and columns in turn are an even permutation, so that the first minor is the entry's own cofactor.
            for (vertex, at) in [(least, 3 * i + j), (most, 9 + 3 * i + j)] {
                let Expanded { minors: [own, _, _], determinant, tail } = Expanded::of(vertex);
                nearest = nearest.least(determinant.abs());
                cofactors[at] = (own.hi, own.lo);
                determinants[at] = (determinant, tail);
            }
        }
    }
    let far = nearest * V::splat(1e12) - known.determinant;
    let mut decided = far.choose(known.holds, V::splat(-1.0));
    for at in 0..18 {
        let (i, j) = ((at % 9) / 3, at % 3);
        let own_size = known.cofactors[3 * j + i];
        let [quotient, rest, error] = divided(cofactors[at], own_size, determinants[at], known.determinant);
        let (bound, tail) = two_sum(quotient, rest);
        // The bound is the double nearest to both, so with an error below the tail the end is on the tail's side of it,
        // and before the next double there.
        decided = own_size.choose(tail.abs() - error, one).choose(decided, V::splat(-1.0));
        let bound = own_size.choose(bound, zero);
        let (bound, tail) = if at < 9 { (bound, tail) } else { (-bound, -tail) };
        bound.store(&mut bounds[at * V::N..]);
        tail.store(&mut errors[at * V::N..]);
    }
    decided
}
