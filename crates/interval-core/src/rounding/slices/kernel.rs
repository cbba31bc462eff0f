//! The operations by error-free transformations, written once over vectors of any width.
//!
//! Each returns both bounds and whether all lanes are exact to the last bit. If that is false, the block is redone by
//! the scalar operators. `lower` and `upper` results are found by rounding to nearest and stepping to the neighbour
//! where the exact error says so, as in [`super::super::scalar`].

/// A vector of doubles. `Mask` holds one truth value a lane.
pub(super) trait Lanes: Copy {
    type Mask: Copy;
    /// Number of lanes.
    const N: usize;

    /// The first `N` numbers of the slice, which has at least `N`.
    fn load(from: &[f64]) -> Self;
    fn store(self, to: &mut [f64]);
    fn splat(x: f64) -> Self;
    fn add(self, b: Self) -> Self;
    fn sub(self, b: Self) -> Self;
    fn mul(self, b: Self) -> Self;
    fn div(self, b: Self) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn neg(self) -> Self;
    /// The smaller; `b` where one is NaN.
    fn min(self, b: Self) -> Self;
    /// The larger; `b` where one is NaN.
    fn max(self, b: Self) -> Self;
    /// A number with the sign of `self * b - c`, exactly the difference where it is a double, for `c` near the product
    /// and a product of at least 2^-969; NaN where that is not certain.
    fn product_less(self, b: Self, c: Self) -> Self;
    fn less(self, b: Self) -> Self::Mask;
    fn less_equal(self, b: Self) -> Self::Mask;
    fn equal(self, b: Self) -> Self::Mask;
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn all(mask: Self::Mask) -> bool;
    /// The double above (below) where the mask holds; no lane is zero there.
    fn above_if(self, mask: Self::Mask) -> Self;
    fn below_if(self, mask: Self::Mask) -> Self;
}

/// 2^-969 and 2^1022: between them a product's error is a double.
const SAFE: f64 = f64::from_bits((1023 - 969) << 52);
/// 2^1022, the upper end of that range: sums of two such numbers do not overflow.
const LARGE: f64 = f64::from_bits((1023 + 1022) << 52);
/// The smallest normal number.
const NORMAL: f64 = f64::MIN_POSITIVE;

/// Both bounds, and whether every lane is right.
pub(super) type Outcome<L> = (L, L, bool);

/// -0 becomes +0.
#[inline(always)]
fn plain_zero<L: Lanes>(x: L) -> L {
    x.add(L::splat(0.0))
}

/// `a + b` and its error (Knuth), exact as long as the sum stays below 2^1022.
#[inline(always)]
fn two_sum<L: Lanes>(a: L, b: L) -> (L, L) {
    let s = a.add(b);
    let b_part = s.sub(a);
    (s, a.sub(s.sub(b_part)).add(b.sub(b_part)))
}

#[inline(always)]
pub(super) fn add<L: Lanes>(a: L, b: L, c: L, d: L) -> Outcome<L> {
    let zero = L::splat(0.0);
    let (lo, lo_error) = two_sum(a, c);
    let (hi, hi_error) = two_sum(b, d);
    let sound = lo.abs().max(hi.abs()).less(L::splat(LARGE));
    // NaN fails every comparison; the maximum keeps only the second operand's, so both bounds are looked at.
    let ordered = lo.less_equal(hi);
    let lo = lo.below_if(lo_error.less(zero));
    let hi = hi.above_if(zero.less(hi_error));
    (plain_zero(lo), plain_zero(hi), L::all(L::both(sound, ordered)))
}

#[inline(always)]
pub(super) fn sub<L: Lanes>(a: L, b: L, c: L, d: L) -> Outcome<L> {
    add(a, b, d.neg(), c.neg())
}

/// The error that decides: that of the selected product, of the lower (`least`) or upper one where both are equal.
#[inline(always)]
fn deciding<L: Lanes>(p: (L, L), q: (L, L), least: bool) -> L {
    let tie = if least { p.1.min(q.1) } else { p.1.max(q.1) };
    let (first, second) = if least { (p.0.less(q.0), q.0.less(p.0)) } else { (q.0.less(p.0), p.0.less(q.0)) };
    L::select(first, p.1, L::select(second, q.1, tie))
}

