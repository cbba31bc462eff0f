//! Scalar operations rounded down and up, each the tightest double on its side.
//!
//! Source: Kashiwagi's emulation of directed rounding by error-free transformations, with two changes. The error of a
//! sum is taken by Dekker's fast two-sum on ordered operands, in which nothing but the sum itself can overflow. The
//! error of a product or quotient is taken by one fused multiply-add, whose sign is exact as long as its result cannot
//! underflow. Below `SAFE` the operands are scaled by powers of two first.
//!
//! Infinite operands give the limit; `inf - inf`, `0 * inf`, `0 / 0` and `inf / inf` give NaN and are the caller's to
//! avoid.

use crate::doubles::Neighbours as _;
#[cfg(not(feature = "std"))]
use crate::software::Real as _;

/// 2^-969: a product of this size or larger has an error term that is a multiple of 2^-1074, hence exact.
const SAFE: f64 = f64::from_bits((1023 - 969) << 52);
/// Factor of the root of an operand below 2^-969. [`TWO_200`] is that of the operand.
const TWO_100: f64 = f64::from_bits((1023 + 100) << 52);
/// Factor of an operand below 2^-969: the fused residual then keeps its sign.
const TWO_200: f64 = f64::from_bits((1023 + 200) << 52);
/// Factor of both operands of a product below 2^-969: the scaled product is a multiple of 2^-1074 and does not
/// overflow.
const TWO_537: f64 = f64::from_bits((1023 + 537) << 52);
/// Denominators below this are multiplied by [`TWO_200`] without overflow.
const TWO_800: f64 = f64::from_bits((1023 + 800) << 52);
/// Operands up to this size are split (Veltkamp) without overflow.
const TWO_970: f64 = f64::from_bits((1023 + 970) << 52);
/// A sum of two numbers below this size does not overflow.
const HALF_MAX: f64 = f64::MAX / 2.0;
/// The smallest positive double, 2^-1074.
const SMALLEST: f64 = f64::from_bits(1);

/// `a + b` rounded up.
#[must_use]
#[inline]
pub fn add_up(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if !sum.is_finite() {
        return saturate_up(sum, a, b);
    }
    let (large, small) = if a.abs() >= b.abs() { (a, b) } else { (b, a) };
    // |small| <= |large| and a finite sum: sum - large is exact (Dekker), so the error is too.
    if small - (sum - large) > 0.0 { sum.above() } else { sum }
}

/// `a + b` rounded down.
#[must_use]
#[inline]
pub fn add_down(a: f64, b: f64) -> f64 {
    -add_up(-a, -b)
}

/// `a - b` rounded up.
#[must_use]
#[inline]
pub fn sub_up(a: f64, b: f64) -> f64 {
    add_up(a, -b)
}

/// `a - b` rounded down.
#[must_use]
#[inline]
pub fn sub_down(a: f64, b: f64) -> f64 {
    -add_up(-a, b)
}

/// A number with the sign of `a * b - product` for the product rounded to nearest, at least `SAFE` in size.
///
/// Without a fused instruction a call of the library's function costs more than Dekker's product, which is as exact
/// where the splitting does not overflow.
#[inline]
fn product_error(a: f64, b: f64, product: f64) -> f64 {
    if cfg!(any(target_feature = "fma", target_arch = "aarch64")) || a.abs().max(b.abs()).max(product.abs()) > TWO_970 {
        return a.mul_add(b, -product);
    }
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    ((ah * bh - product) + ah * bl + al * bh) + al * bl
}

/// Veltkamp's splitting into halves of 26 bits.
#[inline]
fn halves(x: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * x;
    let high = scaled - (scaled - x);
    (high, x - high)
}

/// `a * b` rounded up.
#[must_use]
#[inline]
pub fn mul_up(a: f64, b: f64) -> f64 {
    let product = a * b;
    if !product.is_finite() {
        return saturate_up(product, a, b);
    }
    if a == 0.0 || b == 0.0 {
        return product;
    }
    let too_low = if product.abs() >= SAFE {
        product_error(a, b, product) > 0.0
    } else {
        // |ab| < 2^-969 and |a|, |b| >= 2^-1074 bound both operands by 2^105: scaling cannot overflow, and the scaled
        // product is a multiple of 2^-1074, so the fused error is exact.
        let (x, y) = (a * TWO_537, b * TWO_537);
        let scaled = x * y;
        let candidate = (product * TWO_537) * TWO_537;
        candidate < scaled || (candidate == scaled && x.mul_add(y, -scaled) > 0.0)
    };
    if too_low { product.above() } else { product }
}

