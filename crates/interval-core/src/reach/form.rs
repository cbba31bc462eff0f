//! Functions of the start as polynomials, with linear generators for what was added since, and one error.
//!
//! A form is the set of the numbers `p(s) + sum_j g_j t_j + e r` with all symbols `s_i`, `t_j` and `r` in \[-1, 1\]; `s` and
//! `t` are shared by all forms, `r` is not.
//!
//! **Theorem (inclusion).** The product of two forms lies in the form whose polynomial is the product up to the degree,
//! whose generators are those of either side times the constant of the other, and whose error is the sum of the moduli of
//! all that is left out, since every symbol has modulus at most 1. (Source: Makino and Berz, Int. J. Pure Appl. Math. 4
//! (2003), section 2; Comba and Stolfi 1993 for generators; Kühn, Computing 61 (1998), for zonotopes.)
//!
//! **Rounding.** Coefficients are plain doubles. A sum of at most `m` products of doubles, in any order, is wrong by at most
//! `m u / (1 - m u)` times the sum of the products' moduli, and `m` times half the least number. (Source: Higham 2002,
//! sections 3.1 and 3.5.) `2 m u` bounds the quotient; it is added to the error, all errors rounded up.

use super::basis::Basis;
use super::system::Enclosing;
use crate::interval::Interval;
use crate::rounding::{add_up, mul_up};

/// Twice the unit roundoff.
const TWO_UNITS: f64 = f64::EPSILON;

/// The least positive number, twice what a product loses by underflow.
const LEAST: f64 = f64::from_bits(1);

/// A polynomial in the symbols of the start, generators, and an error.
#[derive(Debug, Clone)]
pub struct Form {
    /// Coefficients by monomial.
    pub polynomial: Vec<f64>,
    /// One coefficient a generator.
    pub generators: Vec<f64>,
    /// Modulus of all else.
    pub error: f64,
}

/// Forms over one basis with a number of generators.
pub struct Forms<'a> {
    /// Monomials.
    pub basis: &'a Basis,
    /// Generators of each form.
    pub generators: usize,
}

/// The sum of the moduli, rounded up.
fn norm(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |sum, value| add_up(sum, value.abs()))
}

#[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
fn count(n: usize) -> f64 {
    n as f64
}

impl Forms<'_> {
    /// Sums of moduli by degree.
    fn norms(&self, a: &Form) -> Vec<f64> {
        let mut norms = vec![0.0; self.basis.degree + 1];
        for (&degree, value) in self.basis.degrees.iter().zip(&a.polynomial) {
            norms[degree] = add_up(norms[degree], value.abs());
        }
        norms
    }

    /// All numbers of a form; None where one overflowed.
    pub fn range(&self, a: &Form) -> Option<Interval> {
        let rest = add_up(norm(&a.generators), a.error);
        let monomials = self.basis.even.iter().zip(&self.basis.degrees).zip(&a.polynomial);
        let (lo, hi) = monomials.fold((-rest, rest), |(lo, hi), ((&even, &degree), &c)| {
            let (below, above) = match (degree, even) {
                (0, _) => (c, c),
                (_, true) => (c.min(0.0), c.max(0.0)),
                _ => (-c.abs(), c.abs()),
            };
            (-add_up(-lo, -below), add_up(hi, above))
        });
        let finite = a.polynomial.iter().chain(&a.generators).all(|c| c.is_finite());
        Interval::new(lo, hi).ok().filter(|range| finite && range.is_common())
    }
}

impl Enclosing for Forms<'_> {
    type Value = Form;

    fn constant(&self, c: Interval) -> Form {
        let mut polynomial = vec![0.0; self.basis.len()];
        polynomial[0] = c.midpoint();
        Form { polynomial, generators: vec![0.0; self.generators], error: c.radius() }
    }

    fn accumulate(&self, to: &mut Form, scale: Interval, a: &Form) {
        let (middle, radius) = (scale.midpoint(), scale.radius());
        let (mut before, mut added) = (0.0, a.error);
        let pairs = to.polynomial.iter_mut().zip(&a.polynomial);
        for (sum, &value) in pairs.chain(to.generators.iter_mut().zip(&a.generators)) {
            before = add_up(before, sum.abs());
            added = add_up(added, value.abs());
            *sum += middle * value;
        }
        let exact = mul_up(middle.abs(), a.error);
        let wide = mul_up(radius, added);
        // Two roundings: of the product and of the sum.
        let moduli = add_up(before, mul_up(middle.abs(), added));
        let rounding = mul_up(2.0 * TWO_UNITS, moduli);
        let underflow = LEAST * count(to.polynomial.len() + to.generators.len());
        to.error = [exact, wide, rounding, underflow].into_iter().fold(to.error, add_up);
    }

    fn accumulate_product(&self, to: &mut Form, a: &Form, b: &Form) {
        let mut moduli = add_up(norm(&to.polynomial), norm(&to.generators));
        for &[i, j, k] in &self.basis.products {
            to.polynomial[k] += a.polynomial[i] * b.polynomial[j];
        }
        let (left, right) = (a.polynomial[0], b.polynomial[0]);
        for (sum, (g, h)) in to.generators.iter_mut().zip(a.generators.iter().zip(&b.generators)) {
            *sum += left * h + right * g;
        }
        let (na, nb) = (self.norms(a), self.norms(b));
        let (ga, gb) = (norm(&a.generators), norm(&b.generators));
        let (curved_a, curved_b) = (norm(&na[1..]), norm(&nb[1..]));
        let (all_a, all_b) = (add_up(norm(&na), ga), add_up(norm(&nb), gb));
        let mut error = to.error;
        for (i, &x) in na.iter().enumerate() {
            for &y in &nb[self.basis.degree + 1 - i..] {
                error = add_up(error, mul_up(x, y));
            }
        }
        moduli = add_up(moduli, mul_up(all_a, all_b));
        let rounding = mul_up(TWO_UNITS * count(self.basis.meeting + 4), moduli);
        let underflow = LEAST * count(self.basis.products.len() + 2 * self.generators);
        let mixed = [mul_up(curved_a, gb), mul_up(curved_b, ga), mul_up(ga, gb)];
        let errors = [mul_up(a.error, all_b), mul_up(b.error, all_a), mul_up(a.error, b.error)];
        to.error = mixed.into_iter().chain(errors).chain([rounding, underflow]).fold(error, add_up);
    }
}
