//! Natural numbers as digits to base 2^64, the lowest first, without leading zeros.

use alloc::vec;
use alloc::vec::Vec;
use core::cmp::Ordering;

/// Bits of a digit.
pub(super) const WIDTH: u64 = 64;

pub(super) fn low(x: u128) -> u64 {
    #[expect(clippy::cast_possible_truncation, reason = "the low half is meant")]
    let digit = x as u64;
    digit
}

pub(super) fn high(x: u128) -> u64 {
    low(x >> WIDTH)
}

pub(super) fn trimmed(mut digits: Vec<u64>) -> Vec<u64> {
    while digits.last() == Some(&0) {
        digits.pop();
    }
    digits
}

pub(super) fn compare(a: &[u64], b: &[u64]) -> Ordering {
    a.len().cmp(&b.len()).then_with(|| a.iter().rev().cmp(b.iter().rev()))
}

pub(super) fn sum(a: &[u64], b: &[u64]) -> Vec<u64> {
    let (long, short) = if a.len() >= b.len() { (a, b) } else { (b, a) };
    let mut found = Vec::with_capacity(long.len() + 1);
    let mut carry = 0;
    for (i, &digit) in long.iter().enumerate() {
        let total = u128::from(digit) + u128::from(short.get(i).copied().unwrap_or(0)) + u128::from(carry);
        found.push(low(total));
        carry = high(total);
    }
    found.push(carry);
    trimmed(found)
}

/// `a - b` for `a >= b`.
pub(super) fn difference(a: &[u64], b: &[u64]) -> Vec<u64> {
    let mut found = Vec::with_capacity(a.len());
    let mut borrow = false;
    for (i, &digit) in a.iter().enumerate() {
        let (first, under) = digit.overflowing_sub(b.get(i).copied().unwrap_or(0));
        let (second, under_too) = first.overflowing_sub(u64::from(borrow));
        found.push(second);
        borrow = under || under_too;
    }
    trimmed(found)
}

pub(super) fn product(a: &[u64], b: &[u64]) -> Vec<u64> {
    let mut found = vec![0; a.len() + b.len()];
    for (i, &x) in a.iter().enumerate() {
        let mut carry = 0;
        for (j, &y) in b.iter().enumerate() {
            let total = u128::from(x) * u128::from(y) + u128::from(found[i + j]) + u128::from(carry);
            found[i + j] = low(total);
            carry = high(total);
        }
        found[i + b.len()] = carry;
    }
    trimmed(found)
}

pub(super) fn shifted_up(a: &[u64], by: u64) -> Vec<u64> {
    if a.is_empty() {
        return Vec::new();
    }
    let (whole, part) = (usize::try_from(by / WIDTH).expect("shifts fit the memory"), by % WIDTH);
    let mut found = vec![0; whole];
    let mut carry = 0;
    for &digit in a {
        let moved = u128::from(digit) << part;
        found.push(low(moved) | carry);
        carry = high(moved);
    }
    found.push(carry);
    trimmed(found)
}

/// The digits without their lowest bits, and whether one of those is set.
pub(super) fn shifted_down(a: &[u64], by: u64) -> (Vec<u64>, bool) {
    let whole = usize::try_from(by / WIDTH).unwrap_or(usize::MAX);
    if whole >= a.len() {
        return (Vec::new(), !a.is_empty());
    }
    let part = by % WIDTH;
    let mut lost = a[..whole].iter().any(|&d| d != 0);
    let kept = &a[whole..];
    if part == 0 {
        return (kept.to_vec(), lost);
    }
    lost |= kept[0] << (WIDTH - part) != 0;
    let digit = |i: usize| (kept[i] >> part) | kept.get(i + 1).map_or(0, |next| next << (WIDTH - part));
    (trimmed((0..kept.len()).map(digit).collect()), lost)
}

/// Quotient and remainder by one digit that is not zero.
pub(super) fn divided_by_digit(a: &[u64], divisor: u64) -> (Vec<u64>, u64) {
    let mut rest = 0_u64;
    let mut found = vec![0; a.len()];
    for i in (0..a.len()).rev() {
        let part = (u128::from(rest) << WIDTH) | u128::from(a[i]);
        found[i] = low(part / u128::from(divisor));
        rest = low(part % u128::from(divisor));
    }
    (trimmed(found), rest)
}

/// The quotient by a divisor that is not zero (Knuth, algorithm D).
pub(super) fn quotient(a: &[u64], b: &[u64]) -> Vec<u64> {
    if compare(a, b) == Ordering::Less {
        return Vec::new();
    }
    if let [digit] = b {
        return divided_by_digit(a, *digit).0;
    }
    // The divisor's highest bit is set, so that a trial digit is at most two too large.
    let shift = u64::from(b[b.len() - 1].leading_zeros());
    let divisor = shifted_up(b, shift);
    let mut rest = shifted_up(a, shift);
    rest.resize(a.len() + 1, 0);
    let n = divisor.len();
    let (top, next) = (u128::from(divisor[n - 1]), u128::from(divisor[n - 2]));
    let mut found = vec![0; rest.len() - n];
    for j in (0..found.len()).rev() {
        let lead = (u128::from(rest[j + n]) << WIDTH) | u128::from(rest[j + n - 1]);
        let (mut trial, mut left) = (lead / top, lead % top);
        while trial > u128::from(u64::MAX) || trial * next > ((left << WIDTH) | u128::from(rest[j + n - 2])) {
            trial -= 1;
            left += top;
            if left > u128::from(u64::MAX) {
                break;
            }
        }
        if take(&mut rest[j..=j + n], &divisor, low(trial)) {
            trial -= 1;
            give_back(&mut rest[j..=j + n], &divisor);
        }
        found[j] = low(trial);
    }
    trimmed(found)
}

/// `rest -= times * divisor`; true if that is negative and 2^64 to the power of the length was added.
fn take(rest: &mut [u64], divisor: &[u64], times: u64) -> bool {
    let (mut carry, mut borrow) = (0, false);
    for (i, slot) in rest.iter_mut().enumerate() {
        let part = u128::from(times) * u128::from(divisor.get(i).copied().unwrap_or(0)) + u128::from(carry);
        carry = high(part);
        let (first, under) = slot.overflowing_sub(low(part));
        let (second, under_too) = first.overflowing_sub(u64::from(borrow));
        *slot = second;
        borrow = under || under_too;
    }
    borrow
}

fn give_back(rest: &mut [u64], divisor: &[u64]) {
    let mut carry = 0;
    for (i, slot) in rest.iter_mut().enumerate() {
        let total = u128::from(*slot) + u128::from(divisor.get(i).copied().unwrap_or(0)) + u128::from(carry);
        *slot = low(total);
        carry = high(total);
    }
}
