"""All bounds at once: a point or a box of parameters that contradicts them, and the rows that a regression may take."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ivsid.physical import drag, inertia, masses
from ivsid.physical.bound import Box, Inequalities, Subject

# The bounds, one module each: ``sentence`` and ``inequalities``.
BOUNDS = (masses, inertia, drag)


@dataclass(frozen=True)
class Fault:
    """A bound that no point of a box keeps.

    Attributes:
        bound: its kind, as ``physical.drag``.
        parameters: ids that stand in it.
        sentence: what contradicts it.
    """

    bound: str
    parameters: tuple[str, ...]
    sentence: str

    def record(self) -> dict[str, object]:
        """The entry of result.json."""
        return {"bound": self.bound, "parameters": list(self.parameters), "says": self.sentence}


def faults(subject: Subject, box: Box) -> tuple[Fault, ...]:
    """Bounds that no point of a box of parameters keeps: for each bound and equation the row that is farthest from it.

    Args:
        subject: the model, with the velocities at which it was seen.
        box: ends of each parameter, by id.
    """
    return tuple(f for module in BOUNDS for rows in module.inequalities(subject, box) for f in _of(subject, rows, box))


def _of(subject: Subject, rows: Inequalities, box: Box) -> Iterator[Fault]:
    ids = tuple(t.id for t in subject.terms)
    reached = rows.reached(ids, box)
    short = np.where(np.isnan(reached), 0.0, rows.least - reached)
    for channel in range(3):
        bad = np.flatnonzero((rows.channel == channel) & (short > 0))
        if bad.size:
            k = int(bad[np.argmax(short[bad])])
            used = (rows.matrix.lower[k] != 0) | (rows.matrix.upper[k] != 0)
            named = tuple(i for i, u in zip(ids, used, strict=True) if u)
            yield Fault(rows.kind, named, rows.words(k, float(reached[k])))


def regression_bounds(subject: Subject) -> tuple[tuple[Inequalities, ...], tuple[str, ...]]:
    """Inequalities that a regression may take as rows, and the assumptions that they are.

    Positive definiteness is a row for each direction of motion; the diagonal entries of ``masses`` are those that a regression takes.
    """
    modules = (masses, drag)
    rows = tuple(i for m in modules for i in m.inequalities(subject) if i.kind != drag.POWER)
    return rows, tuple(m.sentence(subject) for m in modules)
