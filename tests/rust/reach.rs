//! Sets of solutions against single solutions of an oracle written apart: fixed-point numbers of 256 binary places, whose
//! Taylor steps are much finer than a double.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

use interval_core::Interval;
use interval_core::reach::{Node, System, Term, Tube, follow};
use num_bigint::BigInt;

/// Binary places of the oracle.
const PLACES: u32 = 256;

/// Terms of its Taylor series, and parts of each step.
const TERMS: usize = 24;
const PARTS: usize = 4;

/// A double of modulus between 2^-200 and 2^60, or 0, exactly.
fn fixed(x: f64) -> BigInt {
    let bits = x.to_bits();
    let exponent = i64::try_from(bits >> 52 & 0x7ff).expect("eleven bits") - 1075;
    if x == 0.0 {
        return BigInt::ZERO;
    }
    let significand = BigInt::from(bits & ((1 << 52) - 1) | 1 << 52);
    let shift = exponent + i64::from(PLACES);
    let shifted = significand << usize::try_from(shift).expect("no smaller number is used");
    if x < 0.0 { -shifted } else { shifted }
}

fn inside(x: Interval, value: &BigInt) -> bool {
    fixed(x.lo()) <= *value && *value <= fixed(x.hi())
}

/// The products of the oracle, its own statement of them: factor, denominator, and the components of one term.
type Terms = Vec<(i64, i64, Vec<usize>)>;

/// Series of one solution, by the recursion in numbers.
fn advance(equations: &[Terms], x: &[BigInt], h: &BigInt) -> Vec<BigInt> {
    let mut series: Vec<Vec<BigInt>> = x.iter().map(|v| vec![v.clone()]).collect();
    let one = BigInt::from(1) << PLACES;
    for k in 0..TERMS {
        let next: Vec<BigInt> = equations
            .iter()
            .map(|terms| {
                let value = terms.iter().map(|(numerator, denominator, factors)| {
                    let unit = if k == 0 { one.clone() } else { BigInt::ZERO };
                    let term: BigInt = match factors.as_slice() {
                        [] => unit,
                        [i] => series[*i][k].clone(),
                        [i, j] => (0..=k).map(|m| (&series[*i][m] * &series[*j][k - m]) >> PLACES).sum(),
                        _ => unreachable!("the oracle's systems are quadratic"),
                    };
                    term * *numerator / *denominator
                });
                value.sum::<BigInt>() / BigInt::from(k + 1)
            })
            .collect();
        for (all, value) in series.iter_mut().zip(next) {
            all.push(value);
        }
    }
    let sum = |all: &Vec<BigInt>| all.iter().rev().fold(BigInt::ZERO, |sum, c| ((sum * h) >> PLACES) + c);
    series.iter().map(sum).collect()
}

/// The solution through `start` at each node.
fn solution(equations: &[Terms], start: &[f64], nodes: &[Node]) -> Vec<Vec<BigInt>> {
    let (mut x, mut before): (Vec<BigInt>, f64) = (start.iter().map(|&v| fixed(v)).collect(), 0.0);
    let at = |node: &Node| {
        let h = (fixed(node.time) - fixed(before)) / BigInt::from(PARTS);
        for _ in 0..PARTS {
            x = advance(equations, &x, &h);
        }
        before = node.time;
        x.clone()
    };
    nodes.iter().map(at).collect()
}

/// Terms as the engine takes them.
fn stated(equations: &[Terms]) -> System {
    let n = equations.len();
    let term = |(numerator, denominator, factors): &(i64, i64, Vec<usize>)| {
        let powers =
            (0..n).map(|i| u32::try_from(factors.iter().filter(|&&j| j == i).count()).expect("small")).collect();
        Term { coefficient: format!("[{numerator}/{denominator}]").parse().expect("a rational"), powers }
    };
    let tables: Vec<Vec<Term>> = equations.iter().map(|terms| terms.iter().map(term).collect()).collect();
    System::new(&tables).expect("of one shape")
}

fn lotka_volterra() -> Vec<Terms> {
    vec![vec![(3, 1, vec![0]), (-3, 1, vec![0, 1])], vec![(1, 1, vec![0, 1]), (-1, 1, vec![1])]]
}

fn laub_loomis() -> Vec<Terms> {
    vec![
        vec![(14, 10, vec![2]), (-9, 10, vec![0])],
        vec![(25, 10, vec![4]), (-15, 10, vec![1])],
        vec![(6, 10, vec![6]), (-8, 10, vec![1, 2])],
        vec![(2, 1, vec![]), (-13, 10, vec![2, 3])],
        vec![(7, 10, vec![0]), (-1, 1, vec![3, 4])],
        vec![(3, 10, vec![0]), (-31, 10, vec![5])],
        vec![(18, 10, vec![5]), (-15, 10, vec![1, 6])],
    ]
}

