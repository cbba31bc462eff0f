"""Whether declared errors leave their bounds beside all that may have moved them.

A soft noise model and few knots make errors look larger than they are. An error leaves its bound where it does so beside any thrust curve inside
its accuracy, beside the log's own past errors, and beside slow forces inside the declared ambient force.

Source: docs/theory.md, "Errors that leave their bound".
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Final, TypeAlias

from scipy.special import chdtrc

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.any_curve import DOUBT
from ivsid.diagnosis.null.beside import Beside
from ivsid.diagnosis.null.boxed import Boxed, Leaving, outside, readings
from ivsid.diagnosis.null.frequencies import spectrum
from ivsid.diagnosis.null.inside_cells import Cells, settled
from ivsid.diagnosis.null.long_past import LongPast
from ivsid.diagnosis.null.own_past import FORETOLD, OwnPast
from ivsid.diagnosis.null.reached import Reached
from ivsid.diagnosis.null.slow_force import SlowForce, slow_force, wave_beside
from ivsid.diagnosis.plant.declared_readings import ARM

# Size of a fitted thrust error, in bounds, from which on all curves inside their accuracy are asked, though the values at the knots may lie inside theirs
# with their overshoot.
# Source: measured: of 60 sound logs whose thrust errors fill their bounds one reached 2.1, and all curves inside the accuracy came to each of them
FAR: Final = 2.0
# An error of readings by name, what it gains outside of its bound, and the probability of that over all such errors.
Misread: TypeAlias = "tuple[str, Leaving, float]"


class Others(Cells):
    """What may have made a declared error leave its bound: any thrust curve inside its accuracy, past errors, and slow forces."""

    def __init__(self, fit: Fit) -> None:
        self.fit = fit

    @cached_property
    def past(self) -> OwnPast:
        """The base beside the log's own past errors."""
        return OwnPast(self.fit)

    @cached_property
    def slow(self) -> SlowForce | None:
        """The base beside slow forces; None where the vehicle file declares no ambient force."""
        return slow_force(self.fit)

    @cached_property
    def wave(self) -> SlowForce | None:
        """The base beside slow forces and a wave; None where the log shows none."""
        return wave_beside(self.fit)

    def beside(self) -> Iterator[Beside]:
        """What else may have, each made where those before it do not explain enough."""
        yield self.past
        if self.slow is not None:
            yield self.slow
        if self.wave is not None:
            yield self.wave
        yield LongPast(self.fit)


def thrusts(others: Others) -> tuple[float, int, float]:
    """Fall of chi-squared where thrust errors may leave their bounds, the least of what is asked, number of knots that may, and fall beside curves alone."""
    fit = others.fit
    boxed = Boxed(fit)
    left, knots = boxed.leaving, boxed.knots
    if not knots:
        return left, knots, left
    # Values at the knots with their overshoot reach more than a curve inside its accuracy does, and less than one that jumps between them.
    doubt, far = chdtrc(knots, left) <= DOUBT, max((most for _, most in outside(fit)), default=0.0) > FAR
    if doubt or far:
        reached = Reached(others.curve).leaving
        left = min(left, reached) if doubt else reached
    if chdtrc(knots, left) <= DOUBT:
        # However far they leave it: a jump inside a cell stands out of a calm sea as far as a cause does.
        closer = Reached(others.closer).leaving
        if chdtrc(knots, closer) <= DOUBT and not settled(left, closer):
            closer = min(closer, Reached(others.finest).leaving)
        left = min(left, closer)
    bare = left
    if chdtrc(knots, left) <= DOUBT and left < FORETOLD:
        # An ambient force of another spectrum than the whitening knows scatters them as well.
        left = min(left, Reached(others.closer, noise=spectrum(fit, others.closer.g)).leaving)
    for other in others.beside():
        if chdtrc(knots, left) > DOUBT or left >= FORETOLD:
            break
        beside = Reached(others.closer, other, other.spectrum(others.closer.g))
        left = min(left, beside.leaving)
        if doubt and beside.other is not None:
            left = min(left, Boxed(fit, beside.other.base).leaving)
    return left, knots, bare


def misread_of(others: Others) -> tuple[Misread, Misread] | None:
    """The error of readings that leaves its bound most, each beside what leaves it the most probable, and the same beside curves alone."""
    fit, vehicle = others.fit, others.fit.noise.predictor.vehicle
    earth = fit.noise.predictor.log.earth
    found = dict(readings(vehicle, fit.gram, fit.base, earth=earth))
    if fit.noise.left_out:
        # The yaw rate answers to moments that no model follows there, and a gust brings forces with them.
        found = {name: q for name, q in found.items() if not name.startswith(ARM)}
    if not found:
        return None

    def worst() -> Misread:
        name, most = min(found.items(), key=lambda q: q[1].chance)
        return name, most, min(1.0, most.chance * len(found))

    def asked(g: Gram) -> None:
        there = readings(vehicle, g, range(len(g.names)), earth=earth)
        found.update((n, q) for n, q in there if n in found and q.chance > found[n].chance)

    if worst()[2] <= DOUBT:
        # A thrust curve may have moved the readings.
        asked(others.curve.g)
    bare = worst()
    for other in others.beside():
        # Readings that an autopilot answers foretell errors of a colour that the whitening lacks, and a slow force moves them for minutes.
        if worst()[2] > DOUBT or worst()[1].fall >= FORETOLD:
            break
        asked(other.base)
    return worst(), bare
