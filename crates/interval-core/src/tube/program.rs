//! Columns of the equations of motion as a straight-line program, run on intervals, on intervals with a rate, and on
//! plain floats.
//!
//! The program is written once, by whoever knows the physics. Every operation here has its inclusion on intervals and
//! its derivative rule, so that a new column needs no new code.

use crate::error::Error;
use crate::interval::Interval;

/// One operation; operands are registers. Registers 0, 1 and 2 hold u, v and r, and operation `k` fills register
/// `k + 3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Op {
    /// A number.
    Constant(f64),
    /// `a + b`.
    Add(usize, usize),
    /// `a - b`.
    Sub(usize, usize),
    /// `a b`.
    Mul(usize, usize),
    /// `-a`.
    Neg(usize),
    /// `|a|`.
    Abs(usize),
    /// `a^2`.
    Square(usize),
    /// `a |a|`.
    SignedSquare(usize),
    /// `a^3`.
    Cube(usize),
    /// `tanh a`.
    Tanh(usize),
    /// `a |a|` where a is negative, else 0.
    AsternSquare(usize),
    /// The integral of `(a + x b) |a + x b|` over x from -half to half.
    CrossFlowForce(usize, usize, f64),
    /// The integral of `x (a + x b) |a + x b|` over x from -half to half.
    CrossFlowMoment(usize, usize, f64),
}

impl Op {
    /// The operation of a name, which is its variant in snake case; operands and numbers that it does not need are
    /// ignored.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str, a: usize, b: usize, number: f64) -> Result<Self, Error> {
        Ok(match name {
            "constant" => Self::Constant(number),
            "add" => Self::Add(a, b),
            "sub" => Self::Sub(a, b),
            "mul" => Self::Mul(a, b),
            "neg" => Self::Neg(a),
            "abs" => Self::Abs(a),
            "square" => Self::Square(a),
            "signed_square" => Self::SignedSquare(a),
            "cube" => Self::Cube(a),
            "tanh" => Self::Tanh(a),
            "astern_square" => Self::AsternSquare(a),
            "cross_flow_force" => Self::CrossFlowForce(a, b, number),
            "cross_flow_moment" => Self::CrossFlowMoment(a, b, number),
            _ => {
                return Err(Error::Name {
                    what: "operation",
                    given: name.into(),
                    known: "constant, add, sub, mul, neg, abs, square, signed_square, cube, tanh, astern_square, \
                            cross_flow_force, cross_flow_moment"
                        .into(),
                });
            }
        })
    }

    /// The registers that it reads.
    #[must_use]
    pub fn operands(self) -> [Option<usize>; 2] {
        match self {
            Self::Constant(_) => [None, None],
            Self::Add(a, b)
            | Self::Sub(a, b)
            | Self::Mul(a, b)
            | Self::CrossFlowForce(a, b, _)
            | Self::CrossFlowMoment(a, b, _) => [Some(a), Some(b)],
            Self::Neg(a)
            | Self::Abs(a)
            | Self::Square(a)
            | Self::SignedSquare(a)
            | Self::Cube(a)
            | Self::Tanh(a)
            | Self::AsternSquare(a) => [Some(a), None],
        }
    }
}

/// A number on which a program runs.
pub trait Quantity: Copy {
    /// The result of one operation on the registers filled so far.
    fn apply(op: Op, registers: &[Self]) -> Self;
}

/// Runs a program; `registers` holds u, v, r when called and every result when done.
pub fn run<T: Quantity>(program: &[Op], registers: &mut Vec<T>) {
    registers.truncate(3);
    for &op in program {
        let made = T::apply(op, registers);
        registers.push(made);
    }
}

/// `2 x`, exact but for overflow.
fn twice(x: Interval) -> Interval {
    x + x
}

/// `max(-x, 0)`, the size of the negative part.
fn negative_size(x: Interval) -> Interval {
    (-x).max(Interval::ZERO)
}

fn number(x: f64) -> Interval {
    Interval::raw(x, x)
}

