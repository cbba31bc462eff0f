//! The working set of a linear program: the few half-spaces that a search looks at, scaled by powers of two.

/// Half-spaces in scaled unknowns; each keeps its name in the problem that it comes from.
#[derive(Debug, Clone)]
pub(crate) struct Program {
    n: usize,
    column: Vec<f64>,
    coefficients: Vec<f64>,
    right: Vec<f64>,
    /// Reciprocal of the normal's length.
    unit: Vec<f64>,
    row: Vec<f64>,
    names: Vec<usize>,
}

impl Program {
    /// An empty set; `column` holds the powers of two that the unknowns' coefficients are multiplied by.
    pub(crate) fn new(column: Vec<f64>) -> Self {
        let empty = Vec::new;
        let n = column.len();
        Self { n, column, coefficients: empty(), right: empty(), unit: empty(), row: empty(), names: Vec::new() }
    }

    /// Takes in `g x <= h`.
    pub(crate) fn push(&mut self, name: usize, g: &[f64], h: f64) {
        if h == f64::INFINITY {
            return;
        }
        let start = self.coefficients.len();
        self.coefficients.extend(g.iter().zip(&self.column).map(|(x, s)| x * s));
        let scaled = &mut self.coefficients[start..];
        let largest = scaled.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let by = if largest > 0.0 { power_of_two_near(largest).recip() } else { 1.0 };
        for x in scaled.iter_mut() {
            *x *= by;
        }
        let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.unit.push(if length > 0.0 { length.recip() } else { 1.0 });
        self.right.push(h * by);
        self.row.push(by);
        self.names.push(name);
    }

    pub(crate) fn dimension(&self) -> usize {
        self.n
    }

    pub(crate) fn count(&self) -> usize {
        self.right.len()
    }

    /// The names, in the order of arrival.
    pub(crate) fn names(&self) -> &[usize] {
        &self.names
    }

    pub(super) fn normal(&self, index: usize) -> &[f64] {
        &self.coefficients[index * self.n..(index + 1) * self.n]
    }

    pub(super) fn right(&self, index: usize) -> f64 {
        self.right[index]
    }

    pub(super) fn unit(&self, index: usize) -> f64 {
        self.unit[index]
    }

    /// A multiplier of the scaled half-space as one of the half-space itself.
    pub(super) fn unscaled_multiplier(&self, index: usize, multiplier: f64) -> f64 {
        multiplier * self.row[index]
    }

    pub(super) fn scaled_objective(&self, objective: &[f64]) -> Vec<f64> {
        objective.iter().zip(&self.column).map(|(c, s)| c * s).collect()
    }

    pub(super) fn unscaled_point(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.column).map(|(x, s)| x * s).collect()
    }
}

/// The power of two at or below a positive number, kept away from the ends of the range.
pub(crate) fn power_of_two_near(x: f64) -> f64 {
    f64::from_bits(x.clamp(1e-280, 1e280).to_bits() & 0x7ff0_0000_0000_0000)
}