/// True if each lane is a product whose error is a double: moderate, or zero because a factor is.
#[inline(always)]
fn safe<L: Lanes>(product: L, x: L, y: L) -> L::Mask {
    let zero = L::splat(0.0);
    let moderate = L::both(L::splat(SAFE).less_equal(product.abs()), product.abs().less(L::splat(LARGE)));
    L::either(moderate, L::both(product.equal(zero), L::either(x.equal(zero), y.equal(zero))))
}

/// The least product of a member of `[a, b]` and one of `[c, d]` is at an end of both, and at `a` it is with `c` where
/// `a >= 0` and with `d` elsewhere: two products a bound.
#[inline(always)]
pub(super) fn mul<L: Lanes>(a: L, b: L, c: L, d: L) -> Outcome<L> {
    let zero = L::splat(0.0);
    let (a_negative, b_negative) = (a.less(zero), b.less(zero));
    let (ya, yb) = (L::select(a_negative, d, c), L::select(b_negative, d, c));
    let (za, zb) = (L::select(a_negative, c, d), L::select(b_negative, c, d));
    let (pa, pb, qa, qb) = (a.mul(ya), b.mul(yb), a.mul(za), b.mul(zb));
    let (lo, hi) = (pa.min(pb), qa.max(qb));
    // The error of p is x y - p: positive where p is too small.
    let lo_error = deciding((pa, a.product_less(ya, pa)), (pb, b.product_less(yb, pb)), true);
    let hi_error = deciding((qa, a.product_less(za, qa)), (qb, b.product_less(zb, qb)), false);
    let (size_lo, size_hi) = (lo.abs(), hi.abs());
    let moderate = L::both(
        L::both(L::splat(SAFE).less_equal(size_lo), size_lo.less(L::splat(LARGE))),
        L::both(L::splat(SAFE).less_equal(size_hi), size_hi.less(L::splat(LARGE))),
    );
    let known = L::both(lo_error.equal(lo_error), hi_error.equal(hi_error));
    let sound = L::all(L::both(moderate, known))
        || L::all(L::both(
            known,
            L::both(L::both(safe(pa, a, ya), safe(pb, b, yb)), L::both(safe(qa, a, za), safe(qb, b, zb))),
        ));
    let lo = lo.below_if(lo_error.less(zero));
    let hi = hi.above_if(zero.less(hi_error));
    (plain_zero(lo), plain_zero(hi), sound)
}

/// A quotient by `y > 0` with the sign of `q y - x`, and whether that is right.
#[inline(always)]
fn quotient<L: Lanes>(x: L, y: L) -> (L, L, L::Mask) {
    let zero = L::splat(0.0);
    let q = x.div(y);
    let residual = q.product_less(y, x);
    let (size, numerator) = (q.abs(), x.abs());
    // Twice 2^-969, so that the rounded product of q and y is above it too.
    let moderate = L::both(
        L::both(L::splat(NORMAL).less_equal(size), size.less(L::splat(LARGE))),
        L::both(L::splat(2.0 * SAFE).less_equal(numerator), numerator.less(L::splat(LARGE))),
    );
    let known = residual.equal(residual);
    let exact = L::both(x.equal(zero), y.less(L::splat(f64::INFINITY)));
    (q, residual, L::both(known, L::either(moderate, exact)))
}

/// Divisors without zero; a negative one is turned with its dividend.
#[inline(always)]
pub(super) fn div<L: Lanes>(a: L, b: L, c: L, d: L) -> Outcome<L> {
    let zero = L::splat(0.0);
    let turn = d.less(zero);
    let (a, b) = (L::select(turn, b.neg(), a), L::select(turn, a.neg(), b));
    let (c, d) = (L::select(turn, d.neg(), c), L::select(turn, c.neg(), d));
    let (lo, lo_residual, lo_sound) = quotient(a, L::select(a.less(zero), c, d));
    let (hi, hi_residual, hi_sound) = quotient(b, L::select(b.less(zero), d, c));
    let sound = L::both(L::both(lo_sound, hi_sound), L::both(zero.less(c), a.less_equal(b)));
    let lo = lo.below_if(zero.less(lo_residual));
    let hi = hi.above_if(hi_residual.less(zero));
    (plain_zero(lo), plain_zero(hi), L::all(L::both(sound, c.less_equal(d))))
}

