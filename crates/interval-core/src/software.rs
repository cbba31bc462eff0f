//! The operations of a processor or of a C library that `core` has not: square root, fused product and sum, and the
//! integers next to a number, in integers. Each gives the bits that the standard library gives.
//!
//! A build without the feature `std` calls them by the same names, so that the formulas of the crate are written once.

/// The methods of `f64` that need the standard library.
pub trait Real: Copy {
    /// The square root, rounded to nearest.
    #[must_use]
    fn sqrt(self) -> Self;
    /// `self * b + c`, rounded once to nearest.
    #[must_use]
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// The greatest integer not above the number.
    #[must_use]
    fn floor(self) -> Self;
    /// The least integer not below the number.
    #[must_use]
    fn ceil(self) -> Self;
    /// The number without its fraction.
    #[must_use]
    fn trunc(self) -> Self;
    /// The nearest integer, ties away from zero.
    #[must_use]
    fn round(self) -> Self;
    /// The nearest integer, ties to the even one.
    #[must_use]
    fn round_ties_even(self) -> Self;
    /// The number without its integer.
    #[must_use]
    fn fract(self) -> Self;
}

impl Real for f64 {
    fn sqrt(self) -> Self {
        if self == 0.0 || !(self > 0.0 && self < Self::INFINITY) {
            return if self < 0.0 { Self::NAN } else { self };
        }
        let (m, e) = parts(self);
        // An even exponent, and at least 108 bits, of which the root keeps 54 and more.
        let bits = 64 - m.leading_zeros();
        let up = 110 - bits + u32::from((e - i64::from(110 - bits)) % 2 != 0);
        let (square, exponent) = (u128::from(m) << up, e - i64::from(up));
        let root = square.isqrt();
        let rest = u128::from(root * root != square);
        rounded(false, (root << 1) | rest, exponent / 2 - 1)
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        if !(self.is_finite() && b.is_finite()) || self == 0.0 || b == 0.0 {
            return self * b + c;
        }
        if !c.is_finite() {
            return c;
        }
        if c == 0.0 {
            return self * b;
        }
        let ((ma, ea), (mb, eb), (mc, ec)) = (parts(self), parts(b), parts(c));
        let product = top(u128::from(ma) * u128::from(mb), ea + eb);
        let addend = top(u128::from(mc), ec);
        let of_product = self.is_sign_negative() != b.is_sign_negative();
        let of_sum = c.is_sign_negative();
        let ((large, exponent), (small, least), negative) = if (product.1, product.0) >= (addend.1, addend.0) {
            (product, addend, of_product)
        } else {
            (addend, product, of_sum)
        };
        let small = shifted_with_rest(small, exponent - least);
        let size = if of_product == of_sum { large + small } else { large - small };
        rounded(size != 0 && negative, size, exponent)
    }

    fn floor(self) -> Self {
        let whole = Real::trunc(self);
        if self < whole { whole - 1.0 } else { whole }
    }

    fn ceil(self) -> Self {
        let whole = Real::trunc(self);
        if self > whole { whole + 1.0 } else { whole }
    }

    fn trunc(self) -> Self {
        let bits = self.to_bits();
        let exponent = (bits >> 52) & 0x7ff;
        if exponent >= 1023 + 52 {
            self
        } else if exponent < 1023 {
            Self::from_bits(bits & (1 << 63))
        } else {
            Self::from_bits(bits & !((1 << (1023 + 52 - exponent)) - 1))
        }
    }

    fn round(self) -> Self {
        let whole = Real::trunc(self);
        if (self - whole).abs() >= 0.5 { whole + 1.0_f64.copysign(self) } else { whole }
    }

    fn round_ties_even(self) -> Self {
        let whole = Real::trunc(self);
        let rest = (self - whole).abs();
        let odd = Real::trunc(whole / 2.0) * 2.0 != whole;
        if rest > 0.5 || (rest == 0.5 && odd) { whole + 1.0_f64.copysign(self) } else { whole }
    }

    fn fract(self) -> Self {
        self - Real::trunc(self)
    }
}

/// The size of a finite double as an integer times a power of two.
fn parts(x: f64) -> (u64, i64) {
    let bits = x.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    match (bits >> 52) & 0x7ff {
        0 => (fraction, -1074),
        field => (fraction | (1 << 52), i64::try_from(field).unwrap_or(0) - 1075),
    }
}

/// The same number with its leading bit at place 125, which leaves room for a carry. The lowest 20 bits are zero.
fn top(m: u128, e: i64) -> (u128, i64) {
    let up = m.leading_zeros() - 2;
    (m << up, e - i64::from(up))
}

/// `m / 2^by`, whose last bit is set if anything was lost: which side of a tie the number lies on stays known.
fn shifted_with_rest(m: u128, by: i64) -> u128 {
    if by >= 128 {
        return u128::from(m != 0);
    }
    let whole = m >> by;
    whole | u128::from(whole << by != m)
}

/// `± m 2^e` rounded to nearest, ties to even. If the last bit stands for a rest, `m` has at least 55 bits.
fn rounded(negative: bool, m: u128, e: i64) -> f64 {
    let sign = u64::from(negative) << 63;
    if m == 0 {
        return f64::from_bits(sign);
    }
    let length = i64::from(128 - m.leading_zeros());
    // The exponent of the last bit that a double keeps at this size.
    let unit = (e + length - 53).max(-1074);
    let by = unit - e;
    let whole = if by <= 0 {
        m << -by
    } else if by > 127 {
        0
    } else {
        let (whole, rest) = (m >> by, m & ((1 << by) - 1));
        let half = 1 << (by - 1);
        whole + u128::from(rest > half || (rest == half && whole & 1 == 1))
    };
    // Field and fraction follow one another, so that the leading bit counts the exponent up.
    let field = u64::try_from(unit + 1074).unwrap_or(0) << 52;
    let bits = if unit > 971 { u64::MAX } else { field + u64::try_from(whole).unwrap_or(0) };
    f64::from_bits(sign | bits.min(0x7ff0_0000_0000_0000))
}
