"""Numbers between 0 and 1 that stand for a programme: levels of the demands that take turns, inside the vehicle's limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.programme.manoeuvres import Segment
from ivsid.programme.trials import BRISK, brisk, full_demand, pushes_sideways, spins
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Vehicle

Array: TypeAlias = NDArray[np.float64]
# Parts of a programme.
# Source: resource: each adds some numbers to the search; six of 10 s hold the speeds, pushes and turns of a minute
PARTS: Final = 6
# Shortest part, as a share of the mean one.
# Source: definition: a part that is shorter tells little more than its neighbours
SHORTEST: Final = 0.3
# Shortest time between changes of demand [s] for a hull of 1 m.
# Source: definition: half a window of the rows of 1 s
PERIOD: Final = 0.5
# Largest angle of rudders and azimuth thrusters without a limit of their own [rad].
# Source: definition: 30 degrees, beyond which rudders stall
ANGLE: Final = 0.5
# Feedback of the yaw rate, as a share of the full demand for a brisk turn: a vehicle with little damping then does not add up its turns.
# Source: definition: a twentieth of the library's, which holds a rate; this one leaves the levels their turns
DAMPING: Final = 0.03
# Digits of levels and times in the programme.
# Source: definition: what a person types
DIGITS: Final = 4


@dataclass(frozen=True)
class Shape:
    """Programmes of ``PARTS`` parts for one vehicle.

    Attributes:
        vehicle: with thrusters whose curves have an end.
        seconds: length of the programme [s].
        feedback: whether thrusters that turn the vehicle damp its yaw rate, too; its demands then depend on the vehicle.
    """

    vehicle: Vehicle
    seconds: float
    feedback: bool

    def __post_init__(self) -> None:
        if not self.vehicle.thrusters:
            raise IvsidError("a vehicle without thrusters cannot be planned for; add [[thrusters]] to its file")
        if not self.full:
            raise IvsidError(
                "no thruster of the vehicle file has a largest demand; give each a table, or demand_range beside its gain or quadratic"
            )

    @cached_property
    def full(self) -> float:
        """The largest demand from neutral that every thruster can take."""
        return full_demand(self.vehicle)

    @cached_property
    def least(self) -> float:
        """The lowest demand from neutral that every thruster can take, at most 0."""
        ends = [ThrustCurve(t).range[0] - t.neutral for t in self.vehicle.thrusters]
        return max((min(e, 0.0) for e in ends if math.isfinite(e)), default=0.0)

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """What has a number for each part: its length, the time between changes, and the commands that act on this vehicle."""
        steered = [t for t in self.vehicle.thrusters if t.rudder is not None or t.steering != "fixed"]
        found = ["length", "period", "demand", "other"]
        found += ["differential"] if spins(self.vehicle) else []
        found += ["sway"] if pushes_sideways(self.vehicle) else []
        found += ["rudder"] if any(t.rudder is not None for t in steered) else []
        found += ["azimuth"] if any(t.steering != "fixed" for t in steered) else []
        return tuple(found)

    @property
    def sides(self) -> int:
        """The first number of a command to the sides; all behind it are of that kind, and a half stands for none."""
        return PARTS * (self.kinds.index("other") + 1)

    @property
    def size(self) -> int:
        """Number of numbers."""
        return PARTS * len(self.kinds)

    def segments(self, x: Array) -> tuple[Segment, ...]:
        """The programme of the numbers x, shape (size,).

        In each part two common demands take turns, and what turns the vehicle changes its sign with them: it need not spin to be turned
        hard. Commands share the range of the demands: what turns or pushes sideways takes of the room that both common demands leave.
        """
        shares = dict(zip(self.kinds, np.asarray(x).reshape(len(self.kinds), PARTS), strict=True))
        damped = {"yaw_gain": DAMPING * self.full / brisk(self.vehicle), "differential_limit": self.full}
        held = damped if self.feedback and "differential" in shares else {}
        made = []
        for k, length in enumerate(self.lengths(shares["length"])):
            commons = [self.least + (self.full - self.least) * float(shares[name][k]) for name in ("demand", "other")]
            room = min(*(self.full - c for c in commons), *(c - self.least for c in commons))
            numbers: dict[str, object] = {"demand": tuple(_typed(c) for c in commons)}
            for kind in ("differential", "sway", "rudder", "azimuth"):
                if kind in shares:
                    side = 2 * float(shares[kind][k]) - 1
                    size = side * (ANGLE if kind in ("rudder", "azimuth") else room)
                    room -= abs(size) if kind in ("differential", "sway") else 0.0
                    both = (_typed(size), -_typed(size))
                    numbers[kind] = both if kind in ("differential", "rudder") else both[0]
            longest = max(length / 2, self.shortest)
            period = self.shortest * (longest / self.shortest) ** float(shares["period"][k])
            made.append(
                Segment.model_validate(
                    {"manoeuvre": "steps", "duration": length, "period": round(period, 2), **numbers, **held}
                )
            )
        return tuple(made)

    @cached_property
    def shortest(self) -> float:
        """The shortest time between changes [s]."""
        return max(PERIOD * BRISK / brisk(self.vehicle), 0.01)

    def lengths(self, shares: Array) -> list[float]:
        """Lengths of the parts [s], to a hundredth of a second; their sum is that of the programme."""
        mean = self.seconds / PARTS
        raw = SHORTEST + shares / max(float(np.mean(shares)), 1e-9) * (1 - SHORTEST)
        ends = np.round(np.cumsum(raw * mean), 2)
        ends[-1] = self.seconds
        return [float(round(b - a, 2)) for a, b in zip((0.0, *ends[:-1]), ends, strict=True)]


def _typed(x: float) -> float:
    return float(f"{x:.{DIGITS}g}")
