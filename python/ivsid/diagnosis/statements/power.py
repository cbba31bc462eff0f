"""The largest drag that the power of a log allows: no hull gives to the water more than drives it.

Between two moments the kinetic energy of hull and water changes by the work of the thrusters and of the ambient force less what drags take. With drags
d_j of the powers P_j at unit size, all of one sign, d_i times the sum of P_i is at most the work of all that drives and the energy at the start.

Source: docs/theory.md, "Claims"; the energy balance of Fossen 2011, section 6.3, whose Coriolis forces do no work.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.plant.physics import Mass, changed, water
from ivsid.diagnosis.plant.points import place_of
from ivsid.diagnosis.plant.thrust_errors import bound_of
from ivsid.diagnosis.plant.thruster_forces import thruster_force
from ivsid.effects import CHANNELS, Force, State, Term, acting

Array = NDArray[np.float64]
# Standard deviations of the work of the ambient force that count.
# Source: theorem: one-sided 99.95 % quantile of the standard normal distribution
SIGMAS: Final = 3.3


def largest_drag(fit: Fit, term: Term, off: Mapping[str, float]) -> float:
    """The largest value of a drag, in its unit; infinite for a term that does not take power at every sample.

    Args:
        fit: of the last model.
        term: with the drag as its parameter.
        off: largest error of each thrust curve that leaves its bound, in its bounds, by the words for the thrust.
    """
    predictor, h = fit.noise.predictor, fit.h
    vehicle, log = predictor.vehicle, predictor.log
    # Errors are counted around the curves of the file, and the fitted ones are inside them.
    stated = replace(h, declared_errors={})
    p = fit.states.points.under(predictor.driving.thrusts(stated))
    u_c, v_c, _, _ = water(h, p)
    nu = np.stack([p.nu[0] - u_c, p.nu[1] - v_c, p.nu[2]])
    u, v, r = nu
    here = State(u, v, r, 0.0, 0.0, 0.0, place=place_of(p))

    def power(forces: Mapping[str, Array | float]) -> Array:
        return np.asarray(sum(nu[CHANNELS.index(c)] * x for c, x in forces.items()), dtype=np.float64)

    taken = power(term.columns(here))
    if not (taken.ndim and taken.min() >= 0.0 and taken.any()):
        return np.inf
    driven = nu * thruster_force(vehicle, h.given, p, (u, v, r))
    work = float(driven.sum())
    along, across = p.swing or (np.cos(p.angles), np.sin(p.angles))
    for k, t in enumerate(vehicle.thrusters):
        x, y = t.position
        at = u - y * r, v + x * r
        # An error of a thrust pushes along its axis; a rudder turns it anywhere.
        speed = np.abs(at[0] * along[k] + at[1] * across[k]) if t.rudder is None else np.hypot(*at)
        # Samples come before steps.
        bound = np.tile(bound_of(t, predictor.propulsion.curves[k], predictor.propulsion.demands[k]), 2)
        work += off.get(t.words, 1.0) * float(bound @ speed)
    # A wind, a pull or a lift that was fitted may drive as well; what they take elsewhere is given to the drag.
    work += sum(max(-h.values[t.id] * float(power(t.columns(here)).sum()), 0.0) for t in h.terms if t.id != term.id)
    work += sum(max(float(power(f.function(here, numbers)).sum()), 0.0) for f, numbers in acting(h.given, Force))
    masses = np.linalg.inv(Mass(vehicle, h.terms, changed(h, p.t)).inverse[0])
    # The sum of a Gauss-Markov force over a motion that is slower than it.
    pushed = np.diag(masses) * predictor.ambient.deviation
    points = 2.0 * np.array(predictor.ambient.time) / (0.5 * log.h)
    work += SIGMAS * float(np.sqrt(np.sum(pushed**2 * points * np.sum(nu**2, axis=1))))
    work += max(float(nu[:, 0] @ masses @ nu[:, 0]), 0.0) / log.h
    return max(work, 0.0) / float(taken.sum())
