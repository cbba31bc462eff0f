"""Causes asked of the other log: whether one force stands in their place on both, and whether a thruster's number is the same.

The model with every cause is fitted to the other log under the noise of the first. Two runs of one vehicle have independent noise, so that
falls of chi-squared add; and what belongs to its thrusters is the same in both.

Source: docs/theory.md, "Both logs"; Chow, "Tests of equality between sets of coefficients in two linear regressions", Econometrica 28, 1960.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.fit import Fit, survey
from ivsid.diagnosis.estimation.other_log import carried_to
from ivsid.diagnosis.estimation.two_logs import Changes, changes, one_log
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.null.slow_force import slow_force
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.force_rules import ALIKE, SAME_NUMBER, SIGMAS, Changed
from ivsid.diagnosis.selection.in_their_place import InPlace, held_numbers, is_of
from ivsid.diagnosis.selection.one_force import Forces, sets_of
from ivsid.diagnosis.selection.rivals import Found

Array = NDArray[np.float64]


@dataclass(frozen=True)
class OtherLog:
    """What the other log says of causes.

    Attributes:
        in_place: what sets of causes whose errors are sums explain there, and the forces in their place.
        changed: refusals of causes whose number is another one there, by id.
    """

    in_place: Mapping[tuple[str, ...], InPlace]
    changed: Mapping[str, Refusal]


def on_other_log(last: Fit, found: Sequence[Found], other: Channels | None) -> OtherLog:
    """What another run of the same vehicle says of causes; nothing where its numbers cannot be fitted.

    Args:
        last: fit of the model with all causes.
        found: the causes.
        other: the other log; None where there is no other run.
    """
    nothing = OtherLog({}, {})
    if other is None or not any(f.first.candidate.sums or _of_thrusters(f) for f in found):
        return nothing
    try:
        if (carried := carried_to(last, other)) is None:
            return nothing
        there = survey(*carried, last.fixed, frozenset())
        forces = Forces.of(there, found, curves_too=False)
        in_place = {} if forces is None else {ids: forces.in_place(ids) for ids in sets_of(forces.own)}
        return OtherLog(in_place, changed(last, there, found))
    except np.linalg.LinAlgError:
        return nothing


def changed(here: Fit, there: Fit, found: Sequence[Found]) -> Mapping[str, Refusal]:
    """Refusals, by id, of causes of thrusters whose number is another one on the other log.

    Args:
        here: fit of the model with all causes.
        there: the same model fitted to the other log.
        found: the causes.
    """
    before, after = held_numbers(here), held_numbers(there)
    asked, known = [f.id for f in found if _of_thrusters(f)], {there.gram.names[k] for k in there.base}
    names = [n for k in here.base if (n := here.gram.names[k]) in known and before.get(n, 0.0) != 0]
    # A cause of one thruster has a longer id than that of all.
    own = {n: max(ids, key=len) for n in names if (ids := [i for i in asked if is_of(n, i)])}
    values = {n: before[n] for n in own}
    if not own:
        return {}
    ratio = np.array([after[n] / x - 1.0 for n, x in values.items()])
    both = changes(one_log(here.gram, here.base, values), one_log(there.gram, there.base, values), ratio)
    if (np.abs(both.mean) <= ALIKE + SIGMAS * np.sqrt(np.diag(both.covariance))).all():
        return {}
    # Curves may bend or jump between the knots of a fit; and what the model lacks there may move its numbers.
    if not adequacy(there).white:
        return {}
    beside = beside_curves(here, there, values, values, ratio)
    sigma = np.sqrt(np.diag(beside.noise))
    worst = [beside.worst(e) for e in np.eye(len(own))]
    z = (np.abs(beside.mean) - worst - ALIKE) / sigma
    # Of a cause with several numbers the one that changes farthest counts.
    refused: dict[str, Refusal] = {}
    for id_, m, x in sorted(zip(own.values(), beside.mean, z, strict=True), key=lambda one: float(one[2])):
        said = SAME_NUMBER.refuses(Changed(id_, 1.0 + float(m), float(x)), [f.id for f in found if f.id != id_])
        if said is not None:
            refused[id_] = said
    return refused


def _of_thrusters(one: Found) -> bool:
    """Whether a cause is a thruster's, in whatever run: a failure has its time, and water, loads and sensors are others on another day."""
    acts = one.first.candidate.effect.acts
    return acts.at_thruster and not acts.in_time


def beside_curves(
    here: Fit, there: Fit, before: Mapping[str, float], after: Mapping[str, float], ratio: Array
) -> Changes:
    """Changes of numbers beside any thrust curve, the same on both logs, and slow forces, of which each log has its own.

    Args:
        here: fit of a log.
        there: of the other.
        before: by which the numbers of the first are scaled, by column.
        after: by which those of the other are.
        ratio: how the numbers changed, shape (numbers,).
    """
    demands = [fit.noise.predictor.propulsion.demands for fit in (here, there)]
    over = [np.r_[p, q] for p, q in zip(*demands, strict=True)]
    logs = []
    for fit, values in ((here, before), (there, after)):
        curve, slow = AnyCurve(fit, over), slow_force(fit)
        g = curve.g if slow is None else slow.beside(curve.g)
        logs.append(one_log(g, curve.projection.base, values, curve.box))
    return changes(logs[0], logs[1], ratio)
