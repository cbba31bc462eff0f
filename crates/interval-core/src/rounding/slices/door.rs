//! The door: operations by name, the back end chosen once, loops over blocks.

#![cfg_attr(avx2, expect(unsafe_code, reason = "calls of functions whose features were asked for"))]

use super::kernel::{self, Lanes};
use super::operations::{Binary, Bounds, BoundsMut, Unary};
use super::portable::Arrays;
#[cfg(not(target_arch = "x86_64"))]
use super::portable::Arrays as Portable;
#[cfg(target_arch = "x86_64")]
use super::sse2::Sse2 as Portable;
use crate::error::Error;
use crate::interval::Interval;
use crate::parallel;
use crate::rounding;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// The back end of the operations on slices.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Backend {
    /// The instructions that every processor of the architecture has.
    Portable,
    /// AVX2 and FMA.
    Avx2,
    /// AVX-512F, with AVX2 and FMA. Never available where the compiler is older than Rust 1.89.
    Avx512,
}

impl Backend {
    /// All of them, the most capable last.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// True if this processor has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(avx2)]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(avx512)]
            Self::Avx512 => is_x86_feature_detected!("avx512f") && Self::Avx2.is_available(),
            #[cfg(not(avx512))]
            _ => false,
        }
    }

    /// The one in use: the most capable that this processor has.
    ///
    /// ```
    /// use interval_core::rounding::slices::Backend;
    /// assert!(Backend::chosen().is_available());
    /// ```
    #[must_use]
    pub fn chosen() -> Self {
        #[cfg(feature = "std")]
        {
            static CHOSEN: std::sync::OnceLock<Backend> = std::sync::OnceLock::new();
            *CHOSEN.get_or_init(|| {
                Self::ALL.into_iter().rev().find(|backend| backend.is_available()).unwrap_or(Self::Portable)
            })
        }
        // Without the standard library nothing asks the processor.
        #[cfg(not(feature = "std"))]
        Self::Portable
    }

    /// `portable`, `avx2` or `avx512`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

/// True if every lane is an interval with a finite point. `hi - lo >= 0` says all of it: the difference is NaN for a
/// bound that is NaN and for two equal infinities, and underflow is gradual.
#[inline(always)]
fn proper<L: Lanes>(lo: L, hi: L) -> bool {
    L::all(L::splat(0.0).less_equal(hi.sub(lo)))
}

/// The same of two intervals.
#[inline(always)]
fn both_proper<L: Lanes>(a: L, b: L, c: L, d: L) -> bool {
    let zero = L::splat(0.0);
    L::all(L::both(zero.less_equal(b.sub(a)), zero.less_equal(d.sub(c))))
}

// The loops over blocks: `fast` on two vectors at a time, `slow` on the intervals of a block for which it is not sound
// and on the rest. Macros, because a function passed as a value would be compiled without the features of the caller.
macro_rules! unary_blocks {
    ($block:ty, $x:ident, $out:ident, $fast:path, $slow:expr) => {{
        let n = <$block as Lanes>::N;
        let mut start = 0;
        let operands = $x.lo.chunks_exact(2 * n).zip($x.hi.chunks_exact(2 * n));
        let results = $out.lo.chunks_exact_mut(2 * n).zip($out.hi.chunks_exact_mut(2 * n));
        for ((a, b), (low, high)) in operands.zip(results) {
            let ((a, a2), (b, b2)) = (a.split_at(n), b.split_at(n));
            let (a, b) = (<$block as Lanes>::load(a), <$block as Lanes>::load(b));
            let (a2, b2) = (<$block as Lanes>::load(a2), <$block as Lanes>::load(b2));
            let (lo, hi, sound) = $fast(a, b);
            let (lo2, hi2, sound2) = $fast(a2, b2);
            if sound & sound2 & proper(a, b) & proper(a2, b2) {
                lo.store(&mut low[..n]);
                hi.store(&mut high[..n]);
                lo2.store(&mut low[n..]);
                hi2.store(&mut high[n..]);
            } else {
                for k in 0..2 * n {
                    let result: Interval = $slow($x.get(start + k)?);
                    (low[k], high[k]) = (result.lo(), result.hi());
                }
            }
            start += 2 * n;
        }
        for k in start..$x.lo.len() {
            $out.set(k, $slow($x.get(k)?));
        }
        Ok(())
    }};
}

