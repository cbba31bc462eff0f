"""Half-widths of inertial sensors: noise, bias and drift within a number of standard deviations (docs/theory.md, "Sensor bounds")."""

from __future__ import annotations

from collections.abc import Callable, Collection
from fractions import Fraction
from functools import cached_property

import numpy as np

from ivsid.log import Log
from ivsid.vehicle import InertialSensor
from ivsid.verification.decimals import Decimals
from ivsid.verification.rational import Range, exponential, root


class HalfWidths:
    """Half-widths of accelerometers and gyros, sample by sample; equal ones are made once.

    Args:
        log: the log.
        exact: the decimals of the vehicle file.
        factor: the number of standard deviations.
        one: whether the paper's rule (``sigmas``) holds, under which all samples of a channel have one bound.
        apart: channels whose bias is one unknown of the log, so that its change since the middle of the log counts.
        time: the time of a row [s].
    """

    def __init__(
        self,
        log: Log,
        exact: Decimals,
        factor: Range,
        *,
        one: bool,
        apart: Collection[str],
        time: Callable[[int], Range],
    ) -> None:
        self.log, self.exact, self.factor, self.one, self.apart, self.time = log, exact, factor, one, apart, time
        self._made: dict[tuple[str, int, Fraction | int], Range] = {}
        self._least: dict[int, Fraction] = {}

    def __call__(self, sensor: InertialSensor, axis: int, name: str, i: int) -> Range:
        """The half-width of a sensor's axis, which is a channel of the log, at a row."""
        key = (name, axis, 0 if self.one else i if name in self.apart else self._averaging(name, i))
        if key not in self._made:
            self._made[key] = self._of(sensor, axis, name, i)
        return self._made[key]

    def _of(self, sensor: InertialSensor, axis: int, name: str, i: int) -> Range:
        walk, bias = (self.exact(axis_of(x, axis)) for x in (sensor.random_walk, sensor.bias_instability))
        k, t = self.factor, self.log.t
        drift = k * self.exact(sensor.rate_random_walk) * root(Range(Fraction(float(t[-1])) - Fraction(float(t[0]))))
        if self.one:
            step = self._longest(name)
            noise = walk / root(step) + root(step / self.exact(axis_of(sensor.bias_time, axis))) * bias
            return k * noise + drift + self.exact(sensor.accuracy)
        if name in self.apart:
            bias = bias * self._moved(self.exact(axis_of(sensor.bias_time, axis)), i)
        return k * walk / root(Range(self._averaging(name, i))) + k * bias + drift + self.exact(sensor.accuracy)

    def _moved(self, time: Range, i: int) -> Range:
        """Standard deviation of a Gauss-Markov bias's change from the middle of the log to a sample, in its own standard deviations."""
        away = abs(self.time(i) * 2 - self.time(0) - self.time(self.log.t.size - 1)) / 2
        return root((1 - exponential(-(away / time))) * 2)

    def _longest(self, name: str) -> Range:
        """The longest time over which a sample of a channel averages white noise [s]."""
        t = self.log.t
        rows = range(t.size) if len(set(np.diff(t))) > 1 else (0,)
        return Range(max(self._averaging(name, j) for j in rows))

    @cached_property
    def _period(self) -> Fraction:
        return Fraction(self.log.period)

    def _averaging(self, name: str, i: int) -> Fraction:
        """The time over which a sample averages white noise [s]: the period, or less where samples stand closer."""
        if i not in self._least:
            t = self.log.t
            steps = [Fraction(float(t[j + 1])) - Fraction(float(t[j])) for j in (i - 1, i) if 0 <= j < t.size - 1]
            self._least[i] = min([*steps, self._period])
        clock = self.log.clocks.get(name)
        return self._least[i] if clock is None else min(self._least[i], Fraction(clock.interval))


def axis_of(value: float | tuple[float, float], axis: int) -> float:
    """A property of one axis, where the file states one for both."""
    return value[axis] if isinstance(value, tuple) else value
