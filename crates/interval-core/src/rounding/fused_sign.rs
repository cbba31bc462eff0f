//! The sign of a fused product and sum in integers, for targets whose library has no fused operation.

/// -1, 0 or 1 with the sign of `a * b + c`, for finite operands.
pub(crate) fn fused_sign(a: f64, b: f64, c: f64) -> f64 {
    let ((ma, ea), (mb, eb), (mc, ec)) = (parts(a), parts(b), parts(c));
    let (product, exponent) = (u128::from(ma) * u128::from(mb), ea + eb);
    let sign = |negative: bool| if negative { -1.0 } else { 1.0 };
    let of_product = sign(a.is_sign_negative() != b.is_sign_negative());
    let of_sum = sign(c.is_sign_negative());
    if product == 0 || mc == 0 {
        return if product != 0 {
            of_product
        } else if mc != 0 {
            of_sum
        } else {
            0.0
        };
    }
    if of_product == of_sum {
        return of_sum;
    }
    let bits = |x: u128| 128 - x.leading_zeros().cast_signed();
    let (mc, tops) = (u128::from(mc), (exponent + bits(product), ec + bits(u128::from(mc))));
    if tops.0 != tops.1 {
        return if tops.0 > tops.1 { of_product } else { of_sum };
    }
    // The leading bits coincide, so that the shift to a common exponent ends at the longer of the two: 106 bits at most.
    let (p, s) = if exponent >= ec { (product << (exponent - ec), mc) } else { (product, mc << (ec - exponent)) };
    match p.cmp(&s) {
        core::cmp::Ordering::Greater => of_product,
        core::cmp::Ordering::Less => of_sum,
        core::cmp::Ordering::Equal => 0.0,
    }
}

/// The size of a double as an integer times a power of two.
fn parts(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let (field, fraction) = ((bits >> 52) & 0x7ff, bits & ((1 << 52) - 1));
    if field == 0 {
        (fraction, -1074)
    } else {
        (fraction | (1 << 52), i32::from(field.to_le_bytes()[0]) + 256 * i32::from(field.to_le_bytes()[1]) - 1075)
    }
}