const MIDDLE: [f64; 7] = [1.2, 1.05, 1.5, 2.4, 1.0, 0.1, 0.45];

fn p(x: f64) -> Interval {
    Interval::point(x).expect("finite")
}

fn held(tube: &Tube, all: &[Vec<BigInt>]) -> bool {
    tube.nodes.iter().zip(all).all(|(node, x)| node.state.iter().zip(x).all(|(&bound, value)| inside(bound, value)))
}

/// A point stays a near point, and the same tube without its remainders has lost a solution whose coefficients all have
/// one sign.
#[test]
fn the_remainder_holds_what_the_polynomial_leaves_out() {
    let square = vec![vec![(1, 1, vec![0, 0])]];
    let cases = [
        (square, vec![1.0], 0.75, true),
        (laub_loomis(), MIDDLE.to_vec(), 5.0, false),
        (lotka_volterra(), vec![1.3, 1.0], 3.64, false),
    ];
    for (equations, start, horizon, one_sign) in cases {
        let points: Vec<Interval> = start.iter().map(|&x| p(x)).collect();
        let tube = follow(&stated(&equations), &points, horizon).expect("a start");
        let all = solution(&equations, &start, &tube.nodes);
        assert!(tube.complete && held(&tube, &all));
        let widest = tube.nodes.iter().flat_map(|node| &node.state).map(|x| x.width()).fold(0.0, f64::max);
        assert!(widest < 1e-9, "{widest:e}");
        let omitted = |(node, x): (&Node, &Vec<BigInt>)| {
            let (bound, r) = (node.state[0], node.remainder[0]);
            x[0] > fixed(bound.hi()) - fixed(r.hi())
        };
        assert!(
            !one_sign || tube.nodes.iter().zip(&all).any(omitted),
            "a tube without remainders must lose the solution"
        );
    }
}

/// Vertices of the start, its middle and points between them stay inside, at each node and over each step.
#[test]
fn solutions_from_a_box_stay_inside() {
    let equations = laub_loomis();
    let around = |x: f64| p(x) + Interval::new(-0.1, 0.1).expect("ordered");
    let start = MIDDLE.map(around);
    let tube = follow(&stated(&equations), &start, 20.0).expect("a start");
    assert!(tube.complete);
    for vertex in [0_usize, 127, 85, 42, 9, 54, 99] {
        let end = |i: usize| if vertex >> i & 1 == 1 { start[i].hi() } else { start[i].lo() };
        let point: Vec<f64> = (0..7).map(end).collect();
        let all = solution(&equations, &point, &tube.nodes);
        assert!(held(&tube, &all), "vertex {vertex}");
        for ((before, after), node) in all.iter().zip(&all[1..]).zip(&tube.nodes[1..]) {
            assert!((0..7).all(|i| inside(node.over[i], &before[i]) && inside(node.over[i], &after[i])));
        }
    }
    let last = &tube.nodes.last().expect("complete").state;
    assert!(last[3].width() < 0.035, "{}", last[3].width());

    let equations = lotka_volterra();
    let start = [Interval::new(1.288, 1.312).expect("ordered"), p(1.0)];
    let tube = follow(&stated(&equations), &start, 3.64).expect("a start");
    assert!(tube.complete);
    for k in 0..=8 {
        let x = (start[0].lo() + f64::from(k) * 0.003).min(start[0].hi());
        assert!(held(&tube, &solution(&equations, &[x, 1.0], &tube.nodes)), "{x}");
    }
}

/// x' = x^2 from 1 ends at time 1: what is proved lies before, and holds 1 / (1 - t).
#[test]
fn a_solution_that_ends_leaves_the_tube_incomplete() {
    let equations = vec![vec![(1, 1, vec![0, 0])]];
    let tube = follow(&stated(&equations), &[p(1.0)], 2.0).expect("a start");
    assert!(!tube.complete && tube.nodes.last().is_some_and(|node| node.time > 0.9 && node.time < 1.0));
    for node in tube.nodes.iter().filter(|node| node.time < 0.99) {
        let exact = (BigInt::from(1) << (2 * PLACES)) / (fixed(1.0) - fixed(node.time));
        assert!(inside(node.state[0], &exact), "{}", node.time);
    }
}

#[test]
fn starts_that_do_not_fit_are_refused() {
    let system = stated(&lotka_volterra());
    assert!(follow(&system, &[p(1.0)], 1.0).is_err());
    assert!(follow(&system, &[p(1.0), Interval::ENTIRE], 1.0).is_err());
    assert!(follow(&system, &[p(1.0), p(1.0)], f64::INFINITY).is_err());
    assert!(follow(&system, &[p(1.0), p(1.0)], f64::NAN).is_err());
    assert!(follow(&system, &[p(1.0), p(1.0)], -1.0).is_err());
    assert!(System::new(&[vec![Term { coefficient: p(1.0), powers: vec![1, 0] }]]).is_err());
}
