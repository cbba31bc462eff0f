"""Shallow water: masses and drags that change by one factor from TRAIN to TEST.

Added masses and drags grow together where the water is shallow. Thrusters, and with them the errors of their curves, are the same in both logs.
Thrusts that all lost one share between the logs (a battery, fouled propellers) look alike where nothing but such masses and drags is fitted: a
parameter that shallow water leaves alone, as the inertia in yaw, tells the two apart.

Source: docs/theory.md, "The catalogue of effects".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.fit import Fit, survey
from ivsid.diagnosis.estimation.learning import undetermined
from ivsid.diagnosis.estimation.other_log import carried_to
from ivsid.diagnosis.estimation.problem import Problem
from ivsid.diagnosis.estimation.two_logs import Changes, changes, one_log
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.both_logs import beside_curves
from ivsid.effects.environment import SHALLOW_SCALED
from ivsid.log import Log

# Parameters that have to be fitted and to change: a factor of fewer may be chance. Two masses changed by 2.3 % where a failed thruster was fitted.
# Source: measured: make constants
MEMBERS: Final = 3
# The same where axes are left out, as on a straight line, and the fit holds nothing else, or where both logs state their depths, and those differ.
# Source: definition: the mass and the drag of surge
FEWER: Final = 2
# Ratio of the depths of two logs from which on the water is another one.
# Source: definition: half as much again
OTHER_DEPTH: Final = 1.5
# Standard deviations that the common change has to exceed.
# Source: definition: 6e-7 of normal errors lie beyond
SIGMAS: Final = 5.0
# Standard deviations within which each change has to agree with the common one.
# Source: definition: 6e-5 of normal errors lie beyond
AGREE: Final = 4.0
# Standard deviations that a change of one parameter has to exceed.
# Source: definition: 0.3 % of normal errors lie beyond
MOVED: Final = 3.0
# Least relative change that counts.
# Source: measured: make constants
LEAST: Final = 0.02
# Relative variance that is added to that of each parameter, so that their covariance can be inverted.
# Source: measured: make constants
FLOOR: Final = 1e-8
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Factor:
    """Factor by which all parameters change.

    Attributes:
        mean: its natural logarithm.
        error: standard deviation of it by the noise.
        worst: most that declared errors inside their bounds move it.
    """

    mean: float
    error: float
    worst: float

    def within(self, sigmas: float) -> tuple[float, float]:
        """The factors that errors of so many standard deviations allow beside the worst declared errors."""
        half = sigmas * self.error + self.worst
        return float(np.exp(self.mean - half)), float(np.exp(self.mean + half))

    @property
    def counts(self) -> bool:
        """Whether neither noise nor declared errors explain it."""
        return abs(self.mean) >= max(SIGMAS * self.error, LEAST) + self.worst

    @property
    def z(self) -> float:
        """Standard deviations of the noise that no declared error explains."""
        return (abs(self.mean) - self.worst) / self.error


@dataclass(frozen=True)
class Change:
    """Change of the model between two logs.

    Attributes:
        ratio: TEST over TRAIN of each parameter, with its relative standard deviation.
        factor: the common factor; None without one.
        thrusts: whether one factor of all thrusts explains the change as well.
    """

    ratio: dict[str, tuple[float, float]]
    factor: Factor | None
    thrusts: bool = False


def sounded(train: Log, test: Log) -> int:
    """1 where the depths that both logs state say that the water of TEST is shallower, -1 where it is deeper, and 0 where they say neither.

    Args:
        train: the first log.
        test: the other one.
    """
    depths = [log.columns["depth"] for log in (train, test) if "depth" in log.columns]
    there = [float(np.nanmedian(d)) for d in depths if np.isfinite(d).any()]
    if len(there) < 2 or min(there) <= 0 or max(there) < OTHER_DEPTH * min(there):
        return 0
    return 1 if there[1] < there[0] else -1


def change(last: Fit, test: Channels, water: int = 0) -> Change | None:
    """Fits the last hypothesis to the other log, under the noise of the first.

    Args:
        last: fit of the extended model to TRAIN.
        test: the other log.
        water: what depths say of it (``sounded``).

    Returns:
        The change; None if the logs differ in channels or clock, if too few parameters are fitted, or if the fit fails.
    """
    fixed = last.fixed
    unsure = undetermined(last)
    fitted = [i for i in last.h.values if i not in fixed and i not in unsure]
    wanted = [i for i in SHALLOW_SCALED if i in fitted]
    members = FEWER if last.noise.left_out or water else MEMBERS
    if len(wanted) < members:
        return None
    try:
        carried = carried_to(last, test)
        if carried is None:
            return None
        noise, states = carried
        g = Problem.at(noise, fixed, states).gram(states)
        alone = [i for i in fitted if i not in wanted and last.h.values[i] * states.h.values[i] > 0]
        before, after = ({i: q.values[i] for i in (*wanted, *alone)} for q in (last.h, states.h))
        if min(q[i] for q in (before, after) for i in wanted) <= 0:
            return None
        logs = np.array([np.log(after[i] / before[i]) for i in (*wanted, *alone)])
        count = len(wanted)
        found = changes(one_log(last.gram, last.base, before), one_log(g, range(len(g.names)), after), logs)
        factor, thrusts = None, False
        if factor_of(found.of(count))[0].counts:
            # A curve may bend or jump between its knots: what is left has to stand beside any curve, the same in both logs.
            there = survey(noise, states, fixed)
            found = beside_curves(last, there, before, after, logs)
            # The other log may have further structure, which may move the parameters: it may turn where the first one hardly does.
            factor = common(found.of(count), members) if adequacy(there, turning=True).white else None
            if factor is not None and factor.mean * water < 0:
                # Masses and drags do not fall where the water gets shallow.
                factor = None
            thrusts = factor is not None and agree(found, factor.mean)
    except np.linalg.LinAlgError:
        return None
    found = found.of(count)
    sigma = np.sqrt(np.diag(found.covariance))
    ratio = {i: (float(np.exp(m)), float(s)) for i, m, s in zip(wanted, found.mean, sigma, strict=True)}
    return Change(ratio, factor, thrusts)


def factor_of(found: Changes) -> tuple[Factor, NDArray[np.float64]]:
    """Factor by generalised least squares, and the weight of each change in it, shape (parameters,)."""
    n = len(found.mean)
    solved = np.linalg.solve(found.covariance + FLOOR * np.eye(n), np.ones(n))
    weight = np.asarray(solved / solved.sum(), dtype=np.float64)
    # The correlations are an estimate, so the error is at least that without them.
    alone = float(1 / np.sqrt(np.sum(1 / np.maximum(np.diag(found.noise), FLOOR))))
    error = max(float(np.sqrt(weight @ found.noise @ weight)), alone)
    return Factor(float(weight @ found.mean), error, found.worst(weight)), weight


def common(found: Changes, members: int) -> Factor | None:
    """Common factor; None if the changes differ, or if noise and declared errors explain it.

    Args:
        found: the changes.
        members: number of them that have to move by themselves.
    """
    (factor, weight), each = factor_of(found), np.eye(len(found.mean))
    sigma = np.sqrt(np.diag(found.noise) + FLOOR)
    # Enough parameters have to change by themselves, and not only their mean.
    own = np.array([found.worst(e) for e in each])
    moved = bool((np.abs(found.mean) > MOVED * sigma + own).sum() >= members)
    return factor if factor.counts and agree(found, factor.mean, weight) and moved else None


def agree(found: Changes, mean: float, weight: Array | None = None) -> bool:
    """Whether all changes agree with one.

    Args:
        found: the changes.
        mean: natural logarithm of the one.
        weight: of the changes in it, so that errors that move both alike cancel; none by default.
    """
    sigma = np.sqrt(np.diag(found.noise) + FLOOR)
    apart = np.array([found.worst(e if weight is None else e - weight) for e in np.eye(len(found.mean))])
    return bool((np.abs(found.mean - mean) < AGREE * sigma + apart).all())
