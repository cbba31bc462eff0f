//! Many matrices of one order at once, on all threads.

use super::exact::hull_of_three;
use super::{Outcome, exact};
use crate::error::Error;
use crate::matrix::IntervalMatrix;
use crate::parallel;
use crate::status::Status;

/// The results of a method for a batch of matrices.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// One status a matrix.
    pub status: Vec<Status>,
    /// Lower bounds, one matrix after the other, each row-major; NaN where there is no value.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
}

/// Applies a method to matrices of order `n` whose bounds follow each other, each row-major.
///
/// # Errors
/// Lengths that are not whole matrices, bad bounds (their position counts over the whole batch), and misuse of the
/// method.
pub fn batch(
    n: usize,
    lo: &[f64],
    hi: &[f64],
    method: impl Fn(&IntervalMatrix) -> Result<Outcome, Error> + Sync + Send,
) -> Result<Batch, Error> {
    run(n, lo, hi, |lo, hi, lower, upper| {
        let outcome = method(&IntervalMatrix::new(n, n, lo.to_vec(), hi.to_vec())?)?;
        if let Some((l, u)) = outcome.bounds() {
            lower.copy_from_slice(l);
            upper.copy_from_slice(u);
        }
        Ok(outcome.status)
    })
}

/// [`exact`] of every matrix; order 3 without an allocation a matrix.
///
/// # Errors
/// Lengths that are not whole matrices, and bad bounds.
pub fn exact_batch(n: usize, lo: &[f64], hi: &[f64]) -> Result<Batch, Error> {
    if n != 3 {
        return batch(n, lo, hi, exact);
    }
    run(n, lo, hi, |lo, hi, lower, upper| {
        if let Some((l, u)) = hull_of_three(lo, hi) {
            lower.copy_from_slice(&l);
            upper.copy_from_slice(&u);
            return Ok(Status::Enclosed);
        }
        let outcome = exact(&IntervalMatrix::new(n, n, lo.to_vec(), hi.to_vec())?)?;
        if let Some((l, u)) = outcome.bounds() {
            lower.copy_from_slice(l);
            upper.copy_from_slice(u);
        }
        Ok(outcome.status)
    })
}

/// Matrices that one task takes at least, so that its work outweighs its start.
const CHUNK: usize = 256;

fn run(
    n: usize,
    lo: &[f64],
    hi: &[f64],
    one: impl Fn(&[f64], &[f64], &mut [f64], &mut [f64]) -> Result<Status, Error> + Sync + Send,
) -> Result<Batch, Error> {
    crate::rounding::check_environment()?;
    let size = n * n;
    if size == 0 {
        return Err(Error::Zero { what: "the order of the matrix" });
    }
    if hi.len() != lo.len() {
        return Err(Error::Shape { what: "the upper bound", given: hi.len(), needed: lo.len() });
    }
    if lo.len() % size != 0 {
        return Err(Error::Shape { what: "the batch", given: lo.len(), needed: lo.len().next_multiple_of(size) });
    }
    let count = lo.len() / size;
    let chunk = if n <= 4 { CHUNK } else { 1 };
    let mut lower = vec![f64::NAN; lo.len()];
    let mut upper = vec![f64::NAN; lo.len()];
    let status = parallel::chunks(chunk * size, &mut lower, &mut upper, |at, lower, upper| {
        let first = at * chunk;
        let mut status = Vec::with_capacity(lower.len() / size);
        for (k, (l, u)) in lower.chunks_exact_mut(size).zip(upper.chunks_exact_mut(size)).enumerate() {
            let from = (first + k) * size;
            status.push(one(&lo[from..][..size], &hi[from..][..size], l, u).map_err(|e| e.moved(from))?);
        }
        Ok(status)
    });
    let mut all = Vec::with_capacity(count);
    for part in status {
        all.extend(part?);
    }
    Ok(Batch { status: all, lower, upper })
}
