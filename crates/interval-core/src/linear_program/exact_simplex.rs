//! The dual simplex method over the rationals. Its results are exact and proved.
//!
//! Duality is the proof. For multipliers `l >= 0` of half-spaces `g x <= h` with `c + G' l = 0`, every point of the
//! polyhedron satisfies `c x >= -h l`, with equality at the vertex of the basis. A half-space whose normal has only
//! coefficients `<= 0` in the basis, and which the vertex violates, contradicts the basis (Farkas).
//!
//! The search in floats proposes the basis to start at, which is nearly always the last one too.

use super::{HalfSpaces, Row, patience};
use crate::exact;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::ops::Range;

/// Half-spaces with their multipliers.
pub(crate) type Weights = Vec<(usize, BigRational)>;

/// The proved result of a linear program.
pub(crate) enum Proved {
    /// The minimum, and every half-space of the basis; `point` is the vertex.
    Minimum { value: BigRational, rows: Weights, point: Vec<BigRational> },
    /// The polyhedron has a point, and the objective is unbounded along this ray (rounded).
    Unbounded { ray: Vec<f64> },
    /// The polyhedron is empty; the multipliers are positive.
    Empty { rows: Weights },
}

/// The cost of one search at most, in operations on words: seconds. Numbers from both ends of the range of doubles have
/// thousands of digits, and grow with every unknown.
const BUDGET: u64 = 1_000_000_000;

/// The minimum of `direction * x[column]`, `direction` being 1 or -1, from a proposed basis. `None` where it would cost
/// too much, and for a contradiction that does not stand, which is not met.
pub(crate) fn minimum<P: HalfSpaces>(
    problem: &P,
    column: usize,
    direction: f64,
    proposal: Option<Vec<Row>>,
) -> Option<Proved> {
    let n = problem.dimension();
    let mut objective = vec![0.0; n];
    objective[column] = direction;
    let mut basis = proposal
        .and_then(|rows| Basis::new(problem, rows, &objective))
        .or_else(|| Basis::new(problem, Row::corner(&objective), &objective))?;
    let (mut steps, mut spent) = (0, 0);
    loop {
        spent += basis.cost();
        if spent > BUDGET {
            return None;
        }
        let vertex = Vertex::of(&basis);
        // Bland's rule cannot cycle in exact arithmetic, so the search ends.
        let Some(entering) = basis.violated(&vertex, steps > patience(n)) else {
            return Some(basis.finish(&vertex, column, direction));
        };
        let (alpha, h) = basis.coefficients(entering);
        match basis.leaving(&alpha) {
            Some(position) => basis.exchange(position, entering, &alpha, h),
            None => return basis.contradiction(entering, &alpha, &h).map(|rows| Proved::Empty { rows }),
        }
        steps += 1;
    }
}

/// A basis with non-negative multipliers of the objective.
struct Basis<'a, P: HalfSpaces> {
    problem: &'a P,
    rows: Vec<Row>,
    right: Vec<BigRational>,
    /// Inverse of the matrix of the rows, row-major: its column `i` belongs to `rows[i]`.
    inverse: Vec<BigRational>,
    multipliers: Vec<BigRational>,
}

impl<'a, P: HalfSpaces> Basis<'a, P> {
    /// `None` where the rows are dependent or a multiplier is negative.
    fn new(problem: &'a P, rows: Vec<Row>, objective: &[f64]) -> Option<Self> {
        let n = problem.dimension();
        let mut matrix = vec![0.0; n * n];
        let mut right = Vec::with_capacity(n);
        for (row, g) in rows.iter().zip(matrix.chunks_exact_mut(n)) {
            right.push(exact::rational(row.half_space(problem, g)));
        }
        let (_, inverse) = exact::inverse(&matrix, n)?;
        let objective: Vec<BigRational> = objective.iter().map(|&c| -exact::rational(c)).collect();
        let multipliers: Vec<BigRational> = (0..n).map(|i| dot(&objective, inverse[i..].iter().step_by(n))).collect();
        let feasible = multipliers.iter().all(|l| !l.is_negative());
        feasible.then_some(Self { problem, rows, right, inverse, multipliers })
    }

