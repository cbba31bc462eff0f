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

from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.plant.propulsion import SHORTEST_LAG
from ivsid.diagnosis.plant.thruster_forces import bollard_force
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.effects import Grid, Response

Array = NDArray[np.float64]
# Times in which the limited rate takes a thrust from none to its largest, in those of the lag or the delay in whose place it stands.
# Source: geometry: a lag is late by itself, and a limited rate by half of its time for a step of full size and by less for others
PACES: Final = (2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0)


def lags(s: Scored) -> bool:
    """Whether a cause is that the thrusts follow their demands late by a time, which is its number."""
    effect = s.candidate.effect
    return isinstance(effect.acts, Response) and isinstance(effect.form, Grid) and effect.form.of == "seconds"


def slewed(problem: Problem, states: FilteredStates, s: Scored, plain: Hypothesis) -> float:
    """What thrusts whose rate is limited explain in chi-squared beyond a cause by which they follow late, once that is fitted in full.

    Args:
        problem: the log.
        states: of the hypothesis with the cause, fitted in full.
        s: the cause with its score.
        plain: the hypothesis without any cause.

    Source: docs/theory.md, "Limits of a rate": the errors are linear in what the one thrust has beyond the other, and both are fitted to the end.
    """
    predictor = problem.noise.predictor
    n, h, points = predictor.log.n, predictor.log.h, states.points
    (time,) = next(q.values for q in states.h.given if q.effect.id == s.id)
    sent, _, _ = predictor.driving.whole(states.h.without(s.id, plain))
    turn = points.swing or (np.cos(points.angles), np.sin(points.angles))
    mass = predictor.mass(states)
    forces = []
    for pace in PACES:
        change = np.zeros_like(points.thrusts)
        for k, curve in enumerate(predictor.propulsion.curves):
            if s.candidate.alone in (None, predictor.vehicle.thrusters[k].name):
                now = limited(sent[k, :n], curve.largest * h / max(pace * time, SHORTEST_LAG))
                # Over a step the mean of its ends.
                change[k] = np.concatenate([now, 0.5 * (now + np.r_[now[1:], now[-1]])]) - points.thrusts[k]
        forces.append(mass.solve(bollard_force(predictor.vehicle, change, turn)))
    g = problem.gram(states, sums=False)
    x, unit = g.white.blocks([predictor.answer(a) for a in forces], g.good, g.length)
    wide = g.joined([f"limited at {pace:g}" for pace in PACES], x, unit)
    p, first = Projection(wide, range(len(g.names))), len(g.names)
    best = 0.0
    for k in range(len(PACES)):
        if unit[k] > 0:
            theta, _ = p.solve([first + k])
            # All of it, and no more or less, is the other thrust in the place of this one.
            size = float(p.information([first + k])[0, 0]) * unit[k] ** 2
            best = max(best, size * (2.0 * float(theta[0]) / unit[k] - 1.0))
    return best


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
