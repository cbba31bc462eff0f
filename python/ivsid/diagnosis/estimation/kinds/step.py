"""Causes that start at a time: the cross-products of a column from a block on are sums over the later blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Self

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.kinds.candidate import Candidate, NullScores, Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import STEP_FROM_NONE, Signatures
from ivsid.effects import Effect, Given

Array = NDArray[np.float64]
# Blocks at either end of a log in which no step is looked for.
# Source: geometry: half a minute before and after a step, the time over which coefficients are told apart from their scatter
EDGE: Final = 3
# Neighbouring starts of a step that count as one independent start.
# Source: measured: make constants
STARTS_A_LOOK: Final = 6.0
# A step's column has to keep this share of its squared length beside the base.
# Source: measured: make constants
STEP_LEFT: Final = 1e-6


@dataclass(frozen=True)
class StepCandidate(Candidate):
    """A cause that starts at a time.

    Attributes:
        thruster: index of the thruster on which it acts; None if it has no parameter for one.
    """

    thruster: int | None = None
    starts: ClassVar[bool] = True

    @classmethod
    def made(cls, s: Signatures, effect: Effect, out: Columns) -> Sequence[Self]:
        """The candidates of an effect, one a thruster if it has a parameter for one, as if it began before the log."""
        vehicle = s.predictor.vehicle
        several = "thruster" in effect.draws
        found = []
        for k, name in enumerate([t.name for t in vehicle.thrusters] if several else [""]):
            one = cls(effect, thruster=k if several else None)
            step = STEP_FROM_NONE * effect.parameters[one.number].scaled(vehicle.hull.mass)
            column = f"{effect.id}.{name}" if several else effect.parts[one.number]
            out.add(column, s.whole(Given(effect, one.numbers(step, float(s.predictor.log.t[0]) - 1.0))) / step)
            found.append(cls(effect, ((column,),), one.thruster))
        return found

    @property
    def number(self) -> int:
        """Index of the parameter that is fitted: the size."""
        return self.effect.draws.index("size")

    def numbers(self, size: float, time: float) -> tuple[float, ...]:
        """The effect's numbers at a size and a start [s]."""
        known = {"thruster": float(self.thruster or 0), "time": time, "size": size}
        return tuple(min(known.get(p.draw, p.typical), p.most) for p in self.effect.parameters)

    def names(self) -> list[str]:
        """No column over the log."""
        return []

    def looks(self, blocks: int) -> tuple[int, float]:
        """Size and start, with a look for some starts together."""
        return 2, blocks / STARTS_A_LOOK

    def score(self, p: Projection, s: Signatures) -> Scored | None:
        """The best start."""
        g, log = p.g, s.predictor.log
        j = g.at(self.variants[0])[0]
        later = _later(g.blocks[:, j, :])
        score = _later(g.score[:, j])
        H, cross = beside(p, j, later)
        found = score - cross @ p.coefficients
        usable = _usable(H, float(later[0, j]))
        if not usable.any():
            return None
        fall = np.where(usable, found**2 / np.where(usable, H, 1.0), 0.0)
        if not self.effect.parameters[self.number].signed:
            fall = np.where(found > 0, fall, 0.0)
        b = int(np.argmax(fall))
        theta = float(found[b] / max(H[b], 1e-300) / g.unit[j])
        time = float(log.t[0] + b * g.length * log.h)
        return Scored(self, float(fall[b]), *self.looks(len(fall)), (j,), (theta,), self.numbers(theta, time))

    def null_fall(self, null: NullScores) -> Array:
        """Fall of chi-squared by the best start in each draw, shape (draws,)."""
        scores, H = null.since(self.variants[0][0])
        usable = _usable(H, float(null.p.total[(j := null.p.g.at(self.variants[0])[0]), j]))
        return np.asarray(np.where(usable, scores**2 / np.where(usable, H, 1.0), 0.0).max(axis=1))

    def size(self, p: Projection, s: Signatures) -> tuple[float, dict[str, float]]:
        """The z of a start in the middle of the log."""
        g, k = p.g, self.number
        j = g.at(self.variants[0])[0]
        size = self.effect.parameters[k].scaled(s.predictor.vehicle.hull.mass)
        half = len(g.blocks) // 2
        later = g.blocks[half:, j, :].sum(axis=0)
        cross = later[p.base]
        H = float(later[j] - cross @ np.linalg.solve(p.normal, cross))
        return size * float(g.unit[j]) * float(np.sqrt(max(H, 0.0))), {self.effect.parts[k]: size}

    def first_block(self, values: Sequence[float], g: Gram, log: Channels) -> int:
        """The block of the start."""
        start = values[self.effect.draws.index("time")]
        return round((start - float(log.t[0])) / (g.length * log.h))


def _later(x: Array) -> Array:
    """Sums over all blocks from each one on."""
    return np.asarray(np.cumsum(x[::-1], axis=0)[::-1])


def beside(p: Projection, j: int, later: Array) -> tuple[Array, Array]:
    """Information on the size of a step at each block beside the base, shape (blocks,), and its cross-products with the base.

    Args:
        p: least squares on the base.
        j: index of the column.
        later: cross-products of the column from each block on, shape (blocks, columns).
    """
    cross = later[:, p.base]
    return later[:, j] - np.einsum("bi,bi->b", cross, np.linalg.solve(p.normal, cross.T).T), cross


def _usable(H: Array, own: float) -> NDArray[np.bool_]:
    """Starts at which enough of the column is left, and of the log before and after."""
    usable = np.asarray(H / max(own, 1e-300) > STEP_LEFT)
    usable[:EDGE] = usable[len(usable) - EDGE :] = False
    return usable
