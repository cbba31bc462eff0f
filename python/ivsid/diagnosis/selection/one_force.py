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

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import NOTHING_LEFT, Projection
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.null.gradual import gradual_forces
from ivsid.diagnosis.null.modulated import FALL
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.plant.usual_hull import hull_limits
from ivsid.diagnosis.selection.dictionary import Regressors, in_words, regressors
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
from ivsid.diagnosis.selection.in_their_place import REPLACED, InPlace, Without, held_numbers, is_of
from ivsid.diagnosis.selection.rivals import Found
from ivsid.diagnosis.selection.speed_curves import speed_curves, words

Array = NDArray[np.float64]


def imitating(asked: Forces | None, found: Sequence[Found]) -> Mapping[str, Refusal]:
    """Refusals, by id, of causes that one force explains as well as they do together, or better than one of them.

    Args:
        asked: the causes whose errors are sums, with the forces of the log; None if there are none.
        found: all causes.
    """
    if asked is None:
        return {}
    rough = _rough(asked, found)
    refused = _each_set(asked, found, asked.refusal)
    return refused | asked.outlined(rough - refused.keys(), [i for i in asked.own if i not in rough | refused.keys()])


def imitating_on_both(
    asked: Forces | None, found: Sequence[Found], there: Mapping[tuple[str, ...], InPlace]
) -> Mapping[str, Refusal]:
    """The same on two logs together; any function of a velocity, which has many numbers, is asked of one log alone.

    Args:
        asked: the causes whose errors are sums, with the forces of the log; None if there are none.
        found: all causes.
        there: what sets of causes and the forces in their place explain on the other log.
    """

    def refusal(ids: tuple[str, ...], beside: Sequence[str]) -> Refusal | None:
        return by_one_force(asked.in_place(ids).beside(there[ids]), beside) if asked and ids in there else None

    return {} if asked is None or not there else _each_set(asked, found, refusal)


def sets_of(causes: Collection[str]) -> Iterator[tuple[str, ...]]:
    """Sets of causes, the largest first: one that a force explains takes its parts with it."""
    for count in range(len(causes), 0, -1):
        yield from combinations(causes, count)


def _rough(asked: Forces, found: Sequence[Found]) -> set[str]:
    """Ids of causes whose curve is known in rough outline."""
    return {f.id for f in found if f.id in asked.own and f.first.candidate.effect.form.rough}


def _each_set(
    asked: Forces, found: Sequence[Found], refusal: Callable[[tuple[str, ...], Sequence[str]], Refusal | None]
) -> dict[str, Refusal]:
    """Refusals, by id, of sets of causes and of single ones.

    Args:
        asked: the causes.
        found: these and others.
        refusal: of a set, beside the others.
    """
    rough = _rough(asked, found)
    refused: dict[str, Refusal] = {}
    for ids in sets_of(asked.own):
        # A rough curve is no linear cause of such a set.
        if refused.keys() & set(ids) or (len(ids) > 1 and rough & set(ids)):
            continue
        said = refusal(ids, [f.id for f in found if f.id not in ids])
        if said is not None:
            refused |= {i: said for i in ids if i not in said.beside}
    return refused


