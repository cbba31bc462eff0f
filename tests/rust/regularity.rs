//! Verdicts on regularity: never wrong, and each certificate holds in exact arithmetic.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "test data are small numbers"
)]

mod common;

use common::corners::{hull, matrix as from_ends};
use common::{Random, integer, invert, q};
use interval_core::IntervalMatrix;
use interval_core::inverse::Certificate;
use interval_core::regularity::{Regularity, SingularMember, Witness, regularity};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// Matrices to judge; the full number takes minutes.
fn cases(default: usize) -> usize {
    std::env::var("IVSID_CASES").ok().and_then(|v| v.parse::<f64>().ok()).map_or(default, |v| v as usize)
}

fn matrix(n: usize, centre: &[f64], radius: &[f64]) -> IntervalMatrix {
    let end = |sign: f64| centre.iter().zip(radius).map(|(c, r)| c + sign * r).collect();
    IntervalMatrix::new(n, n, end(-1.0), end(1.0)).expect("a good matrix")
}

/// The truth, by the determinants of all vertex matrices in integers (Baumann): small orders only.
fn is_regular(a: &IntervalMatrix) -> bool {
    let n = a.rows();
    let mut sign = 0;
    (0..1_usize << (2 * n - 1)).all(|bits| {
        let (y, z) = (bits >> n, bits & ((1 << n) - 1));
        let vertex: Vec<BigRational> = (0..n * n)
            .map(|at| if ((y >> (at / n)) ^ (z >> (at % n))) & 1 == 1 { q(a.hi()[at]) } else { q(a.lo()[at]) })
            .collect();
        let determinant = determinant(&vertex, n);
        let this = if determinant.is_zero() {
            0
        } else if determinant.is_positive() {
            1
        } else {
            -1
        };
        if sign == 0 {
            sign = this;
        }
        this != 0 && this == sign
    })
}

/// By expansion: independent of any elimination.
fn determinant(a: &[BigRational], n: usize) -> BigRational {
    if n == 1 {
        return a[0].clone();
    }
    (0..n).fold(BigRational::zero(), |sum, j| {
        let minor: Vec<BigRational> = (n..n * n).filter(|at| at % n != j).map(|at| a[at].clone()).collect();
        let term = &a[j] * determinant(&minor, n - 1);
        if j % 2 == 0 { sum + term } else { sum - term }
    })
}

#[test]
fn verdicts_are_those_of_exact_determinants() {
    let mut random = Random(2024);
    let mut counts = [0; 3];
    for case in 0..cases(1500) {
        let n = 1 + case % 3;
        // Whole multiples of 1/8 meet the border between the verdicts often.
        let coarse = case % 2 == 0;
        let number = |x: f64| if coarse { (8.0 * x).round() / 8.0 } else { x };
        let centre: Vec<f64> = (0..n * n).map(|_| number(2.0 * random.unit())).collect();
        let spread = number(0.6 * random.unit().abs());
        let radius: Vec<f64> = (0..n * n).map(|_| if random.bits().is_multiple_of(4) { 0.0 } else { spread }).collect();
        let a = matrix(n, &centre, &radius);
        let truth = is_regular(&a);
        match regularity(&a).expect("square") {
            Regularity::Regular(witness) => {
                counts[0] += 1;
                assert!(truth, "{a:?} is singular, {witness:?}");
                assert!(Certificate::Regular(witness).verify(&a), "{a:?}");
            }
            Regularity::Singular(member) => {
                counts[1] += 1;
                assert!(!truth, "{a:?} is regular, {member:?}");
                assert!(Certificate::Singular(member).verify(&a), "{a:?}");
            }
            Regularity::NotProved => counts[2] += 1,
        }
    }
    assert!(counts[0] > 300 && counts[1] > 300 && counts[2] == 0, "{counts:?}");
}

