//! Right-hand sides that are polynomials, stated as tables of coefficients, and the Taylor coefficients of solutions.
//!
//! **Theorem (recursion of Taylor coefficients).** Let `x' = f(x)` with polynomial `f`, and write `(y)_k` for the k-th
//! Taylor coefficient of `y` along a solution. Then `(x)_{k+1} = (f(x))_k / (k + 1)` and
//! `(y z)_k = sum_{j <= k} (y)_j (z)_{k-j}`. (Leibniz' rule. Source: Moore 1979, section 3.4; Griewank and Walther 2008,
//! section 13.2.) The recursion is carried out once for intervals and once for forms, by the same code.

use crate::error::Error;
use crate::interval::Interval;

/// Operations that enclose those of real numbers.
pub trait Enclosing {
    /// What encloses a number, or a function of the start.
    type Value: Clone;
    /// A number of an interval.
    fn constant(&self, c: Interval) -> Self::Value;
    /// `to + scale * a`.
    fn accumulate(&self, to: &mut Self::Value, scale: Interval, a: &Self::Value);
    /// `to + a b`.
    fn accumulate_product(&self, to: &mut Self::Value, a: &Self::Value, b: &Self::Value);
}

/// One term of a polynomial: a coefficient and the power of each component.
#[derive(Debug, Clone)]
pub struct Term {
    /// An interval that holds the coefficient, which does not change in time.
    pub coefficient: Interval,
    /// Powers, one a component of the state.
    pub powers: Vec<u32>,
}

/// An autonomous system of polynomial differential equations, its monomials as a sequence of binary products.
#[derive(Debug, Clone)]
pub struct System {
    dimension: usize,
    /// Product `k` is node `dimension + k`; nodes below `dimension` are the components.
    products: Vec<(usize, usize)>,
    /// Coefficients of each equation with their nodes; None is the monomial 1.
    equations: Vec<Vec<(Interval, Option<usize>)>>,
}

impl System {
    /// The system whose component `i` has the terms `equations[i]` as its derivative.
    ///
    /// # Errors
    /// Powers of another number than there are equations are refused.
    pub fn new(equations: &[Vec<Term>]) -> Result<Self, Error> {
        let dimension = equations.len();
        let mut products = Vec::new();
        let mut stated = Vec::with_capacity(dimension);
        for equation in equations {
            let mut terms = Vec::with_capacity(equation.len());
            for term in equation {
                let given = term.powers.len();
                if given != dimension {
                    return Err(Error::Shape { what: "powers of a term", given, needed: dimension });
                }
                terms.push((term.coefficient, node(dimension, &mut products, &term.powers)));
            }
            stated.push(terms);
        }
        Ok(Self { dimension, products, equations: stated })
    }

    /// Components of the state.
    #[must_use]
    pub const fn dimension(&self) -> usize {
        self.dimension
    }

    /// Taylor coefficients 0 to `order` of the solutions through `start`, `[order][component]`.
    pub fn series<A: Enclosing>(&self, algebra: &A, start: &[A::Value], order: usize) -> Vec<Vec<A::Value>> {
        let zero = algebra.constant(Interval::ZERO);
        let mut series: Vec<Vec<A::Value>> = vec![start.to_vec()];
        for k in 0..order {
            for &(left, right) in &self.products {
                let mut sum = zero.clone();
                for j in 0..=k {
                    algebra.accumulate_product(&mut sum, &series[j][left], &series[k - j][right]);
                }
                series[k].push(sum);
            }
            let next = self.derivative(algebra, &series[k], k);
            series.push(next);
        }
        for nodes in &mut series {
            nodes.truncate(self.dimension);
        }
        series
    }

    /// Coefficients `k + 1` from the nodes' coefficients `k`.
    fn derivative<A: Enclosing>(&self, algebra: &A, nodes: &[A::Value], k: usize) -> Vec<A::Value> {
        #[allow(clippy::cast_precision_loss, reason = "orders are small")]
        let share = Interval::raw((k + 1) as f64, (k + 1) as f64).recip();
        let equation = |terms: &Vec<(Interval, Option<usize>)>| {
            let mut sum = algebra.constant(Interval::ZERO);
            for &(coefficient, node) in terms {
                match node {
                    Some(node) => algebra.accumulate(&mut sum, coefficient * share, &nodes[node]),
                    // A constant has no coefficients of higher order.
                    None if k == 0 => algebra.accumulate(&mut sum, coefficient, &algebra.constant(Interval::ONE)),
                    None => {}
                }
            }
            sum
        };
        self.equations.iter().map(equation).collect()
    }
}

/// The node of a monomial, with those that it needs; equal products are made once.
fn node(dimension: usize, products: &mut Vec<(usize, usize)>, powers: &[u32]) -> Option<usize> {
    let factors = powers.iter().enumerate().flat_map(|(i, &power)| std::iter::repeat_n(i, power as usize));
    factors.fold(None, |before, factor| {
        let Some(before) = before else { return Some(factor) };
        let known = products.iter().position(|&pair| pair == (before, factor));
        Some(
            dimension
                + known.unwrap_or_else(|| {
                    products.push((before, factor));
                    products.len() - 1
                }),
        )
    })
}

/// Plain intervals.
pub struct Boxes;

impl Enclosing for Boxes {
    type Value = Interval;

    fn constant(&self, c: Interval) -> Interval {
        c
    }

    fn accumulate(&self, to: &mut Interval, scale: Interval, a: &Interval) {
        *to = *to + scale * *a;
    }

    fn accumulate_product(&self, to: &mut Interval, a: &Interval, b: &Interval) {
        *to = *to + *a * *b;
    }
}
