//! Trajectories of single members in plain floats: how much of a tube is attained. Nothing here bounds a set.

use super::model::Model;

/// u, v, r, heading, north, east.
pub type State = [f64; 6];

/// One member's surroundings: its parameters and the steps.
#[derive(Debug, Clone)]
pub struct Member<'a> {
    /// A parameter, one number a term.
    pub theta: &'a [f64],
    /// Lengths of the steps \[s\].
    pub h: &'a [f64],
    /// Forces without errors over each step.
    pub centre: &'a [[f64; 3]],
    /// Independent errors of the forces: for each of them its reach over each step.
    pub errors: &'a [Vec<[f64; 3]>],
    /// Velocities of components that are not free, at each sample, and their accelerations over each step.
    pub given: &'a [[f64; 6]],
    /// Box of the start.
    pub start: [(f64, f64); 6],
}

/// The errors of a member: a sign for each error and step, and for each component of the start.
#[derive(Debug, Clone)]
pub struct Choice {
    /// By error, one number in [-1, 1] a step.
    pub errors: Vec<Vec<f64>>,
    /// -1 for the lower end of the start, 1 for the upper.
    pub start: [f64; 6],
}

impl Member<'_> {
    fn force(&self, k: usize, choice: &Choice) -> [f64; 3] {
        let mut force = self.centre[k];
        for (reach, sign) in self.errors.iter().zip(&choice.errors) {
            for i in 0..3 {
                force[i] += reach[k][i] * sign[k];
            }
        }
        force
    }

    fn rate(&self, model: &Model, x: &State, force: [f64; 3], k: usize, work: &mut Vec<f64>) -> Option<State> {
        let given = self.given.get(k).map_or([0.0; 3], |g| [g[3], g[4], g[5]]);
        let [du, dv, dr] = model.float_accelerations(self.theta, [x[0], x[1], x[2]], force, given, work)?;
        let (s, c) = x[3].sin_cos();
        Some([du, dv, dr, x[2], x[0] * c - x[1] * s, x[0] * s + x[1] * c])
    }

    /// The states at all samples, by the classical Runge-Kutta method, up to the first that is not finite.
    #[must_use]
    pub fn run(&self, model: &Model, choice: &Choice) -> Vec<State> {
        let mut work = Vec::new();
        let mut x: State = std::array::from_fn(|i| {
            let (lo, hi) = self.start[i];
            if choice.start[i] > 0.0 {
                hi
            } else if choice.start[i] < 0.0 {
                lo
            } else {
                0.5 * (lo + hi)
            }
        });
        let mut states = vec![x];
        for (k, &h) in self.h.iter().enumerate() {
            let force = self.force(k, choice);
            if let Some(given) = self.given.get(k) {
                for i in (0..3).filter(|&i| !model.free[i]) {
                    x[i] = given[i];
                }
            }
            let moved = |a: &State, d: &State, t: f64| -> State { std::array::from_fn(|i| a[i] + t * d[i]) };
            let stages = (|| {
                let k1 = self.rate(model, &x, force, k, &mut work)?;
                let k2 = self.rate(model, &moved(&x, &k1, 0.5 * h), force, k, &mut work)?;
                let k3 = self.rate(model, &moved(&x, &k2, 0.5 * h), force, k, &mut work)?;
                let k4 = self.rate(model, &moved(&x, &k3, h), force, k, &mut work)?;
                let next: State = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
                next.iter().all(|v| v.is_finite()).then_some(next)
            })();
            let Some(next) = stages else { break };
            x = next;
            states.push(x);
        }
        states
    }

    /// The errors that push one component up at one sample, to first order about the trajectory of `about`: the signs
    /// of the adjoint (Pontryagin's maximum principle, whose bang-bang controls are candidates here).
    #[must_use]
    pub fn towards(&self, model: &Model, about: &Choice, target: usize, weights: State) -> Choice {
        let states = self.run(model, about);
        let mut found = about.clone();
        let mut work = Vec::new();
        let mut adjoint = weights;
        for k in (0..target.min(states.len() - 1)).rev() {
            let (x, force) = (states[k], self.force(k, about));
            let Some(base) = self.rate(model, &x, force, k, &mut work) else { continue };
            for (reach, sign) in self.errors.iter().zip(&mut found.errors) {
                let pushed = std::array::from_fn(|i| force[i] + reach[k][i]);
                let Some(rate) = self.rate(model, &x, pushed, k, &mut work) else { continue };
                let gain: f64 = (0..3).map(|i| adjoint[i] * (rate[i] - base[i])).sum();
                if gain != 0.0 {
                    sign[k] = gain.signum();
                }
            }
            let mut next = adjoint;
            for j in 0..6 {
                // A difference quotient: a step of a millionth keeps half of the digits.
                let step = 1e-6 * (1.0 + x[j].abs());
                let mut other = x;
                other[j] += step;
                let Some(rate) = self.rate(model, &other, force, k, &mut work) else { continue };
                let gain: f64 = (0..6).map(|i| adjoint[i] * (rate[i] - base[i])).sum();
                next[j] += self.h[k] * gain / step;
            }
            adjoint = next;
        }
        for i in 0..6 {
            found.start[i] = if adjoint[i] == 0.0 { 0.0 } else { adjoint[i].signum() };
        }
        found
    }
}
