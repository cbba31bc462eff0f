//! Sums of products for matrices: one row times packed columns, each product and each partial sum rounded outward.
//!
//! The order of the sum is that of the inner index, as in the scalar loop, so the bits are the same on every back end
//! and for any number of threads.

#![cfg_attr(avx2, expect(unsafe_code, reason = "calls of functions whose features were asked for"))]

use super::door::Backend;
use super::kernel::{self, Lanes};
#[cfg(not(target_arch = "x86_64"))]
use super::portable::Arrays as Portable;
#[cfg(target_arch = "x86_64")]
use super::sse2::Sse2 as Portable;
use crate::interval::Interval;

/// Columns side by side, of which a kernel works on one group at a time.
const GROUP: usize = 16;

/// A bounded matrix whose columns are packed in groups, each group row by row, filled up with zeros.
pub(crate) struct Packed {
    rows: usize,
    columns: usize,
    lo: Vec<f64>,
    hi: Vec<f64>,
}

impl Packed {
    /// From row-major bounds, all finite.
    pub fn new(rows: usize, columns: usize, lo: &[f64], hi: &[f64]) -> Self {
        let groups = columns.div_ceil(GROUP);
        let pack = |from: &[f64]| {
            let mut to = vec![0.0; groups * rows * GROUP];
            for (group, block) in to.chunks_exact_mut(rows * GROUP).enumerate() {
                let first = group * GROUP;
                let width = GROUP.min(columns - first);
                for (k, row) in block.chunks_exact_mut(GROUP).enumerate() {
                    row[..width].copy_from_slice(&from[k * columns + first..][..width]);
                }
            }
            to
        };
        Self { rows, columns, lo: pack(lo), hi: pack(hi) }
    }

    /// The product of a row of finite bounds with the matrix.
    pub fn row_product(&self, backend: Backend, a: (&[f64], &[f64]), out: (&mut [f64], &mut [f64])) {
        let (out_lo, out_hi) = out;
        let mut sums = ([0.0; GROUP], [0.0; GROUP]);
        let size = self.rows * GROUP;
        for group in 0..self.columns.div_ceil(GROUP) {
            let block = (&self.lo[group * size..][..size], &self.hi[group * size..][..size]);
            if !group_product(backend, a, block, &mut sums) {
                one_by_one(a, block, &mut sums);
            }
            let first = group * GROUP;
            let width = GROUP.min(self.columns - first);
            out_lo[first..][..width].copy_from_slice(&sums.0[..width]);
            out_hi[first..][..width].copy_from_slice(&sums.1[..width]);
        }
    }
}

type Slices<'a> = (&'a [f64], &'a [f64]);
type Sums = ([f64; GROUP], [f64; GROUP]);

fn one_by_one(a: Slices<'_>, block: Slices<'_>, sums: &mut Sums) {
    for j in 0..GROUP {
        let mut sum = Interval::ZERO;
        for k in 0..a.0.len() {
            sum = sum + Interval::raw(a.0[k], a.1[k]) * Interval::raw(block.0[k * GROUP + j], block.1[k * GROUP + j]);
        }
        (sums.0[j], sums.1[j]) = (sum.lo(), sum.hi());
    }
}

/// False where a transformation was not exact and the group has to be redone.
fn group_product(backend: Backend, a: Slices<'_>, block: Slices<'_>, sums: &mut Sums) -> bool {
    match backend {
        // SAFETY: the features were found on this processor.
        #[cfg(avx512)]
        Backend::Avx512 if backend.is_available() => unsafe { wide::group_avx512(a, block, sums) },
        #[cfg(avx2)]
        Backend::Avx2 if backend.is_available() => unsafe { wide::group_avx2(a, block, sums) },
        _ => by_transformation::<Portable>(a, block, sums),
    }
}

#[inline(always)]
fn by_transformation<L: Lanes>(a: Slices<'_>, block: Slices<'_>, sums: &mut Sums) -> bool {
    let n = <L as Lanes>::N;
    let mut sound = true;
    for start in (0..GROUP).step_by(n) {
        let (mut lo, mut hi) = (L::splat(0.0), L::splat(0.0));
        for k in 0..a.0.len() {
            let (c, d) = (&block.0[k * GROUP + start..][..n], &block.1[k * GROUP + start..][..n]);
            let (x, y) = (<L as Lanes>::load(c), <L as Lanes>::load(d));
            let (p, q, product_sound) = kernel::mul(L::splat(a.0[k]), L::splat(a.1[k]), x, y);
            let (s, t, sum_sound) = kernel::add(lo, hi, p, q);
            (lo, hi) = (s, t);
            sound &= product_sound & sum_sound;
        }
        <L as Lanes>::store(lo, &mut sums.0[start..]);
        <L as Lanes>::store(hi, &mut sums.1[start..]);
    }
    sound
}

#[cfg(avx2)]
mod wide {
    use super::super::avx2::Avx2;
    #[cfg(avx512)]
    use super::super::avx512;
    use super::{Slices, Sums, by_transformation};

    #[target_feature(enable = "avx2,fma")]
    pub unsafe fn group_avx2(a: Slices<'_>, block: Slices<'_>, sums: &mut Sums) -> bool {
        by_transformation::<Avx2>(a, block, sums)
    }

    #[cfg(avx512)]
    #[target_feature(enable = "avx512f,avx2,fma")]
    pub unsafe fn group_avx512(a: Slices<'_>, block: Slices<'_>, sums: &mut Sums) -> bool {
        avx512::group_product(a, block, sums);
        true
    }
}