/// Beyond the orders whose vertices are examined.
#[test]
fn larger_matrices_have_certificates_that_hold() {
    let mut random = Random(7);
    let mut kinds = [0; 5];
    for case in 0..cases(120).min(2000) {
        let n = 5 + case % 6;
        let centre: Vec<f64> = (0..n * n)
            .map(|at| {
                let orthogonal = (0.5 + (at / n) as f64) * (0.5 + (at % n) as f64);
                match case % 3 {
                    0 => random.unit() + if at.is_multiple_of(n + 1) { 2.0 } else { 0.0 },
                    // A cosine transform: orthogonal, so small radii everywhere keep it regular.
                    1 => (std::f64::consts::PI * orthogonal / n as f64).cos(),
                    _ => random.unit(),
                }
            })
            .collect();
        let spread = match case % 3 {
            1 => 0.28 / n as f64 * (1.0 + 0.9 * random.unit()) * (n as f64).sqrt(),
            _ => 0.3 * random.unit().abs() / n as f64,
        };
        let a = matrix(n, &centre, &vec![spread; n * n]);
        match regularity(&a).expect("square") {
            Regularity::Regular(witness) => {
                kinds[match witness {
                    Witness::PositiveDefinite { .. } => 1,
                    Witness::Cells(_) => 2,
                    _ => 0,
                }] += 1;
                assert!(Certificate::Regular(witness).verify(&a));
                let member: Vec<BigRational> = (a.lo().iter().zip(a.hi()))
                    .map(|(&l, &h)| q(if random.bits().is_multiple_of(2) { l } else { h }))
                    .collect();
                assert!(invert(&member, n).1.is_some());
            }
            Regularity::Singular(member) => {
                kinds[3] += 1;
                assert!(Certificate::Singular(member).verify(&a));
            }
            Regularity::NotProved => kinds[4] += 1,
        }
    }
    assert!(kinds[0] > 20 && kinds[1] > 0 && kinds[3] > 10, "{kinds:?}");
}

/// Regular, but neither strongly nor by the norm of the radii: proved by cells.
#[test]
fn cells_prove_what_one_contraction_does_not() {
    let n = 5;
    let mut centre = vec![0.0; n * n];
    let mut radius = vec![0.0; n * n];
    for i in 0..n {
        centre[i * (n + 1)] = 1.0;
    }
    // [[1, [-0.95, 0.95]], [[-0.2, 1.1], 1]]: the product of the two stays below 1 on one side only where both are bounded.
    (centre[1], radius[1]) = (0.0, 0.85);
    (centre[n], radius[n]) = (0.0, 1.15);
    let a = matrix(n, &centre, &radius);
    let Ok(Regularity::Regular(witness)) = regularity(&a) else { panic!("{:?}", regularity(&a)) };
    assert!(Certificate::Regular(witness).verify(&a));
    radius[n] = 1.2;
    let Ok(Regularity::Singular(member)) = regularity(&matrix(n, &centre, &radius)) else { panic!("1.2 x 0.85 > 1") };
    assert!(matches!(member, SingularMember::NullVector(_)));
}

#[test]
fn tampered_certificates_are_refused() {
    let a = matrix(2, &[3.0, 1.0, 0.5, 2.0], &[0.1; 4]);
    let wider = matrix(2, &[3.0, 1.0, 0.5, 2.0], &[1.5; 4]);
    let Ok(Regularity::Regular(witness)) = regularity(&a) else { panic!("regular") };
    assert!(Certificate::Regular(witness.clone()).verify(&a));
    assert!(!Certificate::Regular(witness.clone()).verify(&wider));
    let Witness::Contraction { mut approximate_inverse, norm } = witness else { panic!("a contraction") };
    approximate_inverse[0] = 5.0;
    assert!(!Certificate::Regular(Witness::Contraction { approximate_inverse, norm }).verify(&a));
    assert!(!Certificate::Regular(Witness::VertexDeterminants { sign: -1 }).verify(&a));
    assert!(Certificate::Regular(Witness::VertexDeterminants { sign: 1 }).verify(&a));
    assert!(!Certificate::Regular(Witness::NonnegativeInverses).verify(&a));
    assert!(!Certificate::Singular(SingularMember::NullVector(vec![0.0, 0.0])).verify(&wider));
    assert!(!Certificate::Singular(SingularMember::NullVector(vec![1.0, -1.0])).verify(&a));
    assert!(!Certificate::Singular(SingularMember::Member(vec![3.0, 1.0, 0.5, 2.0])).verify(&a));
    assert!(!Certificate::Determinant { lo: -1.0, hi: 7.0 }.verify(&a));
    assert!(Certificate::Determinant { lo: 4.0, hi: 7.0 }.verify(&a));
    assert!(!Certificate::Determinant { lo: 5.5, hi: 7.0 }.verify(&a));
}

