"""Thrusts in time: the true curve, changes of the thrust, lag and delay."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Final

from ivsid.effects import Drive, Response, Thrust, acting, for_thruster, with_stated
from ivsid.effects.quantity import Quantity
from ivsid.simulation.equations import Plant
from ivsid.simulation.true_thrust import TrueThrust

# Share of a step by which its ends are evaluated from inside, because a thrust may jump at the very end.
# Source: definition: far above the relative rounding of float64 times, far below any step that matters.
INSIDE: Final = 1e-9
# Ends of the pieces that follow a lag shorter than a step, in time constants.
# Source: theorem: after 16 time constants exp(-16) = 1e-7 of a jump is left.
_PIECES: Final = (1.0, 2.0, 4.0, 8.0, 16.0)


class Propulsion:
    """All thrusters of a plant, stepped through time under demands that hold between samples.

    Under a held demand the lag is exact: T approaches its new value as exp(-t / tau). A delay moves the moments at which demands
    change; ``breaks`` names them, so that no step of the integration crosses one.

    Attributes:
        steady: whether thrusts hold from sample to sample: no lag, no delay, no effect of time.
        plain: whether there is neither lag nor delay nor event.
        events: moments [s] at which a failure or a payload step begins.
        lags: time constants [s] by thruster.
        delays: of the demands [s] by thruster.
        shaft: by thruster, whether the lag is that of the demand (the shaft's speed) and not of the thrust.
    """

    def __init__(self, plant: Plant, curves: Sequence[TrueThrust]) -> None:
        self.curves = curves
        thrusters = plant.vehicle.thrusters
        # An effect of the scenario is the truth if the vehicle file states the same.
        changes = [with_stated(plant.given, Thrust, t) for t in thrusters]
        self._changes = [acting(c, Thrust) for c in changes]
        self._bands = [next((g.values[0] for g in c if g.effect.form.jumps), 0.0) for c in changes]
        self._timed = [any(change.timed for change, _ in c) for c in self._changes]
        self.events = sorted(g.start for g in plant.given if g.start is not None and g.start > 0)
        responses = [
            {r.kind: numbers[0] for r, numbers in acting(for_thruster(plant.given, Response, t.name), Response)}
            for t in thrusters
        ]
        self.lags = [
            r.get("shaft", r.get("lag", t.time_constant or 0.0)) for r, t in zip(responses, thrusters, strict=True)
        ]
        self.delays = [r.get("delay", 0.0) for r in responses]
        self.shaft = ["shaft" in r or t.lag == "demand" for r, t in zip(responses, thrusters, strict=True)]
        self._lagging = any(self.lags)
        self.plain = not any(self.lags) and not any(self.delays) and not self.events
        self.steady = self.plain and not any(self._timed)
        # Causes of a break: an event, a delay, a shaft in its dead band, or a lag shorter than the step.
        banded = any(b and s for b, s in zip(self._bands, self.shaft, strict=True))
        self._jumps = bool(self.events) or any(self.delays) or banded
        self._quickest = min((q for q in self.lags if q > 0), default=math.inf)
        # The curve of each thruster whose thrust nothing else changes.
        self._plainly = [None if changes else c.value for changes, c in zip(self._changes, curves, strict=True)]
        self._times: list[float] = []
        self._demands: list[list[float]] = []
        neutral = [t.neutral for t in thrusters]
        # The thrusters are at rest before the log.
        self._lagged = [n if s else 0.0 for n, s in zip(neutral, self.shaft, strict=True)]
        self._neutral = neutral
        self._known: list[tuple[float, float] | None] = [None] * len(thrusters)
        self._at_speed: list[tuple[float, float] | None] = [None] * len(thrusters)
        self._voltage: Callable[[float], float] | None = None

    def supply(self, voltage: Callable[[float], float]) -> None:
        """Sets the supply's voltage: its share of the first value by time [s]."""
        self._voltage = voltage

    def demand(self, time: float, demands: list[float]) -> None:
        """New demands from ``time`` on."""
        self._times.append(time)
        self._demands.append(demands)

    def breaks(self, start: float, end: float) -> list[float]:
        """Moments [s] strictly between two times at which a thrust or a mass jumps, and those that resolve a shorter lag."""
        if not self._jumps and end - start <= self._quickest:
            return []
        found = {e for e in self.events if start < e < end}
        for delay in set(self.delays):
            if delay:
                low = bisect_right(self._times, start - delay)
                high = bisect_right(self._times, end - delay)
                found |= {q + delay for q in self._times[low:high] if start < q + delay < end}
        found |= {start + q for k in range(len(self.lags)) for q in self._crossings(k, start) if start + q < end}
        for lag in {q for q in self.lags if 0 < q < end - start}:
            # After each jump the thrust moves as exp(-t / lag): pieces of doubling length follow it until it has ended.
            for jump in (start, *found):
                found |= {jump + q * lag for q in _PIECES if jump + q * lag < end}
        return sorted(found)

    def _crossings(self, k: int, start: float) -> list[float]:
        """Times [s] at which a shaft reaches the edges of its dead band: the thrust jumps there while the speed does not."""
        band = self._bands[k]
        if not band or not self.shaft[k] or self.delays[k]:
            return []
        now = self._lagged[k] - self._neutral[k]
        goal = self._acting(k, start) - self._neutral[k]
        shares = [(edge - goal) / (now - goal) for edge in (band, -band)] if now != goal else []
        return [-self.lags[k] * math.log(q) for q in shares if 0 < q < 1]

    def static(self, k: int, time: float) -> tuple[float, float]:
        """The demand that acts on thruster k at a time [s], and its thrust at rest [N] without lag."""
        demand = self._acting(k, time)
        known = self._known[k]
        if known is not None and known[0] == demand and not self._timed[k]:
            return known
        found = (demand, self._thrust(k, demand, time))
        self._known[k] = found
        return found

    def _acting(self, k: int, time: float) -> float:
        delay = self.delays[k]
        if not delay:
            return self._demands[-1][k]
        at = bisect_right(self._times, time - delay) - 1
        return self._neutral[k] if at < 0 else self._demands[at][k]

    def _thrust(self, k: int, demand: float, time: float) -> float:
        curve = self.curves[k]
        thrust: Quantity = curve.value(demand)
        changes = self._changes[k]
        if not changes:
            return float(thrust)
        voltage = None if self._voltage is None else self._voltage(time)
        drive = Drive(demand - self._neutral[k], time, k, curve.thruster.position[1], curve.reference, voltage)
        for change, numbers in changes:
            thrust = change.function(thrust, drive, numbers)
        return float(thrust)

    def over(self, start: float, step: float) -> tuple[list[float], list[float], list[float]]:
        """Thrusts [N] at the start, the middle and the end of a step [s] that crosses no break; advances the lags."""
        middle = start + 0.5 * step
        if not self._lagging:
            thrusts = [self.static(k, middle)[1] for k in range(len(self.curves))]
            return thrusts, thrusts, thrusts
        first, half, last = [], [], []
        for k, lag in enumerate(self.lags):
            demand, target = self.static(k, middle)
            if not lag:
                first.append(target)
                half.append(target)
                last.append(target)
                continue
            decay = math.exp(-0.5 * step / lag)
            goal = demand if self.shaft[k] else target
            now = self._lagged[k]
            then = goal + (now - goal) * decay
            end = goal + (then - goal) * decay
            self._lagged[k] = end
            if self.shaft[k]:
                # The ends may lie on the edge of a dead band: they are evaluated from inside the step.
                inner = INSIDE * (then - now) if self._bands[k] else 0.0
                known = self._at_speed[k]
                again = known is not None and known[0] == now + inner and not self._timed[k]
                plainly = self._plainly[k]
                if plainly is not None:
                    first.append(known[1] if again and known is not None else plainly(now))
                    half.append(plainly(then))
                    last.append(plainly(end))
                else:
                    first.append(known[1] if again and known is not None else self._thrust(k, now + inner, middle))
                    half.append(self._thrust(k, then, middle))
                    last.append(self._thrust(k, end - inner, middle))
                self._at_speed[k] = (end - inner, last[-1])
            else:
                first.append(now)
                half.append(then)
                last.append(end)
        return first, half, last

    def advance(self, start: float, end: float) -> None:
        """Moves the lags from one time to another [s] without a motion."""
        for low, high in pairwise([start, *self.breaks(start, end), end]):
            self.over(low, high - low)

    def now(self, time: float) -> list[float]:
        """Thrusts [N] at a moment [s], under the demands that act just after it."""
        found = []
        for k, lag in enumerate(self.lags):
            if not lag:
                found.append(self.static(k, time)[1])
            elif self.shaft[k]:
                found.append(self._thrust(k, self._lagged[k], time))
            else:
                found.append(self._lagged[k])
        return found
