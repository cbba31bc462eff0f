"""Falls of chi-squared by columns in the place of causes, on one log and on two.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import NOTHING_LEFT, Projection
from ivsid.diagnosis.null.gradual import GRADUAL
from ivsid.diagnosis.null.modulated import FALL
from ivsid.diagnosis.selection.dictionary import FELT, WRONG
from ivsid.diagnosis.selection.force_rules import Together

Array = NDArray[np.float64]
# Largest share of what the least of some causes explains beside the others that they explain beside a force which stands in their place.
# Source: definition: three quarters are the force's; of other parts of the errors it has nothing
REPLACED: Final = 0.25
# First words of forces and readings of one cause with all the channels in which it acts.
EVERYWHERE: Final = (GRADUAL, FALL, WRONG, FELT)


@dataclass(frozen=True)
class InPlace:
    """What some causes explain, and what each force does in their place.

    Attributes:
        fall: of chi-squared by the causes together.
        least: part of it that one of them brings beside the others, the least one.
        own: falls by each column of a cause in the place of all, by its id.
        alone: falls by each force, by its name.
        kept: falls by the causes together beside each force.
        odd: forces beside which a number of the model is none of a hull.
        logs: in words, where it is not one.
    """

    fall: float
    least: float
    own: Mapping[str, tuple[float, ...]]
    alone: Mapping[str, float]
    kept: Mapping[str, float]
    odd: frozenset[str]
    logs: str = ""

    def beside(self, other: Self) -> InPlace:
        """The same on two logs together, each with numbers of its own; of forces that both have."""
        known = same_forces(self.alone, other.alone)
        return InPlace(
            self.fall + other.fall,
            self.least + other.least,
            {i: tuple(a + b for a, b in zip(x, other.own[i], strict=True)) for i, x in self.own.items()},
            {f: self.alone[f] + other.alone[there] for f, there in known.items()},
            {f: self.kept[f] + other.kept[there] for f, there in known.items()},
            self.odd | {f for f, there in known.items() if there in other.odd},
            " on both logs together",
        )

    @property
    def best(self) -> Together:
        """The causes with the force that explains most in their place."""
        # A force beside which one of the causes explains what it did is another part of the errors.
        most = REPLACED * self.least
        stand = {f: x for f, x in self.alone.items() if self.kept[f] <= most and f not in self.odd}
        force = max(stand, key=stand.__getitem__, default="no force")
        return self.by(force, stand.get(force, 0.0))

    def by(self, force: str, alone: float) -> Together:
        """The causes with a force in their place, and what that explains."""
        falls = [x for own in self.own.values() for x in own]
        return Together(
            tuple(self.own), self.fall, len(falls), force, alone, max(falls), force.startswith(EVERYWHERE), self.logs
        )


@dataclass(frozen=True)
class Without:
    """Least squares on a model without some causes, and what explains the errors in their place.

    Attributes:
        p: least squares on all that is neither the causes nor in their place.
        columns: of the causes.
        held: their coefficients that the errors no longer hold, in unit lengths, shape (columns,).
    """

    p: Projection
    columns: Sequence[int]
    held: Array

    @cached_property
    def _known(self) -> tuple[Array, Array, float]:
        """Information on the causes, their scores with what the hypothesis has taken out of the errors, and the largest eigenvalue."""
        columns = list(self.columns)
        H = self.p.information(columns)
        score = self.p.left_score[columns] + self.p.left(columns, columns) @ self.held
        return H, score, float(np.linalg.eigvalsh(H).max())

    @property
    def fall(self) -> float:
        """Fall of chi-squared by the causes together."""
        return _fall(*self._known)

    def least_part(self, parts: Sequence[Sequence[int]]) -> float:
        """Least fall that one of the causes brings beside the others of them.

        Args:
            parts: columns of each cause.
        """
        H, score, largest = self._known
        others = [[i for i, k in enumerate(self.columns) if k not in part] for part in parts]
        most = max((_fall(H[np.ix_(at, at)], score[at], largest) for at in others if at), default=0.0)
        return self.fall - most

    def by_forces(self, forces: Sequence[int]) -> tuple[Array, Array]:
        """Falls by each force in their place, and by the causes beside it, shape (forces,).

        Args:
            forces: columns of which one at a time replaces the causes.
        """
        p, forces = self.p, list(forces)
        H, score, largest = self._known
        own = np.array([p.left([k], [k])[0, 0] for k in forces]) + p.g.prior[forces]
        real = own > NOTHING_LEFT * np.maximum(np.diag(p.total)[forces], 1e-300)
        between = p.left(forces, list(self.columns))
        alone = p.left_score[forces] + between @ self.held
        inverse = np.where(real, 1.0 / np.where(real, own, 1.0), 0.0)
        # Both together, less the force alone.
        beside = H[None] - inverse[:, None, None] * between[:, :, None] * between[:, None, :]
        scores = score[None] - (inverse * alone)[:, None] * between
        kept = np.array([_fall(x, y, largest) for x, y in zip(beside, scores, strict=True)])
        return inverse * alone**2, kept

    def by_curve(self, curve: Sequence[int]) -> tuple[float, float, int]:
        """Falls by a curve of several columns in their place, and by the causes beside it, and its directions.

        Args:
            curve: its columns.
        """
        p, curve = self.p, list(curve)
        H, score, largest = self._known
        G, between = p.information(curve), p.left(curve, list(self.columns))
        own = p.left_score[curve] + between @ self.held
        values, vectors = np.linalg.eigh(G)
        kept = values > NOTHING_LEFT * max(float(values.max()), 1e-300)
        inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
        beside = _fall(H - between.T @ inverse @ between, score - between.T @ (inverse @ own), largest)
        return float(own @ inverse @ own), beside, int(kept.sum())


def same_forces(here: Iterable[str], there: Iterable[str]) -> dict[str, str]:
    """Forces of a log that another one has as well, by their names on both.

    Args:
        here: names of forces, ``function in channel``.
        there: those of the other log. A force with all its channels has the name of the one in which most of it is, which may differ.
    """
    known = {_unique(f): f for f in there}
    return {f: known[_unique(f)] for f in here if _unique(f) in known}


def _unique(force: str) -> str:
    return force.rsplit(" in ", 1)[0] if force.startswith(EVERYWHERE) else force


def _fall(H: Array, score: Array, largest: float) -> float:
    """Fall of chi-squared by columns with the information ``H``, along what is determined beside the largest eigenvalue of all."""
    values, vectors = np.linalg.eigh(H)
    kept = values > NOTHING_LEFT * max(largest, 1e-300)
    return float((((vectors[:, kept].T @ score) ** 2) / values[kept]).sum())


def held_numbers(fit: Fit) -> dict[str, float]:
    """Numbers of a fit's hypothesis by column, from no effect on."""
    numbers = {k: float(x) for k, x in fit.h.values.items()}
    for given in fit.h.given:
        beyond = tuple(float(x) - q.none for x, q in zip(given.values, given.effect.parameters, strict=True))
        numbers |= dict(zip(given.parts, given.effect.form.held(beyond), strict=True))
    return numbers


def is_of(name: str, id_: str) -> bool:
    """Whether a column is one of an effect's."""
    return name == id_ or name.startswith(f"{id_}.")
