"""How sure a finding is: the share of findings like it that were right in the examination.

An examination with a known truth is the only source of such a share. Findings are alike if they have the same company and stand out alike.
A finding is right if the hidden cause is in its set; an ``unknown`` is right if anything is hidden. The share is the mean under Jeffreys'
prior, so that a hundred of a hundred is no certainty.

It holds for vehicles and logs like the examiner's, among which a tenth has a cause that the catalogue lacks.

Source: Jeffreys, *Theory of Probability*, 1961, section 3.10; Brown, Cai and DasGupta, "Interval estimation for a binomial proportion",
Statistical Science 16, 2001; docs/examination.md for the counts and the reliability on other cases.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

# Standard deviations from which a finding counts as clear.
# Source: definition: halves the findings of the examination that are not far beyond doubt
CLEAR: Final = 12.0


@dataclass(frozen=True)
class Alike:
    """Findings of the examination that are alike.

    Attributes:
        words: what they share.
        right: how many were right.
        of: how many there were.
    """

    words: str
    right: int
    of: int

    @property
    def probability(self) -> float:
        """Mean of the share under Jeffreys' prior."""
        return (self.right + 0.5) / (self.of + 1.0)


# Counts of the examination, by kind of finding.
# Source: measured: make reliability
COUNTS: Final[Mapping[str, Alike]] = {
    "alone, clear": Alike(f"one name by itself, {CLEAR:g} standard deviations or more", 88, 88),
    "alone, faint": Alike(f"one name by itself, below {CLEAR:g} standard deviations", 9, 9),
    "several, clear": Alike(f"one of several names, {CLEAR:g} standard deviations or more", 22, 22),
    "several, faint": Alike(f"one of several names, below {CLEAR:g} standard deviations", 2, 2),
    "beside unknown": Alike("a name beside structure that nothing explains", 4, 5),
    "unknown": Alike("structure that nothing explains", 30, 31),
}


def alike(effect: str, z: float, others: Sequence[str]) -> str:
    """Kind of a finding.

    Args:
        effect: its id, or ``unknown``.
        z: how far it stands out, in standard deviations.
        others: the other findings.
    """
    if effect == "unknown":
        return "unknown"
    if "unknown" in others:
        return "beside unknown"
    return f"{'several' if others else 'alone'}, {'clear' if z >= CLEAR else 'faint'}"
