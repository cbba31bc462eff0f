"""Whether a log asks of declared errors to leave their bounds: those of thrusts at the knots of their curves, and those of readings.

Chi-squared is minimised over all other columns of a base, with some errors inside their box or free of it. If the true errors lie inside, then
the truth is one of the points of the box, and the minimum lies below it by chi-squared with as many degrees of freedom as there are errors, at most.

Source: docs/theory.md, "Errors that leave their bound".
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.special import chdtrc

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.any_curve import DETERMINED, LEAST
from ivsid.diagnosis.null.box_least_squares import inside_box
from ivsid.diagnosis.plant.declared_readings import bounded
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Values at the knots, in bounds, up to which an error may lie inside its bound: a straight line beside a jump overshoots.
# Source: geometry: least squares of a saw's teeth by straight pieces of a third of their length, which exceeds them by a quarter
OVERSHOOT: Final = 1.3


class Boxed:
    """Chi-squared of a fit with the thrust errors at the knots inside their bounds.

    A hysteresis parts the errors of rising demands from those of falling ones: each branch has a box, with that of the
    hysteresis beside it, and the larger of the two falls is less than that from a box of both branches.

    Args:
        fit: of the model.
        g: cross-products of its base; those of the fit by default.

    Attributes:
        leaving: fall of chi-squared where the errors may leave their bounds.
        knots: number of knots that may leave their bounds; 0 if no accuracy is declared.
    """

    def __init__(self, fit: Fit, g: Gram | None = None) -> None:
        g, base = (fit.gram, fit.base) if g is None else (g, range(len(g.names)))
        predictor = fit.noise.predictor
        errors = [
            (e.names(t.name), e)
            for t, e in zip(predictor.vehicle.thrusters, predictor.propulsion.errors, strict=True)
            if e.knots.size
        ]
        at = g.at([name for names, _ in errors for name in names])
        # From values at the knots, of either branch and of the hysteresis, to sizes of the functions.
        turns = [block_diag(*(e.sizes(side) for _, e in errors)) for side in (1.0, -1.0)] if at else []
        found = [_leaving(g, base, at, turn) for turn in turns]
        self.leaving = max((q.fall for q in found), default=0.0)
        self.knots = max((q.freedom for q in found), default=0)


@dataclass(frozen=True)
class Leaving:
    """What some errors gain where they may leave their bounds.

    Attributes:
        fall: of chi-squared.
        freedom: number of errors that the log tells of.
        largest: of their free values, in bounds.
    """

    fall: float
    freedom: int
    largest: float

    @property
    def chance(self) -> float:
        """Probability of such a fall, at most, where all errors keep their bounds."""
        return float(chdtrc(self.freedom, self.fall)) if self.freedom else 1.0


def _leaving(g: Gram, base: Sequence[int], at: Sequence[int], turn: Array) -> Leaving:
    """Fall of chi-squared from errors inside the box to free ones.

    Args:
        g: cross-products at a fit.
        base: columns that are fitted.
        at: those of the errors.
        turn: sizes of the errors by values inside [-1, 1], shape (errors, values).
    """
    inside = set(at)
    others = [k for k in base if k not in inside]
    turn = turn * g.unit[at][:, None]
    score, total = g.score.sum(axis=0) - g.prior * g.centre, g.total
    # Errors of the log without the part that the hypothesis holds of these: the box is that of the whole errors.
    score = score + total[:, at] @ g.centre[at]
    cross = g.regression(at, others)
    S = total[np.ix_(at, at)] - total[np.ix_(at, others)] @ cross
    r = score[at] + (g.prior * g.centre)[at] - cross.T @ score[others]
    values, vectors = np.linalg.eigh(turn.T @ S @ turn)
    kept = values > DETERMINED * max(float(values.max()), LEAST)
    root = np.sqrt(values[kept])
    left = vectors[:, kept].T @ (turn.T @ r) / root
    shape = (vectors[:, kept] * root).T
    rest = shape @ inside_box(shape, left, np.full(shape.shape[1], OVERSHOOT)) - left
    free = vectors[:, kept] @ (left / root)
    return Leaving(float(rest @ rest), int(kept.sum()), float(np.abs(free).max(initial=0.0)))


def readings(vehicle: Vehicle, g: Gram, base: Sequence[int], *, earth: bool = False) -> Iterator[tuple[str, Leaving]]:
    """What the errors of each reading gain where they may leave their bounds, by name of the error.

    Args:
        vehicle: with its sensors.
        g: cross-products at a fit.
        base: columns that are fitted.
        earth: whether velocities are read in earth axes.
    """
    known = {g.names[k]: k for k in base}
    for name, parts, turn in bounded(vehicle, earth=earth):
        held = [j for j, part in enumerate(parts) if part in known]
        if held:
            yield name, _leaving(g, base, [known[parts[j]] for j in held], turn[held])


def outside(fit: Fit) -> tuple[tuple[str, float], ...]:
    """Thrusters whose error in the hypothesis, which a soft prior holds, has left its bound, with its largest value in bounds."""
    predictor = fit.noise.predictor
    pairs = zip(predictor.vehicle.thrusters, predictor.propulsion.errors, strict=True)
    found = [(t.name, errors.largest(t.name, fit.h.declared_errors)) for t, errors in pairs]
    return tuple((name, most) for name, most in found if most > 1.0)
