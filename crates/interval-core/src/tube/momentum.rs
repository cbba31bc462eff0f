//! A bound of the momentum that no turn changes: why a tube stays finite however wide its yaw rate is.
//!
//! **Theorem.** Let `p = (p_u, p_v)`, `p_u = sum_k M_0k nu_k`, `p_v = sum_k M_1k nu_k`. Where the columns of inertia are those
//! of a turning frame, `-r p_v` in surge and `r p_u` in sway, one `theta` for the whole run gives
//! `p_u' = r p_v + f_u`, `p_v' = -r p_u + f_v` with `f` the forces less the columns without inertia (Kirchhoff; Fossen 2011,
//! section 6.3), so that `|p| |p|' = p f`: the turn does no work. If `sigma >= 0` bounds `p f / |p|` wherever `|p| >= c` in the
//! box B of the step, and `|p| <= c` at its start, then `|p| <= c + sigma t` over the step. (After the last time with
//! `|p| <= c` the rate is at most sigma.)
//!
//! The circle of directions is covered by boxes of its sines and cosines; in each, `p = s (cos, sin)` with `s >= c` bounds
//! u and v from inside, so that drag outgrows the forces where c is large: sigma is 0 there, and c stays.

use super::model::{Entry, Model, Three, Work};
use super::program::Op;
use crate::interval::Interval;
use crate::rounding::{add_up, mul_up};
use std::collections::BTreeMap;

/// Parts of a quarter of the circle.
const QUARTER: u32 = 4;
/// Largest coefficient of a polynomial whose sums and products are taken as exact: far below 2^53.
const LARGEST: f64 = 1e6;

/// A polynomial of u, v, r with whole coefficients, by exponents.
type Polynomial = BTreeMap<[u8; 3], f64>;

/// The columns of surge and sway without inertia, of a model whose other columns are those of a turning frame.
#[derive(Debug, Clone)]
pub struct Momentum {
    forces: [Vec<Entry>; 2],
    directions: Vec<[Interval; 2]>,
}

fn product(a: &Polynomial, b: &Polynomial) -> Option<Polynomial> {
    let mut made = Polynomial::new();
    for (i, x) in a {
        for (j, y) in b {
            *made.entry(std::array::from_fn(|k| i[k] + j[k])).or_insert(0.0) += x * y;
        }
    }
    kept(made)
}

fn sum(a: &Polynomial, b: &Polynomial, sign: f64) -> Option<Polynomial> {
    let mut made = a.clone();
    for (j, y) in b {
        *made.entry(*j).or_insert(0.0) += sign * y;
    }
    kept(made)
}

/// None where a coefficient is not whole or too large, or an exponent could overflow; zeros are dropped.
fn kept(mut made: Polynomial) -> Option<Polynomial> {
    made.retain(|_, x| *x != 0.0);
    let fit = |(e, x): (&[u8; 3], &f64)| x.fract() == 0.0 && x.abs() <= LARGEST && e.iter().all(|&k| k < 16);
    made.iter().all(fit).then_some(made)
}

/// The registers as polynomials; None for those that are not.
fn polynomials(program: &[Op]) -> Vec<Option<Polynomial>> {
    let mut found: Vec<Option<Polynomial>> =
        (0..3).map(|i| Some(Polynomial::from([(std::array::from_fn(|k| u8::from(k == i)), 1.0)]))).collect();
    for &op in program {
        let at = |a: usize| found[a].as_ref();
        let both = |a: usize, b: usize| at(a).zip(at(b));
        let made = match op {
            Op::Constant(x) => kept(Polynomial::from([([0; 3], x)])),
            Op::Add(a, b) => both(a, b).and_then(|(x, y)| sum(x, y, 1.0)),
            Op::Sub(a, b) => both(a, b).and_then(|(x, y)| sum(x, y, -1.0)),
            Op::Mul(a, b) => both(a, b).and_then(|(x, y)| product(x, y)),
            Op::Neg(a) => at(a).and_then(|x| sum(&Polynomial::new(), x, -1.0)),
            Op::Square(a) => at(a).and_then(|x| product(x, x)),
            _ => None,
        };
        found.push(made);
    }
    found
}

