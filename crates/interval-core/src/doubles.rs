//! Neighbours of doubles and integers of the other sign, which the oldest compiler of the crate does not have.

/// The next doubles.
pub(crate) trait Neighbours {
    /// The next one upwards; NaN and +inf stay.
    fn above(self) -> Self;
    /// The next one downwards; NaN and -inf stay.
    fn below(self) -> Self;
}

impl Neighbours for f64 {
    #[inline]
    fn above(self) -> Self {
        if self.is_nan() || self == Self::INFINITY {
            return self;
        }
        let bits = self.to_bits();
        let size = bits & (u64::MAX >> 1);
        // Bits count upwards for positive and downwards for negative numbers; both zeros go on to the smallest number.
        Self::from_bits(if size == 0 {
            1
        } else if bits == size {
            bits + 1
        } else {
            bits - 1
        })
    }

    #[inline]
    fn below(self) -> Self {
        -(-self).above()
    }
}

/// The integer of the same bits.
#[cfg(feature = "alloc")]
#[inline]
pub(crate) const fn signed(x: u64) -> i64 {
    i64::from_ne_bytes(x.to_ne_bytes())
}

/// The integer of the same bits.
#[cfg(feature = "alloc")]
#[inline]
pub(crate) const fn unsigned(x: i64) -> u64 {
    u64::from_ne_bytes(x.to_ne_bytes())
}
