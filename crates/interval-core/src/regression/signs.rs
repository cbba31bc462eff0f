//! The orthants that the set can meet: signs that are proved, and a branch for any other.
//!
//! Take a sign vector `z` (the home) and let `d_k = max(0, -z_k x_k)` say how far a consistent `x` lies on the other
//! side. From `|x_k| = z_k x_k + 2 d_k` every row's half-space of the home's polyhedron holds at `x` up to
//! `2 sum_k D_ik d_k`. So multipliers `l` that prove `z_j x_j >= b_j` in that polyhedron, without the constraints on
//! its own signs, prove for every consistent `x` `z_j x_j >= b_j - sum_k M_jk d_k` with `M_jk = 2 sum_i l_i D_ik`, and
//!
//! `d <= (M d - b)+ <= M d + p`,  `p = max(0, -b)`.
//!
//! If some `v > 0` has `M v < v`, then `d <= t v` with `t = max p_j / (v - M v)_j`, and `d <- min(d, (M d - b)+)`
//! sharpens that. If `d_j = 0`, the sign of `x_j` is proved, from at most `n` rows each. Signs that stay open are
//! branched on, each side with a proof of its own.

use super::orthant::{DataRow, Orthant};
use super::rows::Rows;
use super::search::{Asked, Piece, Pool, solve};
use crate::approximate::least_squares;
use crate::exact::{ratio_down, ratio_up, rational};
use crate::linear_program::{Outcome, Row, basis_multipliers, enclosed_bound, enclosed_multipliers, exact_bound};
use crate::regularity::{contracted_vector, slack, times};
use crate::rounding::{add_up, div_up, sub_up};
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};

/// Orthants and proofs of signs of one set at most: a bound of the time.
pub const ORTHANT_LIMIT: usize = 4096;
/// Open signs up to which every orthant is looked at without a proof of signs: 16 orthants at most.
const FEW: usize = 4;
/// Repetitions of the sharpening step. Each of them keeps a bound, so a checker may do the same number.
const SHARPENED: usize = 10;

/// A proof of signs: of all consistent parameters whose signs are those `decided`, none lies further than `reach` on
/// the other side of `home`.
#[derive(Debug, Clone, PartialEq)]
pub struct SignProof {
    /// The part of the space that is meant: 1 or -1 for a sign that holds there, 0 for none.
    pub decided: Vec<i8>,
    /// The signs that the rows' coefficients are made with; 0 for an unknown that needs no sign.
    pub home: Vec<i8>,
    /// For each column without a decided sign: rows and signs of the basis that bounds `home[j] * x[j]` from below.
    pub columns: Vec<SignRows>,
    /// A positive vector `v` with `M v < v`, an entry for each of `columns`; empty where none was found.
    pub vector: Vec<f64>,
    /// The distance to which each of `columns` may lie on the other side: 0 proves its sign, infinity proves nothing.
    pub reach: Vec<f64>,
    /// The column whose two signs are looked at apart. The value is `None` if every sign is proved.
    pub branch: Option<usize>,
}

/// The basis that bounds one column.
#[derive(Debug, Clone, PartialEq)]
pub struct SignRows {
    /// The column.
    pub column: usize,
    /// Row number, whether its lower right-hand side is meant, multiplier; empty where nothing was found.
    pub rows: Vec<DataRow>,
    /// Decided signs in the basis, with their multipliers.
    pub signs: Vec<(usize, f64)>,
}

/// Sign vectors that cover every consistent parameter, in a fixed order, with the proofs that leave out the others. The
/// value is `None` if there would be too many.
pub(crate) fn cover(rows: &Rows<'_>, pool: &mut Pool, known: &[i8]) -> Option<(Vec<Vec<i8>>, Vec<SignProof>)> {
    let home = guess(rows, pool, known);
    let (mut leaves, mut proofs) = (Vec::new(), Vec::new());
    let mut regions = vec![known.to_vec()];
    while !regions.is_empty() {
        let (few, many): (Vec<_>, Vec<_>) =
            regions.into_iter().partition(|decided| open(rows, decided).len() <= FEW.min(rows.columns()));
        leaves.extend(few.iter().flat_map(|decided| all(rows, decided)));
        let mut pieces: Vec<Piece<'_>> = many.iter().map(|decided| loose(rows, pool, decided, &home)).collect();
        solve(rows, pool, &mut pieces, Asked::Each);
        regions = Vec::new();
        for (decided, piece) in many.into_iter().zip(&pieces) {
            let proof = prove_signs(&decided, piece);
            let mut rest = decided;
            for (column, &reach) in proof.columns.iter().zip(&proof.reach) {
                if reach == 0.0 {
                    rest[column.column] = proof.home[column.column];
                }
            }
            match proof.branch {
                None => leaves.push(rest),
                Some(j) => {
                    for sign in [proof.home[j], -proof.home[j]] {
                        rest[j] = sign;
                        regions.push(rest.clone());
                    }
                }
            }
            proofs.push(proof);
        }
        if leaves.len() + regions.len() > ORTHANT_LIMIT || proofs.len() > ORTHANT_LIMIT {
            return None;
        }
    }
    Some((leaves, proofs))
}