/// Sizes at which squares overflow prove nothing.
#[test]
fn huge_entries_do_not_pass_for_regular() {
    let (least, most) = (-(2.0_f64.powi(512)), 2.0_f64.powi(512) + 2.0_f64.powi(460));
    for n in [1, 2, 5] {
        let end = |x: f64| {
            (0..n * n)
                .map(|at: usize| if at == 0 { x } else { f64::from(u8::from(at.is_multiple_of(n + 1))) })
                .collect()
        };
        let a = IntervalMatrix::new(n, n, end(least), end(most)).expect("a good matrix");
        assert!(!matches!(regularity(&a), Ok(Regularity::Regular(_))), "n = {n}");
    }
    let mut random = Random(4);
    for exponent in [0, 300, 505, 509, 511, 512] {
        // Rows of a Hadamard matrix with radii at the border of the spectral test.
        let centre: Vec<f64> = (0..64_u32)
            .map(|at| if ((at / 8) & (at % 8)).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 })
            .map(|s| (s + 1e-3 * random.unit()) * 2.0_f64.powi(exponent))
            .collect();
        for spread in [0.3, 0.36, 0.5] {
            let a = matrix(8, &centre, &vec![spread * 2.0_f64.powi(exponent); 64]);
            match regularity(&a).expect("square") {
                Regularity::Regular(w) => assert!(Certificate::Regular(w).verify(&a) && spread < 0.36, "2^{exponent}"),
                Regularity::Singular(m) => {
                    assert!(Certificate::Singular(m).verify(&a) && spread > 0.35, "2^{exponent}");
                }
                Regularity::NotProved => {}
            }
        }
    }
    assert!(regularity(&IntervalMatrix::new(2, 1, vec![1.0; 2], vec![1.0; 2]).expect("good")).is_err());
    assert!(IntervalMatrix::new(1 << 32, 1 << 32, vec![], vec![]).is_err());
    let half = matrix(1, &[2.125], &[0.875]);
    let claim = |norm: f64| Certificate::Regular(Witness::Contraction { approximate_inverse: vec![0.5], norm });
    assert!(claim(0.5).verify(&half) && !claim(0.0).verify(&half) && !claim(7.0).verify(&half));
}

/// Beyond the orders whose vertices are examined: regular by a scaled norm, and never for a matrix with a singular
/// member.
#[test]
fn regularity_of_larger_matrices() {
    let mut random = Random(17);
    let (mut proved, mut singular) = (0, 0);
    for _ in 0..200 {
        let n = 5 + (random.bits() % 8) as usize;
        let scale: Vec<f64> = (0..n).map(|_| 2.0_f64.powi((random.bits() % 40) as i32)).collect();
        let entry = |random: &mut Random, i: usize, j: usize| {
            (random.unit() + if i == j { 4.0 } else { 0.0 }) * scale[i] / scale[j]
        };
        let centre: Vec<f64> = (0..n * n).map(|at| entry(&mut random, at / n, at % n)).collect();
        let spread = 0.3 * random.unit().abs();
        let (lo, hi): (Vec<f64>, Vec<f64>) =
            centre.iter().map(|c| (c - spread * c.abs(), c + spread * c.abs())).unzip();
        match regularity(&from_ends(n, &lo, &hi)).expect("square") {
            Regularity::Regular(_) => {
                proved += 1;
                // Members are as regular as it says: exactly nonsingular.
                let member: Vec<BigRational> =
                    lo.iter().zip(&hi).map(|(&l, &h)| q(if random.bits().is_multiple_of(2) { l } else { h })).collect();
                assert!(invert(&member, n).1.is_some());
            }
            Regularity::NotProved => {}
            Regularity::Singular(member) => {
                singular += 1;
                assert!(is_singular(&from_ends(n, &lo, &hi), &member));
            }
        }
        // A member with two equal rows.
        let mut wide = (lo.clone(), hi.clone());
        for j in 0..n {
            let (a, b) = (centre[j], centre[n + j]);
            (wide.0[j], wide.1[j]) = (a.min(b), a.max(b));
            (wide.0[n + j], wide.1[n + j]) = (a.min(b), a.max(b));
        }
        assert!(!matches!(regularity(&from_ends(n, &wide.0, &wide.1)), Ok(Regularity::Regular(_))));
    }
    assert!(proved > 40 && singular > 5, "{proved} regular, {singular} singular");
}

