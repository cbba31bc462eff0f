"""First values of a model's parameters: least squares on means of the equations of motion over short windows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.plant.propulsion import Propulsion
from ivsid.diagnosis.plant.thruster_forces import thruster_force
from ivsid.diagnosis.plant.usual_hull import hull_limits
from ivsid.effects import CHANNELS, EFFECTS, Place, State, Term, causes, rigid_body, with_terms
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Length of the windows [s]: long enough to average the noise of accelerations, shorter than a manoeuvre.
# Source: measured: make constants
WINDOW: Final = 1.0
# Factors by which windows are longer where the noise of the velocities asks for it, the shortest first.
# Source: geometry: the noise of a mean acceleration falls with the length, and a hull that turns in a second is seen in the shortest
LONGER: Final = (1, 2, 4, 8)
# Largest share of the noise in the variance of an axis's mean accelerations, by which the noise makes its mass too small.
# Source: definition: Gauss-Newton steps start from masses within a tenth
NOISY: Final = 0.05
# Least share of good samples in a window.
# Source: geometry: all of them, up to rounding of a mean
ALL_GOOD: Final = 0.999
# Rounds of weighting the equations by the residuals of the round before.
# Source: measured: make constants
ROUNDS: Final = 3
# Least singular value that counts, in the largest.
# Source: geometry: half the digits of a double
RCOND: Final = 1e-8


def first_values(vehicle: Vehicle, log: Channels, terms: Sequence[Term], claimed: dict[str, float]) -> Hypothesis:
    """A hypothesis whose values are good enough for Gauss-Newton steps.

    Args:
        vehicle: whose terms these are.
        log: on its clock.
        terms: of the model.
        claimed: values of parameters that are not fitted, by id.
    """
    free = [t for t in terms if t.id not in claimed]
    q = max(2, round(WINDOW / log.h))
    smooth = _mean(log.nu, max(2, q // 2))
    rate = np.gradient(smooth, log.h, axis=1)
    thrusts = Propulsion(vehicle, log).thrusts()
    zero = np.zeros(log.n)
    points = Points(smooth, zero, np.zeros((2, log.n)), log.t, thrusts.mean, log.angles, rudders=log.rudders)
    force = thruster_force(vehicle, (), points, (smooth[0], smooth[1], smooth[2]))
    north, east = (None, None) if log.place is None else log.place
    here = None if log.psi is None else Place(log.psi, north, east, log.t)
    state = State(*smooth, *rate, place=here)
    m = vehicle.hull.mass
    x_g, y_g = vehicle.hull.centre_of_gravity
    for channel, column in rigid_body(state, m * x_g, m * y_g).items():
        force[CHANNELS.index(channel)] -= column
    design = np.zeros((len(free), 3, log.n))
    for term in terms:
        for channel, column in term.columns(state).items():
            if term.id in claimed:
                force[CHANNELS.index(channel)] -= claimed[term.id] * column
            else:
                design[free.index(term), CHANNELS.index(channel)] = column
    A, y = [], []
    for k in range(3):
        longer = _length(log, k, rate[k], q)
        good = np.flatnonzero(_mean(log.good.astype(float)[None], longer)[0] > ALL_GOOD)[::longer]
        A.append(_mean(design[:, k], longer)[:, good])
        y.append(_mean(force[k], longer)[good])
    weights = _weights(y)
    found = np.zeros(len(free))
    for _ in range(ROUNDS):
        rows = np.concatenate([a * w for a, w in zip(A, weights, strict=True)], axis=1).T
        scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-30)
        right = np.concatenate([x * w for x, w in zip(y, weights, strict=True)])
        found = np.linalg.lstsq(rows / scale, right, rcond=RCOND)[0] / scale
        if any(_drives(term, value) for term, value in zip(free, found, strict=True)):
            # A drag that drives lets the states run away before the first step.
            least = np.array([-np.inf if _signed(term) else 0.0 for term in free])
            found = lsq_linear(rows / scale, right, (least, np.inf)).x / scale
        weights = _weights([x - found @ a for x, a in zip(y, A, strict=True)])
    values = dict(claimed)
    for term, value in zip(free, found, strict=True):
        values[term.id] = float(value)
    for id_, (low, high) in hull_limits(vehicle, free).items():
        values[id_] = float(np.clip(values[id_], low, high))
    return Hypothesis(tuple(terms), values)


def with_fitted(vehicle: Vehicle, h: Hypothesis) -> Hypothesis:
    """The hypothesis with the causes that the vehicle file's model has, at their fitted numbers.

    Args:
        vehicle: whose ``[model.fitted]`` this is.
        h: of the terms of its model alone; numbers that were fitted beside the causes replace its own.
    """
    given = causes(vehicle)
    if not given:
        return h
    terms = with_terms(vehicle, h.terms, given)
    ids = {t.id for t in terms} - set(vehicle.model.values)
    values = {**h.values, **{k: v for k, v in vehicle.model.numbers.items() if k in ids}}
    return replace(h, terms=terms, values=values, given=(*h.given, *(g for g in given if not g.effect.terms)))


def _signed(term: Term) -> bool:
    """Whether a term's parameter may have either sign."""
    return term.id not in EFFECTS or EFFECTS[term.id].parameters[0].signed


def _drives(term: Term, value: float) -> bool:
    """Whether a parameter has a sign that its physics rules out."""
    return not _signed(term) and value < 0


def _length(log: Channels, k: int, rate: Array, q: int) -> int:
    """Samples in the windows of an axis: the shortest in which the noise is a small share of its mean accelerations.

    Args:
        log: on its clock.
        k: index of the axis.
        rate: its acceleration, of velocities that are means over half of a shortest window, shape (n,).
        q: samples in a shortest window.
    """
    variance = 2.0 * log.noise["uvr"[k]] ** 2 / max(2, q // 2)
    for longer in LONGER:
        seen = float(np.var(_mean(rate, longer * q)[log.good])) if log.good.any() else 0.0
        if variance / (longer * q * log.h) ** 2 <= NOISY * seen:
            break
    return longer * q


def _weights(x: Sequence[Array]) -> Array:
    """Weights of the three equations, shape (3,): one for both forces.

    Without a thrust to the side the sway equation by itself has the solution of no mass at all.
    """
    force = max(float(np.sqrt(np.mean(np.concatenate([x[0], x[1]]) ** 2))), 1e-9)
    return np.array([1 / force, 1 / force, 1 / max(float(np.sqrt(np.mean(x[2] ** 2))), 1e-9)])


def _mean(x: Array, q: int) -> Array:
    """Running mean over q samples, centred, with the ends repeated."""
    from scipy.ndimage import uniform_filter1d  # noqa: PLC0415 - slow to import, and only a diagnosis needs it

    return np.asarray(uniform_filter1d(x, q, axis=-1, mode="nearest"))
