//! The premise of every bound: the processor rounds to nearest and keeps subnormal numbers.

use crate::error::Error;

/// True if the processor rounds to nearest and keeps subnormal numbers: the premise of every bound in this crate.
///
/// # Example
/// ```
/// assert!(interval_core::rounding::environment_is_default());
/// ```
#[must_use]
#[inline]
pub fn environment_is_default() -> bool {
    is_default()
}

/// Refuses to go on where the floating-point environment is not the default one; a nanosecond.
///
/// # Errors
/// [`Error::Environment`].
#[inline]
pub fn check_environment() -> Result<(), Error> {
    if is_default() { Ok(()) } else { Err(Error::Environment) }
}

/// By the control register: rounding to nearest, neither flush-to-zero nor denormals-are-zero.
#[cfg(all(target_arch = "x86_64", not(miri)))]
#[inline]
fn is_default() -> bool {
    // Bits of the control register MXCSR (Intel 64 manual, volume 1, section 10.2.3): rounding control, flush to zero,
    // denormals are zero.
    const ROUNDING: u32 = 0x6000;
    const FLUSH_TO_ZERO: u32 = 0x8000;
    const DENORMALS_ARE_ZERO: u32 = 0x0040;
    let mut control = 0_u32;
    // SAFETY: the instruction stores the register into the four bytes behind the pointer and touches nothing else.
    #[expect(unsafe_code, reason = "there is no other way to read the register")]
    unsafe {
        core::arch::asm!("stmxcsr [{}]", in(reg) &raw mut control, options(nostack, preserves_flags));
    }
    control & (ROUNDING | FLUSH_TO_ZERO | DENORMALS_ARE_ZERO) == 0
}

/// The same by the results of arithmetic.
#[cfg(any(not(target_arch = "x86_64"), miri))]
#[inline]
fn is_default() -> bool {
    use core::hint::black_box;
    let half_ulp_above = black_box(f64::EPSILON) / 2.0;
    let half_ulp_below = half_ulp_above / 2.0;
    let nearest = black_box(1.0) + half_ulp_above == 1.0 && black_box(1.0) - half_ulp_below == 1.0;
    let half_normal = black_box(f64::MIN_POSITIVE) * 0.5;
    let results_kept = half_normal != 0.0;
    let operands_kept = black_box(f64::from_bits(1)) + black_box(0.0) != 0.0;
    nearest && results_kept && operands_kept
}
