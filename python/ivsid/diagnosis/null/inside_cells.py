"""Causes that errors of a thrust curve inside one of the cells of ``any_curve`` may look like, and that have to stand beside more cells.

Faint causes have to as well, whatever they are: among the errors inside many cells some look like any cause a little.
"""

from __future__ import annotations

from functools import cached_property
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.null.any_curve import AnyCurve
from ivsid.diagnosis.plant.thrust_errors import bound_of

# Cells beside which a cause has to stand that errors inside a cell may look like, in those of other causes. Where demands drift or change their
# level, these errors come and go like a cause in time. Where the error jumps, it is like the edge of a dead band. A shaft that lags runs through many
# of them after each change, as a thrust does that comes late. A saw's teeth at their bounds were a fouling and a failure of 11 standard deviations on
# a circle, and a dead band of 14; waves as short as a cell were a lag of 18.
# Source: resource: half a gigabyte for a log of 600 s at 20 Hz
FINER: Final = 3
# The same where doubt is left: for faint causes that errors inside a cell do not look like, and for errors that leave their bounds.
# Source: measured: of a drag in yaw of 33 in chi-squared that jumps inside cells made, 26 were left beside the usual cells, and 3 beside twice as many; errors that
# jump every fortieth of the range left the zonotope of the usual cells by 352 and 609, and that of twice as many by 0 and 1; a force of the heading left both
CLOSER: Final = 2
# The same where what is left has not settled.
# Source: resource: a gigabyte for a log of 600 s at 20 Hz, where errors inside cells stand far out of a calm sea alone
FINEST: Final = 6
# Share of what fewer cells leave, from which on more of them leave what no error inside any cell makes.
# Source: measured: of fifteen causes at thrusters three and six times the cells left 0.85 and more of what the usual ones did, and 0.58 of a dead band of which these left 143;
# of a cap of 540 in chi-squared that errors between two levels made in a calm sea 519, 167, 57, 4 and 0 were left beside one to five times the cells
SETTLED: Final = 0.5
# Fall of chi-squared beside the usual cells from which on a cause is clear of them.
# Source: resource: twelve standard deviations, and more cells take as long as a survey; what errors inside cells made was 39 at most
CLEAR: Final = 144.0


def settled(fewer: float, more: float) -> bool:
    """Whether more cells leave enough of what fewer leave: what is left is not made by errors that jump inside the fewer.

    Args:
        fewer: what is left beside fewer cells, in chi-squared.
        more: what is left beside more of them.
    """
    return more >= SETTLED * fewer


class Cells:
    """The base of a fit beside any thrust curve, in more and more cells of demand.

    Args:
        fit: of the log.
    """

    fit: Fit

    @cached_property
    def curve(self) -> AnyCurve:
        """In the usual cells."""
        return AnyCurve(self.fit)

    @cached_property
    def closer(self) -> AnyCurve:
        """In twice as many."""
        return AnyCurve(self.fit, finer=CLOSER)

    @cached_property
    def finer(self) -> AnyCurve:
        """In three times as many."""
        return AnyCurve(self.fit, finer=FINER)

    @cached_property
    def finest(self) -> AnyCurve:
        """In most."""
        return AnyCurve(self.fit, finer=FINEST)


def inside_cells(fit: Fit, s: Scored) -> bool:
    """Whether a cause may look like errors inside a cell: it changes the vehicle or a thrust in the course of a log, at one demand, or while a demand changes.

    A failure that exceeds twice the accuracy of its thruster does not: two errors inside a cell differ by less.

    Args:
        fit: of the log.
        s: the cause.
    """
    acts, form = s.candidate.effect.acts, s.candidate.effect.form
    if acts.at_thruster and acts.in_time and s.candidate.starts:
        return _inside_accuracy(fit, s)
    return acts.in_time or form.edged or (acts.at_thruster and form.bends)


def _inside_accuracy(fit: Fit, s: Scored) -> bool:
    """Whether a cause takes a share of one thruster's thrust that is less than two errors inside the thruster's stated accuracy may differ by."""
    numbers = dict(zip(s.candidate.effect.draws, s.values, strict=True))
    if "thruster" not in numbers or "size" not in numbers:
        return False
    predictor, k = fit.noise.predictor, round(numbers["thruster"])
    thruster, curve, demand = (
        predictor.vehicle.thrusters[k],
        predictor.propulsion.curves[k],
        predictor.propulsion.demands[k],
    )
    thrust = np.asarray(curve.value(demand + thruster.neutral), dtype=np.float64)
    size = np.sqrt(np.mean(thrust**2))
    return bool(abs(numbers["size"]) * size < 2.0 * np.sqrt(np.mean(bound_of(thruster, curve, demand) ** 2)))
