//! Types that tell proved values from unproved ones.

use std::ops::Deref;

/// A value that a proof stands behind. Only the proofs of this crate make one; it reads as the value itself.
///
/// An [`Unproved`] value does not pass for it:
/// ```compile_fail
/// use interval_core::{Certified, IntervalMatrix, Unproved};
/// fn rely_on(_: &Certified<IntervalMatrix>) {}
/// rely_on(&Unproved(IntervalMatrix::identity(2)));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Certified<T>(T);

impl<T> Certified<T> {
    /// The caller has the proof.
    pub(crate) const fn proved(value: T) -> Self {
        Self(value)
    }

    /// A consequence of the value, by the same proof.
    pub(crate) fn map<U>(&self, consequence: impl FnOnce(&T) -> U) -> Certified<U> {
        Certified(consequence(&self.0))
    }

    /// The value without its proof.
    pub fn into_inner(self) -> T {
        self.0
    }
}

impl<T> Deref for Certified<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

/// A value of which nothing is claimed: an approximation, or the result of a method that proves nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Unproved<T>(pub T);

/// The value of a method that proves it or does not. Without a proof it may be of another type.
#[derive(Debug, Clone, PartialEq)]
pub enum Claim<C, U = C> {
    /// The value is proved.
    Certified(Certified<C>),
    /// Nothing is claimed.
    Unproved(Unproved<U>),
}

impl<C, U> Claim<C, U> {
    /// The value where it is proved.
    pub const fn certified(&self) -> Option<&Certified<C>> {
        match self {
            Self::Certified(value) => Some(value),
            Self::Unproved(_) => None,
        }
    }
}

impl<T> Claim<T> {
    /// The value, proved or not.
    pub const fn either(&self) -> &T {
        match self {
            Self::Certified(Certified(value)) | Self::Unproved(Unproved(value)) => value,
        }
    }
}