impl Momentum {
    /// The columns of a model, where its inertia is that of a turning frame.
    #[must_use]
    pub fn of(model: &Model) -> Option<Self> {
        let polynomials = polynomials(model.program());
        let zero = Polynomial::new();
        let inertial = |e: &Entry| e.inertia != [0.0; 3];
        let terms: Vec<usize> = (0..2).flat_map(|i| model.entries(i)).filter(|e| inertial(e)).map(|e| e.term).collect();
        for &term in &terms {
            let mut factors = [[0.0; 3]; 2];
            let mut columns = [zero.clone(), zero.clone()];
            for i in 0..2 {
                for e in model.entries(i).iter().filter(|e| e.term == term) {
                    for (total, x) in factors[i].iter_mut().zip(e.inertia) {
                        *total += x;
                    }
                    if let Some(a) = e.register {
                        columns[i] = sum(&columns[i], polynomials[a].as_ref()?, 1.0)?;
                    }
                }
            }
            // p_u of v, and p_v of u, would need two equations for each direction below.
            if factors[0][1] != 0.0 || factors[1][0] != 0.0 {
                return None;
            }
            for (i, other, sign) in [(0, 1, -1.0), (1, 0, 1.0)] {
                let mut turned = Polynomial::new();
                for k in 0..3 {
                    let power = std::array::from_fn(|j| u8::from(j == k) + u8::from(j == 2));
                    turned.insert(power, sign * factors[other][k]);
                }
                if columns[i] != kept(turned)? {
                    return None;
                }
            }
        }
        let hull = model.hull();
        if (0..2).any(|i| model.mass(i, i, hull).lo() <= 0.0) {
            return None;
        }
        let forces =
            std::array::from_fn(|i| model.entries(i).iter().filter(|e| !terms.contains(&e.term)).copied().collect());
        Some(Self { forces, directions: directions()? })
    }

    /// `|p|` over a box, at most.
    #[must_use]
    pub fn size(model: &Model, nu: &Three) -> f64 {
        let part = |i: usize| model.mass(i, i, model.hull()) * nu[i] + model.mass(i, 2, model.hull()) * nu[2];
        (part(0).square() + part(1).square()).sqrt().hi()
    }

    /// The bound after a step over the box `nu`, from a bound c before it.
    pub fn after(&self, model: &Model, c: f64, nu: &Three, force: &Three, h: Interval, work: &mut Work) -> f64 {
        let largest = Self::size(model, nu);
        if largest <= c {
            return largest;
        }
        let (hull, size) = (model.hull(), Interval::raw(c, largest));
        let mut rate = 0.0_f64;
        for direction in &self.directions {
            let mut part = *nu;
            for i in 0..2 {
                let p = direction[i] * size;
                part[i] = part[i].intersection((p - model.mass(i, 2, hull) * nu[2]) / model.mass(i, i, hull));
            }
            if part[0].is_empty() || part[1].is_empty() {
                continue;
            }
            let values = model.registers(&part, work);
            let mut power = Interval::ZERO;
            for i in 0..2 {
                let mut push = force[i];
                for e in &self.forces[i] {
                    push = push - hull[e.term] * e.register.map_or(Interval::ZERO, |a| values[a]);
                }
                power = power + direction[i] * push;
            }
            // Not a number counts as no bound.
            rate = if power.hi() <= rate { rate } else { power.hi() };
        }
        largest.min(add_up(c, mul_up(rate, h.hi())))
    }

    /// A box cut to what `|p| <= c` leaves of it.
    #[must_use]
    pub fn within(model: &Model, c: f64, nu: &Three) -> Three {
        let mut cut = *nu;
        for i in 0..2 {
            let p = Interval::raw(-c, c);
            let reach = (p - model.mass(i, 2, model.hull()) * nu[2]) / model.mass(i, i, model.hull());
            cut[i] = nu[i].intersection(reach);
        }
        cut
    }
}

/// Boxes of cosine and sine that cover the circle.
fn directions() -> Option<Vec<[Interval; 2]>> {
    let number = |x: u32| Interval::new(f64::from(x), f64::from(x)).ok();
    let parts = number(QUARTER)?;
    let mut found = Vec::new();
    for k in 0..QUARTER {
        let cosine = (number(k)? / parts).hull(number(k + 1)? / parts);
        let sine = (Interval::ONE - cosine.square()).sqrt();
        for (a, b) in [(cosine, sine), (-cosine, sine), (cosine, -sine), (-cosine, -sine)] {
            found.push([a, b]);
        }
    }
    Some(found)
}
