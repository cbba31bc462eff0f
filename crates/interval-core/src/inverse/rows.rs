//! Rows of intervals under the operations of slices: the tightest bounds, many entries at a time.

use crate::rounding::slices::{Backend, Binary, Bounds, BoundsMut, binary_with};

/// Bounds of a row of intervals.
pub(super) struct Row {
    pub lo: Vec<f64>,
    pub hi: Vec<f64>,
    /// The second operand where it is one interval for all.
    other: (Vec<f64>, Vec<f64>),
}

impl Row {
    pub fn new(n: usize) -> Self {
        Self { lo: vec![0.0; n], hi: vec![0.0; n], other: (vec![0.0; n], vec![0.0; n]) }
    }

    /// Entry `j` becomes `f(j)`.
    pub fn fill(&mut self, f: impl Fn(usize) -> (f64, f64)) {
        for (j, (lo, hi)) in self.lo.iter_mut().zip(&mut self.hi).enumerate() {
            (*lo, *hi) = f(j);
        }
    }

    /// Each entry becomes its hull with zero.
    pub fn stretch_to_zero(&mut self) {
        for (lo, hi) in self.lo.iter_mut().zip(&mut self.hi) {
            (*lo, *hi) = (lo.min(0.0), hi.max(0.0));
        }
    }

    /// `self op other`. The value is `None` if a bound is none, as NaN.
    pub fn combined(&self, op: Binary, other: (&[f64], &[f64]), to: &mut Self) -> Option<()> {
        let (x, y) = (Bounds::new(&self.lo, &self.hi).ok()?, Bounds::new(other.0, other.1).ok()?);
        binary_with(Backend::chosen(), op, x, y, BoundsMut { lo: &mut to.lo, hi: &mut to.hi }).ok()
    }

    /// Every entry over `[least, most]`.
    pub fn divided(&mut self, least: f64, most: f64, to: &mut Self) -> Option<()> {
        self.with_all(Binary::Div, least, most, to)
    }

    /// Every entry times `factor`.
    pub fn multiplied(&mut self, factor: f64, to: &mut Self) -> Option<()> {
        self.with_all(Binary::Mul, factor, factor, to)
    }

    fn with_all(&mut self, op: Binary, lo: f64, hi: f64, to: &mut Self) -> Option<()> {
        self.other.0.fill(lo);
        self.other.1.fill(hi);
        self.combined(op, (&self.other.0, &self.other.1), to)
    }
}
