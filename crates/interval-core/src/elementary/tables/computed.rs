//! The tables by the ball arithmetic that is the kernels' last resort.

use super::{LOG_FIRST, Tables};
use crate::dyadic::dyadic_down;
use crate::elementary::ball::Ball;
use crate::elementary::double_double::{Dd, fast_two_sum};
use crate::elementary::multiprecision::{atan, exp, ln2, ln10, log, pi, sin_cos};
use crate::elementary::nearest;
use crate::integers::Integer;
use alloc::string::String;
use core::fmt::Write as _;

/// Bits of the balls from which the tables are rounded: more than twice those of a double-double.
const BITS: i64 = 256;

/// The leading doubles of a number, each the rest rounded down.
fn parts<const N: usize>(x: &Ball) -> [f64; N] {
    let mut rest = x.clone();
    core::array::from_fn(|_| {
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
    fn computed() -> Self {
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
            exp2: core::array::from_fn(|j| double_double(exp(&ln2.mul(&fraction(j, 64.0)), BITS))),
            steps_per_unit: Ball::integer(64).div(&ln2, BITS).map_or(0.0, |b| b.approximate()),
            step,
            log: core::array::from_fn(|j| {
                let i = (j + LOG_FIRST) as f64;
                let near_one = (127.0..=129.0).contains(&i);
                let c = if near_one { 1.0 } else { nearest(1024.0 * 128.0 / i) / 1024.0 };
                (c, if near_one { Dd::from(0.0) } else { double_double(log(&Ball::from_f64(c), BITS).map(Ball::neg)) })
            }),
            log2_e: double_double(one.div(&ln2, BITS)),
            log10_e: double_double(one.div(&ln10, BITS)),
            third: double_double(one.div(&Ball::integer(3), BITS)),
            sixth: double_double(one.div(&Ball::integer(6), BITS)),
            quarters_per_radian: Ball::integer(2).div(&pi, BITS).map_or(0.0, |b| b.approximate()),
            half_pi: parts(&pi.clone().scale(-1)),
            sin_cos: core::array::from_fn(|j| {
                let (sin, cos, _): (Ball, Ball, Integer) =
                    sin_cos(&fraction(j, 128.0), BITS).expect("angles of the table are small");
                (double_double(Some(sin)), double_double(Some(cos)))
            }),
            atan: core::array::from_fn(|j| double_double(atan(&fraction(j, 64.0), BITS))),
            ln2: double_double(Some(ln2)),
            ln10: double_double(Some(ln10)),
            per_pi: double_double(one.div(&pi, BITS)),
            pi: double_double(Some(pi)),
        }
    }
}

/// The numbers of the tables as the lines of `values.rs`, for the test that compares them.
#[must_use]
pub fn source() -> String {
    let mut text = String::new();
    for (at, x) in Tables::computed().numbers().enumerate() {
        let begin = if at % 6 == 0 { "\n    " } else { " " };
        let _ = write!(text, "{begin}{:#018x},", x.to_bits());
    }
    text
}
