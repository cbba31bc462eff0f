//! Many matrices of one order at once, on all threads.

use super::exact::{hull_of_three, hulls_of_three};
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
    let one = |lo: &[f64], hi: &[f64], lower: &mut [f64], upper: &mut [f64]| {
        let outcome = method(&IntervalMatrix::new(n, n, lo.to_vec(), hi.to_vec())?)?;
        if let Some((l, u)) = outcome.bounds() {
            lower.copy_from_slice(l);
            upper.copy_from_slice(u);
        }
        Ok(outcome.status)
    };
    run(n, lo, hi, |_, _, _, _, _| (), one)
}

/// [`exact`] of every matrix; order 3 without an allocation a matrix.
///
/// # Errors
/// Lengths that are not whole matrices, and bad bounds.
pub fn exact_batch(n: usize, lo: &[f64], hi: &[f64]) -> Result<Batch, Error> {
    if n != 3 {
        return batch(n, lo, hi, exact);
    }
    let one = |lo: &[f64], hi: &[f64], lower: &mut [f64], upper: &mut [f64]| {
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
    };
    run(n, lo, hi, hulls_of_three, one)
}

/// Matrices that one task takes at least, so that its work outweighs its start.
const CHUNK: usize = 256;

/// `many` encloses those of a task's matrices that it can, and says which; `one` any other.
fn run(
    n: usize,
    lo: &[f64],
    hi: &[f64],
    many: impl Fn(&[f64], &[f64], &mut [f64], &mut [f64], &mut [bool]) + Sync + Send,
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
        let (first, count) = (at * chunk, lower.len() / size);
        let mut enclosed = vec![false; count];
        let task = first * size..(first + count) * size;
        many(&lo[task.clone()], &hi[task], lower, upper, &mut enclosed);
        let mut status = vec![Status::Enclosed; count];
        for (k, (l, u)) in lower.chunks_exact_mut(size).zip(upper.chunks_exact_mut(size)).enumerate() {
            if !enclosed[k] {
                let from = (first + k) * size;
                status[k] = one(&lo[from..][..size], &hi[from..][..size], l, u).map_err(|e| e.moved(from))?;
            }
        }
        Ok(status)
    });
    let mut all = Vec::with_capacity(count);
    for part in status {
        all.extend(part?);
    }
    Ok(Batch { status: all, lower, upper })
}
