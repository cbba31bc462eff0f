//! Small interval matrices by their corners: families, and exact hulls over all matrices of end points.

use super::matrices::extremes;
use super::{Random, q};
use interval_core::IntervalMatrix;
use num_rational::BigRational;

pub fn matrix(n: usize, lo: &[f64], hi: &[f64]) -> IntervalMatrix {
    IntervalMatrix::new(n, n, lo.to_vec(), hi.to_vec()).expect("a good matrix")
}

/// All matrices of end points: a superset of the vertex matrices that the theory needs.
pub fn corners(a: &IntervalMatrix) -> Vec<Vec<f64>> {
    let size = a.rows() * a.columns();
    let count = if size <= 9 { 1_usize << size } else { 512 };
    let mut random = Random(size as u64);
    (0..count)
        .map(|k| {
            let bits = if size <= 9 { k as u64 } else { random.bits() };
            (0..size).map(|i| if bits >> i & 1 == 0 { a.lo()[i] } else { a.hi()[i] }).collect()
        })
        .collect()
}

/// Exact extremes of each entry of the inverse over the corners; `None` where one is singular or signs differ.
pub fn hull(a: &IntervalMatrix) -> Option<Vec<(BigRational, BigRational)>> {
    let exactly = |corner: Vec<f64>| corner.into_iter().map(q).collect();
    extremes(corners(a).into_iter().map(exactly), a.rows())
}

pub fn families(n: usize, seed: u64) -> Vec<(&'static str, IntervalMatrix)> {
    let mut random = Random(seed);
    let mut made = Vec::new();
    let mut add = |name, centre: Vec<f64>, radius: Vec<f64>| {
        let lo: Vec<f64> = centre.iter().zip(&radius).map(|(c, r)| c - r).collect();
        let hi: Vec<f64> = centre.iter().zip(&radius).map(|(c, r)| c + r).collect();
        made.push((name, matrix(n, &lo, &hi)));
    };
    let size = n * n;
    let diagonal = |i: usize| i.is_multiple_of(n + 1);
    let dominant: Vec<f64> =
        (0..size).map(|i| random.unit() + if diagonal(i) { 2.0 * n as f64 } else { 0.0 }).collect();
    add("diagonally dominant", dominant.clone(), dominant.iter().map(|x| 0.05 * x.abs()).collect());
    add("thin", dominant.clone(), dominant.iter().map(|x| 1e-14 * x.abs()).collect());
    add("points", dominant.clone(), vec![0.0; size]);
    let mass: Vec<f64> = (0..size).map(|i| if diagonal(i) { 60.0 } else { 3.0 * random.unit() }).collect();
    add("mass", mass, vec![1.5; size]);
    let random_centre: Vec<f64> = (0..size).map(|_| random.unit()).collect();
    add("random", random_centre.clone(), vec![0.01; size]);
    add("wide", random_centre, vec![0.3; size]);
    let mixed: Vec<f64> = (0..size).map(|i| if diagonal(i) { 1.0 } else { 0.0 }).collect();
    add("unit midpoint", mixed.clone(), vec![0.2 / n as f64; size]);
    add("zero inside", mixed, vec![1.5; size]);
    let scaled: Vec<f64> =
        dominant.iter().enumerate().map(|(i, x)| x * 10.0_f64.powi(if i / n == 0 { -150 } else { 100 })).collect();
    add("badly scaled", scaled.clone(), scaled.iter().map(|x| 0.01 * x.abs()).collect());
    let nearly: Vec<f64> = (0..size).map(|i| 1.0 + if diagonal(i) { 1e-7 } else { 0.0 }).collect();
    add("nearly singular", nearly, vec![1e-12; size]);
    add("singular", vec![1.0; size], vec![0.1; size]);
    made
}
