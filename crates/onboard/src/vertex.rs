//! The vertex at which a bound is attained: a dual simplex method in plain floats, which proposes multipliers.
//!
//! A basis holds `N` of the half-spaces and of the ends of the box; its multipliers for the objective are not negative.
//! A violated half-space enters, the one that keeps the multipliers so leaves (Lemke, *Naval Res. Logist. Q.* 1 (1954)
//! 36-47). Nothing here is a proof: multipliers that are wrong by a rounding leave a residual, which the proof counts.

use crate::bounds::Bounds;
use crate::store::Store;

/// Violations below this share of a half-space's change across the box are none: far below any width of interest.
const TOLERANCE: f64 = 1e-9;
/// Entries of the exchange below this share of the largest are zeros of rounding.
const PIVOT: f64 = 1e-9;
/// Exchanges before the inverse is computed afresh.
const FRESH: usize = 12;

/// A member of a basis: half-space `k`, or beyond the `ROWS` half-spaces an end of the box.
pub(crate) type Member = u16;

/// What a search ended with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Found {
    /// No half-space is violated at the vertex.
    Vertex,
    /// No point satisfies the basis and this half-space.
    Contradiction(Member),
    /// The steps allowed were used up, or rounding stood in the way.
    Open,
}

/// The kept half-spaces, as a search sees them.
pub(crate) struct Problem<'a, const N: usize, const ROWS: usize> {
    pub(crate) rows: &'a Store<N, ROWS>,
    pub(crate) region: &'a [Bounds; N],
    pub(crate) widths: &'a [f64; N],
    pub(crate) now: f64,
}

impl<const N: usize, const ROWS: usize> Problem<'_, N, ROWS> {
    /// The member that is the upper or the lower end of a parameter.
    #[expect(clippy::cast_possible_truncation, reason = "a capacity and twice the parameters are far below 65,536")]
    pub(crate) fn end(column: usize, upper: bool) -> Member {
        (ROWS + 2 * column + usize::from(!upper)) as Member
    }

    /// Coefficients, right-hand side and size of a member.
    pub(crate) fn half_space(&self, member: Member) -> ([f64; N], f64, f64) {
        let k = usize::from(member);
        if k < ROWS {
            let row = self.rows.half_space(k, self.now);
            return (row.g, row.h, row.size);
        }
        let (column, upper) = ((k - ROWS) / 2, (k - ROWS) % 2 == 0);
        let mut g = [0.0; N];
        g[column] = if upper { 1.0 } else { -1.0 };
        (g, if upper { self.region[column].hi } else { -self.region[column].lo }, self.widths[column])
    }

    /// The member that the point violates most, in units of its size.
    #[expect(clippy::cast_possible_truncation, reason = "a capacity is far below 65,536")]
    fn most_violated(&self, x: &[f64; N], basis: &[Member; N]) -> Option<(Member, f64)> {
        let free = |k: usize| basis.contains(&(k as Member));
        let row = self.rows.most_violated(x, self.now, TOLERANCE, free);
        let mut found = row.map(|(k, excess, _)| (k as Member, excess));
        let mut worst = row.map_or(TOLERANCE, |(_, _, share)| share);
        let mut ask = |member: Member, excess: f64, size: f64| {
            if excess > worst * size && !basis.contains(&member) {
                (worst, found) = (excess / size, Some((member, excess)));
            }
        };
        for j in 0..N {
            ask(Self::end(j, true), x[j] - self.region[j].hi, self.widths[j]);
            ask(Self::end(j, false), self.region[j].lo - x[j], self.widths[j]);
        }
        found
    }
}

/// The search for one end of one parameter.
#[derive(Debug, Clone)]
pub(crate) struct Vertex<const N: usize> {
    pub(crate) basis: [Member; N],
    /// Inverse of the matrix whose rows are the members' coefficients.
    inverse: [[f64; N]; N],
    pub(crate) x: [f64; N],
    pub(crate) multipliers: [f64; N],
    /// True if the place has to be looked at again.
    pub(crate) pending: bool,
}

impl<const N: usize> Vertex<N> {
    pub(crate) const NONE: Self =
        Self { basis: [0; N], inverse: [[0.0; N]; N], x: [0.0; N], multipliers: [0.0; N], pending: true };

    /// The corner of the box where `direction` times the parameter is least; other parameters take their lower ends.
    pub(crate) fn start_at_corner<const ROWS: usize>(&mut self, column: usize, direction: f64) {
        for j in 0..N {
            self.basis[j] = Problem::<N, ROWS>::end(j, j == column && direction < 0.0);
        }
    }

