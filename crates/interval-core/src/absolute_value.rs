//! Absolute value equations `A_c x - T_y Delta |x| = b`, whose solutions over all sign vectors `y` span the hull of an
//! interval system (Rohn, *Reliable Computing* 11 (2005); docs/theory.md, "Inverses" and "Square systems").
//!
//! `F(x) = A_c x - T_y Delta |x| - b` equals `A_yz x - b` for `z = sgn x`, where `A_yz` has the lower bound of entry
//! `kl` where `y_k z_l = 1` and the upper one elsewhere: no rounding. For a regular interval matrix the equation has
//! one solution, and `F(x) - F(x') = M (x - x')` for a member `M`, since `|x| - |x'| = T (x - x')` with a diagonal
//! `|T| <= I`. So an approximation `x` is within `H |F(x)|` of the solution for any bound `H` of the magnitudes of all
//! members' inverses. That is the whole proof; the search for `x` needs none.

use crate::approximate::{self, Basis};
use crate::doubles::Neighbours as _;
use crate::lanes::{One, Vector, backends, two_product, two_sum};
use crate::matrix::IntervalMatrix;
use crate::rounding::slices::Backend;
use crate::rounding::{add_up, mul_up};

/// The unit roundoff of a double, 2^-53.
const UNIT: f64 = f64::EPSILON / 2.0;
/// The smallest positive double, 2^-1074.
const SMALLEST: f64 = f64::from_bits(1);
/// Rows are padded to the widest vector, 8 doubles.
const PAD: usize = 8;

/// The equations of one sign vector.
pub(crate) struct Equations {
    n: usize,
    stride: usize,
    /// Columns of `A_yz` for `z_l = 1` and for `z_l = -1`.
    plus: Vec<f64>,
    minus: Vec<f64>,
}

/// An approximate solution `x + tail`, and upper bounds of `|F|` there.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    pub x: Vec<f64>,
    pub tail: Vec<f64>,
    pub rest: Vec<f64>,
}

impl Solution {
    /// A bound of the distance of component `i` from the exact one.
    pub(crate) fn error(&self, magnitude: &[f64], i: usize) -> f64 {
        let n = self.x.len();
        let row = &magnitude[i * n..][..n];
        row.iter().zip(&self.rest).fold(0.0, |sum, (&h, &f)| if f == 0.0 { sum } else { add_up(sum, mul_up(h, f)) })
    }

    /// The largest double that is proved not to exceed component `i`, and whether no other double could be.
    pub(crate) fn lower(&self, magnitude: &[f64], i: usize) -> (f64, bool) {
        let (x, tail, error) = (self.x[i], self.tail[i], self.error(magnitude, i));
        let below = |shift: f64| {
            let sum = x + shift;
            let part = sum - x;
            let rounding = (x - (sum - part)) + (shift - part);
            if rounding < 0.0 { sum.below() } else { sum }
        };
        let (least, most) = (crate::rounding::sub_down(tail, error), add_up(tail, error));
        let bound = below(least) + 0.0;
        if bound.is_nan() { (f64::NEG_INFINITY, false) } else { (bound, bound == below(most)) }
    }

    /// The smallest double that is proved not to be exceeded by component `i`, and whether no other double could be.
    pub(crate) fn upper(&self, magnitude: &[f64], i: usize) -> (f64, bool) {
        let mirrored = Self {
            x: self.x.iter().map(|v| -v).collect(),
            tail: self.tail.iter().map(|v| -v).collect(),
            rest: self.rest.clone(),
        };
        let (bound, tight) = mirrored.lower(magnitude, i);
        (-bound + 0.0, tight)
    }
}

impl Equations {
    /// For `y_k = 1` where `positive[k]`.
    pub(crate) fn new(a: &IntervalMatrix, positive: &[bool]) -> Self {
        let n = a.rows();
        let stride = n.next_multiple_of(PAD);
        let (mut plus, mut minus) = (vec![0.0; n * stride], vec![0.0; n * stride]);
        for l in 0..n {
            for k in 0..n {
                let (lo, hi) = (a.lo()[k * n + l], a.hi()[k * n + l]);
                let at = l * stride + k;
                (plus[at], minus[at]) = if positive[k] { (lo, hi) } else { (hi, lo) };
            }
        }
        Self { n, stride, plus, minus }
    }

    fn entry(&self, k: usize, l: usize, positive: bool) -> f64 {
        let from = if positive { &self.plus } else { &self.minus };
        from[l * self.stride + k]
    }

    /// The matrix `A_yz` for `z_l = 1` where `positive[l]`, row-major.
    pub(crate) fn vertex(&self, positive: &[bool]) -> Vec<f64> {
        let n = self.n;
        (0..n * n).map(|at| self.entry(at / n, at % n, positive[at % n])).collect()
    }