macro_rules! binary_blocks {
    ($block:ty, $x:ident, $y:ident, $out:ident, $fast:path, $slow:expr) => {{
        let n = <$block as Lanes>::N;
        let mut start = 0;
        let first = $x.lo.chunks_exact(2 * n).zip($x.hi.chunks_exact(2 * n));
        let second = $y.lo.chunks_exact(2 * n).zip($y.hi.chunks_exact(2 * n));
        let results = $out.lo.chunks_exact_mut(2 * n).zip($out.hi.chunks_exact_mut(2 * n));
        for (((a, b), (c, d)), (low, high)) in first.zip(second).zip(results) {
            let ((a, a2), (b, b2)) = (a.split_at(n), b.split_at(n));
            let ((c, c2), (d, d2)) = (c.split_at(n), d.split_at(n));
            let (a, b, c, d) = (
                <$block as Lanes>::load(a),
                <$block as Lanes>::load(b),
                <$block as Lanes>::load(c),
                <$block as Lanes>::load(d),
            );
            let (a2, b2, c2, d2) = (
                <$block as Lanes>::load(a2),
                <$block as Lanes>::load(b2),
                <$block as Lanes>::load(c2),
                <$block as Lanes>::load(d2),
            );
            let (lo, hi, sound) = $fast(a, b, c, d);
            let (lo2, hi2, sound2) = $fast(a2, b2, c2, d2);
            let proper = both_proper(a, b, c, d) & both_proper(a2, b2, c2, d2);
            if sound & sound2 & proper {
                lo.store(&mut low[..n]);
                hi.store(&mut high[..n]);
                lo2.store(&mut low[n..]);
                hi2.store(&mut high[n..]);
            } else {
                for k in 0..2 * n {
                    let result: Interval = $slow($x.get(start + k)?, $y.get(start + k)?);
                    (low[k], high[k]) = (result.lo(), result.hi());
                }
            }
            start += 2 * n;
        }
        for k in start..$x.lo.len() {
            $out.set(k, $slow($x.get(k)?, $y.get(k)?));
        }
        Ok(())
    }};
}

/// The transformations on vectors `L`, the rest one by one.
#[inline(always)]
fn unary_on<L: Lanes>(op: Unary, x: Bounds<'_>, mut out: BoundsMut<'_>) -> Result<(), Error> {
    match op {
        Unary::Neg => unary_blocks!(L, x, out, kernel::neg, Neg::neg),
        Unary::Abs => unary_blocks!(L, x, out, kernel::abs, Interval::abs),
        Unary::Square => unary_blocks!(L, x, out, kernel::square, Interval::square),
        Unary::Sqrt => unary_blocks!(L, x, out, kernel::sqrt, Interval::sqrt),
        _ => op.one_by_one(x, out),
    }
}

#[inline(always)]
fn binary_on<L: Lanes>(op: Binary, x: Bounds<'_>, y: Bounds<'_>, mut out: BoundsMut<'_>) -> Result<(), Error> {
    match op {
        Binary::Add => binary_blocks!(L, x, y, out, kernel::add, Add::add),
        Binary::Sub => binary_blocks!(L, x, y, out, kernel::sub, Sub::sub),
        Binary::Mul => binary_blocks!(L, x, y, out, kernel::mul, Mul::mul),
        Binary::Div => binary_blocks!(L, x, y, out, kernel::div, Div::div),
        Binary::Min => binary_blocks!(L, x, y, out, kernel::min, Interval::min),
        Binary::Max => binary_blocks!(L, x, y, out, kernel::max, Interval::max),
        Binary::Hull => binary_blocks!(L, x, y, out, kernel::hull, Interval::hull),
        Binary::Intersection => binary_blocks!(L, x, y, out, kernel::intersection, Interval::intersection),
        _ => op.one_by_one((x, y), out),
    }
}

