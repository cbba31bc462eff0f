"""The true curve of a thruster: its static curve with an error within the stated accuracy."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from functools import cached_property

import numpy as np

from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Thruster


class TrueThrust:
    """A thrust curve with a smooth error inside its accuracy, fixed for the log; no thrust has no error."""

    def __init__(self, thruster: Thruster, rng: np.random.Generator) -> None:
        self.thruster = thruster
        # Dead band, limit and reverse factor of the file act after the error, as the effects do that may replace them.
        bare = {"dead_band": None, "limit": None, "reverse_factor": None}
        self._bare = ThrustCurve(thruster.model_copy(update=bare))
        self.phase, self.cycles, self.size = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 1.5), rng.uniform(0.2, 1.0)
        low, high = self._bare.range
        self.span = high - low if np.isfinite(high - low) else 1.0
        self._low, self._high = low, high

    @property
    def description(self) -> dict[str, float]:
        """The numbers of the error, for the truth."""
        return {"size": self.size, "cycles": self.cycles, "phase": self.phase}

    def __call__(self, demand: float) -> float:
        """Thrust [N] at a demand in the thruster's unit."""
        return self.value(demand)

    @cached_property
    def value(self) -> Callable[[float], float]:
        """``__call__`` as a plain function, which is quicker for the many calls of a simulation."""
        curve = scalar_curve(self._bare)
        accuracy = self.thruster.accuracy
        absolute, relative, size = accuracy.absolute, accuracy.relative, self.size
        cycles, span, phase = 2 * math.pi * self.cycles, self.span, self.phase
        # A reverse factor above 1 enlarges the error, too, and the stated accuracy is that of the product.
        astern = absolute / max(self.thruster.reverse_factor or 1.0, 1.0)
        sin = math.sin

        def value(demand: float) -> float:
            thrust = curve(demand)
            amount = abs(thrust)
            bound = (astern if thrust < 0 else absolute) + relative * amount
            bound = min(bound, amount)
            if not bound:
                return thrust
            return thrust + size * bound * sin(cycles * demand / span + phase)

        return value

    def clip(self, demand: float) -> float:
        """The demand about the curve's neutral, clipped to its range."""
        return min(max(demand + self.thruster.neutral, self._low), self._high)

    @property
    def reference(self) -> float:
        """The largest thrust of the curve [N]; 0 for a curve without end."""
        return self._bare.largest


def scalar_curve(curve: ThrustCurve) -> Callable[[float], float]:
    """A static curve for one demand at a time, in plain floats: NumPy costs ten times as much for one number."""
    neutral = curve.thruster.neutral
    pieces = curve.pieces
    if pieces is None:
        whole = curve.formula
        lowest, highest = curve.range

        def clipped(demand: float) -> float:
            return whole((lowest if demand < lowest else highest if demand > highest else demand) - neutral)

        return clipped
    knots, coefficients = pieces
    first, last = knots[0], knots[-1]

    def value(demand: float) -> float:
        d = min(max(demand - neutral, first), last)
        k = min(bisect_right(knots, d) - 1, len(coefficients) - 1)
        x = d - knots[k]
        total = 0.0
        for c in coefficients[k]:
            total = total * x + c
        return total

    return value
