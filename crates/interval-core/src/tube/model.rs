//! The equations of motion `M(theta) nu' + sum theta_j c_j(nu) = F` with `theta` in a polytope, and their
//! accelerations.
//!
//! **Lemma (vertices).** For fixed velocities, forces and other accelerations, row i gives
//! `nu_i' = N(theta) / D(theta)` with N and D affine. If D > 0 at the vertices of the polytope, then `nu_i'` lies
//! between the least and the largest quotient at the vertices: with `theta = sum a_v theta_v`, the quotient is the
//! mean of the vertices' quotients with the weights `a_v D(theta_v) > 0`. (Quotients of affine functions are quasi-convex
//! and quasi-concave: Boyd and Vandenberghe, Convex Optimization, 2004, section 3.4.)
//!
//! Vertices are boxes: an interval vertex stands for the hull of all its members, so that rounded vertices, a box
//! instead of a polytope, and known numbers in intervals need no case of their own.

use super::program::{Moving, Op, run};
use crate::error::Error;
use crate::interval::Interval;

/// Velocities, accelerations or forces in surge, sway and yaw.
pub type Three = [Interval; 3];

/// A term's part in one channel.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Number of the term.
    pub term: usize,
    /// The register that holds the column's part without accelerations, or none.
    pub register: Option<usize>,
    /// The column's factors of u', v' and r'.
    pub inertia: [f64; 3],
}

/// A model: columns by channel, and the vertices of its parameters.
#[derive(Debug, Clone)]
pub struct Model {
    program: Vec<Op>,
    channels: [Vec<Entry>; 3],
    vertices: [Vec<Vec<Interval>>; 3],
    hull: Vec<Interval>,
    /// Which of u, v, r follow the equations; the others are given.
    pub free: [bool; 3],
}

/// Registers that are used again from step to step.
#[derive(Debug, Default)]
pub struct Work {
    values: Vec<Interval>,
    moving: Vec<Moving>,
}

impl Model {
    /// A model.
    ///
    /// # Arguments
    /// `vertices` holds for each channel the vertices of the parameters that act in it, one interval a term. Their
    /// hull over all channels has to contain every parameter.
    ///
    /// # Errors
    /// Registers that are not filled, terms without a parameter, a channel without a vertex, an empty interval.
    pub fn new(
        program: Vec<Op>,
        channels: [Vec<Entry>; 3],
        vertices: [Vec<Vec<Interval>>; 3],
        hull: Vec<Interval>,
        free: [bool; 3],
    ) -> Result<Self, Error> {
        let unfit = |what, given, needed| Err(Error::Shape { what, given, needed });
        for (k, op) in program.iter().enumerate() {
            if let Some(&a) = op.operands().iter().flatten().find(|&&a| a >= k + 3) {
                return unfit("an operand of the program", a, k + 3);
            }
        }
        for entry in channels.iter().flatten() {
            if entry.term >= hull.len() {
                return unfit("a term of the model", entry.term, hull.len());
            }
            if let Some(a) = entry.register.filter(|&a| a >= program.len() + 3) {
                return unfit("a column of the model", a, program.len() + 3);
            }
        }
        for points in &vertices {
            if points.is_empty() {
                return Err(Error::Zero { what: "the number of vertices of a channel" });
            }
            if let Some(p) = points.iter().find(|p| p.len() != hull.len()) {
                return unfit("a vertex", p.len(), hull.len());
            }
        }
        if let Some(index) = vertices.iter().flatten().flatten().chain(&hull).position(|x| !x.is_common()) {
            return Err(Error::NoFinitePoint { index });
        }
        Ok(Self { program, channels, vertices, hull, free })
    }

