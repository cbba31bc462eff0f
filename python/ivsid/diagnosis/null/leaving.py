"""Whether declared errors leave their bounds beside all that may have moved them.

A soft noise model and few knots make errors look larger than they are. An error leaves its bound where it does so beside any thrust curve inside
its accuracy, and beside the log's own past errors.

Source: docs/theory.md, "Errors that leave their bound".
"""

from __future__ import annotations

from functools import cached_property

from scipy.special import chdtrc

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.any_curve import DOUBT, AnyCurve
from ivsid.diagnosis.null.boxed import Boxed, Leaving, readings
from ivsid.diagnosis.null.own_past import FORETOLD, OwnPast
from ivsid.diagnosis.null.reached import Reached


class Others:
    """What may have made a declared error leave its bound: any thrust curve inside its accuracy, and past errors."""

    def __init__(self, fit: Fit) -> None:
        self.fit = fit

    @cached_property
    def curve(self) -> AnyCurve:
        """The base beside any thrust curve."""
        return AnyCurve(self.fit)

    @cached_property
    def past(self) -> OwnPast:
        """The base beside the log's own past errors."""
        return OwnPast(self.fit)


def thrusts(others: Others) -> tuple[float, int]:
    """Fall of chi-squared where thrust errors may leave their bounds, the least of what is asked, and number of knots that may."""
    fit = others.fit
    boxed = Boxed(fit)
    left, knots = boxed.leaving, boxed.knots
    if knots and chdtrc(knots, left) <= DOUBT:
        # Curves that jump between knots reach more than values at the knots do.
        left = min(left, Reached(others.curve).leaving)
    if knots and chdtrc(knots, left) <= DOUBT and left < FORETOLD:
        left = min(left, Boxed(fit, others.past.base).leaving, Reached(others.curve, others.past).leaving)
    return left, knots


def misread_of(others: Others) -> tuple[str, Leaving, float] | None:
    """The error of readings that leaves its bound most, each beside what leaves it the most probable."""
    fit, vehicle = others.fit, others.fit.noise.predictor.vehicle
    found = dict(readings(vehicle, fit.gram, fit.base))
    if not found:
        return None

    def worst() -> tuple[str, Leaving, float]:
        name, most = min(found.items(), key=lambda q: q[1].chance)
        return name, most, min(1.0, most.chance * len(found))

    def asked(g: Gram) -> None:
        found.update((n, q) for n, q in readings(vehicle, g, range(len(g.names))) if q.chance > found[n].chance)

    if worst()[2] <= DOUBT and vehicle.thrusters:
        # A thrust curve may have moved the readings.
        asked(others.curve.g)
    if worst()[2] <= DOUBT and worst()[1].fall < FORETOLD:
        # Readings that an autopilot answers foretell errors of a colour that the whitening lacks.
        asked(others.past.base)
    return worst()
