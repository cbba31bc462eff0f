"""A cause among the candidates, with the columns by which it is looked for, and a candidate at its best."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Final, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.gauss_newton import within
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import Effect, Given

Array = NDArray[np.float64]
# Price of each number beyond the first, in chi-squared: dearer than the 2 of Akaike's criterion.
# Source: measured: make constants
PRICE: Final = 3.0
# Eigenvalues of the information below this share of the largest belong to directions that the base explains.
# Source: definition: square root of the rounding unit of doubles
DEPENDENT: Final = 1e-8
# Below this z no size of an effect is called detectable.
# Source: definition: signatures of no effect are zero up to rounding
NO_SIZE: Final = 1e-6


class NullScores(Protocol):
    """Draws of the scores of all columns without any effect.

    Attributes:
        p: least squares beside which they are scored.
    """

    p: Projection

    def of(self, names: Sequence[str]) -> Array:
        """Scores of columns over the log beside the base, shape (draws, columns)."""

    def since(self, name: str) -> tuple[Array, Array]:
        """Scores of a column from each block on beside the base, shape (draws, blocks), and their information, shape (blocks,)."""


@dataclass(frozen=True)
class Candidate(ABC):
    """A cause among the candidates.

    Attributes:
        effect: of the catalogue, in the form that the log supports.
        variants: names of its columns, one group for each value that is tried; empty if columns are found by a search.
        alone: name of the only thruster on which it acts; None for all.
        searched: whether its columns are found by a search.
        starts: whether its columns begin at a time that is searched.
        sums: whether the errors are the sum of its columns times numbers of the effect.
    """

    effect: Effect
    variants: tuple[tuple[str, ...], ...] = ()
    alone: str | None = field(default=None, kw_only=True)
    searched: ClassVar[bool] = False
    starts: ClassVar[bool] = False
    sums: ClassVar[bool] = False

    @classmethod
    @abstractmethod
    def made(cls, s: Signatures, effect: Effect, out: Columns) -> Sequence[Candidate]:
        """The candidates of an effect, whose columns are added to ``out``."""

    def alone_on(self, _s: Signatures, _thruster: str, _out: Columns) -> Sequence[Candidate]:
        """The same cause on one thruster alone, whose columns are added; none for a kind that has no such form.

        Args:
            _s: signatures of the fit.
            _thruster: its name.
            _out: gets the columns.
        """
        return []

    @abstractmethod
    def score(self, p: Projection, s: Signatures) -> Scored | None:
        """The candidate at its best beside the base; None without a value that can be scored.

        Args:
            p: least squares beside which it is scored.
            s: signatures of the fit.
        """

    @property
    def id(self) -> str:
        """The id of its effect."""
        return self.effect.id

    def given(self, values: Sequence[float]) -> Given:
        """Its effect with numbers."""
        return Given(self.effect, tuple(values), self.alone)

    @property
    def sided(self) -> bool:
        """Whether its only number can have one sign alone."""
        return len(self.effect.parameters) == 1 and not self.effect.parameters[0].signed

    @property
    def limited(self) -> int:
        """Number of parameters, from the first on, whose coefficients are columns and have an upper limit without a search."""
        return 0

    def names(self) -> list[str]:
        """Names of its columns over the log."""
        return [n for names in self.variants for n in names]

    def tried(self) -> dict[str, float]:
        """Values of the effect's number that are tried, by column; empty for a number that is not tried by value."""
        return {}

    def looks(self, blocks: int) -> tuple[int, float]:
        """Number of columns, and factor of the chance by the values that are searched and by the sign.

        Args:
            blocks: of the log.
        """
        return len(self.variants[0]), 0.5 if self.sided else 1.0

    def null_fall(self, null: NullScores) -> Array:
        """Fall of chi-squared by the best of its columns in each draw without an effect, shape (draws,)."""
        best: Array = np.zeros(1)
        for names in self.variants:
            values, vectors = np.linalg.eigh(null.p.information(null.p.g.at(names)))
            keep = values > DEPENDENT * max(float(values.max()), 1e-300)
            scores = null.of(names)
            fall = ((scores @ vectors[:, keep] / np.sqrt(values[keep])) ** 2).sum(axis=1)
            if self.sided:
                fall = np.where(scores[:, 0] > 0, fall, 0.0)
            best = np.maximum(best, fall)
        return best

    def size(self, p: Projection, s: Signatures) -> tuple[float, dict[str, float]]:
        """The z of the effect at its typical size, and that size by parameter.

        Args:
            p: least squares beside which it is scored.
            s: signatures of the fit.
        """
        at = p.g.at(self.variants[0])
        mass = s.predictor.vehicle.hull.mass
        sizes = np.array([q.scaled(mass) - q.none for q in self.effect.parameters])
        theta = sizes * p.g.unit[at]
        named = dict(zip(self.effect.parts, sizes.tolist(), strict=True))
        return float(np.sqrt(max(float(theta @ p.information(at) @ theta), 0.0))), named

    def detectable(self, _p: Projection, visible: float, z: float, sizes: Mapping[str, float]) -> dict[str, float]:
        """The size at which z reaches ``visible``, by parameter; empty if there is none.

        Args:
            p: least squares beside which it is scored.
            visible: standard deviations that are asked for.
            z: at the typical size.
            sizes: the typical size by parameter.
        """
        return {k: v * visible / z for k, v in sizes.items() if v} if z > NO_SIZE else {}

    def shifted(self, _s: Signatures) -> list[tuple[str, Array]]:
        """Names and columns once more at other states, for the part of them that errors of the states make; none if there is no such part."""
        return []

    def share(self, values: Sequence[float], mass: float) -> float:
        """The largest of its numbers in the size that is usual for a vehicle of this mass [kg]; 1 if no number has such a size."""
        sizes = [
            abs(v - q.none) / abs(q.scaled(mass) - q.none)
            for q, v in zip(self.effect.parameters, values, strict=True)
            # A demand has no usual size: its unit is the thruster's own.
            if q.draw in ("size", "north", "east") and not q.inverse and q.unit != "demand" and q.scaled(mass) != q.none
        ]
        return max(sizes, default=1.0)

    def adopted(self, h: Hypothesis, values: Sequence[float], _s: Signatures) -> Hypothesis:
        """The hypothesis with the effect in it.

        Args:
            h: the hypothesis.
            values: the effect's numbers.
            s: signatures of the fit in which they were found.
        """
        numbers = tuple(within(value, p) for value, p in zip(values, self.effect.parameters, strict=True))
        return h.with_effect(self.given(numbers))

    def first_block(self, _values: Sequence[float], _g: Gram, _log: Channels) -> int:
        """Index of the first block in which its columns act.

        Args:
            values: the effect's numbers.
            g: cross-products, by block.
            log: on its clock.
        """
        return 0


