"""The examiner's own thrusters: curves that are wrong inside their accuracy, and the effects on a thrust at rest."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable

import numpy as np
from scipy.interpolate import PchipInterpolator
from tests.exam.thrust_errors import SHAPES


class Curve:
    """A thrust curve that is wrong by a share of its accuracy; demands come in their order, because one kind of error remembers."""

    def __init__(self, thruster: dict, error=None, share: float = 0.0, *, at_rest: bool = False) -> None:
        table, accuracy = thruster["table"], thruster["accuracy"]
        self.low, self.high = table["demand"][0], table["demand"][-1]
        self.largest = max(map(abs, table["thrust"]))
        self.nominal = PchipInterpolator(table["demand"], table["thrust"])
        self._knots, self._cubics = table["demand"], self.nominal.c.T.tolist()
        self.absolute, self.relative = accuracy["absolute"], accuracy["relative"]
        self.error, self.share, self.at_rest = error, share, at_rest
        # Before the first demand nothing is known of the thrust at rest.
        self.demand, self.side, self.thrust = math.nan if at_rest else 0.0, 1.0, 0.0

    def bound(self, demand):
        """Of the error [N]: no thrust has none, or that of the accuracy at rest."""
        return self.allowed(np.abs(self.nominal(demand)))

    def allowed(self, amount):
        """The same at sizes of the thrust [N]."""
        whole = self.absolute + self.relative * amount
        if self.at_rest:
            return whole
        # A sail asks for one thrust at a time.
        return min(whole, amount) if isinstance(amount, float) else np.minimum(whole, amount)

    def __call__(self, demand: float) -> float:
        if demand == self.demand:
            return self.thrust
        self.side = math.copysign(1.0, demand - (0.0 if math.isnan(self.demand) else self.demand))
        i = min(max(bisect_right(self._knots, demand) - 1, 0), len(self._cubics) - 1)
        a, b, c, d = self._cubics[i]
        x = demand - self._knots[i]
        self.demand, self.thrust = demand, ((a * x + b) * x + c) * x + d
        if self.error is not None and self.share:
            self.thrust += self.share * self.allowed(abs(self.thrust)) * self._shape(demand)
        return self.thrust

    def _shape(self, demand: float) -> float:
        """The error as a share of its bound; ``hysteresis`` follows the side from which the demand came."""
        if isinstance(self.error, float):
            return self.side * self.error
        width = self.high - self.low
        return float(self.error(np.array([(demand - self.low) / width]), -self.low / width)[0])


def by_inflow(
    thruster: dict, share: float, length: float, rng: np.random.Generator, *, at_rest: bool = False
) -> Callable:
    """The error of a thrust [N] by the speed of the water along the thruster: a share of its bound that bends, or turns, over the speeds."""
    curve = Curve(thruster, at_rest=at_rest)
    pace = 0.3 * math.sqrt(9.81 * length)
    turns, phase, side = rng.uniform(1.0, 4.0), rng.uniform(0.0, 2.0 * math.pi), rng.choice([-1, 1])
    bends = rng.uniform() < 0.5

    def error(thrust, inflow):
        bound = share * curve.allowed(np.abs(thrust))
        q = inflow / pace
        return bound * (side * np.tanh(q) if bends else np.sin(turns * q + phase))

    return error


def errors(family: str | None, count: int, alike: bool, rng: np.random.Generator) -> list:
    """The error of each thruster as a shape over its demands; of ``hysteresis`` the sign for a rising demand."""
    if family is None or family == "inflow":
        return [None] * count
    make = (lambda q: float(q.choice([-1, 1]))) if family == "hysteresis" else SHAPES[family]
    return [make(rng)] * count if alike else [make(rng) for _ in range(count)]


def changed_thrust(effects, name: str, index: int, arm: float, demand: float, thrust: float, largest: float, t: float):
    """A thrust at rest [N] after the effects on it, in the order of docs/effects.md."""
    if not effects:
        return thrust

    def number(id_: str) -> float | None:
        p = effects.get(f"{id_}.{name}", effects.get(id_))
        return None if p is None else p[""]

    if (q := number("thruster.gain")) is not None:
        thrust *= 1 + q
    if (q := number("thruster.asymmetry")) is not None and arm:
        thrust *= 1 - math.copysign(q, arm)
    if (p := effects.get("thruster.failure")) and index == p["thruster"] and t >= p["time"]:
        thrust *= 1 - p["loss"]
    if (p := effects.get("x.heat")) and index == p["thruster"]:
        thrust *= 1 + p["loss"] * math.expm1(-t / p["pace"])
    if (q := number("thruster.deadband")) is not None and abs(demand) < q:
        thrust = 0.0
    if (q := number("thruster.saturation")) is not None:
        thrust = math.copysign(min(abs(thrust), q), thrust)
    if (q := number("thruster.reverse_loss")) is not None and thrust < 0:
        thrust *= 1 - q
    if (q := number("thruster.voltage_sag")) is not None:
        thrust *= max(1 - q * t, 0.0)
    if (q := number("thruster.curve")) is not None:
        thrust += q * thrust * (1 - abs(thrust) / largest)
    return thrust
