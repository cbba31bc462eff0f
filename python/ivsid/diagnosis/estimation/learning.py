"""The noise of a log, learnt from what no cause explains, and the first fit of a model on the way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.angles import RUNS, run
from ivsid.diagnosis.estimation.first_values import first_values, with_fitted
from ivsid.diagnosis.estimation.fit import Fit, Search, survey
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.left_out import YAW, axes_left_out, rows_too_long
from ivsid.diagnosis.estimation.noise import (
    Noise,
    ambient_of,
    declared_ambient,
    quick_enough,
    settled_after,
    usable_rows,
)
from ivsid.diagnosis.estimation.parting import parted
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.estimation.roughness import roughness
from ivsid.diagnosis.estimation.scatter import scattered
from ivsid.diagnosis.estimation.whitening import plain_scale, whiten
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.plant.points import place_of
from ivsid.diagnosis.plant.usual_hull import typical_sizes, usual_numbers
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor, replaced
from ivsid.effects import State, terms_of
from ivsid.effects.inertia import INERTIA_YAW
from ivsid.errors import IvsidError
from ivsid.vehicle import Vehicle, with_known_forces

Array = NDArray[np.float64]
# Least time that counts, between gaps and the settling of the filters [s].
# Source: measured: make constants
LEAST: Final = 40.0
# Share by which hulls of one mass and length differ: a number that a log determines less well is stated as that of a usual hull.
# Source: physics: the water that moves along sideways is 0.2 to 1 of the mass of slender and of full hulls
HULLS_DIFFER: Final = 0.3


def learn(
    predictor: Predictor,
    states: FilteredStates,
    search: Search,
    fixed: Mapping[str, float],
    left_out: frozenset[int],
    rounds: int = 2,
) -> tuple[Noise, FilteredStates]:
    """The noise of a log from the errors that the whole catalogue leaves, and the hypothesis fitted on the way.

    An effect that is taken for noise would hide itself. So every cause of the catalogue is taken out of the errors first, whether it is
    there or not.

    Args:
        predictor: of the log, with first filters.
        states: of the hypothesis to start from.
        search: adds the columns of searched causes, in the last round.
        fixed: values of parameters that are not fitted, by id.
        left_out: indices of the axes that are left out.
        rounds: of fitting and learning; the last one learns the whitening alone.

    Returns:
        The noise, and the states of the fitted hypothesis.

    Raises:
        IvsidError: the log has too few samples that count.
    """
    for turn in range(rounds):
        good = usable_rows(predictor)
        if good.sum() * predictor.log.h < LEAST:
            raise IvsidError(
                f"{predictor.log.name}: after {settled_after(predictor):.0f} s in which its thrusters run up, and between its gaps and lost rows, "
                f"{good.sum() * predictor.log.h:.0f} s can be used, and a diagnosis needs {LEAST:.0f} s; give a longer log, or one with fewer missing samples"
            )
        noise = Noise(predictor, plain_scale(predictor.errors(states), good, predictor, left_out), good, left_out)
        slow = replace(noise, whitening=noise.whitening.slowed(predictor, left_out))
        states = improve(Problem.at(slow, fixed, states), states)
        noise = replace(noise, whitening=plain_scale(predictor.errors(states), good, predictor, left_out))
        every = survey(noise, states, fixed)
        last = turn == rounds - 1
        # The ambient force alone is learnt before the last round, from slopes over seconds: the whitening takes out what a search would find.
        left = remaining(search(every) if last else every)
        if last:
            rough, bare = roughness(predictor, left, good, left_out, states)
            rougher, alone = tuple(rough.tolist()), tuple(tuple(x) for x in bare.tolist())
            white = whiten(predictor, left, good, left_out)
            apart = scattered(predictor, left, good, left_out)
            return replace(
                noise, whitening=white, rougher=rougher, alone=alone, scatter=apart, parted=parted(predictor, states)
            ), states
        predictor = predictor.adopt(ambient_of(predictor, left, good, states.h.values))
        predictor = quick_enough(predictor, predictor.slopes(states))
        states = predictor.settle(states)
    raise AssertionError("rounds must be positive")


def remaining(fit: Fit) -> Array:
    """The errors in their own units without all that any column explains, shape (rows, n)."""
    g = fit.gram
    theta, _ = Projection(g, []).solve(range(len(g.names)))
    left = g.left(range(len(g.names)), theta)
    out = np.zeros((len(left), fit.noise.good.size))
    out[:, : left.shape[1]] = left
    for group, taps in zip(fit.noise.whitening.groups, fit.noise.whitening.taps, strict=True):
        scale = np.diag(taps[0])[:, None]
        out[list(group)] /= np.where(scale > 0, scale, 1.0)
    return out


def plain_fit(vehicle: Vehicle, log: Channels, search: Search, *, yaw: Mapping[str, float] | None = None) -> Fit:
    """The vehicle file's model, fitted to a log.

    Args:
        vehicle: whose model it is.
        log: on its clock.
        search: adds the columns of searched causes.
        yaw: numbers of the moment's terms, by id, of a model that damps its turns within rows: yaw is left out then, and they are kept.

    Raises:
        IvsidError: the log has too little between its gaps, or no numbers of the model follow it at all.
    """
    vehicle = with_known_forces(vehicle)
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            fit = _plain(vehicle, log, search, yaw)
            if not run(fit, search):
                return fit
            return _plain(vehicle, replace(log, running=True, notes=(*log.notes, RUNS)), search, yaw)
    except (np.linalg.LinAlgError, ValueError, FloatingPointError) as error:
        if isinstance(error, IvsidError):
            raise
        raise IvsidError(
            f"{log.name}: no numbers of the model follow this log; check the units, signs and clock of its columns, and whether its "
            "velocities are good enough to show the motion"
        ) from None


def within_rows(fit: Fit) -> bool:
    """Whether a fitted model with causes damps its turns so quickly for the log's rows that yaw has to be left out, and is not (``rows_too_long``)."""
    predictor = fit.noise.predictor
    return not fit.noise.left_out and rows_too_long(predictor, predictor.slopes(fit.states))