/// `a * b` rounded down.
#[must_use]
#[inline]
pub fn mul_down(a: f64, b: f64) -> f64 {
    -mul_up(-a, b)
}

/// `a / b` rounded up, for `b != 0`.
#[must_use]
#[inline]
pub fn div_up(a: f64, b: f64) -> f64 {
    let (a, b) = if b < 0.0 { (-a, -b) } else { (a, b) };
    let quotient = a / b;
    if a == 0.0 || a.is_infinite() || b.is_infinite() {
        return quotient;
    }
    if !quotient.is_finite() {
        return saturate_up(quotient, a, b);
    }
    let (numerator, denominator) = if a.abs() >= SAFE {
        (a, b)
    } else if b < TWO_800 {
        (a * TWO_200, b * TWO_200)
    } else {
        // |a / b| < 2^-1769: far below the smallest double.
        return if a > 0.0 { SMALLEST } else { -0.0 };
    };
    // The sign of quotient * denominator - numerator, rounded once, is the sign of the exact difference.
    if quotient.mul_add(denominator, -numerator) < 0.0 { quotient.above() } else { quotient }
}

/// `a / b` rounded down, for `b != 0`.
#[must_use]
#[inline]
pub fn div_down(a: f64, b: f64) -> f64 {
    -div_up(-a, b)
}

/// The square root of `x >= 0` rounded up.
#[must_use]
#[inline]
pub fn sqrt_up(x: f64) -> f64 {
    let root = x.sqrt();
    if sqrt_residual(root, x) > 0.0 { root.above() } else { root }
}

/// The square root of `x >= 0` rounded down.
#[must_use]
#[inline]
pub fn sqrt_down(x: f64) -> f64 {
    let root = x.sqrt();
    if sqrt_residual(root, x) < 0.0 { root.below() } else { root }
}

/// A number with the sign of `x - root^2`; zero where there is no rounding.
#[inline]
fn sqrt_residual(root: f64, x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return 0.0;
    }
    if x >= SAFE {
        (-root).mul_add(root, x)
    } else {
        let root = root * TWO_100;
        (-root).mul_add(root, x * TWO_200)
    }
}

/// Rounding up of an overflow: from finite operands -inf becomes the lowest double, everything else stands.
#[cold]
fn saturate_up(result: f64, a: f64, b: f64) -> f64 {
    if result == f64::NEG_INFINITY && a.is_finite() && b.is_finite() { f64::MIN } else { result }
}

/// `a * b + c` rounded up once; infinite operands give the limit.
#[must_use]
#[inline]
pub fn fma_up(a: f64, b: f64, c: f64) -> f64 {
    let nearest = a.mul_add(b, c);
    if !nearest.is_finite() {
        return if c.is_finite() { saturate_up(nearest, a, b) } else { nearest };
    }
    let product = a * b;
    let moderate = product.abs().max(c.abs()).max(nearest.abs()) < HALF_MAX;
    let too_low = if moderate && (product.abs() >= SAFE || a == 0.0 || b == 0.0) {
        // a b = product + e exactly. The sum of product, c, -nearest and e is grown into an expansion whose parts do
        // not overlap (Shewchuk, Discrete Comput. Geom. 18 (1997) 305-363): the largest that is not zero has its sign.
        let e = a.mul_add(b, -product);
        let (h1, h0) = two_sum(product, c);
        let (q, h0) = two_sum(-nearest, h0);
        let (h2, h1) = two_sum(q, h1);
        let (q, g0) = two_sum(e, h0);
        let (q, g1) = two_sum(q, h1);
        let (g3, g2) = two_sum(q, h2);
        [g3, g2, g1, g0].into_iter().find(|&x| x != 0.0).is_some_and(|x| x > 0.0)
    } else {
        crate::accumulator::sign_of_fused(a, b, c, nearest) == core::cmp::Ordering::Greater
    };
    if too_low { nearest.above() } else { nearest }
}

/// `a * b + c` rounded down once.
#[must_use]
#[inline]
pub fn fma_down(a: f64, b: f64, c: f64) -> f64 {
    -fma_up(-a, b, -c)
}

/// The sum and its error, for sums that do not overflow.
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}
