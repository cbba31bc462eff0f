"""Isolability of a programme: the effects that it can show (z), those that it can tell apart (d), and the manoeuvres that would help.

The distance d of two causes is the square root of the fall of chi-squared that is lost if one is taken for the other.

Source: docs/theory.md, "Isolability".
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import Channels, channels
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.visibility import Visibility, visibility
from ivsid.diagnosis.statements.diagnosis import inputs_of
from ivsid.effects import EFFECTS
from ivsid.files.records import envelope
from ivsid.log import GivenLog, log_of
from ivsid.vehicle import GivenVehicle, vehicle_of

Array = NDArray[np.float64]
# Below this distance two causes of typical size are not told apart. Their difference in chi-squared is normal with mean d² and standard
# deviation 2 d, so at d = 5 it exceeds the margin of 9 in 95 % of logs.
# Source: definition: normal distribution, and the margin between rivals
APART: Final = 5.0
# Below this distance two causes are the same column up to noise, and no manoeuvre separates them.
# Source: measured: make constants
NONE: Final = 0.5
# Factor by which a manoeuvre has to raise the smallest distance to be advised.
# Source: measured: make constants
BETTER: Final = 1.05
# Eigenvalues of the information below this share of the largest belong to directions that the base explains.
# Source: measured: make constants
DEPENDENT: Final = 1e-9


@dataclass(frozen=True)
class Choice:
    """Effect of one manoeuvre on one set of causes.

    Attributes:
        trial: name of the manoeuvre.
        d: smallest distance of any two causes of the set, by the log and the manoeuvre together.
        groups: causes that are not told apart then, group by group.
    """

    trial: str
    d: float
    groups: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Advice:
    """Manoeuvres for a set of causes.

    Attributes:
        ids: of the causes.
        d: smallest distance of any two causes by the log alone.
        choices: one for each manoeuvre, the best first.
    """

    ids: tuple[str, ...]
    d: float
    choices: tuple[Choice, ...]

    @property
    def best(self) -> Choice | None:
        """Best manoeuvre; None if none separates the causes or raises their distance."""
        if not self.choices:
            return None
        first = self.choices[0]
        return first if len(first.groups) > 1 or first.d >= max(BETTER * self.d, NONE) else None

    def record(self) -> dict[str, object]:
        """An entry of ``advice`` in result.json."""
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
    """Isolability of the causes by a log.

    Attributes:
        visible: visibility at the typical size, by id.
        ids: of the tested causes, in the order of the matrices, k of them.
        rho: absolute cosine of the projected signatures, of the closest directions for causes with several parameters, shape (k, k).
        distance: distance d if the column's cause is taken for the row's, shape (k, k).
        classes: sets of causes that the log does not tell apart, each with the manoeuvre that separates them, in words.
        refused: reason by id, for causes that cannot be tested at all.
        inputs: names and SHA-256 hashes of the files.
        advice: for each class, and for pairs that are barely told apart.
        shown: by id of a cause that is not tested, the manoeuvre that shows it best, with z.
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
        """The content of result.json."""
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


def isolability(
    vehicle: GivenVehicle,
    log: GivenLog,
    *,
    wanted: Collection[str] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Isolability:
    """Isolability of a log's programme.

    Args:
        vehicle: with the model. A checked vehicle, the path of its file, or a shipped one's name.
        log: of the programme. A checked log, its path, or a table in memory.
        wanted: ids of the causes, whether the log shows them or not; None takes all that it shows.
        progress: told of each step.

    Raises:
        IvsidError: a log that the model cannot be diagnosed with.
    """
    vehicle = vehicle_of(vehicle)
    log = log_of(log, vehicle.log)
    progress("fitting the model")
    data: Channels = channels(log, vehicle)
    fit = plain_fit(vehicle, data, everything)
    return separability(fit, inputs_of(vehicle, log), wanted=wanted)


def separability(
    fit: Fit,
    inputs: tuple[tuple[str, str], ...] = (),
    visible: Mapping[str, Visibility] | None = None,
    wanted: Collection[str] | None = None,
) -> Isolability:
    """Isolability of the causes by a fit.

    Args:
        fit: of the plain model.
        inputs: names and SHA-256 hashes of the files.
        visible: visibility by id, if it is known already.
        wanted: ids of the causes, tested or not; None takes all tested causes.
    """
    if visible is None:
        visible = visibility(fit)
    chosen: dict[str, tuple[tuple[str, ...], float]] = {}
    for candidate in fit.candidates:
        id_ = candidate.id
        if candidate.searched or id_ in chosen:
            continue
        if not visible[id_].tested if wanted is None else id_ not in wanted:
            continue
        chosen[id_] = (candidate.variants[len(candidate.variants) // 2], visible[id_].z)
    ids = tuple(chosen)
    p = fit.projection
    k = len(ids)
    rho = np.eye(k)
    bases = []
    for id_ in ids:
        at = fit.gram.at(chosen[id_][0])
        values, vectors = np.linalg.eigh(p.information(at))
        keep = values > DEPENDENT * max(float(values.max()), 1e-300)
        bases.append((at, vectors[:, keep] / np.sqrt(values[keep])))
    for i in range(k):
        for j in range(i + 1, k):
            (a, x), (b, y) = bases[i], bases[j]
            cross = x.T @ p.left(a, b) @ y
            rho[i, j] = rho[j, i] = min(float(np.linalg.svd(cross, compute_uv=False).max(initial=0.0)), 1.0)
    z = np.array([chosen[i][1] for i in ids])
    distance = z[:, None] * np.sqrt(np.maximum(1 - rho**2, 0.0))
    classes = tuple((members, EFFECTS[members[0]].separate) for members in _classes(ids, distance) if len(members) > 1)
    return Isolability(visible, ids, rho, distance, classes, fit.refused, inputs)


def _classes(ids: tuple[str, ...], distance: Array) -> list[tuple[str, ...]]:
    """Sets of causes that are linked by distances below ``APART``, the largest first."""
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
