"""Fall of chi-squared of a thrust that changes no faster than it can, in the place of one that lags or is late.

A drive whose rate is limited follows a small step at once and a large one late. A lag and a delay explain most of it, and a second cause of the
sensors the rest. The catalogue has no such limit.

Source: docs/theory.md, "Limits of a rate"; Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2011, section 9.8 (saturation of
actuators).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import largest_fall
from ivsid.diagnosis.plant.thruster_forces import bollard_force
from ivsid.effects import Grid, Response

Array = NDArray[np.float64]
# Times in which the limited rate takes a thrust from none to its largest, in those of the lag or the delay in whose place it stands.
# Source: geometry: a lag is late by itself, and a limited rate by half of its time for a step of full size and by less for others
PACES: Final = (2.0, 4.0, 6.0, 8.0, 12.0)


def lags(s: Scored) -> bool:
    """Whether a cause is that the thrusts follow their demands late by a time, which is its number."""
    effect = s.candidate.effect
    return isinstance(effect.acts, Response) and isinstance(effect.form, Grid) and effect.form.of == "seconds"


def slewed(fit: Fit, s: Scored) -> float:
    """Largest fall of chi-squared of thrusts whose rate is limited.

    Args:
        fit: of the model without them.
        s: the lag or the delay with its score.
    """
    predictor, p = fit.noise.predictor, fit.states.points
    n, h = predictor.log.n, predictor.log.h
    turn = p.swing or (np.cos(p.angles), np.sin(p.angles))
    forces = []
    for pace in PACES:
        change = np.zeros_like(p.thrusts)
        for k, curve in enumerate(predictor.propulsion.curves):
            if s.candidate.alone not in (None, predictor.vehicle.thrusters[k].name):
                continue
            now = p.thrusts[k, :n]
            late = limited(now, curve.largest * h / (pace * s.values[0])) - now
            # Over a step the mean of its ends.
            change[k] = np.concatenate([late, 0.5 * (late + np.r_[late[1:], late[-1]])])
        forces.append(fit.signatures.mass.solve(bollard_force(predictor.vehicle, change, turn)))
    g = fit.gram
    x, _ = g.white.blocks([predictor.answer(a) for a in forces], g.good, g.length)
    return largest_fall(g, fit.base, x)


def limited(x: Array, most: float) -> Array:
    """What follows a signal from rest by at most so much a sample, shape (n,)."""
    if float(np.abs(np.diff(x, prepend=0.0)).max(initial=0.0)) <= most:
        return x
    out, y = [], 0.0
    for a in x.tolist():
        # What is not limited is the signal to the bit: rounding is no force.
        y = a if abs(a - y) <= most else y + (most if a > y else -most)
        out.append(y)
    return np.array(out)
