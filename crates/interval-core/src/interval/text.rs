//! Text in and out. Reading rounds outward from the exact decimal value; writing rounds outward from the exact double.

use super::Interval;
use crate::error::Error;
use crate::exact::{from_decimal, outward_decimal, ratio_down, ratio_up};
use std::fmt;
use std::str::FromStr;

impl FromStr for Interval {
    type Err = Error;

    /// Reads `[lower, upper]`, `[number]`, `number`, `[empty]` or `[entire]`. Numbers are decimals; `inf` is an open end.
    ///
    /// ```
    /// let tenth: interval_core::Interval = "0.1".parse()?;
    /// assert!(tenth.lo() < tenth.hi());
    /// # Ok::<(), interval_core::Error>(())
    /// ```
    fn from_str(text: &str) -> Result<Self, Error> {
        let refusal = || Error::Text { text: text.chars().take(80).collect() };
        let trimmed = text.trim();
        let inner = match trimmed.strip_prefix('[') {
            Some(rest) => rest.strip_suffix(']').ok_or_else(refusal)?,
            None => trimmed,
        };
        match inner.trim().to_ascii_lowercase().as_str() {
            "empty" => return Ok(Self::EMPTY),
            "entire" => return Ok(Self::ENTIRE),
            _ => {}
        }
        let (lower, upper) = inner.split_once(',').unwrap_or((inner, inner));
        let exact = |part: &str| from_decimal(part.trim());
        let open = |part: &str| match part.trim().to_ascii_lowercase().as_str() {
            "inf" | "+inf" | "infinity" | "+infinity" => Some(f64::INFINITY),
            "-inf" | "-infinity" => Some(f64::NEG_INFINITY),
            _ => None,
        };
        let pair = (exact(lower), exact(upper));
        if let (Some(a), Some(b)) = &pair
            && a > b
        {
            return Err(Error::ReversedBounds { index: 0 });
        }
        let lo = match &pair.0 {
            Some(value) => ratio_down(value),
            None => open(lower).ok_or_else(refusal)?,
        };
        let hi = match &pair.1 {
            Some(value) => ratio_up(value),
            None => open(upper).ok_or_else(refusal)?,
        };
        Self::new(lo, hi)
    }
}

impl fmt::Display for Interval {
    /// `[lower, upper]` in decimals, rounded outward, with just the digits that read back as the same doubles.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("[empty]");
        }
        write!(f, "[{}, {}]", outward_decimal(self.lo, false), outward_decimal(self.hi, true))
    }
}
