//! Constants of the double-double kernels: numbers in `values`, which the ball arithmetic of `computed` gives.

mod computed;
mod values;

pub use computed::source;

use super::double_double::Dd;
use values::BITS;

/// First index of [`Tables::log`]: mantissas from 90/128 to 181/128.
pub(crate) const LOG_FIRST: usize = 89;

/// Double-double values are within 2^-103 relative; a reduction constant in parts says how far it reaches.
pub(crate) struct Tables {
    /// `2^(j/64)`.
    pub exp2: [Dd; 64],
    /// `64 / ln 2`, nearest.
    pub steps_per_unit: f64,
    /// `ln 2 / 64` in a part of 36 bits and one of 53: within 2^-95 absolute.
    pub step: [f64; 2],
    /// For `i = LOG_FIRST ..`: `c` near `128/i` of at most 11 bits, and `-ln c`.
    pub log: [(f64, Dd); 94],
    pub ln2: Dd,
    pub ln10: Dd,
    /// `1 / ln 2` and `1 / ln 10`.
    pub log2_e: Dd,
    pub log10_e: Dd,
    pub third: Dd,
    pub sixth: Dd,
    /// `2 / pi`, nearest.
    pub quarters_per_radian: f64,
    /// `pi / 2` in three parts of 53 bits: within 2^-160 absolute.
    pub half_pi: [f64; 3],
    pub pi: Dd,
    /// `1 / pi`.
    pub per_pi: Dd,
    /// `sin` and `cos` of `j/128`.
    pub sin_cos: [(Dd, Dd); 102],
    /// `atan` of `j/64`.
    pub atan: [Dd; 65],
}

pub(crate) static TABLES: Tables = Tables::read();

/// Doubles of a table of double-doubles, of points with a double-double, and of pairs of double-doubles.
const EXP2: usize = 0;
const LOG: usize = EXP2 + 2 * 64;
const SIN_COS: usize = LOG + 3 * 94;
const ATAN: usize = SIN_COS + 4 * 102;
const REST: usize = ATAN + 2 * 65;

const fn double(at: usize) -> f64 {
    f64::from_bits(BITS[at])
}

const fn double_double(at: usize) -> Dd {
    Dd { hi: double(at), lo: double(at + 1) }
}

const fn double_doubles<const N: usize>(start: usize) -> [Dd; N] {
    let mut all = [Dd { hi: 0.0, lo: 0.0 }; N];
    let mut j = 0;
    while j < N {
        all[j] = double_double(start + 2 * j);
        j += 1;
    }
    all
}

impl Tables {
    /// From the numbers of `values`, in the order of [`Tables::numbers`].
    const fn read() -> Self {
        let zero = Dd { hi: 0.0, lo: 0.0 };
        let (mut log, mut sin_cos) = ([(0.0, zero); 94], [(zero, zero); 102]);
        let mut j = 0;
        while j < 94 {
            log[j] = (double(LOG + 3 * j), double_double(LOG + 3 * j + 1));
            j += 1;
        }
        j = 0;
        while j < 102 {
            sin_cos[j] = (double_double(SIN_COS + 4 * j), double_double(SIN_COS + 4 * j + 2));
            j += 1;
        }
        Self {
            exp2: double_doubles(EXP2),
            log,
            sin_cos,
            atan: double_doubles(ATAN),
            steps_per_unit: double(REST),
            step: [double(REST + 1), double(REST + 2)],
            ln2: double_double(REST + 3),
            ln10: double_double(REST + 5),
            log2_e: double_double(REST + 7),
            log10_e: double_double(REST + 9),
            third: double_double(REST + 11),
            sixth: double_double(REST + 13),
            quarters_per_radian: double(REST + 15),
            half_pi: [double(REST + 16), double(REST + 17), double(REST + 18)],
            pi: double_double(REST + 19),
            per_pi: double_double(REST + 21),
        }
    }

    /// All doubles, in the order in which they are read.
    fn numbers(&self) -> impl Iterator<Item = f64> {
        let pair = |d: &Dd| [d.hi, d.lo];
        let log = self.log.iter().flat_map(move |(c, l)| [*c, l.hi, l.lo]);
        let waves = self.sin_cos.iter().flat_map(move |(s, c)| [s.hi, s.lo, c.hi, c.lo]);
        let logarithms = [self.ln2, self.ln10, self.log2_e, self.log10_e, self.third, self.sixth];
        let rest = [self.steps_per_unit].into_iter().chain(self.step);
        let rest = rest.chain(logarithms.into_iter().flat_map(move |d| pair(&d))).chain([self.quarters_per_radian]);
        let rest = rest.chain(self.half_pi).chain([self.pi, self.per_pi].into_iter().flat_map(move |d| pair(&d)));
        let pairs = self.exp2.iter().flat_map(pair);
        pairs.chain(log).chain(waves).chain(self.atan.iter().flat_map(pair)).chain(rest)
    }
}