def of_yaw(states: FilteredStates) -> dict[str, float]:
    """Numbers of the terms of a fitted model that have a moment and no force, by id."""
    h, p = states.h, states.points
    state = State(*p.nu, *states.nudot, place=place_of(p))
    return {t.id: h.values[t.id] for t in h.terms if t.id in h.values and set(t.columns(state)) == {"yaw"}}


def _plain(vehicle: Vehicle, log: Channels, search: Search, yaw: Mapping[str, float] | None) -> Fit:
    claimed = dict(vehicle.model.values)
    h = with_fitted(vehicle, first_values(vehicle, log, terms_of(vehicle), claimed))
    predictor = Predictor(vehicle, log, declared_ambient(vehicle))
    left_out = axes_left_out(predictor) if yaw is None else YAW
    if left_out:
        predictor = Predictor(vehicle, log, predictor.ambient, driving=predictor.driving, turning=False)
        # Yaw is left out, so that nothing determines the inertia.
        known = {INERTIA_YAW.id: usual_numbers(vehicle)[INERTIA_YAW.id], **(yaw or {})}
        fixed = {i: x for i, x in known.items() if i in h.values and i not in claimed}
        h, claimed = replaced(h, fixed), {**claimed, **fixed}
    else:
        predictor = predictor.adopt(_expected(predictor.ambient, declared_ambient(vehicle, h.values)))
    slopes = predictor.slopes(predictor.start(h))
    quicker = quick_enough(predictor, slopes)
    damped, predictor = quicker is not predictor, quicker
    noise, states = learn(predictor, predictor.settle(predictor.start(h), 2), search, claimed, left_out)
    states = improve(Problem.at(noise, claimed, states), states)
    # A filter that forgets as quickly as the hull damps follows the noise of a heading alone.
    noisy = log.turned and damped and axes_left_out(noise.predictor)
    if not left_out and noisy:
        return _plain(vehicle, log, search, {})
    if not left_out and rows_too_long(noise.predictor, noise.predictor.slopes(states)):
        return _plain(vehicle, log, search, of_yaw(states))
    return survey(noise, states, claimed)


def _expected(dry: Ambient, wet: Ambient) -> Ambient:
    """The declared ambient acceleration of the dry hull, or of the hull with the water that moves along, whichever is less by axis.

    A first regression may give a mass or an inertia that is too small, and none is below the hull's.
    """
    x, y, n = (min(a, b) for a, b in zip(dry.deviation, wet.deviation, strict=True))
    return Ambient((x, y, n), dry.time)


def determined(fit: Fit) -> Hypothesis:
    """The hypothesis of a fit, with numbers of a usual hull where the log determines none."""
    return replaced(fit.h, undetermined(fit))


def undetermined(fit: Fit) -> dict[str, float]:
    """Numbers of a usual hull for those parameters of the model that a log determines less well than hulls differ, by id.

    The fit needs them free: they take up what errors of the states make of small drifts, where the vehicle does not turn. Where it turns, a number
    is open which the log would not determine beside the true values of all others: nothing else of the model changes with it.
    """
    p, g = fit.projection, fit.gram
    vehicle, at = fit.noise.predictor.vehicle, list(p.base)
    if fit.noise.left_out:
        deviation = dict(zip((g.names[k] for k in at), np.sqrt(np.diag(p.covariance)) / g.unit[at], strict=True))
        found = usual_numbers(vehicle).items()
        return {i: x for i, x in found if i in fit.free and deviation[i] > HULLS_DIFFER * abs(x)}
    known = {g.names[k]: float(np.sqrt(g.total[k, k]) * g.unit[k]) for k in at}
    sizes = {i: q for i, q in typical_sizes(vehicle).items() if i in fit.free}
    return {i: x for i, (x, size) in sizes.items() if max(size, abs(fit.h.values[i])) * known[i] < 1.0 / HULLS_DIFFER}
