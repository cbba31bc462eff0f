//! Double-double arithmetic of vectors. Every lane does the operations of [`crate::elementary::Dd`], in their order, so
//! that the errors stated there are those of a lane here.

use super::fused::Fused;

/// `hi + lo`, with `hi` the double nearest to the sum.
#[derive(Clone, Copy)]
pub(super) struct Dd<L> {
    pub hi: L,
    pub lo: L,
}

#[inline(always)]
pub(super) fn fast_two_sum<L: Fused>(a: L, b: L) -> Dd<L> {
    let hi = a.add(b);
    Dd { hi, lo: b.sub(hi.sub(a)) }
}

#[inline(always)]
pub(super) fn two_sum<L: Fused>(a: L, b: L) -> Dd<L> {
    let hi = a.add(b);
    let b_part = hi.sub(a);
    let a_part = hi.sub(b_part);
    Dd { hi, lo: a.sub(a_part).add(b.sub(b_part)) }
}

#[inline(always)]
pub(super) fn two_product<L: Fused>(a: L, b: L) -> Dd<L> {
    let hi = a.mul(b);
    Dd { hi, lo: a.product_less(b, hi) }
}

impl<L: Fused> Dd<L> {
    #[inline(always)]
    pub fn splat(x: crate::elementary::Dd) -> Self {
        Self { hi: L::splat(x.hi), lo: L::splat(x.lo) }
    }

    /// Times a power of two.
    #[inline(always)]
    pub fn scale(self, power: f64) -> Self {
        let power = L::splat(power);
        Self { hi: self.hi.mul(power), lo: self.lo.mul(power) }
    }

    #[inline(always)]
    pub fn neg(self) -> Self {
        Self { hi: self.hi.neg(), lo: self.lo.neg() }
    }

    #[inline(always)]
    pub fn select(mask: L::Mask, yes: Self, no: Self) -> Self {
        Self { hi: L::select(mask, yes.hi, no.hi), lo: L::select(mask, yes.lo, no.lo) }
    }

    #[inline(always)]
    pub fn add_f64(self, b: L) -> Self {
        let s = two_sum(self.hi, b);
        fast_two_sum(s.hi, self.lo.add(s.lo))
    }

    #[inline(always)]
    pub fn mul_f64(self, b: L) -> Self {
        let p = two_product(self.hi, b);
        fast_two_sum(p.hi, self.lo.mul_add(b, p.lo))
    }

    #[inline(always)]
    pub fn add(self, b: Self) -> Self {
        let s = two_sum(self.hi, b.hi);
        let t = two_sum(self.lo, b.lo);
        let v = fast_two_sum(s.hi, s.lo.add(t.hi));
        fast_two_sum(v.hi, t.lo.add(v.lo))
    }

    #[inline(always)]
    pub fn mul(self, b: Self) -> Self {
        let p = two_product(self.hi, b.hi);
        let cross = self.hi.mul_add(b.lo, self.lo.mul(b.hi));
        fast_two_sum(p.hi, p.lo.add(cross))
    }

    #[inline(always)]
    pub fn square(self) -> Self {
        self.mul(self)
    }

    #[inline(always)]
    pub fn div(self, b: Self) -> Self {
        let q = self.hi.div(b.hi);
        let r = self.add(b.mul_f64(q).neg());
        fast_two_sum(q, r.hi.div(b.hi))
    }

    /// The largest double not above a normal number within `|v| error` of `v`, and the lanes where the error leaves no
    /// choice.
    #[inline(always)]
    pub fn down(self, error: f64) -> (L, L::Mask) {
        let margin = self.hi.abs().mul(L::splat(error));
        (self.hi.below_if(self.lo.less(margin.neg())), margin.less(self.lo.abs()))
    }

    /// The smallest double not below it, and the same lanes.
    #[inline(always)]
    pub fn up(self, error: f64) -> (L, L::Mask) {
        let margin = self.hi.abs().mul(L::splat(error));
        (self.hi.above_if(margin.less(self.lo)), margin.less(self.lo.abs()))
    }
}
