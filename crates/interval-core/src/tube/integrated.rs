//! The row of yaw integrated from the start of a tube: parameters that stay what they are, and errors of forces as integrals.
//!
//! **Theorem.** Along every solution row i reads `sum_k M_ik nu_k' + sum_j theta_j c_ji(nu) = F_i` almost everywhere. With
//! one `theta` for the whole run its integral from 0 to T is
//!
//! `sum_k M_ik (nu_k(T) - nu_k(0)) + sum_j theta_j S_ji = G_i`, `S_ji` the integral of `c_ji(nu)` and `G_i` that of `F_i`.
//!
//! That is a row as the lemma of vertices (`model`) takes it: `nu_i(T) - nu_i(0)` lies between its least and its largest
//! quotient at the vertices, for each solution at its own `S`, `G` and other differences, all inside known ranges. `S` and
//! `G` add `H` times the ranges over each step (mean value theorem for integrals). (A first integral of the motion, the
//! momentum of the turn: Fossen 2011, section 6.3.)
//!
//! **Corollary.** Any numbers times the other rows may be taken from row i first; parameters of those rows then stand
//! there by their hull. With `M_ik / M_kk` that moves the momentum of the turn to the centre of gravity, where what turns
//! with the vehicle cancels.
//!
//! A box that is followed step by step lets the parameters change from step to step. A row that is integrated does not.

use super::enclosure::Enclosure;
use super::model::{Model, Three, Work};
use super::program::Op;
use crate::interval::Interval;

/// The component that is bounded: yaw alone may lack damping, and where there is some, the comparison is narrower.
const YAW: usize = 2;

/// A row of yaw at one vertex of its parameters.
#[derive(Debug, Clone)]
struct Vertex {
    columns: Vec<(usize, Interval)>,
    inertia: [Interval; 3],
}

/// The row of yaw, less multiples of those of surge and sway.
#[derive(Debug, Clone)]
pub struct Row {
    multiples: [Interval; 2],
    vertices: Vec<Vertex>,
}

impl Row {
    /// The row as it stands, and the one about the centre of gravity; none without a positive inertia.
    #[must_use]
    pub fn all(model: &Model) -> Vec<Self> {
        let hull = model.hull();
        let ratio = |k: usize| {
            let x = model.mass(YAW, k, hull).midpoint() / model.mass(k, k, hull).midpoint();
            if x.is_finite() { Interval::raw(x, x) } else { Interval::ZERO }
        };
        let about = [ratio(0), ratio(1)];
        let plain = [Interval::ZERO; 2];
        let wanted = if about == plain { vec![plain] } else { vec![plain, about] };
        wanted.into_iter().filter_map(|multiples| Self::of(model, multiples)).collect()
    }

    fn of(model: &Model, multiples: [Interval; 2]) -> Option<Self> {
        let hull = model.hull();
        let vertices = model.vertices(YAW).iter().map(|vertex| {
            let mut columns: Vec<(usize, Interval)> = Vec::new();
            let mut inertia: [Interval; 3] = std::array::from_fn(|k| model.mass(YAW, k, vertex));
            let mut add = |i: usize, factor: Interval, theta: &[Interval]| {
                for e in model.entries(i) {
                    let Some(register) = e.register else { continue };
                    let (base, sign) = unsigned(model.program(), register);
                    let x = factor * Interval::raw(sign, sign) * theta[e.term];
                    match columns.iter_mut().find(|(a, _)| *a == base) {
                        Some((_, total)) => *total = *total + x,
                        None => columns.push((base, x)),
                    }
                }
            };
            add(YAW, Interval::ONE, vertex);
            for i in 0..2 {
                if multiples[i] != Interval::ZERO {
                    add(i, -multiples[i], hull);
                    for (k, total) in inertia.iter_mut().enumerate() {
                        *total = *total - multiples[i] * model.mass(i, k, hull);
                    }
                }
            }
            Vertex { columns, inertia }
        });
        let vertices: Vec<Vertex> = vertices.collect();
        vertices.iter().all(|v| v.inertia[YAW].lo() > 0.0).then_some(Self { multiples, vertices })
    }
}

/// The register without its changes of sign, and the sign.
fn unsigned(program: &[Op], mut register: usize) -> (usize, f64) {
    let mut sign = 1.0;
    while let Some(Op::Neg(a)) = register.checked_sub(3).and_then(|k| program.get(k)) {
        (register, sign) = (*a, -sign);
    }
    (register, sign)
}

/// What is known of the integrals since the start.
#[derive(Debug, Clone)]
pub struct Integrals {
    start: Three,
    registers: Vec<Interval>,
    force: Three,
}

impl Integrals {
    /// Nothing is integrated yet.
    #[must_use]
    pub fn new(start: &Three) -> Self {
        Self { start: *start, registers: Vec::new(), force: [Interval::ZERO; 3] }
    }

    /// What is true of the solutions of both, which have run as long.
    pub fn join(&mut self, other: &Self) {
        let Self { start, registers, force } = self;
        let mine = start.iter_mut().chain(registers).chain(force);
        let theirs = other.start.iter().chain(&other.registers).chain(&other.force);
        for (total, &more) in mine.zip(theirs) {
            *total = total.hull(more);
        }
    }

    /// Adds a part of a step.
    pub fn add(&mut self, model: &Model, step: &Enclosure, force: &Three, h: Interval, work: &mut Work) {
        let values = model.registers(&step.nu, work);
        self.registers.resize(values.len(), Interval::ZERO);
        for (total, &value) in self.registers.iter_mut().zip(values) {
            *total = *total + h * value;
        }
        for (total, &f) in self.force.iter_mut().zip(force) {
            *total = *total + h * f;
        }
    }

    /// The yaw rate now by a row, where the other velocities are known by now.
    #[must_use]
    pub fn yaw(&self, row: &Row, now: &Three) -> Interval {
        let mut force = self.force[YAW];
        for (&multiple, &f) in row.multiples.iter().zip(&self.force) {
            force = force - multiple * f;
        }
        let mut found = Interval::EMPTY;
        for vertex in &row.vertices {
            let mut rest = force;
            for &(a, x) in &vertex.columns {
                rest = rest - x * self.registers[a];
            }
            for k in 0..YAW {
                rest = rest - vertex.inertia[k] * (now[k] - self.start[k]);
            }
            found = found.hull(rest / vertex.inertia[YAW]);
        }
        self.start[YAW] + found
    }
}