/// Functions compiled for processors that have more than the baseline.
#[cfg(avx2)]
mod wide {
    use super::super::avx2::Avx2;
    #[cfg(avx512)]
    use super::super::avx512;
    #[cfg(avx512)]
    use super::super::avx512_lanes::Wide;
    use super::super::elementary;
    #[cfg(avx512)]
    use super::{Add, Div, Interval, Lanes, Mul, Sub, both_proper, proper};
    use super::{Binary, Bounds, BoundsMut, Error, Unary, binary_on, unary_on};

    #[target_feature(enable = "avx2,fma")]
    pub unsafe fn unary_avx2(op: Unary, x: Bounds<'_>, out: BoundsMut<'_>) -> Result<(), Error> {
        if op.is_arithmetic() { unary_on::<Avx2>(op, x, out) } else { elementary::unary_on::<Avx2>(op, x, out) }
    }

    #[target_feature(enable = "avx2,fma")]
    pub unsafe fn binary_avx2(op: Binary, x: Bounds<'_>, y: Bounds<'_>, out: BoundsMut<'_>) -> Result<(), Error> {
        binary_on::<Avx2>(op, x, y, out)
    }

    #[cfg(avx512)]
    #[target_feature(enable = "avx512f,avx2,fma")]
    pub unsafe fn unary_avx512(op: Unary, x: Bounds<'_>, mut out: BoundsMut<'_>) -> Result<(), Error> {
        match op {
            Unary::Square => unary_blocks!(Wide, x, out, avx512::square, Interval::square),
            Unary::Sqrt => unary_blocks!(Wide, x, out, avx512::sqrt, Interval::sqrt),
            _ if op.is_arithmetic() => unary_on::<Avx2>(op, x, out),
            _ => elementary::unary_on::<Wide>(op, x, out),
        }
    }

    #[cfg(avx512)]
    #[target_feature(enable = "avx512f,avx2,fma")]
    pub unsafe fn binary_avx512(op: Binary, x: Bounds<'_>, y: Bounds<'_>, mut out: BoundsMut<'_>) -> Result<(), Error> {
        match op {
            Binary::Add => binary_blocks!(Wide, x, y, out, avx512::add, Add::add),
            Binary::Sub => binary_blocks!(Wide, x, y, out, avx512::sub, Sub::sub),
            Binary::Mul => binary_blocks!(Wide, x, y, out, avx512::mul, Mul::mul),
            Binary::Div => binary_blocks!(Wide, x, y, out, avx512::div, Div::div),
            _ => binary_on::<Avx2>(op, x, y, out),
        }
    }
}

fn fits(what: &'static str, given: usize, needed: usize) -> Result<(), Error> {
    if given == needed { Ok(()) } else { Err(Error::Shape { what, given, needed }) }
}

/// The rounding mode and the lengths of both bounds of the result.
fn check_results(needed: usize, out: &BoundsMut<'_>) -> Result<(), Error> {
    rounding::check_environment()?;
    fits("the lower result", out.lo.len(), needed)?;
    fits("the upper result", out.hi.len(), needed)
}

/// `op` on every interval of a slice, long ones on several threads.
///
/// # Errors
/// Different lengths, bounds that are no interval, and a changed rounding mode.
///
/// ```
/// use interval_core::rounding::slices::{Bounds, BoundsMut, Unary, unary};
/// let (mut lo, mut hi) = ([0.0; 2], [0.0; 2]);
/// let x = Bounds::new(&[1.0, -2.0], &[2.0, 1.0])?;
/// unary(Unary::Square, x, BoundsMut { lo: &mut lo, hi: &mut hi })?;
/// assert_eq!((lo, hi), ([1.0, 0.0], [4.0, 4.0]));
/// # Ok::<(), interval_core::Error>(())
/// ```
pub fn unary(op: Unary, x: Bounds<'_>, out: BoundsMut<'_>) -> Result<(), Error> {
    let portion = portion(op.is_arithmetic());
    if x.len() <= portion || x.len() != out.len() {
        return unary_with(Backend::chosen(), op, x, out);
    }
    let ((x1, x2), (out1, out2)) = (x.halves(), out.halves());
    let middle = x1.len();
    let (first, second) = parallel::join(|| unary(op, x1, out1), || unary(op, x2, out2));
    first.and(second.map_err(|error| error.moved(middle)))
}