@dataclass(frozen=True)
class Forces:
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
    def of(
        cls, fit: Fit, found: Sequence[Found], *, curves_too: bool = True, known: Regressors | None = None
    ) -> Self | None:
        """The causes of a fit whose errors are sums of columns; None if there are none.

        Args:
            fit: of the model with all causes.
            found: all causes.
            curves_too: whether any function of a velocity is among the forces.
            known: the dictionary's regressors of the fit, where they were made before.
        """
        causes = [f for f in found if f.first.candidate.sums]
        numbers = held_numbers(fit)
        names = [fit.gram.names[k] for k in fit.base]
        own = {f.id: [i for i, n in enumerate(names) if n in numbers and is_of(n, f.id)] for f in causes}
        own = {id_: at for id_, at in own.items() if at}
        if not own:
            return None
        regular, x, unit = known or regressors(fit)
        g = fit.bare
        held = np.array([numbers.get(n, 0.0) for n in names]) * g.unit
        forces = [in_words(n) for n in regular]
        wide = g.joined(forces, x, unit)
        slow, x, unit = gradual_forces(fit)
        if slow:
            forces, wide = [*forces, *slow], wide.joined(slow, x, unit)
        nothing: tuple[list[str], Array, Array, list[range]] = ([], np.zeros((0, 0)), np.zeros(0), [])
        curves, lines, lengths, groups = speed_curves(fit) if curves_too else nothing
        if groups:
            wide = wide.joined(curves, lines, lengths)
        limits = hull_limits(fit.noise.predictor.vehicle, fit.h.terms)
        hull = {names.index(i): (fit.h.values[i], *ends) for i, ends in limits.items() if i in names}
        boxed = {f.id for f in causes if f.first.boxed > f.fall}

        @cache
        def free() -> Gram:
            beside = AnyCurve(fit).g
            return beside.joined(curves, lines, lengths)

        return cls(own, held, wide, forces, curves, groups, hull, boxed, free)

    def _without(self, ids: Iterable[str]) -> Without:
        """The model without some causes."""
        at = [k for i in ids for k in self.own[i]]
        return Without(Projection(self.wide, [k for k in range(self.held.size) if k not in at]), at, self.held[at])

    def _curve(self, group: range) -> list[int]:
        """Columns of a curve."""
        return [self.held.size + len(self.forces) + k for k in group]

    def in_place(self, ids: Sequence[str]) -> InPlace:
        """What causes explain, and each force in their place.

        Args:
            ids: of the causes.
        """
        left, first = self._without(ids), self.held.size
        alone, kept = left.by_forces(range(first, first + len(self.forces)))
        own = dict(zip(left.columns, left.by_forces(left.columns)[0].tolist(), strict=True))
        usual = self._of_hulls(left)
        return InPlace(
            left.fall,
            left.least_part([self.own[i] for i in ids]),
            {i: tuple(own[k] for k in self.own[i]) for i in ids},
            dict(zip(self.forces, alone.tolist(), strict=True)),
            dict(zip(self.forces, kept.tolist(), strict=True)),
            frozenset(f for f, ok in zip(self.forces, usual, strict=True) if not ok),
        )

    def refusal(self, ids: Sequence[str], others: Sequence[str]) -> Refusal | None:
        """The refusal of causes together, or of one, or None.

        Args:
            ids: of the causes.
            others: ids of all other causes.
        """
        case = self.in_place(ids)
        refusal = by_one_force(case, others)
        without = self._without(ids)
        for group in self.groups:
            # Any function of a velocity explains more beside soft errors than a cause whose evidence is that they have to keep their bounds.
            if refusal is not None or self.boxed >= set(ids):
                break
            shape, left, directions = without.by_curve(self._curve(group))
            if left <= REPLACED * case.least:
                whole = self._without({*ids, *self.spanned(group)}).fall
                numbers, said = len(without.columns), words(self.curves, group)
                curve = Curve(tuple(ids), case.fall, numbers, said, shape, directions=directions, whole=whole)
                refusal = BETTER_CURVE.refuses(curve, others)
                if refusal is not None and self.free is not None:
                    # A thrust curve inside its accuracy may make what the function adds to the causes.
                    refusal = BETTER_CURVE.refuses(self._beside_thrusts(curve, self.free(), without, group), others)
        return refusal

    def _beside_thrusts(self, curve: Curve, g: Gram, without: Without, group: range) -> Curve:
        """A function of a velocity in the place of causes, beside any thrust curve.

        Args:
            curve: the same beside the thrusts of the fit.
            g: cross-products of the model, any thrust curve and all functions.
            without: the model without the causes.
            group: columns of the function, among those of all.
        """
        first = len(g.names) - len(self.curves)
        free = replace(without, p=Projection(g, [k for k in range(first) if k not in without.columns]))
        shape, _, directions = free.by_curve([first + k for k in group])
        return replace(curve, fall=free.fall, alone=shape, directions=directions)

    def _of_hulls(self, without: Without) -> NDArray[np.bool_]:
        """Whether the numbers of the model are ones that a hull may have, with each force in the place of causes, shape (forces,).

        Args:
            without: the model without the causes.
        """
        p, at, held = without.p, list(without.columns), without.held
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
            without = self._without([id_])
            if without.by_curve(self._curve(group))[1] <= REPLACED * without.fall:
                found[id_] = without.fall
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


def by_one_force(case: InPlace, others: Sequence[str]) -> Refusal | None:
    """The refusal of causes together, or of one, by a force in their place, or None.

    Args:
        case: what they explain.
        others: ids of all other causes.
    """
    best = case.best
    if len(case.own) == 1:
        return BETTER_FORCE.refuses(best, others)
    refusal = ONE_FORCE.refuses(best, [*others, *_own(case, best)])
    known = {f: x for f, x in case.alone.items() if f.startswith(FALL)}
    if refusal is None and known:
        outline = max(known, key=known.__getitem__)
        refusal = ROUGH_FORCE.refuses(case.by(outline, known[outline]), others)
    return refusal


def _own(case: InPlace, best: Together) -> list[str]:
    """The cause of several whose own force the one in their place may be, as it might be a single cause's.

    Args:
        case: what they explain.
        best: the force.
    """
    single = {i: own[0] for i, own in case.own.items() if len(own) == 1}
    if not single:
        return []
    one = max(single, key=single.__getitem__)
    alone = replace(best, ids=(one,), fall=single[one], numbers=1)
    return [] if BETTER_FORCE.refuses(alone) else [one]