    /// The approximate cost of a step: with each entry of the inverse some fractions are reduced, in the square of
    /// their length.
    fn cost(&self) -> u64 {
        let bits = |x: &BigRational| x.numer().bits() + x.denom().bits();
        let longest = self.inverse.iter().chain(&self.multipliers).map(bits).max().unwrap_or(0);
        3 * self.inverse.len() as u64 * longest * longest.div_ceil(64)
    }

    /// The half-space that the vertex violates most (in units of its normal), at order `M` before the finite order;
    /// with `careful` the first one violated.
    fn violated(&self, vertex: &Vertex, careful: bool) -> Option<usize> {
        let mut g = vec![0.0; self.rows.len()];
        let mut worst: Option<(bool, f64, usize)> = None;
        for index in 0..self.problem.count() {
            let h = self.problem.half_space(index, &mut g);
            if h == f64::INFINITY || self.rows.contains(&Row::Given(index)) {
                continue;
            }
            let Some((at_large, amount)) = vertex.violation(&g, h) else { continue };
            if careful {
                return Some(index);
            }
            let amount = amount / g.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
            if worst.is_none_or(|(order, most, _)| (at_large, amount) > (order, most)) {
                worst = Some((at_large, amount, index));
            }
        }
        worst.map(|(_, _, index)| index)
    }

    /// Coefficients of a half-space's normal in the rows of the basis, and its right-hand side.
    fn coefficients(&self, entering: usize) -> (Vec<BigRational>, BigRational) {
        let n = self.rows.len();
        let mut g = vec![0.0; n];
        let h = exact::rational(self.problem.half_space(entering, &mut g));
        let g: Vec<BigRational> = g.into_iter().map(exact::rational).collect();
        ((0..n).map(|i| dot(&g, self.inverse[i..].iter().step_by(n))).collect(), h)
    }

    /// The position that keeps the multipliers non-negative: smallest ratio, then smallest order.
    fn leaving(&self, alpha: &[BigRational]) -> Option<usize> {
        (0..alpha.len())
            .filter(|&i| alpha[i].is_positive())
            .min_by_key(|&i| (&self.multipliers[i] / &alpha[i], self.rows[i].order()))
    }

    /// Puts a half-space in the place of a row: its normal is `sum alpha_i rows_i`, with `alpha[position] > 0`.
    fn exchange(&mut self, position: usize, entering: usize, alpha: &[BigRational], h: BigRational) {
        self.rows[position] = Row::Given(entering);
        self.right[position] = h;
        let n = alpha.len();
        for row in self.inverse.chunks_exact_mut(n).chain([self.multipliers.as_mut_slice()]) {
            let share = &row[position] / &alpha[position];
            for (x, a) in row.iter_mut().zip(alpha) {
                *x -= a * &share;
            }
            row[position] = share;
        }
    }

    /// The proof that no point satisfies the basis and the half-space:
    /// `g x = sum alpha_i g_i x >= sum alpha_i h_i > h`.
    fn contradiction(&self, entering: usize, alpha: &[BigRational], h: &BigRational) -> Option<Weights> {
        let stands =
            self.rows.iter().zip(alpha).all(|(row, a)| a.is_zero() || (a.is_negative() && !row.is_at_infinity()))
                && dot(alpha, self.right.iter()) > *h;
        let opposite: Vec<BigRational> = alpha.iter().map(|a| -a).collect();
        let mut rows = self.weights(&opposite);
        rows.retain(|(_, l)| !l.is_zero());
        rows.push((entering, BigRational::one()));
        stands.then_some(rows)
    }

    fn finish(self, vertex: &Vertex, column: usize, direction: f64) -> Proved {
        let open = self.rows.iter().zip(&self.multipliers).any(|(row, l)| row.is_at_infinity() && !l.is_zero());
        if open {
            return Proved::Unbounded { ray: vertex.ray.iter().map(nearest).collect() };
        }
        let value = &vertex.point[column] * exact::rational(direction);
        Proved::Minimum { value, rows: self.weights(&self.multipliers), point: vertex.point.clone() }
    }

