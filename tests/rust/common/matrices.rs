//! Interval matrices by family, methods by name, and hulls in rationals.

use super::{Random, invert, q};
use interval_core::inverse::{Outcome, exact, hansen_bliek_rohn, krawczyk, kuttler, neumaier, partitioned};
use interval_core::{Error, IntervalMatrix};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};

/// Least and largest value of each entry.
pub type Hull = Vec<(BigRational, BigRational)>;

pub type Method = fn(&IntervalMatrix) -> Result<Outcome, Error>;

pub fn by_cells(a: &IntervalMatrix) -> Result<Outcome, Error> {
    partitioned(a, 512)
}

pub const METHODS: [(&str, Method); 6] = [
    ("exact", exact),
    ("partitioned", by_cells),
    ("hansen-bliek-rohn", hansen_bliek_rohn),
    ("krawczyk", krawczyk),
    ("neumaier", neumaier),
    ("kuttler", kuttler),
];

pub fn matrix(n: usize, centre: &[f64], radius: &[f64]) -> IntervalMatrix {
    let end = |sign: f64| centre.iter().zip(radius).map(|(c, r)| c + sign * r).collect();
    IntervalMatrix::new(n, n, end(-1.0), end(1.0)).expect("a good matrix")
}

pub fn relative(centre: &[f64], by: f64) -> Vec<f64> {
    centre.iter().map(|c| by * c.abs()).collect()
}

/// The families of the specification, of any order.
pub fn families(n: usize, seed: u64) -> Vec<(&'static str, IntervalMatrix)> {
    let mut random = Random(seed.wrapping_mul(1000) + n as u64);
    let mut noise = |scale: f64| -> Vec<f64> { (0..n * n).map(|_| scale * random.unit()).collect() };
    let plus = |mut m: Vec<f64>, diagonal: f64| {
        (0..n).for_each(|i| m[i * (n + 1)] += diagonal);
        m
    };
    let order = n as f64;
    let mass: Vec<f64> = noise(3.0).iter().enumerate().map(|(at, x)| if at % 3 == 1 { 0.0 } else { *x }).collect();
    let mass = plus(mass, 20.0 * order);
    let dominant = plus(noise(1.0), order);
    let any = noise(1.0);
    let thin = noise(1.0);
    let wide = plus(noise(1.0), order);
    let nearly = plus(vec![1.0; n * n], 1e-6);
    let scales: Vec<f64> = noise(150.0)[..n].iter().map(|e| 10.0_f64.powi(*e as i32)).collect();
    let scaled: Vec<f64> = dominant.iter().enumerate().map(|(at, x)| x * scales[at / n] / scales[at % n]).collect();
    let permuted: Vec<f64> = (0..n * n).map(|at| dominant[((at / n + 1) % n) * n + at % n]).collect();
    let transposed: Vec<f64> = (0..n * n).map(|at| any[(at % n) * n + at / n]).collect();
    let unit = plus(vec![0.0; n * n], 1.0);
    vec![
        ("mass", matrix(n, &mass, &relative(&mass, 0.01))),
        ("diagonally dominant", matrix(n, &dominant, &relative(&dominant, 0.01))),
        ("random", matrix(n, &any, &relative(&any, 0.05 / order))),
        ("sign-mixed", matrix(n, &dominant, &vec![0.2; n * n])),
        ("nearly singular", matrix(n, &nearly, &vec![1e-9 / order; n * n])),
        ("singular", matrix(n, &vec![1.0; n * n], &vec![0.01; n * n])),
        ("wide", matrix(n, &wide, &relative(&wide, 0.5))),
        ("badly scaled", matrix(n, &scaled, &relative(&scaled, 0.01))),
        ("thin", matrix(n, &thin, &relative(&thin, 1e-13))),
        ("huge radii", matrix(n, &thin, &vec![1e100; n * n])),
        ("zero radii", matrix(n, &dominant, &vec![0.0; n * n])),
        ("permuted", matrix(n, &permuted, &relative(&permuted, 0.02))),
        ("transposed", matrix(n, &transposed, &relative(&transposed, 0.02 / order))),
        ("unit midpoint", matrix(n, &unit, &vec![0.25 / order; n * n])),
    ]
}

pub fn from_entries(n: usize, entries: &[(f64, f64)]) -> IntervalMatrix {
    let (lo, hi) = entries.iter().copied().unzip();
    IntervalMatrix::new(n, n, lo, hi).expect("a good matrix")
}

/// The hull by another way: all vertex matrices in rationals, once for each pair of sign vectors.
pub fn vertex_hull(a: &IntervalMatrix) -> Option<Hull> {
    let n = a.rows();
    let vertices = (0..1_usize << (2 * n - 1)).map(|bits| {
        let (y, z) = (bits >> n, bits & ((1 << n) - 1));
        let end = |at: usize| if ((y >> (at / n)) ^ (z >> (at % n))) & 1 == 1 { a.hi()[at] } else { a.lo()[at] };
        (0..n * n).map(|at| q(end(at))).collect()
    });
    extremes(vertices, n)
}

/// Exact extremes of each entry of the inverses; `None` where one is singular or signs of determinants differ.
pub fn extremes(matrices: impl Iterator<Item = Vec<BigRational>>, n: usize) -> Option<Hull> {
    let mut found: Option<Hull> = None;
    let mut positive = None;
    for matrix in matrices {
        let (determinant, inverse) = invert(&matrix, n);
        let inverse = inverse?;
        if *positive.get_or_insert(determinant.is_positive()) != determinant.is_positive() {
            return None;
        }
        found = Some(match found {
            None => inverse.into_iter().map(|x| (x.clone(), x)).collect(),
            Some(f) => f.into_iter().zip(inverse).map(|((l, h), x)| (l.min(x.clone()), h.max(x))).collect(),
        });
    }
    found
}

/// The widest a bound may be beyond the exact one, relative to the width of the hull and to the size of the entry.
pub fn is_tight(value: &IntervalMatrix, hull: &[(BigRational, BigRational)]) -> bool {
    value.entries().zip(hull).all(|(e, (least, most))| {
        let width = (most - least).to_f64().expect("a number");
        let size = most.abs().max(least.abs()).to_f64().expect("a number");
        let excess = |d: BigRational| d.to_f64().expect("a number");
        let allowed = 1e-12 * width + 4.0 * f64::EPSILON * size;
        q(e.lo()) <= *least
            && *most <= q(e.hi())
            && excess(least - q(e.lo())) <= allowed
            && excess(q(e.hi()) - most) <= allowed
    })
}
