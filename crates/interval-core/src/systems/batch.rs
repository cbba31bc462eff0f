//! Many systems of one order at once, on all threads.

use crate::error::Error;
use crate::interval::Interval;
use crate::inverse::{Batch, Outcome};
use crate::matrix::IntervalMatrix;
use crate::parallel;

/// Applies a method to systems of order `n` whose matrices (row-major) and right-hand sides follow each other. The
/// batch holds `n` bounds a system.
///
/// # Errors
/// Lengths that are not whole systems, bad bounds, and misuse of the method.
pub fn batch(
    n: usize,
    (lo, hi): (&[f64], &[f64]),
    b: &[Interval],
    method: impl Fn(&IntervalMatrix, &[Interval]) -> Result<Outcome, Error> + Sync + Send,
) -> Result<Batch, Error> {
    crate::rounding::check_environment()?;
    if n == 0 {
        return Err(Error::Zero { what: "the order of the matrix" });
    }
    let count = lo.len() / (n * n);
    for (what, given, needed) in [
        ("the batch", lo.len(), count * n * n),
        ("the upper bound", hi.len(), lo.len()),
        ("the right-hand side", b.len(), count * n),
    ] {
        if given != needed {
            return Err(Error::Shape { what, given, needed });
        }
    }
    let one = |k: usize| -> Result<Outcome, Error> {
        let part = k * n * n..(k + 1) * n * n;
        let a = IntervalMatrix::new(n, n, lo[part.clone()].to_vec(), hi[part.clone()].to_vec());
        method(&a.map_err(|e| e.moved(part.start))?, &b[k * n..(k + 1) * n])
    };
    let mut found = Batch { status: Vec::with_capacity(count), lower: Vec::new(), upper: Vec::new() };
    for outcome in parallel::map(count, count > 1, one) {
        let outcome = outcome?;
        found.status.push(outcome.status);
        if let Some((lower, upper)) = outcome.bounds() {
            found.lower.extend_from_slice(lower);
            found.upper.extend_from_slice(upper);
        } else {
            found.lower.resize(found.lower.len() + n, f64::NAN);
            found.upper.resize(found.upper.len() + n, f64::NAN);
        }
    }
    Ok(found)
}