/// `[m^2, M^2]` of the smallest and largest magnitude.
#[inline(always)]
pub(super) fn square<L: Lanes>(a: L, b: L) -> Outcome<L> {
    let zero = L::splat(0.0);
    let small = a.max(b.neg()).max(zero);
    let large = a.neg().max(b);
    let (lo, hi) = (small.mul(small), large.mul(large));
    let (lo_error, hi_error) = (small.product_less(small, lo), large.product_less(large, hi));
    let known = L::both(lo_error.equal(lo_error), hi_error.equal(hi_error));
    let sound = L::both(L::both(safe(lo, small, small), safe(hi, large, large)), L::both(known, a.less_equal(b)));
    let lo = lo.below_if(lo_error.less(zero));
    let hi = hi.above_if(zero.less(hi_error));
    (plain_zero(lo), plain_zero(hi), L::all(sound))
}

/// The square root with the sign of its square less `x`, and whether that is right.
#[inline(always)]
fn root<L: Lanes>(x: L) -> (L, L, L::Mask) {
    let r = x.sqrt();
    let moderate = L::both(L::splat(2.0 * SAFE).less_equal(x), x.less(L::splat(LARGE)));
    (r, r.product_less(r, x), L::either(moderate, x.equal(L::splat(0.0))))
}

/// Roots of intervals that hold a number that is not negative.
#[inline(always)]
pub(super) fn sqrt<L: Lanes>(a: L, b: L) -> Outcome<L> {
    let zero = L::splat(0.0);
    let a = a.max(zero);
    let (lo, lo_excess, lo_sound) = root(a);
    let (hi, hi_excess, hi_sound) = root(b);
    let known = L::both(lo_excess.equal(lo_excess), hi_excess.equal(hi_excess));
    let sound = L::both(L::both(lo_sound, hi_sound), L::both(known, a.less_equal(b)));
    let lo = lo.below_if(zero.less(lo_excess));
    let hi = hi.above_if(hi_excess.less(zero));
    (plain_zero(lo), plain_zero(hi), L::all(sound))
}

#[inline(always)]
pub(super) fn neg<L: Lanes>(a: L, b: L) -> Outcome<L> {
    (plain_zero(b.neg()), plain_zero(a.neg()), true)
}

/// Exact; of the empty interval the infinities stay where they are.
#[inline(always)]
pub(super) fn abs<L: Lanes>(a: L, b: L) -> Outcome<L> {
    (plain_zero(a.max(b.neg()).max(L::splat(0.0))), plain_zero(a.neg().max(b)), true)
}

/// `(lo, hi)` where the mask holds, elsewhere the empty interval.
#[inline(always)]
fn or_empty<L: Lanes>(mask: L::Mask, lo: L, hi: L) -> Outcome<L> {
    let empty = L::splat(f64::INFINITY);
    (plain_zero(L::select(mask, lo, empty)), plain_zero(L::select(mask, hi, empty.neg())), true)
}

#[inline(always)]
pub(super) fn min<L: Lanes>(a: L, b: L, c: L, d: L) -> Outcome<L> {
    or_empty(L::both(a.less_equal(b), c.less_equal(d)), a.min(c), b.min(d))
}

#[inline(always)]
pub(super) fn max<L: Lanes>(a: L, b: L, c: L, d: L) -> Outcome<L> {
    or_empty(L::both(a.less_equal(b), c.less_equal(d)), a.max(c), b.max(d))
}

#[inline(always)]
pub(super) fn hull<L: Lanes>(a: L, b: L, c: L, d: L) -> Outcome<L> {
    (plain_zero(a.min(c)), plain_zero(b.max(d)), true)
}

#[inline(always)]
pub(super) fn intersection<L: Lanes>(a: L, b: L, c: L, d: L) -> Outcome<L> {
    let (lo, hi) = (a.max(c), b.min(d));
    or_empty(lo.less_equal(hi), lo, hi)
}
