"""Liquid in a tank of the hull, which the examination hides outside of the catalogue."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass
class Tank:
    """Liquid that swings sideways in a tank, lightly damped.

    Attributes:
        share: of the hull's mass that swings.
        period: of its own [s].
        place: sideways [m].
        speed: of it [m/s].
    """

    share: float
    period: float
    place: float = 0.0
    speed: float = 0.0

    def pull(self, mass: float) -> float:
        """Force on the hull to starboard [N]."""
        w = 2 * math.pi / self.period
        return self.share * mass * (w**2 * self.place + 0.1 * w * self.speed)

    def swing(self, acceleration: float, h: float) -> None:
        """A step in which the hull is accelerated to starboard, semi-implicit in twenty parts, relative to the hull."""
        w = 2 * math.pi / self.period
        for _ in range(20):
            self.speed -= (acceleration + w**2 * self.place + 0.1 * w * self.speed) * h / 20
            self.place += self.speed * h / 20
