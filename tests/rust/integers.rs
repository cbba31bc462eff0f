//! The crate's own integers against those of num-bigint: every operation, on digits that carry, borrow and cancel.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

extern crate alloc;

#[allow(dead_code, unreachable_pub, reason = "the module is compiled as it stands in the crate")]
#[path = "../../crates/interval-core/src/integers/mod.rs"]
mod integers;

use integers::Integer;
use num_bigint::{BigInt, Sign};
use proptest::collection::vec;
use proptest::prelude::*;

fn big(x: &Integer) -> BigInt {
    let bytes: Vec<u8> = x.digits().iter().flat_map(|d| d.to_le_bytes()).collect();
    BigInt::from_bytes_le(if x.is_negative() { Sign::Minus } else { Sign::Plus }, &bytes)
}

/// Halves of digits that are 0 or all ones half of the time, where carries run through.
fn integer() -> impl Strategy<Value = Integer> {
    let half = prop_oneof![Just(0_u32), Just(u32::MAX), Just(1), Just(1 << 31), any::<u32>(), any::<u32>()];
    (any::<bool>(), vec(half, 0..24)).prop_map(|(negative, halves)| Integer::from_halves(negative, &halves))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn sums_products_and_quotients(a in integer(), b in integer()) {
        let (x, y) = (big(&a), big(&b));
        prop_assert_eq!(big(&(&a + &b)), &x + &y);
        prop_assert_eq!(big(&(&a - &b)), &x - &y);
        prop_assert_eq!(big(&(&a * &b)), &x * &y);
        prop_assert_eq!(a.cmp(&b), x.cmp(&y));
        prop_assert_eq!(a.compare_magnitude(&b), x.magnitude().cmp(y.magnitude()));
        if !b.is_zero() {
            prop_assert_eq!(big(&a.quotient(&b)), &x / &y);
            // A multiple, and one less: the trial digits are right to the last one.
            let whole = &a * &b;
            let less = &whole - &Integer::from(1_u64);
            prop_assert_eq!(big(&whole.quotient(&b)), x.clone());
            prop_assert_eq!(big(&less.quotient(&b)), (&x * &y - 1) / &y);
        }
    }

    #[test]
    fn shifts_bits_and_text(a in integer(), by in 0_u64..300) {
        let x = big(&a);
        prop_assert_eq!(big(&(&a << by)), &x << by);
        prop_assert_eq!(big(&(&a >> by)), &x >> by);
        prop_assert_eq!(a.bits(), x.bits());
        prop_assert_eq!(a.trailing_zeros(), x.trailing_zeros());
        prop_assert_eq!(a.to_string(), x.to_string());
        let text = a.abs().to_string();
        prop_assert_eq!(Integer::parse(&text, 10), Some(a.abs()));
        prop_assert_eq!(Integer::parse(&format!("{:x}", x.magnitude()), 16), Some(a.abs()));
        prop_assert_eq!(a.to_i64(), i64::try_from(&x).ok());
        prop_assert_eq!(a.magnitude(), u64::try_from(x.magnitude()).ok());
        prop_assert_eq!(big(&-&a), -x);
    }

    #[test]
    fn small_divisors_roots_and_powers(a in integer(), divisor in 1_u64.., n in 0_u32..6) {
        let x = big(&a);
        prop_assert_eq!(big(&a.divided(divisor)), &x / divisor);
        prop_assert_eq!(BigInt::from(a.modulo(divisor)), ((&x % divisor) + divisor) % divisor);
        prop_assert_eq!(big(&a.abs().sqrt()), BigInt::from(x.magnitude().clone()).sqrt());
        let square = &a * &a;
        prop_assert_eq!(square.sqrt(), a.abs());
        prop_assert_eq!(big(&a.pow(n)), x.pow(n));
    }
}

#[test]
fn signs_of_zero_and_unreadable_text() {
    let none = &Integer::from(5_i64) - &Integer::from(5_u64);
    assert!(none.is_zero() && !none.is_negative() && !none.is_positive() && none.bits() == 0);
    assert_eq!((-none.clone()).to_string(), "0");
    assert_eq!(none.sqrt(), Integer::ZERO);
    assert_eq!(none.trailing_zeros(), None);
    assert!(Integer::parse("12a", 10).is_none());
    assert_eq!(Integer::from(i64::MIN).to_i64(), Some(i64::MIN));
    assert!(Integer::from(1_u64).is_one() && !Integer::from(-1_i64).is_one());
}
