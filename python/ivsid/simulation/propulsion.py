"""From demands to thrusts in time: the curve with its true error, what changes it, lag and delay."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ivsid.effects import EFFECTS, Drive, Given, Response, Thrust, for_thruster
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.simulation.equations import Plant
from ivsid.vehicle import Thruster

# Effects that say of a thruster what its file may claim; where both are given, the effect is the truth.
_CLAIMS = {
    "thruster.deadband": "dead_band",
    "thruster.saturation": "limit",
    "thruster.reverse_loss": "reverse_factor",
}


_INSIDE = 1e-9
# Ends of the pieces, in lags.
_PIECES = (1.0, 2.0, 4.0, 8.0, 16.0)


class TrueThrust:
    """A thrust curve with a smooth error inside its accuracy, fixed for the log; no thrust has no error."""

    def __init__(self, thruster: Thruster, rng: np.random.Generator) -> None:
        self.thruster = thruster
        # What the file claims beyond the curve is put on here, after the error, as the effects are that may replace it.
        bare = {"dead_band": None, "limit": None, "reverse_factor": None}
        self._bare = ThrustCurve(thruster.model_copy(update=bare))
        self.phase, self.cycles, self.size = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 1.5), rng.uniform(0.2, 1.0)
        low, high = self._bare.range
        self.span = high - low if np.isfinite(high - low) else 1.0
        self._low, self._high = low, high

    @property
    def description(self) -> dict[str, float]:
        """The error, for the truth."""
        return {"size": self.size, "cycles": self.cycles, "phase": self.phase}

    def __call__(self, demand: float) -> float:
        """Thrust [N] at a demand."""
        return self.value(demand)

    @cached_property
    def value(self) -> Callable[[float], float]:
        """The same as a plain function, for the many calls of a simulation."""
        curve = scalar_curve(self._bare)
        accuracy = self.thruster.accuracy
        absolute, relative, size = accuracy.absolute, accuracy.relative, self.size
        cycles, span, phase = 2 * math.pi * self.cycles, self.span, self.phase
        # A thrust astern that the file claims to be larger takes its error along: what is claimed of the error holds for the product.
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
        """The demand inside the range of the curve, about its neutral."""
        return min(max(demand + self.thruster.neutral, self._low), self._high)

    @property
    def reference(self) -> float:
        """The largest thrust of the curve [N]; 0 for a curve without end."""
        return self._bare.largest


def scalar_curve(curve: ThrustCurve) -> Callable[[float], float]:
    """The same static curve for one demand at a time, in plain floats: NumPy costs ten times as much for one number."""
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


class Propulsion:
    """All thrusters of a plant, stepped through time with demands that are held between samples.

    A held demand makes the lag exact: T goes to its new value as exp(-t / tau). A delay moves the moments at which demands change;
    ``breaks`` names them, so that no step of the integration crosses one.
    """

    def __init__(self, plant: Plant, curves: Sequence[TrueThrust]) -> None:
        self.curves = curves
        thrusters = plant.vehicle.thrusters
        self._changes = [_changes(plant, t) for t in thrusters]
        self._bands = [next((g.values[0] for g in c if g.effect.id == "thruster.deadband"), 0.0) for c in self._changes]
        self._timed = [
            any(g.effect.id in ("thruster.failure", "thruster.voltage_sag") for g in c) for c in self._changes
        ]
        self.events = sorted(
            g.values[-1]
            for g in plant.given
            if g.effect.id in ("thruster.failure", "payload.step") and g.values[-1] > 0
        )
        responses = [
            {
                g.effect.acts.kind: g.values[0]
                for g in for_thruster(plant.given, Response, t.name)
                if isinstance(g.effect.acts, Response)
            }
            for t in thrusters
        ]
        self.lags = [r.get("lag", t.time_constant or 0.0) for r, t in zip(responses, thrusters, strict=True)]
        self.delays = [r.get("delay", 0.0) for r in responses]
        self.shaft = [t.lag == "demand" for t in thrusters]
        self._lagging = any(self.lags)
        self.plain = not any(self.lags) and not any(self.delays) and not self.events
        # Thrusts that hold from sample to sample: no lag, no delay, no clock.
        self.steady = self.plain and not any(self._timed)
        # What can break a step: a clock, a delay, a shaft in its dead band, or a lag shorter than the step.
        banded = any(b and s for b, s in zip(self._bands, self.shaft, strict=True))
        self._jumps = bool(self.events) or any(self.delays) or banded
        self._quickest = min((q for q in self.lags if q > 0), default=math.inf)
        # Thrusters whose thrust is their curve's alone.
        self._plainly = [None if changes else c.value for changes, c in zip(self._changes, curves, strict=True)]
        self._times: list[float] = []
        self._demands: list[list[float]] = []
        neutral = [t.neutral for t in thrusters]
        # Before the log the thrusters stand still.
        self._lagged = [n if s else 0.0 for n, s in zip(neutral, self.shaft, strict=True)]
        self._neutral = neutral
        self._known: list[tuple[float, float] | None] = [None] * len(thrusters)
        self._at_speed: list[tuple[float, float] | None] = [None] * len(thrusters)
        self._voltage: Callable[[float], float] | None = None

    def supply(self, voltage: Callable[[float], float]) -> None:
        """The supply's voltage as a share of its first value, by time [s]."""
        self._voltage = voltage

    def demand(self, time: float, demands: list[float]) -> None:
        """New demands from ``time`` on."""
        self._times.append(time)
        self._demands.append(demands)

    def breaks(self, start: float, end: float) -> list[float]:
        """Moments strictly between two times at which a thrust or a mass jumps, and those that resolve a lag shorter than that."""
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
            # After each jump the thrust moves as exp(-t / lag): pieces that double follow it until nothing is left of it.
            for jump in (start, *found):
                found |= {jump + q * lag for q in _PIECES if jump + q * lag < end}
        return sorted(found)

    def _crossings(self, k: int, start: float) -> list[float]:
        """How long a shaft takes to the edges of its dead band, where the thrust jumps while the speed does not."""
        band = self._bands[k]
        if not band or not self.shaft[k] or self.delays[k]:
            return []
        now = self._lagged[k] - self._neutral[k]
        goal = self._acting(k, start) - self._neutral[k]
        shares = [(edge - goal) / (now - goal) for edge in (band, -band)] if now != goal else []
        return [-self.lags[k] * math.log(q) for q in shares if 0 < q < 1]

    def static(self, k: int, time: float) -> tuple[float, float]:
        """Demand that acts on thruster k at a time, and its thrust at rest, without lag."""
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
        thrust: Any = curve.value(demand)
        changes = self._changes[k]
        if not changes:
            return float(thrust)
        voltage = None if self._voltage is None else self._voltage(time)
        drive = Drive(demand - self._neutral[k], time, k, curve.thruster.position[1], curve.reference, voltage)
        for g in changes:
            if isinstance(g.effect.acts, Thrust):
                thrust = g.effect.acts.function(thrust, drive, g.values)
        return float(thrust)

    def over(self, start: float, step: float) -> tuple[list[float], list[float], list[float]]:
        """Thrusts at the start, the middle and the end of a step that crosses no break; the lag moves on."""
        middle = start + 0.5 * step
        if not self._lagging:
            held = [self.static(k, middle)[1] for k in range(len(self.curves))]
            return held, held, held
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
                # From inside the step, whose ends may be the very edge of a dead band.
                inner = _INSIDE * (then - now) if self._bands[k] else 0.0
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

    def now(self, time: float) -> list[float]:
        """Thrusts at a moment, with those demands that act just after it."""
        found = []
        for k, lag in enumerate(self.lags):
            if not lag:
                found.append(self.static(k, time)[1])
            elif self.shaft[k]:
                found.append(self._thrust(k, self._lagged[k], time))
            else:
                found.append(self._lagged[k])
        return found


def _changes(plant: Plant, thruster: Thruster) -> list[Given]:
    """What changes a thrust at rest: the file's claims that no effect replaces, then the effects, in the catalogue's order."""
    given = for_thruster(plant.given, Thrust, thruster.name)
    named = {g.effect.id for g in given}
    for id_, key in _CLAIMS.items():
        value = getattr(thruster, key)
        if value is not None and id_ not in named:
            given.append(Given(EFFECTS[id_], (1.0 - value if key == "reverse_factor" else value,)))
    order = list(EFFECTS)
    return sorted(given, key=lambda g: order.index(g.effect.id))