/// The integral of `x^power w |w|`, `w = v + x r`, at a point, enclosed.
///
/// Where the flow has one sign along the hull the integrand is a polynomial; else the integral is split at its zero:
/// with `dx = dw / r`, `w |w|` integrates to `w^2 |w| / 3` and `w^2 |w|` to `w^3 |w| / 4`.
fn integral(v: f64, r: f64, half: f64, moment: bool) -> Interval {
    let (v, r, half) = (number(v), number(r), number(half));
    let cube = half * half.square();
    let reach = r.abs() * half;
    let smooth = || {
        let sign = if v.lo() < 0.0 { number(-1.0) } else { Interval::ONE };
        if moment {
            sign * (number(4.0) * v * r * cube) / number(3.0)
        } else {
            sign * (twice(half) * v.square() + twice(cube) * r.square() / number(3.0))
        }
    };
    let split = || {
        let (low, high) = (v - r * half, v + r * half);
        let first = (high.square() * high.abs() - low.square() * low.abs()) / (number(3.0) * r);
        if !moment {
            return first;
        }
        let second = (high * high.square() * high.abs() - low * low.square() * low.abs()) / (number(4.0) * r.square());
        second - v * first / r
    };
    if v.abs().lo() >= reach.hi() {
        smooth()
    } else if v.abs().hi() < reach.lo() {
        split()
    } else {
        // Rounding leaves open which formula holds; they agree at the border, and each covers its own side.
        smooth().hull(split())
    }
}

/// The force grows with v; it grows with |r| where v > 0 and falls with it where v < 0.
fn cross_flow_force(v: Interval, r: Interval, half: f64) -> Interval {
    let (small, large) = (r.mignitude(), r.magnitude());
    let low = integral(v.lo(), if v.lo() >= 0.0 { small } else { large }, half, false);
    let high = integral(v.hi(), if v.hi() >= 0.0 { large } else { small }, half, false);
    low.hull(high)
}

/// The moment grows with r; it grows with |v| where r > 0 and falls with it where r < 0.
fn cross_flow_moment(v: Interval, r: Interval, half: f64) -> Interval {
    let (small, large) = (v.mignitude(), v.magnitude());
    let low = integral(if r.lo() >= 0.0 { small } else { large }, r.lo(), half, true);
    let high = integral(if r.hi() >= 0.0 { large } else { small }, r.hi(), half, true);
    low.hull(high)
}

/// Bounds of the integrals of `2 |v + x r|`, `2 |x| |v + x r|` and `2 x^2 |v + x r|` over the hull: no derivative of
/// force and moment by v and r is larger.
fn cross_flow_slopes(v: Interval, r: Interval, half: f64) -> [f64; 3] {
    let (speed, turn, half) = (number(v.magnitude()), number(r.magnitude()), number(half));
    // |v + x r| <= |v| + |x| |r|, and |x|^k integrates to 2 half^(k+1) / (k + 1).
    let square = half.square();
    let cube = square * half;
    let plain = twice(twice(half) * speed + square * turn);
    let first = twice(square * speed + twice(cube) * turn / number(3.0));
    let second = twice(twice(cube) * speed / number(3.0) + square.square() * turn / number(2.0));
    [plain.hi(), first.hi(), second.hi()]
}

impl Quantity for Interval {
    #[inline]
    fn apply(op: Op, r: &[Self]) -> Self {
        match op {
            Op::Constant(x) => number(x),
            Op::Add(a, b) => r[a] + r[b],
            Op::Sub(a, b) => r[a] - r[b],
            Op::Mul(a, b) => r[a] * r[b],
            Op::Neg(a) => -r[a],
            Op::Abs(a) => r[a].abs(),
            Op::Square(a) => r[a].square(),
            Op::SignedSquare(a) => r[a].signed_square(),
            Op::Cube(a) => r[a].powi(3),
            Op::Tanh(a) => r[a].tanh(),
            Op::AsternSquare(a) => -negative_size(r[a]).square(),
            Op::CrossFlowForce(a, b, half) => cross_flow_force(r[a], r[b], half),
            Op::CrossFlowMoment(a, b, half) => cross_flow_moment(r[a], r[b], half),
        }
    }
}