/// `op` on every pair of intervals of two slices, long ones on several threads.
///
/// # Errors
/// Different lengths, bounds that are no interval, and a changed rounding mode.
///
/// ```
/// use interval_core::rounding::slices::{Binary, Bounds, BoundsMut, binary};
/// let (mut lo, mut hi) = ([0.0], [0.0]);
/// let (x, y) = (Bounds::new(&[1.0], &[2.0])?, Bounds::new(&[-3.0], &[4.0])?);
/// binary(Binary::Mul, x, y, BoundsMut { lo: &mut lo, hi: &mut hi })?;
/// assert_eq!((lo, hi), ([-6.0], [8.0]));
/// # Ok::<(), interval_core::Error>(())
/// ```
pub fn binary(op: Binary, x: Bounds<'_>, y: Bounds<'_>, out: BoundsMut<'_>) -> Result<(), Error> {
    let portion = portion(op.is_arithmetic());
    if x.len() <= portion || x.len() != y.len() || x.len() != out.len() {
        return binary_with(Backend::chosen(), op, x, y, out);
    }
    let ((x1, x2), (y1, y2), (out1, out2)) = (x.halves(), y.halves(), out.halves());
    let middle = x1.len();
    let (first, second) = parallel::join(|| binary(op, x1, y1, out1), || binary(op, x2, y2, out2));
    first.and(second.map_err(|error| error.moved(middle)))
}

/// The numbers that one thread takes at a time: some tens of microseconds.
fn portion(arithmetic: bool) -> usize {
    if arithmetic { 1 << 16 } else { 1 << 9 }
}

/// [`unary`] on the caller's thread and a back end of its choice. The portable one is used if the processor lacks it.
///
/// # Errors
/// Different lengths, bounds that are no interval, and a changed rounding mode.
pub fn unary_with(backend: Backend, op: Unary, x: Bounds<'_>, out: BoundsMut<'_>) -> Result<(), Error> {
    check_results(x.len(), &out)?;
    match backend {
        // SAFETY: the features were found on this processor.
        #[cfg(avx512)]
        Backend::Avx512 if backend.is_available() => unsafe { wide::unary_avx512(op, x, out) },
        #[cfg(avx2)]
        Backend::Avx2 if backend.is_available() => unsafe { wide::unary_avx2(op, x, out) },
        _ => unary_on::<Portable>(op, x, out),
    }
}

/// [`binary`] on the caller's thread and a back end of its choice. The portable one is used if the processor lacks it.
///
/// # Errors
/// Different lengths, bounds that are no interval, and a changed rounding mode.
pub fn binary_with(
    backend: Backend,
    op: Binary,
    x: Bounds<'_>,
    y: Bounds<'_>,
    out: BoundsMut<'_>,
) -> Result<(), Error> {
    fits("the second operand", y.len(), x.len())?;
    check_results(x.len(), &out)?;
    match backend {
        // SAFETY: the features were found on this processor.
        #[cfg(avx512)]
        Backend::Avx512 if backend.is_available() => unsafe { wide::binary_avx512(op, x, y, out) },
        #[cfg(avx2)]
        Backend::Avx2 if backend.is_available() => unsafe { wide::binary_avx2(op, x, y, out) },
        _ => binary_on::<Portable>(op, x, y, out),
    }
}

/// [`unary_with`] on the vectors of architectures that have no back end of their own, for tests on this one.
///
/// # Errors
/// As [`unary_with`].
#[doc(hidden)]
pub fn unary_on_arrays(op: Unary, x: Bounds<'_>, out: BoundsMut<'_>) -> Result<(), Error> {
    check_results(x.len(), &out)?;
    unary_on::<Arrays>(op, x, out)
}

/// [`binary_with`] on the same vectors.
///
/// # Errors
/// As [`binary_with`].
#[doc(hidden)]
pub fn binary_on_arrays(op: Binary, x: Bounds<'_>, y: Bounds<'_>, out: BoundsMut<'_>) -> Result<(), Error> {
    fits("the second operand", y.len(), x.len())?;
    check_results(x.len(), &out)?;
    binary_on::<Arrays>(op, x, y, out)
}
