//! `serde`: an interval is the pair of its bounds, exact in formats with doubles. Infinite ends and the empty interval
//! are written as the text of [`Interval::to_exact`], which formats without infinities can hold.

use super::Interval;
use core::fmt;
use serde::de::{Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

impl Serialize for Interval {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.is_common() {
            (self.lo, self.hi).serialize(serializer)
        } else {
            serializer.serialize_str(&self.to_exact())
        }
    }
}

struct Bounds;

impl<'de> Visitor<'de> for Bounds {
    type Value = Interval;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("two bounds or an interval literal")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Interval, E> {
        text.parse().map_err(E::custom)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut bounds: A) -> Result<Interval, A::Error> {
        let mut next = |count| bounds.next_element::<f64>()?.ok_or_else(|| A::Error::invalid_length(count, &self));
        let (lo, hi) = (next(0)?, next(1)?);
        Interval::new(lo, hi).map_err(A::Error::custom)
    }
}

impl<'de> Deserialize<'de> for Interval {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Bounds)
    }
}
