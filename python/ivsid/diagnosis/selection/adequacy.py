"""Adequacy of a model: the structure that a generic dictionary of regressors finds in its innovations.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import AnyCurve, beyond
from ivsid.diagnosis.null.beyond_curves import rougher_beyond
from ivsid.diagnosis.null.blows import blow
from ivsid.diagnosis.null.boxed import outside
from ivsid.diagnosis.null.frequencies import Scatter, Spectrum, excess, spectrum
from ivsid.diagnosis.null.inside_cells import settled
from ivsid.diagnosis.null.leaving import Others, misread_of, thrusts
from ivsid.diagnosis.null.own_past import FORETOLD
from ivsid.diagnosis.null.rhythm import rhythm
from ivsid.diagnosis.null.slow_force import SlowForce
from ivsid.diagnosis.plant.usual_hull import hull_length
from ivsid.diagnosis.selection.dictionary import MEMORY, Regressors, regressors
from ivsid.diagnosis.selection.hulls import asked_of_hulls
from ivsid.diagnosis.selection.standing import Standing
from ivsid.diagnosis.selection.structure import ALONE, ROUGHER, Adequacy
from ivsid.effects import CHANNELS

Array = NDArray[np.float64]
# Structure beside any thrust curve, with the cross-products, least squares and regressors that it is of, and the worst of declared errors there.
_Beside: TypeAlias = "tuple[Adequacy, Gram, Projection, range, Callable[[Array], Array]]"
# Fall of a single regressor beside slow forces from which on it is no scatter of the noise above their frequencies.
# Source: measured: the examination; sound logs in waves of half a minute had 52 at most, and the scatter takes four fifths of it
LOUD: Final = 100.0
# Eigenvalues of the correlation matrix below this belong to directions that other regressors explain to one per cent of their length.
# Source: measured: make constants
DEPENDENT: Final = 1e-4


def adequacy(fit: Fit, *, turning: bool = False, known: Regressors | None = None) -> Adequacy:
    """Adequacy of a fitted model; structure that is more than chance has to stand beside any thrust curve inside its accuracy.

    Args:
        fit: of the model.
        turning: whether functions of the yaw rate are structure where yaw is left out, as gusts that turn the hull may make them.
        known: the dictionary's regressors of the fit, where they were made before.
    """
    names, x, unit = known or regressors(fit, turning=turning)
    # The model's own columns stand beside the dictionary, and those of the causes do not.
    g = fit.bare
    first = len(g.names)
    wide = g.joined(names, x, unit)
    own, at = Projection(wide, range(first)), range(first, len(wide.names))
    found = _structure(own, at, names, _none)
    noise: Spectrum | None = None
    if not found.white:
        # An ambient force of another spectrum than the whitening knows scatters the scores as well.
        noise = spectrum(fit, wide)
        found = _structure(own, at, names, _none, excess(fit, own, at, noise))
    found = replace(found, alone=found.chance_of_one <= ALONE)
    others = Others(fit)
    left, knots, bare = thrusts(others)
    misread, bare_misread = misread_of(others) or (None, None)
    far = outside(fit)
    words = {t.name: t.words for t in fit.noise.predictor.vehicle.thrusters}
    hulls = asked_of_hulls(others)
    rougher, beyond_curves = fit.noise.rougher, (0.0, 0.0, 0.0)
    if max(rougher) <= ROUGHER < max(fit.noise.alone[0] + fit.noise.alone[1]):
        # What thrust errors allow may hide a force of the time, which no thrust curve makes.
        beyond_curves = rougher_beyond(others.curve, ROUGHER)
    found = replace(
        found,
        leaving=left,
        knots=knots,
        pushed=_pushed(fit, far),
        outside=tuple((words[name], most) for name, most in far),
        misread=misread,
        hulls=hulls,
        rougher=rougher,
        beyond_curves=beyond_curves,
        scattered=max(fit.noise.scatter.items(), key=lambda q: q[1], default=("", 0.0)),
        parted=max(fit.noise.parted.items(), key=lambda q: q[1], default=("", 0.0)),
        rhythm=rhythm(fit),
        blow=blow(others),
    )

    def beside_curves(free: AnyCurve) -> _Beside:
        wide = free.g.joined(names, x, unit)
        own, at = Projection(wide, free.projection.base), range(len(free.g.names), len(wide.names))
        scatter = excess(fit, own, at, spectrum(fit, wide) if noise is None else noise)
        return found.also(_structure(own, at, names, free.worst, scatter)), wide, own, at, free.worst

    worst: Callable[[Array], Array] = _none
    if not found.white:
        found, wide, own, at, worst = _resolved(others, found, beside_curves)
    leans = not found.white or not replace(found, leaving=bare, misread=bare_misread).in_bounds
    for other in others.beside():
        # A regressor that stands for coefficients that the whitening lacks has no more to say than past errors do, and one of minutes no more than
        # a slow force.
        if found.white or found.strongest[0][2] >= FORETOLD:
            break
        less = Projection(other.beside(wide), own.base)
        beside = found.also(_structure(less, at, names, worst))
        loud = not beside.white and beside.strongest[0][2] >= LOUD
        if not beside.white and not loud and (colour := other.spectrum(wide)) is not None:
            beside = found.also(_structure(less, at, names, worst, excess(fit, own, at, colour)))
        found = max(found, beside, key=lambda q: q.of_regressors)
        if loud and isinstance(other, SlowForce):
            # A wave that joins slow forces may follow what is no noise.
            break
    return replace(found, leans=leans)


def _resolved(others: Others, bare: Adequacy, beside: Callable[[AnyCurve], _Beside]) -> _Beside:
    """Structure beside any thrust curve in the usual cells, or in most where twice as many leave less than half of it: it is of errors that jump inside cells.

    Args:
        others: with the curves.
        bare: structure beside none.
        beside: structure beside curves.
    """
    usual = beside(others.curve)
    before, now = (q.strongest[0][2] for q in (bare, usual[0]))
    # Where the usual cells take little, more of them do.
    if usual[0].white or settled(before, now):
        return usual
    return usual if settled(now, beside(others.closer)[0].strongest[0][2]) else beside(others.finest)


def _pushed(fit: Fit, far: Sequence[tuple[str, float]]) -> str:
    """Channel in which the thruster pushes whose error is farthest outside of its bound; empty if none is."""
    if not far:
        return ""
    worst = max(far, key=lambda q: q[1])[0]
    vehicle = fit.noise.predictor.vehicle
    k = [t.name for t in vehicle.thrusters].index(worst)
    c, s = (x[k] for x in fit.noise.predictor.driving.swing)
    x, y = vehicle.thrusters[k].position
    # A force inside the hull turns it by less than its own axis; a known moment has a longer arm.
    sizes = [float(np.abs(q).mean()) for q in (c, s, (x * s - y * c) / hull_length(vehicle))]
    return CHANNELS[int(np.argmax(sizes))]


def _none(moved: Array) -> Array:
    """No declared error moves a sum."""
    return np.zeros(moved.shape[1:])


def _structure(
    p: Projection,
    at: Sequence[int],
    names: Sequence[str],
    most: Callable[[Array], Array],
    more: Scatter | None = None,
) -> Adequacy:
    """Structure that regressors find beside a base.

    Args:
        p: least squares on the base.
        at: indices of the regressors.
        names: theirs, ``channel|function``.
        most: what declared errors move sums by at most, from what a unit of each moves them by.
        more: how the scores scatter beyond what they do in white noise.
    """
    q = Standing.of(p, at, most, more)
    real, H, d, scores, moved, single = q.real, q.information, q.length, q.scores, q.moved, q.falls

    def gained(which: NDArray[np.bool_]) -> tuple[float, int]:
        values, vectors = np.linalg.eigh(H[np.ix_(which, which)] / np.outer(d[which], d[which]))
        keep = values > DEPENDENT
        s = vectors[:, keep].T @ scores[which]
        theta = vectors[:, keep] @ (s / values[keep])
        fall = float(np.sum(s**2 / values[keep]))
        return beyond(fall, float(most(moved[:, which] @ theta))), int(keep.sum())

    fall, freedom = gained(real)

    def beyond_directions(which: NDArray[np.bool_]) -> float:
        own, directions = gained(real & which)
        return max(own - directions, 0.0)

    of_axis = {axis: np.array([n.startswith(axis) for n in names]) for axis in CHANNELS}
    now = np.array([not n.endswith(MEMORY) for n in names])
    excess = {axis: beyond_directions(own) for axis, own in of_axis.items()}
    of_now = {axis: beyond_directions(own & now) for axis, own in of_axis.items()}
    order = np.argsort(-single)[:3]
    strongest = tuple((names[k].split("|", 1)[1], names[k].split("|", 1)[0], float(single[k])) for k in order)
    one = float(min(1.0, chdtrc(1, float(single.max())) * len(names)))
    return Adequacy(fall, freedom, float(chdtrc(freedom, fall)), strongest, one, excess, of_now)
