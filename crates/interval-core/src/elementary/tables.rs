//! Constants of the double-double kernels, computed once by the ball arithmetic that is their last resort.

use super::ball::Ball;
use super::double_double::{Dd, fast_two_sum};
use super::multiprecision::{atan, exp, ln2, ln10, log, pi, sin_cos};
use crate::dyadic::dyadic_down;
use crate::integers::Integer;
use std::sync::LazyLock;

/// Bits of the balls from which the tables are rounded: more than twice those of a double-double.
const BITS: i64 = 256;

/// First index of [`Tables::log`]: mantissas from 90/128 to 181/128.
pub(crate) const LOG_FIRST: usize = 89;

/// Double-double values are within 2^-103 relative; a reduction constant in parts says how far it reaches.
pub(crate) struct Tables {
    /// `2^(j/64)`.
    pub exp2: [Dd; 64],
    /// `64 / ln 2`, nearest.
    pub steps_per_unit: f64,
    /// `ln 2 / 64` in a part of 36 bits and one of 53: within 2^-95 absolute.
    pub step: [f64; 2],
    /// For `i = LOG_FIRST ..`: `c` near `128/i` of at most 11 bits, and `-ln c`.
    pub log: [(f64, Dd); 94],
    pub ln2: Dd,
    pub ln10: Dd,
    /// `1 / ln 2` and `1 / ln 10`.
    pub log2_e: Dd,
    pub log10_e: Dd,
    pub third: Dd,
    pub sixth: Dd,
    /// `2 / pi`, nearest.
    pub quarters_per_radian: f64,
    /// `pi / 2` in three parts of 53 bits: within 2^-160 absolute.
    pub half_pi: [f64; 3],
    pub pi: Dd,
    /// `1 / pi`.
    pub per_pi: Dd,
    /// `sin` and `cos` of `j/128`.
    pub sin_cos: [(Dd, Dd); 102],
    /// `atan` of `j/64`.
    pub atan: [Dd; 65],
}

pub(crate) static TABLES: LazyLock<Tables> = LazyLock::new(Tables::new);

/// The leading doubles of a number, each the rest rounded down.
fn parts<const N: usize>(x: &Ball) -> [f64; N] {
    let mut rest = x.clone();
    std::array::from_fn(|_| {
        let part = dyadic_down(&rest.mid, rest.exp);
        rest = rest.sub(&Ball::from_f64(part));
        part
    })
}

fn double_double(x: Option<Ball>) -> Dd {
    let [hi, lo] = parts(&x.expect("arguments of the tables lie in the domains"));
    fast_two_sum(hi, lo)
}

#[expect(clippy::cast_precision_loss, reason = "indices of tables are small")]
fn fraction(j: usize, steps: f64) -> Ball {
    Ball::from_f64(j as f64 / steps)
}

impl Tables {
    #[expect(clippy::cast_precision_loss, reason = "indices of tables are small")]
    fn new() -> Self {
        let one = Ball::integer(1);
        let (ln2, ln10, pi) = (ln2(BITS), ln10(BITS), pi(BITS));
        let step = {
            let whole = ln2.clone().scale(-6);
            let [head] = parts(&whole);
            // 17 bits less than a double has: the product with a count of steps below 2^17 is exact.
            let head = f64::from_bits(head.to_bits() & !((1 << 17) - 1));
            let [tail] = parts(&whole.sub(&Ball::from_f64(head)));
            [head, tail]
        };
        Self {
            exp2: std::array::from_fn(|j| double_double(exp(&ln2.mul(&fraction(j, 64.0)), BITS))),
            steps_per_unit: Ball::integer(64).div(&ln2, BITS).map_or(0.0, |b| b.approximate()),
            step,
            log: std::array::from_fn(|j| {
                let i = (j + LOG_FIRST) as f64;
                let near_one = (127.0..=129.0).contains(&i);
                let c = if near_one { 1.0 } else { (1024.0 * 128.0 / i).round() / 1024.0 };
                (c, if near_one { Dd::from(0.0) } else { double_double(log(&Ball::from_f64(c), BITS).map(Ball::neg)) })
            }),
            log2_e: double_double(one.div(&ln2, BITS)),
            log10_e: double_double(one.div(&ln10, BITS)),
            third: double_double(one.div(&Ball::integer(3), BITS)),
            sixth: double_double(one.div(&Ball::integer(6), BITS)),
            quarters_per_radian: Ball::integer(2).div(&pi, BITS).map_or(0.0, |b| b.approximate()),
            half_pi: parts(&pi.clone().scale(-1)),
            sin_cos: std::array::from_fn(|j| {
                let (sin, cos, _): (Ball, Ball, Integer) =
                    sin_cos(&fraction(j, 128.0), BITS).expect("angles of the table are small");
                (double_double(Some(sin)), double_double(Some(cos)))
            }),
            atan: std::array::from_fn(|j| double_double(atan(&fraction(j, 64.0), BITS))),
            ln2: double_double(Some(ln2)),
            ln10: double_double(Some(ln10)),
            per_pi: double_double(one.div(&pi, BITS)),
            pi: double_double(Some(pi)),
        }
    }
}
