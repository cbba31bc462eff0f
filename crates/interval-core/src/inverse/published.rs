//! The partitioned hull inverse of the paper, literally (section IV.C, eq. 11-13), and the hull over both of its sets.
//!
//! With `delta = Delta / N` the sets are `I = {lo + k delta}` and `S = {hi - k delta}`, `k = 0 .. N - 1` (in the paper's step 2 the
//! printed `n` stands for `N`). Eq. 11 takes the smallest inverse over `I` and the largest over `S`. Entries of the inverse that
//! fall while `A` grows come out improper, and in two dimensions or more both sets lie on one diagonal of the box of
//! matrices, so the result encloses nothing. Its status is never `Enclosed`.

use super::{Endpoints, Outcome, UNBOUNDED};
use crate::error::Error;
use crate::matrix::IntervalMatrix;
use crate::parallel;
use crate::status::Status;

/// Eq. 11 as printed; improper entries are kept.
///
/// # Errors
/// A matrix that is not square, or `partitions` of 0.
pub fn published(a: &IntervalMatrix, partitions: u64) -> Result<Outcome, Error> {
    Ok(match sweep(a, partitions)? {
        Err(refusal) => refusal,
        Ok(sweep) => not_an_enclosure(Endpoints { lower: sweep.infima.lower, upper: sweep.suprema.upper }),
    })
}

/// The hull over both sets: proper, but still along one diagonal of the box only.
///
/// # Errors
/// A matrix that is not square, or `partitions` of 0.
pub fn published_hull(a: &IntervalMatrix, partitions: u64) -> Result<Outcome, Error> {
    Ok(match sweep(a, partitions)? {
        Err(refusal) => refusal,
        Ok(sweep) => {
            let pair =
                |f: fn(f64, f64) -> f64, x: Vec<f64>, y: Vec<f64>| x.into_iter().zip(y).map(|(x, y)| f(x, y)).collect();
            not_an_enclosure(Endpoints {
                lower: pair(f64::min, sweep.infima.lower, sweep.suprema.lower),
                upper: pair(f64::max, sweep.infima.upper, sweep.suprema.upper),
            })
        }
    })
}

fn not_an_enclosure(value: Endpoints) -> Outcome {
    let improper = value.improper().iter().filter(|&&x| x).count();
    let reason = format!(
        "the sweep follows one diagonal of the box of matrices, so its result is not an enclosure; {improper} of {} \
         entries are improper",
        value.lower.len()
    );
    Outcome { status: Status::NotProved, value: Some(value), certificate: None, reason: Some(reason) }
}

/// Extremes of the inverses over each set.
struct Sweep {
    infima: Endpoints,
    suprema: Endpoints,
}

/// Partitions handled by one task: enough to hide the cost of a task, few enough to share out.
const CHUNK: u64 = 4096;

fn sweep(a: &IntervalMatrix, partitions: u64) -> Result<Result<Sweep, Outcome>, Error> {
    let n = a.order()?;
    if partitions == 0 {
        return Err(Error::Zero { what: "the number of partitions" });
    }
    if !a.is_bounded() {
        return Ok(Err(Outcome::not_applicable(UNBOUNDED)));
    }
    #[expect(clippy::cast_precision_loss, reason = "the published step is a plain float; nothing is claimed of it")]
    let step: Vec<f64> = a.lo().iter().zip(a.hi()).map(|(l, h)| (0.5 * h - 0.5 * l) / partitions as f64).collect();
    let chunk_extremes = |chunk: u64| {
        let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(partitions);
        let infima = extremes(a.lo(), &step, 1.0, range.clone(), n)?;
        Some((infima, extremes(a.hi(), &step, -1.0, range, n)?))
    };
    let extremes = parallel::map_reduce(partitions.div_ceil(CHUNK), chunk_extremes, |x, y| match (x, y) {
        (Some(x), Some(y)) => Some((merge(x.0, y.0), merge(x.1, y.1))),
        _ => None,
    })
    .flatten();
    Ok(match extremes {
        Some((infima, suprema)) => Ok(Sweep { infima, suprema }),
        None => Err(Outcome::not_applicable("a matrix of the sweep is singular or its inverse overflows")),
    })
}

fn merge(mut x: Endpoints, y: Endpoints) -> Endpoints {
    x.lower.iter_mut().zip(y.lower).for_each(|(a, b)| *a = a.min(b));
    x.upper.iter_mut().zip(y.upper).for_each(|(a, b)| *a = a.max(b));
    x
}

/// Extremes of `(start + direction k step)^-1` over the range; `None` at a singular matrix.
fn extremes(start: &[f64], step: &[f64], direction: f64, range: std::ops::Range<u64>, n: usize) -> Option<Endpoints> {
    let mut found = Endpoints { lower: vec![f64::INFINITY; n * n], upper: vec![f64::NEG_INFINITY; n * n] };
    let mut work = vec![0.0; 2 * n * n];
    for k in range {
        #[expect(clippy::cast_precision_loss, reason = "the published sweep is a plain float computation")]
        let shift = direction * k as f64;
        for i in 0..n {
            for j in 0..n {
                work[2 * n * i + j] = start[i * n + j] + shift * step[i * n + j];
                work[2 * n * i + n + j] = f64::from(u8::from(i == j));
            }
        }
        invert_in_place(&mut work, n)?;
        for i in 0..n {
            for j in 0..n {
                let entry = work[2 * n * i + n + j];
                if !entry.is_finite() {
                    return None;
                }
                let at = i * n + j;
                found.lower[at] = found.lower[at].min(entry);
                found.upper[at] = found.upper[at].max(entry);
            }
        }
    }
    Some(found)
}

/// Gauss-Jordan elimination with partial pivoting of `[A | I]`, row-major with `2 n` columns.
fn invert_in_place(work: &mut [f64], n: usize) -> Option<()> {
    let width = 2 * n;
    for p in 0..n {
        let pivot_row = (p..n).max_by(|&i, &j| work[i * width + p].abs().total_cmp(&work[j * width + p].abs()))?;
        let pivot = work[pivot_row * width + p];
        if pivot == 0.0 || !pivot.is_finite() {
            return None;
        }
        for j in 0..width {
            work.swap(p * width + j, pivot_row * width + j);
            work[p * width + j] /= pivot;
        }
        for i in 0..n {
            let factor = work[i * width + p];
            if i != p && factor != 0.0 {
                for j in 0..width {
                    work[i * width + j] -= factor * work[p * width + j];
                }
            }
        }
    }
    Some(())
}
