//! The tables of the scalar kernels, column by column, for vectors that gather their entries.

use crate::elementary::{Dd, LOG_FIRST, TABLES};
use std::sync::LazyLock;

/// Heads and tails of double-double tables. Lengths are powers of two, whatever stands in the entries that are not
/// reached.
pub(super) struct Columns {
    /// `2^(j/64)`.
    pub exp2: [[f64; 64]; 2],
    /// `sin` and `cos` of `j/128`, up to 101.
    pub sin: [[f64; 128]; 2],
    pub cos: [[f64; 128]; 2],
    /// `c` near `128/i` and `-ln c`, `i` from 90 to 180, at the seven lowest bits of `i`.
    pub log_point: [f64; 128],
    pub log: [[f64; 128]; 2],
}

pub(super) static COLUMNS: LazyLock<Columns> = LazyLock::new(|| Columns {
    exp2: columns(&TABLES.exp2),
    sin: columns(&TABLES.sin_cos.map(|(sin, _)| sin)),
    cos: columns(&TABLES.sin_cos.map(|(_, cos)| cos)),
    log_point: std::array::from_fn(|j| log_entry(j).0),
    log: [std::array::from_fn(|j| log_entry(j).1.hi), std::array::from_fn(|j| log_entry(j).1.lo)],
});

fn columns<const SIZE: usize>(entries: &[Dd]) -> [[f64; SIZE]; 2] {
    let entry = |j: usize| entries.get(j).copied().unwrap_or(Dd::from(0.0));
    [std::array::from_fn(|j| entry(j).hi), std::array::from_fn(|j| entry(j).lo)]
}

/// The entry of the logarithm's table whose index has these seven lowest bits.
fn log_entry(bits: usize) -> (f64, Dd) {
    let index = if bits < LOG_FIRST { bits + 128 } else { bits };
    TABLES.log.get(index - LOG_FIRST).copied().unwrap_or((1.0, Dd::from(0.0)))
}