/// True if a certificate of a singular member holds, in rationals.
fn is_singular(a: &IntervalMatrix, member: &SingularMember) -> bool {
    let n = a.rows();
    let belongs = |m: &[f64]| m.iter().zip(a.entries()).all(|(&x, e)| e.contains(x));
    let determinant = |m: &[f64]| invert(&m.iter().map(|&x| q(x)).collect::<Vec<_>>(), n).0;
    match member {
        SingularMember::Member(m) => belongs(m) && determinant(m).is_zero(),
        SingularMember::OppositeSigns(m, o) => {
            belongs(m) && belongs(o) && (determinant(m) * determinant(o)).is_negative()
        }
        SingularMember::NullVector(x) => {
            let row = |i: usize| {
                let ends = (0..n).map(|j| {
                    let (l, h) = (q(a.get(i, j).lo()) * q(x[j]), q(a.get(i, j).hi()) * q(x[j]));
                    (l.clone().min(h.clone()), l.max(h))
                });
                ends.fold((BigRational::zero(), BigRational::zero()), |(s, t), (l, h)| (s + l, t + h))
            };
            x.iter().any(|&v| v != 0.0)
                && (0..n).map(row).all(|(least, most)| !least.is_positive() && !most.is_negative())
        }
    }
}

#[test]
fn regularity_agrees_with_exact_determinants() {
    let mut verdicts = [0; 2];
    let mut random = Random(3);
    for n in 1..=3 {
        for _ in 0..400 {
            let centre: Vec<f64> = (0..n * n).map(|_| random.unit()).collect();
            let r = 0.4 * random.unit().abs();
            let a = from_ends(
                n,
                &centre.iter().map(|c| c - r).collect::<Vec<_>>(),
                &centre.iter().map(|c| c + r).collect::<Vec<_>>(),
            );
            match (regularity(&a).expect("square"), hull(&a).is_some()) {
                (Regularity::Regular(_), true) => verdicts[0] += 1,
                (Regularity::Singular(_), false) => verdicts[1] += 1,
                (verdict, truth) => panic!("{verdict:?} for an interval matrix whose regularity is {truth}"),
            }
        }
    }
    assert!(verdicts.iter().all(|&v| v > 50), "{verdicts:?}");
}

/// The oracle of all tests of inverses: its product with the matrix is the identity, its determinant that of an expansion,
/// with rows to swap and denominators that are no powers of two.
#[test]
fn the_oracle_inverts() {
    let mut random = Random(41);
    let mut singular = 0;
    for case in 0..200 {
        let n = 1 + case % 5;
        let mut a: Vec<BigRational> = (0..n * n)
            .map(|_| BigRational::new(((random.bits() % 7).cast_signed() - 3).into(), ((random.bits() % 6) + 1).into()))
            .collect();
        if n > 1 {
            a[0] = BigRational::zero();
        }
        let (found, inverse) = invert(&a, n);
        assert_eq!(found, determinant(&a, n));
        let Some(inverse) = inverse else {
            singular += 1;
            continue;
        };
        for i in 0..n {
            for j in 0..n {
                let sum = (0..n).fold(BigRational::zero(), |s, k| s + &a[i * n + k] * &inverse[k * n + j]);
                assert_eq!(sum, integer(i64::from(i == j)));
            }
        }
    }
    assert!(singular > 5 && singular < 100, "{singular}");
}