@dataclass(frozen=True)
class Scored:
    """A candidate at its best.

    Attributes:
        candidate: the cause.
        fall: of chi-squared.
        count: numbers that are fitted for it, searched ones included.
        looks: independent values that were searched.
        columns: indices among the cross-products.
        theta: coefficients in their units.
        values: the effect's numbers, in the catalogue's order.
        physical: whether the sign is one that the cause can have.
        lost: standard deviations of the score that declared errors inside their bounds may make.
        boxed: fall of chi-squared beside errors that keep their bounds, as rare as one of the family's numbers alone; 0 where it is not asked.
    """

    candidate: Candidate
    fall: float
    count: int
    looks: float
    columns: tuple[int, ...]
    theta: tuple[float, ...]
    values: tuple[float, ...]
    physical: bool = True
    lost: float = 0.0
    boxed: float = 0.0

    @property
    def shown(self) -> float:
        """The fall of chi-squared that is tested: soft priors of the declared errors hide what errors inside their bounds cannot take."""
        return max(self.fall, self.boxed)

    @property
    def id(self) -> str:
        """The id of its effect."""
        return self.candidate.id

    def share(self, mass: float) -> float:
        """The largest of its numbers in the size that is usual for a vehicle of this mass [kg]; 1 if no number has such a size."""
        return self.candidate.share(self.values, mass)

    def first_block(self, g: Gram, log: Channels) -> int:
        """Index of the first block in which its columns act."""
        return self.candidate.first_block(self.values, g, log)

    @property
    def merit(self) -> float:
        """The fall of chi-squared, less a price for each number beyond the first."""
        return self.fall - PRICE * (self.count - 1)

    @property
    def chance(self) -> float:
        """The probability of such a fall without the effect, over all values that were searched.

        A cause that can have one sign alone gets half of it.
        """
        one = chdtrc(self.count, self.fall) * self.looks
        return float(min(1.0, one * (0.5 if self.candidate.sided else 1.0)))
