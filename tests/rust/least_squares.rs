//! Enclosures of all least-squares solutions: members solved exactly, first-order width, honest statuses.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::cast_precision_loss, reason = "test data are small numbers")]

mod common;

use common::{Random, invert, q};
use interval_core::regression::{LeastSquares, LeastSquaresStatus, Rows, augmented, least_squares};
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};

/// The least-squares solution of a member, by its normal equations in rationals.
fn solution(a: &[f64], y: &[f64], n: usize) -> Vec<BigRational> {
    let rows: Vec<Vec<BigRational>> = a.chunks_exact(n).map(|r| r.iter().map(|&x| q(x)).collect()).collect();
    let mut gram = vec![BigRational::zero(); n * n];
    let mut right = vec![BigRational::zero(); n];
    for (row, &y) in rows.iter().zip(y) {
        for i in 0..n {
            right[i] += &row[i] * q(y);
            for j in 0..n {
                gram[i * n + j] += &row[i] * &row[j];
            }
        }
    }
    let inverse = invert(&gram, n).1.expect("full rank");
    (0..n).map(|i| (0..n).fold(BigRational::zero(), |s, j| s + &inverse[i * n + j] * &right[j])).collect()
}

struct Data {
    n: usize,
    bounds: [Vec<f64>; 4],
}

impl Data {
    fn random(random: &mut Random, m: usize, n: usize, radius: f64) -> Self {
        let mut bounds = [vec![], vec![], vec![], vec![]];
        for _ in 0..m {
            for _ in 0..n {
                let (c, r) = (random.unit(), radius * random.unit().abs());
                bounds[0].push(c - r);
                bounds[1].push(c + r);
            }
            let (c, r) = (3.0 * random.unit(), radius * random.unit().abs());
            bounds[2].push(c - r);
            bounds[3].push(c + r);
        }
        Self { n, bounds }
    }

    fn rows(&self) -> Rows<'_> {
        let [lower, upper, low, high] = &self.bounds;
        Rows::new(self.n, lower, upper, low, high).expect("good rows")
    }

    /// A member: each entry at an end, or anywhere between.
    fn member(&self, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
        let mut pick = |lower: &[f64], upper: &[f64]| -> Vec<f64> {
            lower
                .iter()
                .zip(upper)
                .map(|(&l, &u)| match random.bits() % 3 {
                    0 => l,
                    1 => u,
                    _ => (l + (u - l) * random.unit().abs()).clamp(l, u),
                })
                .collect()
        };
        (pick(&self.bounds[0], &self.bounds[1]), pick(&self.bounds[2], &self.bounds[3]))
    }
}

fn holds(fit: &LeastSquares, x: &[BigRational]) -> bool {
    let Some(bounds) = &fit.parameters else { return false };
    bounds.iter().zip(x).all(|(b, x)| q(b.lo()) <= *x && *x <= q(b.hi()))
}

#[test]
fn every_member_is_inside() {
    let mut random = Random(51);
    let (mut proved, mut wide) = (0, 0);
    for trial in 0..60 {
        let n = 1 + trial % 4;
        let m = n + trial % 9;
        let radius = [0.0, 1e-10, 1e-3, 0.02][trial / 15];
        let data = Data::random(&mut random, m, n, radius);
        let fit = least_squares(&data.rows()).expect("the default rounding");
        let dense = augmented(&data.rows()).expect("the default rounding");
        for found in [&fit, &dense] {
            if found.status != LeastSquaresStatus::Enclosed {
                assert!(found.parameters.is_none() && found.reason.is_some());
            }
        }
        for _ in 0..12 {
            let (a, y) = data.member(&mut random);
            let x = solution(&a, &y, n);
            if fit.status == LeastSquaresStatus::Enclosed {
                assert!(holds(&fit, &x), "trial {trial}, qr");
                proved += 1;
            }
            if dense.status == LeastSquaresStatus::Enclosed {
                assert!(holds(&dense, &x), "trial {trial}, augmented");
                wide += 1;
            }
        }
    }
    assert!(proved > 500 && wide > 400, "{proved} {wide}");
}