/// The range of a quantity over a box, and of its rate along the directions of the inputs' rates.
///
/// The rate encloses the generalised gradient (Clarke) times the direction, so that the mean value theorem holds for
/// `|x|`, too (Lebourg).
#[derive(Debug, Clone, Copy)]
pub struct Moving {
    /// The range.
    pub value: Interval,
    /// The range of the rate.
    pub rate: Interval,
}

impl Moving {
    fn new(value: Interval, rate: Interval) -> Self {
        Self { value, rate }
    }
}

/// The slopes of `|x|`.
fn signs(x: Interval) -> Interval {
    if x.lo() > 0.0 {
        Interval::ONE
    } else if x.hi() < 0.0 {
        number(-1.0)
    } else {
        Interval::raw(-1.0, 1.0)
    }
}

impl Quantity for Moving {
    #[inline]
    fn apply(op: Op, q: &[Self]) -> Self {
        match op {
            Op::Constant(x) => Self::new(number(x), Interval::ZERO),
            Op::Add(a, b) => Self::new(q[a].value + q[b].value, q[a].rate + q[b].rate),
            Op::Sub(a, b) => Self::new(q[a].value - q[b].value, q[a].rate - q[b].rate),
            Op::Mul(a, b) => {
                let (x, y) = (q[a], q[b]);
                Self::new(x.value * y.value, x.rate * y.value + x.value * y.rate)
            }
            Op::Neg(a) => Self::new(-q[a].value, -q[a].rate),
            Op::Abs(a) => Self::new(q[a].value.abs(), signs(q[a].value) * q[a].rate),
            Op::Square(a) => Self::new(q[a].value.square(), twice(q[a].value) * q[a].rate),
            Op::SignedSquare(a) => Self::new(q[a].value.signed_square(), twice(q[a].value.abs()) * q[a].rate),
            Op::Cube(a) => Self::new(q[a].value.powi(3), number(3.0) * q[a].value.square() * q[a].rate),
            Op::Tanh(a) => {
                let value = q[a].value.tanh();
                // The slope lies in [0, 1]; the difference from 1 may leave it by rounding, which is no harm.
                Self::new(value, (Interval::ONE - value.square()) * q[a].rate)
            }
            Op::AsternSquare(a) => {
                let size = negative_size(q[a].value);
                Self::new(-size.square(), twice(size) * q[a].rate)
            }
            Op::CrossFlowForce(a, b, half) => {
                let [plain, first, _] = cross_flow_slopes(q[a].value, q[b].value, half);
                // The force never falls with v.
                let rate = Interval::raw(0.0, plain) * q[a].rate + Interval::raw(-first, first) * q[b].rate;
                Self::new(cross_flow_force(q[a].value, q[b].value, half), rate)
            }
            Op::CrossFlowMoment(a, b, half) => {
                let [_, first, second] = cross_flow_slopes(q[a].value, q[b].value, half);
                // The moment never falls with r.
                let rate = Interval::raw(-first, first) * q[a].rate + Interval::raw(0.0, second) * q[b].rate;
                Self::new(cross_flow_moment(q[a].value, q[b].value, half), rate)
            }
        }
    }
}

/// Plain floats: for trajectories of single members, which prove nothing.
impl Quantity for f64 {
    #[inline]
    fn apply(op: Op, r: &[Self]) -> Self {
        match op {
            Op::Constant(x) => x,
            Op::Add(a, b) => r[a] + r[b],
            Op::Sub(a, b) => r[a] - r[b],
            Op::Mul(a, b) => r[a] * r[b],
            Op::Neg(a) => -r[a],
            Op::Abs(a) => r[a].abs(),
            Op::Square(a) => r[a] * r[a],
            Op::SignedSquare(a) => r[a] * r[a].abs(),
            Op::Cube(a) => r[a] * r[a] * r[a],
            Op::Tanh(a) => r[a].tanh(),
            Op::AsternSquare(a) => r[a].min(0.0) * r[a].abs(),
            Op::CrossFlowForce(a, b, half) => integral(r[a], r[b], half, false).midpoint(),
            Op::CrossFlowMoment(a, b, half) => integral(r[a], r[b], half, true).midpoint(),
        }
    }
}
