"""What no log states: the mass, the places of the thrusters, their thrust. The user answers, or the file holds marked keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from ivsid.proposal.found import Found
from ivsid.proposal.thrusters import steps_of

# Demands between these are taken for pulse widths [us].
# Source: definition: pulses of hobby controllers and servos last 1000 to 2000 us, with a margin
PULSES: Final = (800.0, 2200.0)
# Neutral pulse of a controller that also drives astern [us], and how far a resting demand may stand from it.
# Source: definition: the midpoint of 1000 and 2000 us
NEUTRAL: Final = 1500.0
NEAR: Final = 50.0
# Longest pulse of a controller [us].
# Source: definition: pulses last 1000 to 2000 us
LONGEST: Final = 2000.0
# End of the proposed range of a demand, as a multiple of the largest one seen: the next log may go further.
# Source: definition: a guess that the proposed file calls one
FURTHER: Final = 1.5

# Words of a demand that is a speed, which no pulse width is.
SPEEDS: Final = frozenset({"rpm", "rps", "rad", "hz"})


@dataclass(frozen=True)
class Answers:
    """What the user knows.

    Attributes:
        mass: of the hull [kg].
        positions: of thrusters, forward and to starboard [m].
        thrusts: thrust ahead at the largest demand [N].
        scales: SI units in one unit of a channel whose header states an unknown one.
    """

    mass: float | None = None
    positions: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    thrusts: Mapping[str, float] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Demand:
    """The demands of one thruster.

    Attributes:
        name: of the thruster.
        column: of the log.
        lowest: demand of the log.
        highest: demand of the log.
        neutral: the demand that stands for zero.
        reason: why that is taken for neutral.
    """

    name: str
    column: str
    lowest: float
    highest: float
    neutral: float
    reason: str

    @property
    def span(self) -> float:
        """The largest distance from neutral."""
        return max(self.highest - self.neutral, self.neutral - self.lowest)

    @property
    def end(self) -> float:
        """The proposed end of its range, from neutral: that of pulses or shares, or half more than the largest one seen."""
        if self.neutral >= PULSES[0]:
            return max(self.span, LONGEST - self.neutral)
        return 1.0 if 0 < self.span <= 1.0 else FURTHER * self.span


def demand_of(name: str, found: Found) -> Demand:
    """Range and neutral demand of a thruster."""
    values = found.values[np.isfinite(found.values)]
    low, high = float(values.min()), float(values.max())
    neutral, reason = 0.0, "zero"
    if not steps_of(found.match.column) & SPEEDS and low >= PULSES[0] and high <= PULSES[1]:
        levels, counts = np.unique(np.round(values), return_counts=True)
        usual = float(levels[int(np.argmax(counts))])
        neutral, reason = NEUTRAL, "pulse widths in us, on both sides of 1500"
        if low > NEUTRAL - NEAR or high < NEUTRAL + NEAR:
            if abs(usual - NEUTRAL) > NEAR and low < NEUTRAL - NEAR:
                neutral, reason = low, "pulse widths in us; the smallest is taken for rest"
            else:
                reason = "pulse widths in us"
    return Demand(name, found.match.column, low, high, neutral, reason)