/// Columns that need a sign and have none.
fn open(rows: &Rows<'_>, decided: &[i8]) -> Vec<usize> {
    (0..decided.len()).filter(|&j| rows.uncertain()[j] && decided[j] == 0).collect()
}

/// Every sign vector beside the known ones. The value is `None` if there would be too many.
pub(crate) fn every(rows: &Rows<'_>, known: &[i8]) -> Option<Vec<Vec<i8>>> {
    (1_u64.checked_shl(u32::try_from(open(rows, known).len()).ok()?)? <= ORTHANT_LIMIT as u64).then(|| all(rows, known))
}

/// Every sign vector of a region.
fn all(rows: &Rows<'_>, decided: &[i8]) -> Vec<Vec<i8>> {
    let open = open(rows, decided);
    (0..1_usize << open.len())
        .map(|bits| {
            let mut signs = decided.to_vec();
            for (k, &j) in open.iter().enumerate() {
                signs[j] = if bits >> k & 1 == 0 { 1 } else { -1 };
            }
            signs
        })
        .collect()
}

/// The signs of a least-squares solution of the rows at hand.
fn guess(rows: &Rows<'_>, pool: &Pool, known: &[i8]) -> Vec<i8> {
    let m = rows.count();
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for &i in pool.members.iter().filter(|&&index| index < m) {
        let ((lower, upper), (low, high)) = (rows.row(i), rows.right(i));
        if lower.iter().chain(upper).chain([&low, &high]).all(|x| x.is_finite()) {
            a.extend(lower.iter().zip(upper).map(|(l, u)| 0.5 * l + 0.5 * u));
            b.push(0.5 * low + 0.5 * high);
        }
    }
    let solution = least_squares(&a, &b, rows.columns());
    let sign = |(j, &x): (usize, &f64)| match (known[j], rows.uncertain()[j]) {
        (0, false) => 0,
        (0, true) if x < 0.0 => -1,
        (0, true) => 1,
        (sign, _) => sign,
    };
    solution.iter().enumerate().map(sign).collect()
}

/// The polyhedron of the home's coefficients in which only decided signs are held.
fn loose<'a>(rows: &'a Rows<'a>, pool: &Pool, decided: &[i8], home: &[i8]) -> Piece<'a> {
    let signs: Vec<i8> = decided.iter().zip(home).map(|(&d, &h)| if d == 0 { h } else { d }).collect();
    let goals: Vec<(usize, f64)> = open(rows, decided).into_iter().map(|j| (j, f64::from(signs[j]))).collect();
    let mut orthant = Orthant::new(rows, signs);
    orthant.loose = decided.iter().map(|&d| d == 0).collect();
    let mut piece = Piece::new(orthant, pool, &goals);
    piece.persistent = true;
    piece
}

/// One column's part of the proof: `b`, the row of `M` over the open columns, and the basis.
struct Line {
    least: f64,
    growth: Vec<f64>,
    rows: Vec<(usize, f64)>,
}

