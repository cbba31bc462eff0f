//! Interval rows of a known parameter.

use super::Random;
use interval_core::regression::{FeasibleOptions, FeasibleSet, Rows, feasible_rows};

/// Bounds of rows that hold at a known parameter.
#[derive(Clone)]
pub struct Data {
    pub n: usize,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    pub truth: Vec<f64>,
}

impl Data {
    pub fn rows(&self) -> Rows<'_> {
        Rows::new(self.n, &self.lower, &self.upper, &self.low, &self.high).expect("good rows")
    }

    pub fn set(&self, options: &FeasibleOptions) -> FeasibleSet {
        feasible_rows(&self.rows(), options).expect("good options")
    }

    pub fn count(&self) -> usize {
        self.low.len()
    }

    /// The rows of these numbers.
    pub fn take(&self, which: &[usize]) -> Self {
        let n = self.n;
        let cut = |v: &[f64]| which.iter().flat_map(|&i| v[i * n..(i + 1) * n].to_vec()).collect();
        let pick = |v: &[f64]| which.iter().map(|&i| v[i]).collect();
        let (lower, upper, low, high) = (cut(&self.lower), cut(&self.upper), pick(&self.low), pick(&self.high));
        Self { n, lower, upper, low, high, truth: self.truth.clone() }
    }
}

pub fn data(seed: u64, m: usize, n: usize, radius: f64, slack: f64, size: f64) -> Data {
    let mut random = Random(seed);
    let truth: Vec<f64> = (0..n).map(|_| size * random.unit()).collect();
    let mut made = Data { n, lower: vec![], upper: vec![], low: vec![], high: vec![], truth: truth.clone() };
    for _ in 0..m {
        let exact: Vec<f64> = (0..n).map(|_| random.unit()).collect();
        let value: f64 = exact.iter().zip(&truth).map(|(a, t)| a * t).sum();
        for a in exact {
            let shift = 0.9 * radius * random.unit();
            made.lower.push(a + shift - radius);
            made.upper.push(a + shift + radius);
        }
        let shift = 0.9 * slack * random.unit();
        made.low.push(value + shift - slack);
        made.high.push(value + shift + slack);
    }
    made
}

pub fn plain() -> FeasibleOptions {
    FeasibleOptions::default()
}
