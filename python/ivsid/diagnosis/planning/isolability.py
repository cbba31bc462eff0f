"""Before any diagnosis: what a programme can show (z), what it can tell apart (d), and which manoeuvre would help."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import Channels, channels
from ivsid.diagnosis.estimation.candidate_columns import Family
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.visibility import VISIBLE, Visibility, visibility
from ivsid.effects import EFFECTS
from ivsid.files.records import envelope
from ivsid.log import Log
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Below this distance two causes of typical size are not told apart.
APART: Final = 5.0
# Distances below this are none: algebra, which no manoeuvre breaks.
NONE: Final = 0.5


@dataclass(frozen=True)
class Choice:
    """What one manoeuvre would do for one set of causes.

    Attributes:
        trial: its name.
        d: the smallest distance of any two of the set, with the log and the manoeuvre together.
        groups: the sets that are still together then.
    """

    trial: str
    d: float
    groups: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Advice:
    """For a set of causes, the manoeuvres of the library, the best first.

    Attributes:
        ids: the set.
        d: its smallest distance in the log alone.
        choices: one a manoeuvre.
    """

    ids: tuple[str, ...]
    d: float
    choices: tuple[Choice, ...]

    @property
    def best(self) -> Choice | None:
        """The manoeuvre that does most; None where none does anything."""
        if not self.choices:
            return None
        first = self.choices[0]
        return first if len(first.groups) > 1 or first.d >= max(1.05 * self.d, NONE) else None

    def record(self) -> dict[str, Any]:
        """As in result.json."""
        best = self.best
        return {
            "effects": list(self.ids),
            "d": self.d,
            "best": None
            if best is None
            else {"manoeuvre": best.trial, "d": best.d, "left_together": [list(g) for g in best.groups if len(g) > 1]},
            "manoeuvres": {c.trial: c.d for c in self.choices},
        }


@dataclass(frozen=True)
class Isolability:
    """What a log can show.

    Attributes:
        visible: z at the typical size, by id.
        ids: those that are tested, in the order of the matrices.
        rho: |cosine| of projected signatures (of the closest directions, where there are several numbers), shape (k, k).
        distance: expected loss of fit when the column's cause is taken for the row's, as d, shape (k, k).
        classes: causes of typical size that the log does not tell apart, with the manoeuvre that would.
        refused: ids that cannot be tested at all, and why.
        inputs: names and hashes.
        advice: for each class, and for pairs that are barely told apart, what a manoeuvre more would do.
        shown: for causes that are not tested, the manoeuvre that would show them best, with z.
    """

    visible: Mapping[str, Visibility]
    ids: tuple[str, ...]
    rho: Array
    distance: Array
    classes: tuple[tuple[tuple[str, ...], str], ...]
    refused: Mapping[str, str]
    inputs: tuple[tuple[str, str], ...]
    advice: tuple[Advice, ...] = ()
    shown: Mapping[str, tuple[str, float]] = field(default_factory=dict)

    def record(self) -> dict[str, Any]:
        """As in result.json."""
        nearest = {}
        for i, id_ in enumerate(self.ids):
            others = [(float(self.rho[i, j]), other) for j, other in enumerate(self.ids) if j != i]
            if others:
                rho, other = max(others)
                nearest[id_] = {"effect": other, "rho": rho, "d": float(self.distance[i, self.ids.index(other)])}
        return {
            **envelope("isolability", self.inputs),
            "z": {k: v.z for k, v in self.visible.items()},
            "typical": {k: dict(v.typical) for k, v in self.visible.items()},
            "detectable": {k: dict(v.detectable) for k, v in self.visible.items() if v.tested},
            "nearest": nearest,
            "classes": [{"effects": list(ids), "separate_by": words} for ids, words in self.classes],
            "advice": [a.record() for a in self.advice],
            "shown_by": {k: {"manoeuvre": name, "z": z} for k, (name, z) in self.shown.items()},
            "not_tested": [{"effect": k, "reason": why} for k, why in self.refused.items()]
            + [
                {
                    "effect": k,
                    "reason": f"z = {v.z:.1f} at its typical size"
                    if not v.blind
                    else "made of the sensors' own errors",
                }
                for k, v in self.visible.items()
                if not v.tested
            ],
        }


def isolability(vehicle: Vehicle, log: Log, *, progress: Callable[[str], None] = lambda _: None) -> Isolability:
    """What this log's programme can detect and tell apart.

    Raises:
        IvsidError: a log that the model cannot be held against.
    """
    progress("fitting the model")
    data: Channels = channels(log, vehicle)
    fit = plain_fit(vehicle, data, everything)
    inputs = ((vehicle.source.rsplit("/", 1)[-1] or vehicle.name, vehicle.sha256), (log.name, log.sha256))
    return separability(fit, inputs)


def separability(
    fit: Fit,
    inputs: tuple[tuple[str, str], ...] = (),
    visible: Mapping[str, Visibility] | None = None,
    wanted: Collection[str] | None = None,
) -> Isolability:
    """The same from a fit; of the ``wanted`` causes alone, tested or not, where they are given."""
    if visible is None:
        visible = visibility(fit)
    chosen: dict[str, tuple[Family, tuple[str, ...], float]] = {}
    for family in fit.families:
        if not family.variants or family.id in chosen:
            continue
        if not visible[family.id].tested if wanted is None else family.id not in wanted:
            continue
        chosen[family.id] = (family, family.variants[len(family.variants) // 2], visible[family.id].z)
    ids = tuple(chosen)
    p = fit.projection
    k = len(ids)
    rho = np.eye(k)
    bases = []
    for id_ in ids:
        at = fit.gram.at(chosen[id_][1])
        values, vectors = np.linalg.eigh(p.information(at))
        keep = values > 1e-9 * max(float(values.max()), 1e-300)
        bases.append((at, vectors[:, keep] / np.sqrt(values[keep])))
    for i in range(k):
        for j in range(i + 1, k):
            (a, x), (b, y) = bases[i], bases[j]
            cross = x.T @ p.left(a, b) @ y
            rho[i, j] = rho[j, i] = min(float(np.linalg.svd(cross, compute_uv=False).max(initial=0.0)), 1.0)
    z = np.array([chosen[i][2] for i in ids])
    distance = z[:, None] * np.sqrt(np.maximum(1 - rho**2, 0.0))
    classes = tuple((members, EFFECTS[members[0]].separate) for members in _classes(ids, distance) if len(members) > 1)
    return Isolability(visible, ids, rho, distance, classes, fit.refused, inputs)


def _classes(ids: tuple[str, ...], distance: Array) -> list[tuple[str, ...]]:
    """Sets of causes that are linked by a distance below the limit."""
    left = set(range(len(ids)))
    found = []
    while left:
        group = {left.pop()}
        grown = True
        while grown:
            near = {j for j in left if any(min(distance[i, j], distance[j, i]) < APART for i in group)}
            grown = bool(near)
            group |= near
            left -= near
        found.append(tuple(ids[i] for i in sorted(group)))
    return sorted(found, key=lambda g: -len(g))


__all__ = ["VISIBLE", "Isolability", "isolability", "separability"]
