//! Square interval systems `A x = b`: the methods of [`inverse`](crate::inverse) with a right-hand side.

mod batch;
mod cramer;
mod exact;
mod gauss_seidel;
mod hansen_bliek_rohn;
mod krawczyk;
mod method;

pub use batch::batch;
pub use cramer::cramer;
pub use exact::exact;
pub use gauss_seidel::gauss_seidel;
pub use hansen_bliek_rohn::hansen_bliek_rohn;
pub use krawczyk::krawczyk;
pub use method::Method;

use crate::error::Error;
use crate::interval::Interval;
use crate::matrix::IntervalMatrix;

/// The right-hand side as a column, once the shapes are known to fit.
fn column(a: &IntervalMatrix, b: &[Interval]) -> Result<IntervalMatrix, Error> {
    let n = a.order()?;
    if b.len() != n {
        return Err(Error::Shape { what: "the right-hand side", given: b.len(), needed: n });
    }
    Ok(IntervalMatrix::from_entries(n, 1, b))
}
