"""Causes that imitate one force of no cause.

Two linear causes can add up to a force that neither of them is: a share of the thrust's moment, less a moment that follows the
acceleration, is one that follows the drag. Each then stands in a fit with many standard deviations, and nothing is left unexplained. But one
regressor of the adequacy's dictionary, in the place of all of them and with one number, explains as much. A single cause is none where
such a regressor explains more in its place than the cause does. A regressor stands in the place of causes if hardly anything is left to
any of them beside it: one that explains another part of the errors replaces nothing, and one that replaces a large cause does not replace a small one. Nor
does one beside which a mass is none of a hull: the thrust turned around, with no mass left, is the sum of whatever drags a log lacks. The same is asked of any function of one velocity
(``speed_curves``), which has many numbers. What the rough outline of a hump leaves is a function of the same velocity, and no cause.

Source: docs/theory.md, "Diagnosis"; Akaike, "A new look at the statistical model identification", IEEE Transactions on Automatic Control 19,
1974.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import NOTHING_LEFT, Projection
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.null.gradual import GRADUAL, gradual_forces
from ivsid.diagnosis.null.modulated import FALL
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.plant.usual_hull import hull_limits
from ivsid.diagnosis.selection.dictionary import FELT, WRONG, regressors
from ivsid.diagnosis.selection.force_rules import (
    BETTER_CURVE,
    BETTER_FORCE,
    ONE_FORCE,
    OUTLINE,
    ROUGH_FORCE,
    Curve,
    Remainder,
    Together,
)
from ivsid.diagnosis.selection.hulls import BEYOND
from ivsid.diagnosis.selection.rivals import Found
from ivsid.diagnosis.selection.speed_curves import speed_curves, words

Array = NDArray[np.float64]
# Largest share of what the least of some causes explains beside the others that they explain beside a force which stands in their place.
# Source: definition: three quarters are the force's; of other parts of the errors it has nothing
REPLACED: Final = 0.25
# First words of forces and readings of one cause with all the channels in which it acts.
EVERYWHERE: Final = (GRADUAL, FALL, WRONG, FELT)


def imitating(fit: Fit, found: Sequence[Found]) -> Mapping[str, Refusal]:
    """Refusals, by id, of causes that one force explains as well as they do together, or better than one of them.

    Args:
        fit: of the model with all causes.
        found: the causes.
    """
    causes = [f for f in found if f.first.candidate.sums]
    asked = _Asked.of(fit, causes)
    if asked is None:
        return {}
    rough = {f.id for f in causes if f.first.candidate.effect.form.rough}
    refused: dict[str, Refusal] = {}
    # The largest sets first: a set that one force explains takes its parts with it. A rough curve is no linear cause of such a set.
    for count in range(len(asked.own), 0, -1):
        for ids in combinations(asked.own, count):
            if refused.keys() & set(ids) or (count > 1 and rough & set(ids)):
                continue
            refusal = asked.refusal(ids, [f.id for f in found if f.id not in ids])
            if refusal is not None:
                refused |= {i: refusal for i in ids if i not in refusal.beside}
    return refused | asked.outlined(rough - refused.keys(), [i for i in asked.own if i not in rough | refused.keys()])


@dataclass(frozen=True)
class _Asked:
    """Causes with the forces and the curves of a velocity that may stand in their place.

    Attributes:
        own: columns of each cause among those of the model, by id.
        held: coefficients of the model's columns that the errors no longer hold, in unit lengths, shape (model,).
        wide: cross-products of the model's columns, the forces and the curves, in this order.
        forces: in words.
        curves: names of the columns of all curves.
        groups: columns of each curve, among those of all.
        hull: value, least and most of numbers that hulls limit, in their units, by column of the model.
        boxed: ids of causes whose evidence is that thrust errors would have to leave their bounds, of which their falls know nothing.
        free: the model and the curves beside any thrust curve, in this order with the cells between; None asks of none.
    """

    own: Mapping[str, list[int]]
    held: Array
    wide: Gram
    forces: Sequence[str]
    curves: Sequence[str]
    groups: Sequence[range]
    hull: Mapping[int, tuple[float, float, float]]
    boxed: AbstractSet[str] = frozenset()
    free: Callable[[], Gram] | None = None

    @classmethod
    def of(cls, fit: Fit, causes: Sequence[Found]) -> Self | None:
        """The causes of a fit whose errors are sums of columns; None if there are none."""
        numbers = _numbers(fit)
        names = [fit.gram.names[k] for k in fit.base]
        own = {f.id: [i for i, n in enumerate(names) if n in numbers and _of(n, f.id)] for f in causes}
        own = {id_: at for id_, at in own.items() if at}
        if not own:
            return None
        known, x, unit = regressors(fit)
        g = fit.gram.only(fit.base)
        held = np.array([numbers.get(n, 0.0) for n in names]) * g.unit
        forces = [f"{function} in {channel}" for channel, function in (n.split("|", 1) for n in known)]
        wide = g.joined(forces, x, unit)
        slow, x, unit = gradual_forces(fit)
        if slow:
            forces, wide = [*forces, *slow], wide.joined(slow, x, unit)
        curves, lines, lengths, groups = speed_curves(fit)
        if groups:
            wide = wide.joined(curves, lines, lengths)
        limits = hull_limits(fit.noise.predictor.vehicle, fit.h.terms)
        hull = {names.index(i): (fit.h.values[i], *ends) for i, ends in limits.items() if i in names}
        boxed = {f.id for f in causes if f.first.boxed > f.fall}

        @cache
        def free() -> Gram:
            beside = AnyCurve(fit).g
            return beside.joined(curves, lines.reshape(len(lines), *beside.y.shape), lengths)

        return cls(own, held, wide, forces, curves, groups, hull, boxed, free)

    def _without(self, ids: Iterable[str]) -> tuple[Projection, list[int], Array]:
        """Least squares on the model without some causes, with their columns and what the errors no longer hold of them."""
        at = [k for i in ids for k in self.own[i]]
        return Projection(self.wide, [k for k in range(self.held.size) if k not in at]), at, self.held[at]

    def _curve(self, group: range) -> list[int]:
        """Columns of a curve."""
        return [self.held.size + len(self.forces) + k for k in group]

    def refusal(self, ids: Sequence[str], others: Sequence[str]) -> Refusal | None:
        """The refusal of causes together, or of one, or None.

        Args:
            ids: of the causes.
            others: ids of all other causes.
        """
        p, at, held = self._without(ids)
        first = self.held.size
        fall, alone, kept = in_their_place(p, at, held, range(first, first + len(self.forces)))
        # A force beside which one of the causes explains what it did is another part of the errors.
        most = REPLACED * least_part(p, at, held, [self.own[i] for i in ids])
        alone = np.where((kept <= most) & self._of_hulls(p, at, held), alone, 0.0)
        best = int(np.argmax(alone))
        one = in_their_place(p, at, held, at)[1]
        case = Together(
            tuple(ids),
            fall,
            len(at),
            self.forces[best],
            float(alone[best]),
            float(one.max()),
            self.forces[best].startswith(EVERYWHERE),
        )
        if len(ids) > 1:
            refusal = ONE_FORCE.refuses(case, [*others, *self._own(case, p, at, held)])
        else:
            refusal = BETTER_FORCE.refuses(case, others)
        if refusal is None and len(ids) > 1:
            refusal = self._rough(case, p, at, held, others)
        for group in self.groups:
            # Any function of a velocity explains more beside soft errors than a cause whose evidence is that they have to keep their bounds.
            if refusal is not None or self.boxed >= set(ids):
                break
            shape, left, directions = curve_in_their_place(p, at, held, self._curve(group))
            if left <= most:
                whole, _, _ = in_their_place(*self._without({*ids, *self.spanned(group)}), self._curve(group)[:1])
                curve = Curve(
                    tuple(ids), fall, len(at), words(self.curves, group), shape, directions=directions, whole=whole
                )
                refusal = BETTER_CURVE.refuses(curve, others)
                if refusal is not None and self.free is not None:
                    # A thrust curve inside its accuracy may make what the function adds to the causes.
                    beside = self._beside_thrusts(curve, self.free(), at, held, group)
                    refusal = BETTER_CURVE.refuses(beside, others)
        return refusal

    def _own(self, case: Together, p: Projection, at: Sequence[int], held: Array) -> list[str]:
        """The cause of several whose own force the one in their place may be, as it might be a single cause's.

        Args:
            case: the causes.
            p: least squares on the model without them.
            at: their columns.
            held: their coefficients that the errors no longer hold, in unit lengths.
        """
        single = [i for i in case.ids if len(self.own[i]) == 1]
        if not single:
            return []
        falls = in_their_place(p, at, held, [self.own[i][0] for i in single])[1]
        best = int(np.argmax(falls))
        alone = replace(case, ids=(single[best],), fall=float(falls[best]), numbers=1)
        return [] if BETTER_FORCE.refuses(alone) else [single[best]]

    def _rough(
        self, case: Together, p: Projection, at: Sequence[int], held: Array, others: Sequence[str]
    ) -> Refusal | None:
        """The refusal of several causes by a force that is known in rough outline, or None.

        Args:
            case: the causes.
            p: least squares on the model without them.
            at: their columns.
            held: their coefficients that the errors no longer hold, in unit lengths.
            others: ids of all other causes.
        """
        known = [k for k, name in enumerate(self.forces) if name.startswith(FALL)]
        if not known:
            return None
        alone = in_their_place(p, at, held, [self.held.size + k for k in known])[1]
        best = int(np.argmax(alone))
        return ROUGH_FORCE.refuses(replace(case, force=self.forces[known[best]], alone=float(alone[best])), others)

    def _beside_thrusts(self, curve: Curve, g: Gram, at: Sequence[int], held: Array, group: range) -> Curve:
        """A function of a velocity in the place of causes, beside any thrust curve.

        Args:
            curve: the same beside the thrusts of the fit.
            g: cross-products of the model, any thrust curve and all functions.
            at: columns of the causes.
            held: their coefficients that the errors no longer hold, in unit lengths.
            group: columns of the function, among those of all.
        """
        first = len(g.names) - len(self.curves)
        p = Projection(g, [k for k in range(first) if k not in at])
        shape, _, directions = curve_in_their_place(p, at, held, [first + k for k in group])
        fall, _, _ = in_their_place(p, at, held, [first])
        return replace(curve, fall=fall, alone=shape, directions=directions)

    def _of_hulls(self, p: Projection, at: Sequence[int], held: Array) -> NDArray[np.bool_]:
        """Whether the numbers of the model are ones that a hull may have, with each force in the place of causes, shape (forces,).

        Args:
            p: least squares on the model without the causes.
            at: columns of the causes.
            held: their coefficients that the errors no longer hold, in unit lengths.
        """
        g, first = self.wide, self.held.size
        k = list(range(first, first + len(self.forces)))
        own = np.array([p.left([i], [i])[0, 0] for i in k]) + g.prior[k]
        own = np.where(own > NOTHING_LEFT * np.maximum(np.diag(p.total)[k], 1e-300), own, np.inf)
        size = (p.left_score[k] + p.left(k, at) @ held) / own / g.unit[k]
        usual = np.ones(len(k), dtype=bool)
        for column, (value, least, most) in self.hull.items():
            if column not in p.base:
                continue
            j = p.base.index(column)
            by = p.taken([column], k)[0]
            before = value + float(p.coefficients[j] / g.unit[column] + p.taken([column], at)[0] @ (held / g.unit[at]))
            estimate = before - by * size
            deviation = np.sqrt(p.covariance[j, j] / g.unit[column] ** 2 + by**2 / own / g.unit[k] ** 2)
            usual &= np.maximum(least - estimate, estimate - most) <= BEYOND * deviation
        return usual

    def spanned(self, group: range) -> dict[str, float]:
        """Causes that a function of one velocity replaces, with their falls of chi-squared."""
        found: dict[str, float] = {}
        for id_ in self.own:
            p, at, held = self._without([id_])
            fall, _, _ = in_their_place(p, at, held, self._curve(group)[:1])
            _, left, _ = curve_in_their_place(p, at, held, self._curve(group))
            if left <= REPLACED * fall:
                found[id_] = fall
        return found

    def outlined(self, rough: AbstractSet[str], others: Sequence[str]) -> dict[str, Refusal]:
        """Refusals of causes that are what the shape of a rough one leaves, by id.

        Args:
            rough: ids of causes whose shape is known in rough outline.
            others: ids of the others.
        """
        refused: dict[str, Refusal] = {}
        for group in self.groups if rough else ():
            spanned = {i: fall for i, fall in self.spanned(group).items() if i in rough or i in others}
            for whole in rough & spanned.keys():
                for id_ in spanned.keys() - rough:
                    case = Remainder(spanned[id_], whole, spanned[whole])
                    if (refusal := OUTLINE.refuses(case, [i for i in (*rough, *others) if i != id_])) is not None:
                        refused[id_] = refusal
        return refused


def curve_in_their_place(
    p: Projection, columns: Sequence[int], held: Array, curve: Sequence[int]
) -> tuple[float, float, int]:
    """Fall of chi-squared by a curve of several columns in the place of causes, by the causes beside it, and its directions.

    Args:
        p: least squares on all that is neither.
        columns: of the causes.
        held: their coefficients that the errors no longer hold, in unit lengths, shape (columns,).
        curve: columns of the curve.
    """
    columns, curve = list(columns), list(curve)
    H, G, between = p.information(columns), p.information(curve), p.left(curve, columns)
    mine, own = p.left_score[columns] + H @ held, p.left_score[curve] + between @ held
    values, vectors = np.linalg.eigh(G)
    kept = values > NOTHING_LEFT * max(float(values.max()), 1e-300)
    inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
    beside = _fall(
        H - between.T @ inverse @ between, mine - between.T @ (inverse @ own), float(np.linalg.eigvalsh(H).max())
    )
    return float(own @ inverse @ own), beside, int(kept.sum())


def in_their_place(
    p: Projection, columns: Sequence[int], held: Array, forces: Sequence[int]
) -> tuple[float, Array, Array]:
    """Fall of chi-squared by some columns together, by each force in their place, and by them beside each force, shape (forces,).

    Args:
        p: least squares on all that is neither.
        columns: of the causes.
        held: their coefficients that the errors no longer hold, in unit lengths, shape (columns,).
        forces: columns of which one at a time replaces the causes.
    """
    columns, forces = list(columns), list(forces)
    # What the hypothesis has taken out of the errors goes back into the scores.
    H = p.information(columns)
    score = p.left_score[columns] + p.left(columns, columns) @ held
    largest = float(np.linalg.eigvalsh(H).max())
    fall = _fall(H, score, largest)
    own = np.array([p.left([k], [k])[0, 0] for k in forces]) + p.g.prior[forces]
    real = own > NOTHING_LEFT * np.maximum(np.diag(p.total)[forces], 1e-300)
    between = p.left(forces, columns)
    alone = p.left_score[forces] + between @ held
    inverse = np.where(real, 1.0 / np.where(real, own, 1.0), 0.0)
    # Both together, less the force alone.
    beside = H[None] - inverse[:, None, None] * between[:, :, None] * between[:, None, :]
    scores = score[None] - (inverse * alone)[:, None] * between
    kept = np.array([_fall(x, y, largest) for x, y in zip(beside, scores, strict=True)])
    return fall, inverse * alone**2, kept


def least_part(p: Projection, columns: Sequence[int], held: Array, parts: Sequence[Sequence[int]]) -> float:
    """Least fall of chi-squared that one of several causes brings beside the others of them.

    Args:
        p: least squares on all that is none of them.
        columns: of the causes.
        held: their coefficients that the errors no longer hold, in unit lengths, shape (columns,).
        parts: columns of each cause.
    """
    columns = list(columns)
    H = p.information(columns)
    score = p.left_score[columns] + p.left(columns, columns) @ held
    largest = float(np.linalg.eigvalsh(H).max())
    others = [[i for i, k in enumerate(columns) if k not in part] for part in parts]
    most = max((_fall(H[np.ix_(at, at)], score[at], largest) for at in others if at), default=0.0)
    return _fall(H, score, largest) - most


def _fall(H: Array, score: Array, largest: float) -> float:
    """Fall of chi-squared by columns with the information ``H``, along what is determined beside the largest eigenvalue of all."""
    values, vectors = np.linalg.eigh(H)
    kept = values > NOTHING_LEFT * max(largest, 1e-300)
    return float((((vectors[:, kept].T @ score) ** 2) / values[kept]).sum())


def _numbers(fit: Fit) -> dict[str, float]:
    """Numbers of the hypothesis by column, from no effect on."""
    numbers = {k: float(x) for k, x in fit.h.values.items()}
    for given in fit.h.given:
        beyond = tuple(float(x) - q.none for x, q in zip(given.values, given.effect.parameters, strict=True))
        numbers |= dict(zip(given.parts, given.effect.form.held(beyond), strict=True))
    return numbers


def _of(name: str, id_: str) -> bool:
    """Whether a column is one of an effect's."""
    return name == id_ or name.startswith(f"{id_}.")