    /// An approximate solution by sign accord: signs that do not agree with the solution of their vertex are turned,
    /// all of them at first, later the first one only, which ends (Rohn).
    pub(crate) fn solve(&self, b: &[f64], signs: &mut [bool]) -> Option<Solution> {
        let n = self.n;
        let mut work = vec![0.0; n * (n + 1)];
        for step in 0..64 + 4 * n {
            for k in 0..n {
                for l in 0..n {
                    work[k * (n + 1) + l] = self.entry(k, l, signs[l]);
                }
                work[k * (n + 1) + n] = b[k];
            }
            approximate::solve_in_place(&mut work, n)?;
            let x: Vec<f64> = (0..n).map(|i| work[i * (n + 1) + n]).collect();
            let largest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            // Signs of components that are zero but for rounding do not matter.
            let wrong = |l: usize| x[l].abs() > 1e-13 * largest && (x[l] > 0.0) != signs[l];
            let mut disagreeing: Vec<usize> = (0..n).filter(|&l| wrong(l)).collect();
            if disagreeing.is_empty() {
                return self.checked(b, x, vec![0.0; n]).map(|(solution, _)| solution);
            }
            if step >= 8 {
                disagreeing.truncate(1);
            }
            for l in disagreeing {
                signs[l] = !signs[l];
            }
        }
        None
    }

    /// The same more accurately, by steps of Newton's method with residuals in twice the working precision.
    pub(crate) fn refine(&self, b: &[f64], from: &Solution) -> Solution {
        let n = self.n;
        let positive: Vec<bool> = from.x.iter().map(|&v| v >= 0.0).collect();
        let Some(basis) = Basis::new(&self.vertex(&positive), n) else { return from.clone() };
        let Some((mut best, mut value)) = self.checked(b, from.x.clone(), from.tail.clone()) else {
            return from.clone();
        };
        for _ in 0..5 {
            let step = basis.solve(&value);
            let (mut x, mut tail) = (Vec::with_capacity(n), Vec::with_capacity(n));
            for i in 0..n {
                let (s, e) = two_sum(One(best.x[i]), One(-step[i]));
                let (s, e) = two_sum(s, One(e.0 + best.tail[i]));
                x.push(s.0);
                tail.push(e.0);
            }
            let Some((next, next_value)) = self.checked(b, x, tail) else { break };
            let size = |s: &Solution| s.rest.iter().fold(0.0_f64, |m, &v| m.max(v));
            let (before, after) = (size(&best), size(&next));
            if after >= before {
                break;
            }
            (best, value) = (next, next_value);
            if after > 0.25 * before {
                break;
            }
        }
        best
    }

    /// The approximation with bounds of `|F|`, and `F` itself approximately. The value is `None` if something
    /// overflows.
    fn checked(&self, b: &[f64], x: Vec<f64>, tail: Vec<f64>) -> Option<(Solution, Vec<f64>)> {
        let n = self.n;
        let (mut value, mut size) = (vec![0.0; self.stride], vec![0.0; self.stride]);
        let mut right = vec![0.0; self.stride];
        right[..n].copy_from_slice(b);
        residual(Backend::chosen(), self, &x, &tail, &right, &mut value, &mut size);
        #[expect(clippy::cast_precision_loss, reason = "an order, far below 2^53")]
        let terms = n as f64 + 4.0;
        // Every tail that is summed is at most (terms) u size, and each of their additions is within u of it; products
        // that underflow lose at most the smallest number each.
        let gamma = 4.0 * terms * terms * UNIT * UNIT;
        let bound = |k: usize| (value[k].abs() + gamma * size[k]) * (1.0 + 8.0 * UNIT) + 16.0 * terms * SMALLEST;
        // Nothing is lost only where each product has a factor of zero: products may also vanish by underflow.
        let exact = |k: usize| {
            let vanishes = |l: usize| self.entry(k, l, x[l] > 0.0) == 0.0 || (x[l] == 0.0 && tail[l] == 0.0);
            value[k] == 0.0 && size[k] == 0.0 && (0..n).all(vanishes)
        };
        let rest: Vec<f64> = (0..n).map(|k| if exact(k) { 0.0 } else { bound(k) }).collect();
        value.truncate(n);
        let finite = x.iter().chain(&tail).chain(&rest).chain(&value).all(|v| v.is_finite());
        finite.then_some((Solution { x, tail, rest }, value))
    }
}

backends!(fn residual(
    equations: &Equations, x: &[f64], tail: &[f64], b: &[f64], value: &mut [f64], size: &mut [f64],
) = residual_rows);

/// `A_yz (x + tail) - b` in twice the working precision with `z = sgn x`, and the sums of the magnitudes of its terms.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled inside functions with wider instruction sets")]
fn residual_rows<V: Vector>(
    equations: &Equations,
    x: &[f64],
    tail: &[f64],
    b: &[f64],
    value: &mut [f64],
    size: &mut [f64],
) {
    let stride = equations.stride;
    let mut k = 0;
    while k < stride {
        let mut sum = -V::load(&b[k..]);
        let mut magnitude = sum.abs();
        let mut low = V::splat(0.0);
        for l in 0..equations.n {
            // The sign of x + tail is that of x, the larger part.
            let from = if x[l] > 0.0 { &equations.plus } else { &equations.minus };
            let column = V::load(&from[l * stride + k..]);
            let (p, p_error) = two_product(column, V::splat(x[l]));
            let (s, s_error) = two_sum(sum, p);
            sum = s;
            low = low + (s_error + (p_error + column * V::splat(tail[l])));
            magnitude = magnitude + p.abs();
        }
        let (s, e) = two_sum(sum, low);
        (s + e).store(&mut value[k..]);
        magnitude.store(&mut size[k..]);
        k += V::N;
    }
}
