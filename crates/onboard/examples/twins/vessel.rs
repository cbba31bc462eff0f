//! Simulated vessels: the rows of each sample, which hold at a known truth.
//!
//! Fossen's equations in surge, sway and yaw with diagonal masses and linear and quadratic drags, under a programme of
//! held demands. Readings are wrong by up to their accuracies, uniformly.

use interval_core::Interval;
use onboard::Bounds;

/// The columns of the equations that a vessel has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Masses in surge and sway, linear and quadratic drag in surge, quadratic drag in sway; rows of surge and sway.
    Five,
    /// Masses and inertia, linear and quadratic drags of all three axes; rows of all axes.
    Nine,
}

/// Half-widths of the readings: accelerations, velocities, yaw acceleration, yaw rate; absolute and relative of the force.
const ACCURACY: [f64; 6] = [0.01, 0.005, 0.005, 0.002, 0.5, 0.02];

/// A row of the equations and its known force.
pub struct Row<const N: usize> {
    pub a: [Bounds; N],
    pub y: Bounds,
}

/// A vessel under way.
pub struct Vessel {
    kind: Kind,
    /// Mass in surge and sway, inertia; linear and quadratic drag of surge, sway and yaw.
    pub truth: [f64; 9],
    velocity: [f64; 3],
    force: [f64; 3],
    held: u32,
    state: u64,
    /// True for errors of a quarter of the accuracy (normal, cut off at the accuracy); else uniform up to it.
    normal: bool,
}

impl Vessel {
    pub fn new(kind: Kind, seed: u64) -> Self {
        let mut vessel = Self {
            kind,
            truth: [0.0; 9],
            velocity: [0.0; 3],
            force: [0.0; 3],
            held: 0,
            state: seed,
            normal: seed % 2 == 1,
        };
        let usual = match kind {
            Kind::Five => [60.0, 75.0, 12.0, 2.0, 35.0, 0.0, 60.0, 3.0, 6.0],
            Kind::Nine => [85.0, 160.0, 42.0, 20.0, 15.0, 60.0, 90.0, 25.0, 15.0],
        };
        for (t, u) in vessel.truth.iter_mut().zip(usual) {
            *t = u * (1.0 + 0.25 * Self::unit(&mut vessel.state));
        }
        if seed % 4 > 1 {
            // A parameter without a sign: its interval holds 0 for ever.
            vessel.truth[if kind == Kind::Five { 3 } else { 5 }] = 0.0;
        }
        vessel
    }

    /// Uniform in [-1, 1): `SplitMix64`.
    fn unit(state: &mut u64) -> f64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from(u32::try_from((z ^ (z >> 31)) >> 32).expect("32 bits")) / f64::from(1_u32 << 31) - 1.0
    }

    /// The true parameters in the order of the columns.
    pub fn parameters<const N: usize>(&self) -> [f64; N] {
        let t = &self.truth;
        let all: &[f64] = match self.kind {
            Kind::Five => &[t[0], t[1], t[3], t[4], t[6]],
            Kind::Nine => t,
        };
        all.try_into().expect("the vessel has N parameters")
    }

    /// A reading of a true value: the interval of its accuracy.
    fn reading(&mut self, value: f64, accuracy: f64) -> Interval {
        // A little less than the accuracy, so that no rounding of the simulation can make a row false.
        let error = if self.normal {
            // The sum of twelve uniform numbers has the standard deviation 2.
            ((0..12).map(|_| Self::unit(&mut self.state)).sum::<f64>() / 8.0).clamp(-1.0, 1.0)
        } else {
            Self::unit(&mut self.state)
        };
        let read = value + 0.999_999 * accuracy * error;
        Interval::new(read - accuracy, read + accuracy).expect("finite")
    }

    /// Goes on by a tenth of a second, and returns the rows of surge, sway and, for nine parameters, yaw.
    pub fn sample<const N: usize>(&mut self) -> ([Row<N>; 3], usize) {
        if self.held == 0 {
            self.held = 50 + ((Self::unit(&mut self.state) + 1.0) * 250.0) as u32;
            let scale = [70.0, if self.kind == Kind::Five { 0.0 } else { 40.0 }, 25.0];
            self.force = scale.map(|s| s * Self::unit(&mut self.state));
        }
        self.held -= 1;
        let [mu, mv, i, du, duu, dv, dvv, dr, drr] = self.truth;
        let rates = |[u, v, r]: [f64; 3], [x, y, n]: [f64; 3]| {
            [
                (x + mv * v * r - du * u - duu * u * u.abs()) / mu,
                (y - mu * u * r - dv * v - dvv * v * v.abs()) / mv,
                (n - (mv - mu) * u * v - dr * r - drr * r * r.abs()) / i,
            ]
        };
        // Midpoint rule: the motion is any that the equations allow at the sample itself.
        let first = rates(self.velocity, self.force);
        let middle = [0, 1, 2].map(|k| self.velocity[k] + 0.05 * first[k]);
        let second = rates(middle, self.force);
        for k in 0..3 {
            self.velocity[k] += 0.1 * second[k];
        }
        let (motion, force) = (self.velocity, self.force);
        let now = rates(motion, force);
        let [u, v, r] = motion;
        let [du1, dv1] = [0, 1].map(|k| self.reading(now[k], ACCURACY[0]));
        let dr1 = self.reading(now[2], ACCURACY[2]);
        let [u, v, r] = [self.reading(u, ACCURACY[1]), self.reading(v, ACCURACY[1]), self.reading(r, ACCURACY[3])];
        let known = force.map(|f| self.reading(f, ACCURACY[4] + ACCURACY[5] * f.abs()));
        let zero = Interval::ZERO;
        let rows: [Vec<Interval>; 3] = match self.kind {
            Kind::Five => [
                vec![du1, -(v * r), u, u.signed_square(), zero],
                vec![u * r, dv1, zero, zero, v.signed_square()],
                vec![zero; 5],
            ],
            Kind::Nine => [
                vec![du1, -(v * r), zero, u, u.signed_square(), zero, zero, zero, zero],
                vec![u * r, dv1, zero, zero, zero, v, v.signed_square(), zero, zero],
                vec![-(u * v), u * v, dr1, zero, zero, zero, zero, r, r.signed_square()],
            ],
        };
        let count = if self.kind == Kind::Five { 2 } else { 3 };
        let mut known = known.into_iter();
        let rows = rows.map(|a| Row {
            a: std::array::from_fn(|j| Bounds::from(a[j])),
            y: known.next().expect("three forces").into(),
        });
        (rows, count)
    }
}
