//! A quantity that follows held goals behind a first-order lag: `x' = e x + (1 - e) g` in bounds.
//!
//! One step in plain floats is rounded four times, each time by at most 2^-53 of `|x| + |g|`. A slack of
//! `STEP_ROUNDING` of that is added on either side, which holds all four and its own rounding.

use crate::Error;

/// More than eight times 2^-53, twice the four roundings of a step.
const STEP_ROUNDING: f64 = 1e-15;

/// Lengths of the slices: one entry a row, and the last goal is not followed.
fn fits(needed: usize, lengths: &[usize]) -> Result<(), Error> {
    match lengths.iter().find(|&&n| n != needed) {
        Some(&given) => Err(Error::Shape { what: "a column of the lag", given, needed }),
        None => Ok(()),
    }
}

/// Bounds of the quantity at each row.
///
/// `start` bounds it at the first row, and again after each step that is not `whole`. Over step `k` its share of the
/// previous value is within `slack[k]` of `decay[k]`, and inside `[0, 1]`. `lo` and `hi` hold the goals' bounds when
/// called and the quantity's when done. All slices but these are one shorter.
///
/// # Errors
/// Slices of other lengths, or none.
pub fn follow(
    start: (f64, f64),
    decay: &[f64],
    slack: &[f64],
    whole: &[bool],
    lo: &mut [f64],
    hi: &mut [f64],
) -> Result<(), Error> {
    fits(lo.len().max(1), &[lo.len(), hi.len(), decay.len() + 1, slack.len() + 1, whole.len() + 1])?;
    let (mut low, mut high) = start;
    let mut goal = (lo[0], hi[0]);
    (lo[0], hi[0]) = start;
    for k in 0..decay.len() {
        let next = (lo[k + 1], hi[k + 1]);
        (low, high) = if whole[k] { step((low, high), goal, decay[k], slack[k]) } else { start };
        (lo[k + 1], hi[k + 1]) = (low, high);
        goal = next;
    }
    Ok(())
}

/// One step; linear in the share, so its extremes stand at the ends of the share's range.
fn step((a, b): (f64, f64), (g_low, g_high): (f64, f64), decay: f64, slack: f64) -> (f64, f64) {
    let (least, most) = ((decay - slack).max(0.0), (decay + slack).min(1.0));
    let between = |x: f64, g: f64| (least * x + (1.0 - least) * g, most * x + (1.0 - most) * g);
    let (p, q) = between(a, g_low);
    let (r, s) = between(b, g_high);
    (p.min(q) - STEP_ROUNDING * (a.abs() + g_low.abs()), r.max(s) + STEP_ROUNDING * (b.abs() + g_high.abs()))
}