fn prove_signs(decided: &[i8], piece: &Piece<'_>) -> SignProof {
    let orthant = &piece.orthant;
    let open: Vec<usize> = piece.goals.iter().map(|g| g.column).collect();
    let lines: Vec<Option<Line>> =
        crate::parallel::map(piece.goals.len(), piece.goals.len() > 4, |k| line(piece, k, &open));
    let k = open.len();
    let columns = open
        .iter()
        .zip(&lines)
        .map(|(&column, line)| {
            let (rows, signs) = line.as_ref().map_or((Vec::new(), Vec::new()), |l| orthant.split(&l.rows));
            SignRows { column, rows, signs }
        })
        .collect();
    let mut proof = SignProof {
        decided: decided.to_vec(),
        home: orthant.signs.clone(),
        columns,
        vector: Vec::new(),
        reach: vec![f64::INFINITY; k],
        branch: None,
    };
    let complete: Option<Vec<Line>> = lines.into_iter().collect();
    let growth: Vec<f64>;
    if let Some(lines) = complete {
        growth = lines.iter().flat_map(|l| l.growth.iter().copied()).collect();
        let slack_of = |vector: Vec<f64>| slack(&growth, &vector).map(|rest| (vector, rest));
        if let Some((vector, rest)) = contracted_vector(&growth, k).and_then(slack_of) {
            let factor = lines.iter().zip(&rest).map(|(l, &r)| div_up((-l.least).max(0.0), r)).fold(0.0, f64::max);
            let mut reach: Vec<f64> = vector.iter().map(|&v| crate::rounding::mul_up(factor, v)).collect();
            for _ in 0..SHARPENED {
                let grown = times(&growth, &reach);
                for ((r, g), l) in reach.iter_mut().zip(grown).zip(&lines) {
                    // Upper bounds of zeros come with a few of the smallest doubles.
                    let g = if factor == 0.0 { 0.0 } else { g };
                    *r = r.min(sub_up(g, l.least).max(0.0));
                }
            }
            if reach.iter().all(|r| r.is_finite()) {
                (proof.vector, proof.reach) = (vector, reach);
            }
        }
    } else {
        growth = Vec::new();
    }
    proof.branch = branch(&open, &proof.reach, &growth);
    proof
}

/// The open column that stands most in the way: without a proof the one that the others depend on most, else the one
/// that reaches furthest.
fn branch(open: &[usize], reach: &[f64], growth: &[f64]) -> Option<usize> {
    let k = open.len();
    let weight = |at: usize| -> f64 {
        if reach[at].is_finite() || growth.is_empty() {
            reach[at]
        } else {
            (0..k).map(|j| growth[j * k + at] + growth[at * k + j]).sum()
        }
    };
    let at = (0..k).filter(|&at| reach[at] > 0.0).max_by(|&a, &b| weight(a).total_cmp(&weight(b)).then(b.cmp(&a)))?;
    Some(open[at])
}

fn line(piece: &Piece<'_>, k: usize, open: &[usize]) -> Option<Line> {
    let goal = &piece.goals[k];
    if !matches!(goal.outcome, Outcome::Vertex | Outcome::Contradiction(_)) {
        return None;
    }
    let orthant = &piece.orthant;
    let basis: Vec<Row> = goal.search.basis(&piece.program).into_iter().map(|r| r.0).collect();
    let m = orthant.rows.count();
    if let Some(weights) = enclosed_multipliers(orthant, &basis, goal.column, goal.direction) {
        let least = enclosed_bound(orthant, &weights);
        let mut growth = vec![0.0; open.len()];
        for &(index, l) in &weights {
            if index < 2 * m {
                let (lower, upper) = orthant.rows.row(index % m);
                for (sum, &j) in growth.iter_mut().zip(open) {
                    let width = sub_up(upper[j], lower[j]);
                    *sum = add_up(*sum, crate::rounding::mul_up(l.hi(), width));
                }
            }
        }
        let rows = weights.iter().map(|(index, l)| (*index, l.midpoint())).collect();
        return Some(Line { least, growth, rows }).filter(Line::is_finite);
    }
    let weights = basis_multipliers(orthant, &basis, goal.column, goal.direction)?;
    let least = ratio_down(&exact_bound(orthant, &weights));
    let mut growth = vec![BigRational::zero(); open.len()];
    for (index, l) in weights.iter().filter(|(index, l)| *index < 2 * m && !l.is_zero()) {
        let (lower, upper) = orthant.rows.row(index % m);
        for (sum, &j) in growth.iter_mut().zip(open) {
            if !(upper[j].is_finite() && lower[j].is_finite()) {
                return None;
            }
            *sum += l * (rational(upper[j]) - rational(lower[j]));
        }
    }
    let rows = weights.iter().map(|(index, l)| (*index, l.to_f64().unwrap_or(f64::NAN))).collect();
    Some(Line { least, growth: growth.iter().map(ratio_up).collect(), rows }).filter(Line::is_finite)
}

impl Line {
    fn is_finite(&self) -> bool {
        self.least.is_finite() && self.growth.iter().all(|x| x.is_finite())
    }
}
