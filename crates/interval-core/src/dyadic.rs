//! Doubles as integers times powers of two, and back with a stated rounding.

#[cfg(feature = "alloc")]
use crate::integers::Integer;

/// `x * 2^shift`, rounded down where `shift` is negative.
#[cfg(feature = "alloc")]
pub(crate) fn shifted(x: &Integer, shift: i64) -> Integer {
    let by = shift.unsigned_abs();
    if shift >= 0 { x << by } else { x >> by }
}

/// The largest double not above `m * 2^exp`.
#[cfg(feature = "alloc")]
pub(crate) fn dyadic_down(m: &Integer, exp: i64) -> f64 {
    if m.is_zero() {
        return 0.0;
    }
    let length = i64::try_from(m.bits()).unwrap_or(i64::MAX);
    let top = length + exp;
    if top > 1024 {
        return if m.is_positive() { f64::MAX } else { f64::NEG_INFINITY };
    }
    if top < -1074 {
        return if m.is_positive() { 0.0 } else { -f64::from_bits(1) };
    }
    // Position of the last bit that a double keeps at this size.
    let unit = (top - 53).max(-1074);
    let mantissa = shifted(m, exp - unit);
    let Some(integer) = mantissa.magnitude() else { return f64::NEG_INFINITY };
    // At most 2^53: exact; the two factors keep the scaling exact in the subnormal range.
    let value = compose(integer, unit);
    if mantissa.is_negative() { -value } else { value }
}

/// `m * 2^unit` for `m <= 2^53` and a result that is a double, or infinite.
#[cfg(feature = "alloc")]
fn compose(m: u64, unit: i64) -> f64 {
    if m == 0 {
        return 0.0;
    }
    if m == 1 << 53 {
        return compose(1 << 52, unit + 1);
    }
    let shift = u64::from(m.leading_zeros()) - 11;
    let (normal, exponent) = (m << shift, unit - i64::try_from(shift).unwrap_or(0));
    let biased = exponent + 1075;
    if biased >= 2047 {
        f64::INFINITY
    } else if biased >= 1 {
        let field = u64::try_from(biased).unwrap_or(0);
        f64::from_bits((field << 52) | (normal & ((1 << 52) - 1)))
    } else {
        f64::from_bits(normal >> (1 - biased).unsigned_abs())
    }
}

/// Mantissa and exponent with `x = m * 2^e`, trailing zeros removed.
pub(crate) fn decode(x: f64) -> (i64, i64) {
    let bits = x.to_bits();
    let biased = i64::try_from((bits >> 52) & 0x7ff).unwrap_or(0);
    let fraction = i64::try_from(bits & 0x000f_ffff_ffff_ffff).unwrap_or(0);
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | (1 << 52), biased - 1075) };
    if mantissa == 0 {
        return (0, 0);
    }
    let shift = mantissa.trailing_zeros();
    let magnitude = mantissa >> shift;
    (if x < 0.0 { -magnitude } else { magnitude }, exponent + i64::from(shift))
}
