//! Proofs of signs, checked in rationals: the orthants that are not looked at hold no consistent parameter.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]

mod common;

use common::rows::{Data, data, plain};
use common::{integer, invert, q};
use interval_core::Interval;
use interval_core::regression::{FeasibleOptions, FeasibleSet, FeasibleStatus, SignProof};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// The statement of a certificate of signs, in rationals: a reach of each of its columns, refined until it proves what is
/// stated or twenty times. Every refinement is a bound, and none is larger than the one before it.
fn reach(data: &Data, proof: &SignProof) -> Option<Vec<BigRational>> {
    let n = data.n;
    let half_space = |i: usize, below: bool| -> (Vec<BigRational>, BigRational) {
        let g = (0..n)
            .map(|j| {
                let at = i * n + j;
                let upper = (proof.home[j] < 0) != below;
                let value = q(if upper { data.upper[at] } else { data.lower[at] });
                if below { -value } else { value }
            })
            .collect();
        (g, if below { -q(data.low[i]) } else { q(data.high[i]) })
    };
    let k = proof.columns.len();
    let (mut least, mut growth) = (Vec::new(), Vec::new());
    for column in &proof.columns {
        let mut planes: Vec<(Vec<BigRational>, BigRational)> =
            column.rows.iter().map(|&(i, below, _)| half_space(i, below)).collect();
        for &(j, _) in &column.signs {
            assert_ne!(proof.decided[j], 0, "only signs that are decided may be used");
            let g = (0..n).map(|c| integer(if c == j { -i64::from(proof.decided[j]) } else { 0 })).collect();
            planes.push((g, BigRational::zero()));
        }
        if planes.len() != n {
            return None;
        }
        // sum l g = -home e_j
        let transposed: Vec<BigRational> = (0..n).flat_map(|r| planes.iter().map(move |p| p.0[r].clone())).collect();
        let inverse = invert(&transposed, n).1?;
        let target = integer(-i64::from(proof.home[column.column]));
        let l: Vec<BigRational> = (0..n).map(|i| &inverse[i * n + column.column] * &target).collect();
        if l.iter().any(Signed::is_negative) {
            return None;
        }
        least.push(l.iter().zip(&planes).fold(BigRational::zero(), |s, (l, p)| s - l * &p.1));
        for other in &proof.columns {
            let j = other.column;
            growth.push(column.rows.iter().zip(&l).fold(BigRational::zero(), |s, (&(i, ..), l)| {
                s + l * (q(data.upper[i * n + j]) - q(data.lower[i * n + j]))
            }));
        }
    }
    let times = |v: &[BigRational], i: usize| (0..k).fold(BigRational::zero(), |s, j| s + &growth[i * k + j] * &v[j]);
    let vector: Vec<BigRational> = proof.vector.iter().map(|&v| q(v)).collect();
    if vector.len() != k {
        return None;
    }
    let mut factor = BigRational::zero();
    for i in 0..k {
        let rest = &vector[i] - times(&vector, i);
        if !rest.is_positive() || !vector[i].is_positive() {
            return None;
        }
        factor = factor.max((-&least[i]).max(BigRational::zero()) / rest);
    }
    let mut reach: Vec<BigRational> = vector.iter().map(|v| v * &factor).collect();
    for _ in 0..20 {
        if reach.iter().zip(&proof.reach).all(|(found, &stated)| *found <= q(stated)) {
            break;
        }
        reach = (0..k).map(|i| (times(&reach, i) - &least[i]).max(BigRational::zero()).min(reach[i].clone())).collect();
    }
    Some(reach)
}

