"""Causes in whose number the errors bend or jump, as lags, delays, dead bands and limits: a column for each value that is tried."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.kinds.candidate import Candidate, Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import Signatures, of_file
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import Effect, Given, Grid

Array = NDArray[np.float64]
# Least lag or delay that is tried, in steps of the clock.
# Source: geometry: a tenth of a sample stands for all delays below one sample, whose columns are proportional to each other
LEAST_DELAY: Final = 0.1
# Largest lag or delay that is tried, as a share of the log.
# Source: geometry: nine tenths of the log are left behind it
MOST_DELAY: Final = 0.1
# The share of demands, apart from zero, that the unit of dead bands exceeds.
# Source: measured: make constants
MOST_DEMANDS: Final = 0.7
# Largest demand that counts as none, in its own unit.
# Source: geometry: rounding of a demand
NO_DEMAND: Final = 1e-9
# Independent values that each further value of a number adds to a search: the columns of neighbours are alike.
# Source: measured: make constants
LOOKS_A_VALUE: Final = 0.3
# Least and largest factor between the value of a column and the value that its coefficient gives.
# Source: measured: make constants
SECANT: Final = (0.3, 3.0)


@dataclass(frozen=True)
class GridCandidate(Candidate):
    """A cause whose column at a value is the whole effect there: the secant.

    Attributes:
        values: of the effect's number, one for each variant.
        idle: largest band, or least cap, that changes nothing in this log; None for a time, to which its column is about proportional.
    """

    values: tuple[float, ...] = ()
    idle: float | None = None

    @classmethod
    def made(cls, s: Signatures, effect: Effect, out: Columns, alone: str | None = None) -> Sequence[Self]:
        """The candidate of an effect at the values of its form that the log can show; of one thruster alone, if one is named."""
        assert isinstance(effect.form, Grid)
        idle, values = _values(s, effect.form, alone)
        names, kept = [], []
        for value in values:
            given = Given(effect, (value,), alone)
            column = s.secant(given)
            if idle is None or np.any(column):
                out.add(f"{given.parts[0]}@{value:.6g}", column)
                names.append((out.names[-1],))
                kept.append(value)
        return [cls(effect, tuple(names), tuple(kept), idle, alone=alone)] if names else []

    def alone_on(self, s: Signatures, thruster: str, out: Columns) -> Sequence[Self]:
        """The same values, or slopes, of one thruster."""
        return self.made(s, self.effect, out, thruster)

    def tried(self) -> dict[str, float]:
        """The value of each column."""
        return {name: value for (name,), value in zip(self.variants, self.values, strict=True)}

    def looks(self, _blocks: int) -> tuple[int, float]:
        """One column, and a share of a look for each value beside it."""
        return 1, (1.0 + LOOKS_A_VALUE * len(self.variants)) * (0.5 if self.sided else 1.0)

    def score(self, p: Projection, _s: Signatures) -> Scored | None:
        """The best of the values."""
        best: Scored | None = None
        looks = 1.0 + LOOKS_A_VALUE * len(self.variants)
        for names, value in zip(self.variants, self.values, strict=True):
            at = p.g.at(names)
            theta, fall = p.solve(at)
            real = float(theta[0] / p.g.unit[at[0]])
            if real <= 0:
                fall = 0.0
            if best is None or fall > best.fall:
                scaled = value * float(np.clip(real, *SECANT)) if self.idle is None else value
                best = Scored(self, fall, 1, looks, tuple(at), (real,), (scaled,), real > 0)
        return best

    def adopted(self, h: Hypothesis, values: Sequence[float], s: Signatures) -> Hypothesis:
        """The hypothesis with the effect in it, and a cap on the curve on which it was found."""
        found = super().adopted(h, values, s)
        return of_file(found) if self.effect.form.limits and s.on_file is not s.h else found

    def levels(self, p: Projection) -> list[tuple[float, float]]:
        """Values with their z, from the value without effect on: the z of a band or a cap is not proportional to it."""
        found = [] if self.idle is None else [(self.idle, 0.0)]
        for names, value in zip(self.variants, self.values, strict=True):
            at = p.g.at(names)
            found.append((value, float(np.sqrt(max(p.information(at)[0, 0], 0.0)) * p.g.unit[at[0]])))
        return sorted(found, key=lambda q: abs(q[0] - found[0][0]))

    def size(self, p: Projection, s: Signatures) -> tuple[float, dict[str, float]]:
        """The z at the typical size: between two levels, or in proportion from the nearest time."""
        parameter = self.effect.parameters[0]
        largest = max((c.largest for c in s.predictor.propulsion.curves), default=0.0)
        typical = parameter.scaled(s.predictor.vehicle.hull.mass, largest)
        if self.idle is not None:
            if parameter.unit == "demand":
                # Typical demands are per cent of the largest.
                typical = parameter.typical / 100 * float(np.abs(s.predictor.log.demands).max())
            values, shown = np.array(sorted(self.levels(p))).T
            return float(np.interp(typical, values, shown)), {self.effect.parts[0]: typical}
        k = int(np.argmin([abs(np.log(max(v, 1e-9) / max(typical, 1e-9))) for v in self.values]))
        at = p.g.at(self.variants[k])
        z = typical / self.values[k] * float(np.sqrt(max(p.information(at)[0, 0], 0.0))) * float(p.g.unit[at[0]])
        return z, {self.effect.parts[0]: typical}

    def detectable(self, p: Projection, visible: float, z: float, sizes: Mapping[str, float]) -> dict[str, float]:
        """The value at which z first reaches ``visible``, by linear interpolation between levels; empty if no level reaches it."""
        if self.idle is None:
            return super().detectable(p, visible, z, sizes)
        for (a, low), (b, high) in pairwise(self.levels(p)):
            if low < visible <= high:
                return {next(iter(sizes)): a + (b - a) * (visible - low) / (high - low)}
        return {}


def _values(s: Signatures, form: Grid, alone: str | None) -> tuple[float | None, list[float]]:
    """The value that changes nothing in a log, if there is one beside zero, and the values that are tried; none where the log is at rest."""
    log, propulsion = s.predictor.log, s.predictor.propulsion
    own = [k for k, t in enumerate(s.predictor.vehicle.thrusters) if alone in (None, t.name)]
    if form.of == "seconds":
        return None, sorted({LEAST_DELAY * log.h, *(d for d in form.values if d < MOST_DELAY * log.n * log.h)})
    if form.of == "demand":
        used = np.abs(np.concatenate([propulsion.demands[k] for k in own]))
        low = used[used > NO_DEMAND]
        if not low.size:
            return 0.0, []
        return float(low.min()), [float(np.quantile(low, MOST_DEMANDS)) * q for q in form.values]
    largest = float(np.abs(propulsion.thrusts(s.h.given).now[own]).max())
    return largest, [largest * q for q in form.values] if largest > 0 else []
