//! The tables of the scalar kernels, column by column, for vectors that gather their entries.

use crate::elementary::{Dd, LOG_FIRST, TABLES};

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

pub(super) static COLUMNS: Columns = Columns::new();

impl Columns {
    const fn new() -> Self {
        let mut columns = Self {
            exp2: [[0.0; 64]; 2],
            sin: [[0.0; 128]; 2],
            cos: [[0.0; 128]; 2],
            log_point: [1.0; 128],
            log: [[0.0; 128]; 2],
        };
        let mut j = 0;
        while j < TABLES.exp2.len() {
            put(&mut columns.exp2, j, TABLES.exp2[j]);
            j += 1;
        }
        j = 0;
        while j < TABLES.sin_cos.len() {
            let (sin, cos) = TABLES.sin_cos[j];
            put(&mut columns.sin, j, sin);
            put(&mut columns.cos, j, cos);
            j += 1;
        }
        j = 0;
        while j < TABLES.log.len() {
            let (point, log) = TABLES.log[j];
            // The entry whose index has these seven lowest bits.
            let bits = (j + LOG_FIRST) % 128;
            columns.log_point[bits] = point;
            put(&mut columns.log, bits, log);
            j += 1;
        }
        columns
    }
}

const fn put<const SIZE: usize>(columns: &mut [[f64; SIZE]; 2], at: usize, value: Dd) {
    columns[0][at] = value.hi;
    columns[1][at] = value.lo;
}