    /// The registers of the program over a box.
    pub fn registers<'w>(&self, nu: &Three, work: &'w mut Work) -> &'w [Interval] {
        work.values.clear();
        work.values.extend_from_slice(nu);
        run(&self.program, &mut work.values);
        &work.values
    }

    /// `F_i - sum theta_j c_ji(nu) - sum_{k != i} M_ik nu_k'` at one vertex.
    fn rest(&self, i: usize, vertex: &[Interval], values: &[Interval], force: Interval, rates: &Three) -> Interval {
        let mut total = force;
        for e in &self.channels[i] {
            let mut part = e.register.map_or(Interval::ZERO, |a| values[a]);
            for k in 0..3 {
                if k != i && e.inertia[k] != 0.0 {
                    part = part + Interval::raw(e.inertia[k], e.inertia[k]) * rates[k];
                }
            }
            total = total - vertex[e.term] * part;
        }
        total
    }

    /// `M_ik` at one vertex.
    #[must_use]
    pub fn mass(&self, i: usize, k: usize, vertex: &[Interval]) -> Interval {
        let mut total = Interval::ZERO;
        for e in &self.channels[i] {
            if e.inertia[k] != 0.0 {
                total = total + vertex[e.term] * Interval::raw(e.inertia[k], e.inertia[k]);
            }
        }
        total
    }

    /// Whether row i has a positive inertia at every vertex, which the lemma needs.
    fn positive(&self, i: usize) -> bool {
        self.vertices[i].iter().all(|v| self.mass(i, i, v).lo() > 0.0)
    }

    /// The range of `nu_i'` by row i alone, given the other accelerations; needs `positive(i)`.
    fn quotient(&self, i: usize, values: &[Interval], force: Interval, rates: &Three) -> Interval {
        let mut found = Interval::EMPTY;
        for v in &self.vertices[i] {
            found = found.hull(self.rest(i, v, values, force, rates) / self.mass(i, i, v));
        }
        found
    }

    /// Accelerations over a box of velocities under all forces of a box; `given` holds those of components that are not
    /// free. None where no bound is found.
    ///
    /// Cramer's rule over the parameters' hull gives the first bounds, and two sweeps of Gauss-Seidel over the vertices
    /// narrow them: every acceleration satisfies each row.
    pub fn accelerations(&self, nu: &Three, force: &Three, given: &Three, work: &mut Work) -> Option<Three> {
        let mut rates = *given;
        let free: Vec<usize> = (0..3).filter(|&i| self.free[i]).collect();
        if !free.iter().all(|&i| self.positive(i)) {
            return None;
        }
        self.registers(nu, work);
        let values = &work.values;
        for &i in &free {
            rates[i] = Interval::ZERO;
        }
        let right: Vec<Interval> = free.iter().map(|&i| self.rest(i, &self.hull, values, force[i], &rates)).collect();
        let matrix: Vec<Vec<Interval>> =
            free.iter().map(|&i| free.iter().map(|&k| self.mass(i, k, &self.hull)).collect()).collect();
        let first = cramer(&matrix, &right)?;
        for (&i, &x) in free.iter().zip(&first) {
            rates[i] = x;
        }
        for _ in 0..2 {
            for &i in &free {
                rates[i] = rates[i].intersection(self.quotient(i, values, force[i], &rates));
            }
        }
        rates.iter().all(|x| x.is_common()).then_some(rates)
    }

    /// The range of `nu_i'` over a face, given the other accelerations.
    pub fn on_face(&self, i: usize, nu: &Three, force: Interval, rates: &Three, work: &mut Work) -> Interval {
        self.registers(nu, work);
        self.quotient(i, &work.values, force, rates)
    }

    /// The range of the rate of `nu_i'` over a box, while the velocities move at `rates` and all accelerations on the
    /// right of row i stand still.
    pub fn drift(&self, i: usize, nu: &Three, rates: &Three, work: &mut Work) -> Interval {
        work.moving.clear();
        work.moving.extend((0..3).map(|k| Moving { value: nu[k], rate: rates[k] }));
        run(&self.program, &mut work.moving);
        let mut found = Interval::EMPTY;
        for v in &self.vertices[i] {
            let mut total = Interval::ZERO;
            for e in &self.channels[i] {
                if let Some(a) = e.register {
                    total = total - v[e.term] * work.moving[a].rate;
                }
            }
            found = found.hull(total / self.mass(i, i, v));
        }
        found
    }

    /// Accelerations in plain floats at one parameter; None for a singular matrix.
    pub fn float_accelerations(
        &self,
        theta: &[f64],
        nu: [f64; 3],
        force: [f64; 3],
        given: [f64; 3],
        registers: &mut Vec<f64>,
    ) -> Option<[f64; 3]> {
        registers.clear();
        registers.extend_from_slice(&nu);
        run(&self.program, registers);
        let mut matrix = [[0.0; 3]; 3];
        let mut right = force;
        for i in 0..3 {
            if !self.free[i] {
                (matrix[i], matrix[i][i], right[i]) = ([0.0; 3], 1.0, given[i]);
                continue;
            }
            for e in &self.channels[i] {
                right[i] -= theta[e.term] * e.register.map_or(0.0, |a| registers[a]);
                for k in 0..3 {
                    matrix[i][k] += theta[e.term] * e.inertia[k];
                }
            }
        }
        let minor = |a: usize, b: usize| {
            let (p, q, s, t) = ((a + 1) % 3, (a + 2) % 3, (b + 1) % 3, (b + 2) % 3);
            matrix[p][s] * matrix[q][t] - matrix[p][t] * matrix[q][s]
        };
        let determinant: f64 = (0..3).map(|k| matrix[0][k] * minor(0, k)).sum();
        let solved: [f64; 3] =
            std::array::from_fn(|i| (0..3).map(|k| minor(k, i) * right[k]).sum::<f64>() / determinant);
        solved.iter().all(|x| x.is_finite()).then_some(solved)
    }

    /// The operations of the columns.
    #[must_use]
    pub fn program(&self) -> &[Op] {
        &self.program
    }

    /// The columns of channel i.
    #[must_use]
    pub fn entries(&self, i: usize) -> &[Entry] {
        &self.channels[i]
    }

    /// The vertices of the parameters of channel i.
    #[must_use]
    pub fn vertices(&self, i: usize) -> &[Vec<Interval>] {
        &self.vertices[i]
    }

    /// The hull of the parameters.
    #[must_use]
    pub fn hull(&self) -> &[Interval] {
        &self.hull
    }
}

/// Bounds of the solutions of up to three equations by Cramer's rule; None where a member may be singular.
fn cramer(matrix: &[Vec<Interval>], right: &[Interval]) -> Option<Vec<Interval>> {
    let whole = determinant(matrix);
    if whole.contains(0.0) {
        return None;
    }
    let solved = (0..right.len()).map(|j| {
        let mut changed = matrix.to_vec();
        for (row, &b) in changed.iter_mut().zip(right) {
            row[j] = b;
        }
        determinant(&changed) / whole
    });
    Some(solved.collect())
}

fn determinant(m: &[Vec<Interval>]) -> Interval {
    match m.len() {
        0 => Interval::ONE,
        1 => m[0][0],
        2 => m[0][0] * m[1][1] - m[0][1] * m[1][0],
        _ => {
            let minor = |k: usize| {
                let (s, t) = ((k + 1) % 3, (k + 2) % 3);
                m[1][s] * m[2][t] - m[1][t] * m[2][s]
            };
            m[0][0] * minor(0) + m[0][1] * minor(1) + m[0][2] * minor(2)
        }
    }
}