    /// The given half-spaces of the basis with their multipliers.
    fn weights(&self, multipliers: &[BigRational]) -> Weights {
        let given = |(row, l): (&Row, &BigRational)| match row {
            Row::Given(index) => Some((*index, l.clone())),
            Row::AtInfinity { .. } => None,
        };
        self.rows.iter().zip(multipliers).filter_map(given).collect()
    }
}

/// The vertex of a basis, `point + M ray`.
struct Vertex {
    point: Vec<BigRational>,
    ray: Vec<BigRational>,
    near_point: Vec<f64>,
    near_ray: Vec<f64>,
    bounded: bool,
}

impl Vertex {
    fn of<P: HalfSpaces>(basis: &Basis<'_, P>) -> Self {
        let n = basis.rows.len();
        let large: Vec<BigRational> = basis
            .rows
            .iter()
            .map(|row| if row.is_at_infinity() { BigRational::one() } else { BigRational::zero() })
            .collect();
        let image = |v: &[BigRational]| -> Vec<BigRational> {
            basis.inverse.chunks_exact(n).map(|row| dot(row, v.iter())).collect()
        };
        let (point, ray) = (image(&basis.right), image(&large));
        let near = |x: &[BigRational]| x.iter().map(trusted).collect();
        let (near_point, near_ray) = (near(&point), near(&ray));
        Self { point, ray, near_point, near_ray, bounded: large.iter().all(Zero::is_zero) }
    }

    /// By how much `g x <= h` is violated, and whether at order `M`. The value is `None` if it holds.
    fn violation(&self, g: &[f64], h: f64) -> Option<(bool, f64)> {
        if !self.bounded {
            let large = difference(g, 0.0, &self.ray, &self.near_ray);
            if large != 0.0 {
                return (large > 0.0).then_some((true, large));
            }
        }
        let finite = difference(g, h, &self.point, &self.near_point);
        (finite > 0.0).then_some((false, finite))
    }
}

/// Beyond these magnitudes an error need not be relative, or a sum may overflow.
const TRUSTED: Range<f64> = 1e-280..1e280;
/// A scalar product of `n` floats near the exact ones is off by less than `n + 4` relative errors of 2^-52: this is
/// more.
const DOUBT: f64 = 1e-12;

/// The nearest float, or NaN where its error need not be relative.
fn trusted(x: &BigRational) -> f64 {
    let near = nearest(x);
    if x.is_zero() || TRUSTED.contains(&near.abs()) { near } else { f64::NAN }
}

fn nearest(x: &BigRational) -> f64 {
    x.to_f64().unwrap_or(f64::NAN)
}

/// A number with the sign of `g x - h`: in floats where their error cannot change it, else exactly.
fn difference(g: &[f64], h: f64, x: &[BigRational], near: &[f64]) -> f64 {
    let (mut sum, mut size) = (-h, h.abs());
    for (a, b) in g.iter().zip(near) {
        let term = a * b;
        sum += term;
        size += term.abs();
    }
    // NaN fails both comparisons.
    if TRUSTED.contains(&size) && sum.abs() > DOUBT * size {
        return sum;
    }
    let exactly =
        g.iter().zip(x).filter(|(a, _)| **a != 0.0).fold(-exact::rational(h), |s, (a, b)| s + exact::rational(*a) * b);
    match nearest(&exactly) {
        // A difference below the range of floats keeps its sign.
        0.0 if exactly.is_positive() => f64::MIN_POSITIVE,
        0.0 if exactly.is_negative() => -f64::MIN_POSITIVE,
        near => near,
    }
}

/// The scalar product, terms with a zero left out.
fn dot<'b>(a: &[BigRational], b: impl Iterator<Item = &'b BigRational>) -> BigRational {
    a.iter().zip(b).filter(|(x, y)| !x.is_zero() && !y.is_zero()).fold(BigRational::zero(), |sum, (x, y)| sum + x * y)
}
