//! All least-squares solutions of interval rows by Rump's augmented system (docs/theory.md, "Least squares"):
//! `[A, -f I; 0, A'] [x; r] = [y; 0]`, a square interval system of order `m + n`, with `f` a scale. The rows stand in
//! it twice as if they were independent, so it is wide.

use super::least_squares::LeastSquares;
use super::rows::Rows;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;
use crate::status::{LeastSquaresStatus, Status};
use crate::systems::hansen_bliek_rohn;

/// The largest order, `m + n`: the system is dense, and its cost grows with the cube.
pub const ORDER_LIMIT: usize = 1000;

/// Encloses every least-squares solution of every member.
///
/// # Errors
/// A changed rounding mode.
pub fn augmented(rows: &Rows<'_>) -> Result<LeastSquares, crate::Error> {
    crate::rounding::check_environment()?;
    let (m, n) = (rows.count(), rows.columns());
    if m < n {
        let reason = format!("{m} rows leave {n} parameters undetermined");
        return Ok(LeastSquares::without(LeastSquaresStatus::NotApplicable, reason));
    }
    let order = m + n;
    if order > ORDER_LIMIT {
        let reason = format!("the augmented system has order {order}; at most {ORDER_LIMIT} is possible");
        return Ok(LeastSquares::without(LeastSquaresStatus::NotApplicable, reason));
    }
    let whole = IntervalMatrix::new(m, n, rows.slices(0, m)[0].to_vec(), rows.slices(0, m)[1].to_vec())?;
    let scale = 1e-4 * (whole.norm() * whole.norm_one()).sqrt();
    let scale = if scale > 0.0 && scale.is_finite() { scale } else { 1.0 };
    let mut entries = vec![Interval::ZERO; order * order];
    for i in 0..m {
        for j in 0..n {
            entries[i * order + j] = whole.get(i, j);
            entries[(m + j) * order + n + i] = whole.get(i, j);
        }
        entries[i * order + n + i] = Interval::raw(-scale, -scale);
    }
    let right: Vec<Interval> = (0..order)
        .map(|i| if i < m { Interval::raw(rows.right(i).0, rows.right(i).1) } else { Interval::ZERO })
        .collect();
    let found = hansen_bliek_rohn(&IntervalMatrix::from_entries(order, order, &entries), &right)?;
    if let Some(x) = found.enclosure() {
        return Ok(LeastSquares::enclosed(x.map(|x| (0..n).map(|j| x.get(j, 0)).collect())));
    }
    let status = match found.status {
        Status::NotApplicable => LeastSquaresStatus::NotApplicable,
        // Regular or not, the system has no enclosure.
        Status::Enclosed | Status::Singular | Status::NotProved => LeastSquaresStatus::NotProved,
    };
    Ok(LeastSquares { status, parameters: None, reason: found.reason })
}