#[test]
fn points_are_enclosed_to_rounding_even_where_normal_equations_fail() {
    // Columns that are dependent to 1e-9: the condition of A'A is near 1e18.
    let mut random = Random(52);
    let (m, n) = (60, 3);
    let mut a = Vec::new();
    let mut y = Vec::new();
    for _ in 0..m {
        let (p, r) = (random.unit(), random.unit());
        a.extend([p, r, p + 1e-9 * random.unit()]);
        y.push(random.unit());
    }
    let fit = least_squares(&Rows::new(n, &a, &a, &y, &y).expect("good rows")).expect("the default rounding");
    assert_eq!(fit.status, LeastSquaresStatus::Enclosed, "{:?}", fit.reason);
    let exact = solution(&a, &y, n);
    assert!(holds(&fit, &exact));
    let size = exact.iter().map(|x| x.to_f64().unwrap_or(0.0).abs()).fold(0.0, f64::max);
    assert!(fit.parameters.expect("enclosed").iter().all(|x| x.width() < 1e-4 * size));
    // Well conditioned: a few units in the last place.
    let data = Data::random(&mut random, 200, 4, 0.0);
    let fit = least_squares(&data.rows()).expect("the default rounding").parameters.expect("enclosed");
    assert!(fit.iter().all(|x| x.width() < 1e-13), "{fit:?}");
}

#[test]
fn the_width_is_that_of_first_order() {
    let mut random = Random(53);
    let (m, n, radius) = (80, 3, 1e-6);
    let data = Data::random(&mut random, m, n, radius);
    let fit = least_squares(&data.rows()).expect("the default rounding").parameters.expect("enclosed");
    // Each bound moved by itself changes the solution by its share of the first order: the sum of the shares is the
    // width.
    let middle =
        |k: usize| -> Vec<f64> { data.bounds[k].iter().zip(&data.bounds[k + 1]).map(|(l, u)| 0.5 * (l + u)).collect() };
    let (a, y) = (middle(0), middle(2));
    let base: Vec<f64> = solution(&a, &y, n).iter().map(|x| x.to_f64().unwrap_or(f64::NAN)).collect();
    let mut shares = vec![0.0; n];
    let mut note = |a: &[f64], y: &[f64]| {
        for (s, (x, b)) in shares.iter_mut().zip(solution(a, y, n).iter().zip(&base)) {
            *s += (x.to_f64().unwrap_or(f64::NAN) - b).abs();
        }
    };
    for k in 0..m * n {
        let mut moved = a.clone();
        moved[k] = data.bounds[1][k];
        note(&moved, &y);
    }
    for k in 0..m {
        let mut moved = y.clone();
        moved[k] = data.bounds[3][k];
        note(&a, &moved);
    }
    for (x, s) in fit.iter().zip(shares) {
        assert!(x.width() < 2.0 * s * 1.001, "{} against {}", x.width(), 2.0 * s);
    }
}

#[test]
fn what_cannot_be_proved_says_why() {
    let twice = [1.0, 2.0, 2.0, 4.0, 3.0, 6.0];
    let y = [1.0, 2.0, 3.0];
    let fit = least_squares(&Rows::new(2, &twice, &twice, &y, &y).expect("good rows")).expect("the default rounding");
    assert_eq!(fit.status, LeastSquaresStatus::NotProved);
    assert!(fit.reason.is_some_and(|r| r.contains("dependent")));
    let few = Rows::new(2, &twice[..2], &twice[..2], &y[..1], &y[..1]).expect("good rows");
    for solve in [least_squares, augmented] {
        let fit = solve(&few).expect("the default rounding");
        assert_eq!(
            (fit.status, fit.reason.as_deref()),
            (LeastSquaresStatus::NotApplicable, Some("1 rows leave 2 parameters undetermined"))
        );
    }
    let (low, high) = ([f64::NEG_INFINITY, 1.0, 1.0], [1.0, 2.0, 2.0]);
    let fit = least_squares(&Rows::new(1, &y, &y, &low, &high).expect("good rows")).expect("the default rounding");
    assert_eq!(fit.status, LeastSquaresStatus::NotApplicable);
    // Regressors that may all vanish: some members have no full rank.
    let fit = least_squares(&Rows::new(1, &[-1.0, -1.0], &[1.0, 1.5], &[1.0, 1.0], &[1.0, 1.0]).expect("good rows"));
    assert_eq!(fit.expect("the default rounding").status, LeastSquaresStatus::NotProved);
    let ones = vec![1.0; 1200];
    let fit = augmented(&Rows::new(1, &ones, &ones, &ones, &ones).expect("good rows")).expect("the default rounding");
    assert_eq!(fit.status, LeastSquaresStatus::NotApplicable);
}

#[test]
fn threads_do_not_change_the_bits() {
    let data = Data::random(&mut Random(54), 40_000, 3, 0.01);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| least_squares(&data.rows()).expect("the default rounding"))
    };
    let one = on(1);
    assert_eq!(one.status, LeastSquaresStatus::Enclosed);
    assert_eq!(one, on(3));
}
