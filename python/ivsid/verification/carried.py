"""Causes of ``[model.fitted]`` in readings and thrusts, once more: biases, scales, a current, gains, delays (docs/theory.md, "Fitted causes")."""

from __future__ import annotations

import numpy as np

from ivsid.log import Log
from ivsid.vehicle import Thruster, Vehicle
from ivsid.vehicle.carried import ends_of, names_of, of_thruster
from ivsid.verification.decimals import Decimals
from ivsid.verification.rational import Range

_BIAS = {
    "ax": "sensor.acceleration.bias.x",
    "udot": "sensor.acceleration.bias.x",
    "ay": "sensor.acceleration.bias.y",
    "vdot": "sensor.acceleration.bias.y",
    "r": "sensor.yaw_rate.bias",
}
_SCALE = {"r": "sensor.yaw_rate.scale", "u": "sensor.velocity.scale", "v": "sensor.velocity.scale"}
_WATER = ("current.steady.north", "current.steady.east")


class Carried:
    """The numbers of ``[model.fitted]`` that the rows of a log take into account.

    Args:
        log: the log.
        vehicle: with the keys that fitted numbers stand for.
        exact: the decimals of its file.
    """

    def __init__(self, log: Log, vehicle: Vehicle, exact: Decimals) -> None:
        self.log, self.vehicle, self.exact = log, vehicle, exact
        self.numbers = {n: f for n, f in vehicle.model.fitted.items() if f.value is not None}
        heading = vehicle.sensors.heading is not None and "psi" in log.columns
        self.water = self._pair() if heading and self.numbers.keys() >= {*_WATER} else None
        self.scaled = all(t.limit is None for t in vehicle.thrusters)
        delays = [of_thruster(vehicle, "thruster.delay", t.name) for t in vehicle.thrusters]
        held = vehicle.log.demand == "hold" and not any(t.time_constant for t in vehicle.thrusters)
        self.late = held and all(d is None or ends_of(d)[0] >= 0 for d in delays)

    @property
    def names(self) -> set[str]:
        """The numbers that are taken into account; a cause of a sensor that reads nothing in the log is."""
        found = {n for n in _BIAS.values() if n in self.numbers}
        found |= {n for n in {*_SCALE.values()} if n in self.numbers and self._scales(n)}
        found |= set() if self.water is None else {*_WATER}
        for id_, kept in (
            ("thruster.gain", self.scaled),
            ("thruster.asymmetry", self.scaled),
            ("thruster.delay", self.late),
        ):
            found |= {*names_of(self.vehicle, id_)} if kept else set()
        return found

    def without(self, name: str, reading: Range) -> Range:
        """A logged reading, its error included, without the bias and the scale of its channel."""
        bias, scale = _BIAS.get(name, ""), _SCALE.get(name, "")
        if bias in self.numbers:
            reading = reading - self._range(bias)
        if scale in self.numbers and self._scales(scale):
            reading = reading / (self._range(scale) + 1)
        return reading

    def biased(self, name: str) -> bool:
        """Whether a channel has a stated bias."""
        return _BIAS.get(name, "") in self.numbers

    def factor(self, thruster: Thruster) -> Range:
        """The factor of a thrust."""
        made = Range(1)
        if not self.scaled:
            return made
        if (gain := of_thruster(self.vehicle, "thruster.gain", thruster.name)) is not None:
            made = made * (self._ends(*ends_of(gain)) + 1)
        side = int(np.sign(thruster.position[1]))
        if "thruster.asymmetry" in self.numbers and side:
            made = made * (1 - side * self._range("thruster.asymmetry"))
        return made

    def delay(self, thruster: Thruster) -> Range | None:
        """The delay of a demand [s], or None."""
        found = of_thruster(self.vehicle, "thruster.delay", thruster.name) if self.late else None
        return None if found is None else self._ends(*ends_of(found))

    def _scales(self, id_: str) -> bool:
        columns, log = [c for c, i in _SCALE.items() if i == id_], self.log
        own = [c for c in columns if c in log.columns and c not in log.derived]
        gyro = self.vehicle.sensors.yaw_rate
        averages = id_ == "sensor.yaw_rate.scale" and gyro is not None and gyro.sampling == "averaged"
        from_earth = "u" in columns and log.derived.get("u", ("",))[0] == "velocity_north"
        possible = ends_of(self.numbers[id_])[0] > -1
        return possible and not averages and not from_earth and not {*own} & {*log.by_rate}

    def _pair(self) -> tuple[Range, Range]:
        return self._range(_WATER[0]), self._range(_WATER[1])

    def _range(self, name: str) -> Range:
        return self._ends(*ends_of(self.numbers[name]))

    def _ends(self, low: float, high: float) -> Range:
        return self.exact(low).hull(self.exact(high))