    /// Computes inverse, vertex and multipliers from the basis. The value is false if it is not regular, or no basis of
    /// a minimum.
    pub(crate) fn refresh<const ROWS: usize>(
        &mut self,
        problem: &Problem<'_, N, ROWS>,
        column: usize,
        direction: f64,
    ) -> bool {
        let mut a = [[0.0; N]; N];
        let mut right = [0.0; N];
        let mut sizes = [1.0; N];
        for k in 0..N {
            (a[k], right[k], sizes[k]) = problem.half_space(self.basis[k]);
            for j in 0..N {
                a[k][j] *= problem.widths[j] / sizes[k];
            }
        }
        let Some(inverse) = inverted(a) else { return false };
        let (mut x, mut least) = ([0.0; N], 0.0_f64);
        for j in 0..N {
            for k in 0..N {
                self.inverse[j][k] = inverse[j][k] * problem.widths[j] / sizes[k];
                x[j] += self.inverse[j][k] * right[k];
            }
        }
        let mut largest = 0.0_f64;
        for k in 0..N {
            let l = -direction * self.inverse[column][k];
            self.multipliers[k] = l.max(0.0);
            least = least.min(l * sizes[k]);
            largest = largest.max(l.abs() * sizes[k]);
        }
        self.x = x;
        x.iter().all(|v| v.is_finite()) && least >= -1e-7 * largest
    }

    /// Exchanges members until none is violated, with at most `steps` exchanges, of which it takes the number away.
    pub(crate) fn search<const ROWS: usize>(
        &mut self,
        problem: &Problem<'_, N, ROWS>,
        column: usize,
        direction: f64,
        steps: &mut usize,
    ) -> Found {
        if !self.refresh(problem, column, direction) {
            self.start_at_corner::<ROWS>(column, direction);
            self.refresh(problem, column, direction);
        }
        let mut since = 0;
        loop {
            let Some((entering, excess)) = problem.most_violated(&self.x, &self.basis) else {
                if since == 0 {
                    return Found::Vertex;
                }
                since = 0;
                if self.refresh(problem, column, direction) {
                    continue;
                }
                return Found::Open;
            };
            if *steps == 0 {
                if since > 0 {
                    self.refresh(problem, column, direction);
                }
                return Found::Open;
            }
            *steps -= 1;
            let alpha = self.coefficients(&problem.half_space(entering).0);
            let Some(leaving) = self.leaving(problem, &alpha) else { return Found::Contradiction(entering) };
            self.exchange(entering, leaving, &alpha, excess);
            since += 1;
            if since >= FRESH {
                since = 0;
                if !self.refresh(problem, column, direction) {
                    return Found::Open;
                }
            }
        }
    }

    /// The combination of the basis that a half-space's coefficients are.
    pub(crate) fn coefficients(&self, g: &[f64; N]) -> [f64; N] {
        let mut alpha = [0.0; N];
        for j in 0..N {
            for k in 0..N {
                alpha[k] += g[j] * self.inverse[j][k];
            }
        }
        alpha
    }

    /// The member whose multiplier reaches zero first; of several the one with the largest entry.
    fn leaving<const ROWS: usize>(&self, problem: &Problem<'_, N, ROWS>, alpha: &[f64; N]) -> Option<usize> {
        let mut sizes = [1.0; N];
        let mut largest = 0.0_f64;
        for k in 0..N {
            sizes[k] = problem.half_space(self.basis[k]).2;
            largest = largest.max((alpha[k] * sizes[k]).abs());
        }
        let mut best: Option<(usize, f64, f64)> = None;
        for k in 0..N {
            let entry = alpha[k] * sizes[k];
            if entry > PIVOT * largest {
                let ratio = self.multipliers[k] / alpha[k];
                if best.is_none_or(|(_, r, e)| ratio < r || (ratio == r && entry > e)) {
                    best = Some((k, ratio, entry));
                }
            }
        }
        best.map(|b| b.0)
    }

    fn exchange(&mut self, entering: Member, leaving: usize, alpha: &[f64; N], excess: f64) {
        let step = self.multipliers[leaving] / alpha[leaving];
        for k in 0..N {
            self.multipliers[k] = (self.multipliers[k] - step * alpha[k]).max(0.0);
        }
        self.multipliers[leaving] = step;
        for j in 0..N {
            let pivot = self.inverse[j][leaving] / alpha[leaving];
            self.x[j] -= excess * pivot;
            for k in 0..N {
                self.inverse[j][k] -= alpha[k] * pivot;
            }
            self.inverse[j][leaving] = pivot;
        }
        self.basis[leaving] = entering;
    }
}

/// The inverse by Gauss and Jordan with pivots by column. The value is `None` for a matrix that is singular to rounding.
fn inverted<const N: usize>(mut a: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut b = [[0.0; N]; N];
    for k in 0..N {
        b[k][k] = 1.0;
    }
    for p in 0..N {
        let mut best = p;
        for r in p + 1..N {
            if a[r][p].abs() > a[best][p].abs() {
                best = r;
            }
        }
        if a[best][p].is_nan() || a[best][p].abs() <= 1e-13 {
            return None;
        }
        a.swap(p, best);
        b.swap(p, best);
        let pivot = a[p][p];
        for j in 0..N {
            a[p][j] /= pivot;
            b[p][j] /= pivot;
        }
        let (row, unit) = (a[p], b[p]);
        for r in 0..N {
            if r != p {
                let factor = a[r][p];
                for j in 0..N {
                    a[r][j] -= factor * row[j];
                    b[r][j] -= factor * unit[j];
                }
            }
        }
    }
    Some(b)
}