/// True if the proofs of signs and the orthants listed cover every sign vector.
fn covered(data: &Data, set: &FeasibleSet) -> bool {
    let rows = data.rows();
    let mut regions = vec![vec![0_i8; data.n]];
    while let Some(mut region) = regions.pop() {
        if let Some(proof) = set.sign_proofs.iter().find(|p| p.decided == region) {
            let Some(proved) = reach(data, proof) else {
                return proof.vector.is_empty() && descend(&mut regions, proof);
            };
            for ((column, stated), proved) in proof.columns.iter().zip(&proof.reach).zip(proved) {
                if proved > q(*stated) {
                    return false;
                }
                if *stated == 0.0 {
                    region[column.column] = proof.home[column.column];
                }
            }
            if let Some(j) = proof.branch {
                for sign in [1, -1] {
                    region[j] = sign;
                    regions.push(region.clone());
                }
                continue;
            }
        }
        match (0..data.n).find(|&j| rows.uncertain()[j] && region[j] == 0) {
            Some(j) => {
                for sign in [1, -1] {
                    region[j] = sign;
                    regions.push(region.clone());
                }
            }
            None if set.orthants.iter().any(|o| o.signs == region) => {}
            None => return false,
        }
    }
    true
}

/// A proof that proves nothing only branches.
fn descend(regions: &mut Vec<Vec<i8>>, proof: &SignProof) -> bool {
    let Some(j) = proof.branch else { return false };
    for sign in [1, -1] {
        let mut region = proof.decided.clone();
        region[j] = sign;
        regions.push(region);
    }
    true
}

#[test]
fn proofs_of_signs_cover_what_is_not_looked_at() {
    let mut saved = 0;
    for seed in 0..12 {
        let n = 5 + (seed % 3) as usize;
        // Some parameters near zero: their signs stay open.
        let mut data = data(seed, 220, n, 0.01, 0.3, 5.0);
        if seed % 2 == 1 {
            for i in 0..data.count() {
                let middle = 0.5 * (data.lower[i * n] + data.upper[i * n]);
                data.low[i] -= middle * data.truth[0];
                data.high[i] -= middle * data.truth[0];
                data.low[i] -= 0.01 * data.truth[0].abs();
                data.high[i] += 0.01 * data.truth[0].abs();
            }
            data.truth[0] = 0.0;
        }
        let set = data.set(&plain());
        assert_eq!(set.status, FeasibleStatus::Enclosed, "seed {seed}");
        assert!(set.parameters.iter().zip(&data.truth).all(|(x, t)| x.contains(*t)));
        assert!(covered(&data, &set), "seed {seed}: the certificate does not cover every orthant");
        saved += (1 << n) - set.orthants.len();
        // The same hull with every orthant by itself.
        let mut whole = vec![Interval::EMPTY; n];
        for bits in 0..1_usize << n {
            let signs = (0..n).map(|j| if bits >> j & 1 == 0 { 1 } else { -1 }).collect();
            let part = data.set(&FeasibleOptions { signs: Some(signs), ..plain() });
            whole.iter_mut().zip(part.parameters.iter()).for_each(|(w, x)| *w = w.hull(*x));
        }
        for (x, w) in set.parameters.iter().zip(&whole) {
            let slack = 1e-12 * (1.0 + w.magnitude());
            assert!((x.lo() - w.lo()).abs() <= slack && (x.hi() - w.hi()).abs() <= slack, "seed {seed}: {x} {w}");
        }
        // A proof that claims more than it shows is noticed.
        if let Some(at) = set.sign_proofs.iter().position(|p| p.reach.iter().any(|r| *r > 0.0 && r.is_finite())) {
            let mut forged = set.clone();
            forged.sign_proofs[at].reach.fill(0.0);
            forged.sign_proofs[at].branch = None;
            assert!(!covered(&data, &forged), "seed {seed}");
        }
    }
    assert!(saved > 600, "{saved}");
}

#[test]
fn twenty_parameters_with_uncertain_regressors() {
    let data = data(5, 4000, 20, 0.002, 0.2, 10.0);
    let set = data.set(&plain());
    assert_eq!(set.status, FeasibleStatus::Enclosed, "{:?}", set.reason);
    assert!(set.parameters.iter().zip(&data.truth).all(|(x, t)| x.contains(*t) && x.width() < 2.0));
    assert!(set.orthants.len() < 64, "{}", set.orthants.len());
}
