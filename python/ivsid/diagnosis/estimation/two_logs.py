"""Changes of parameters between two logs of the same thrusters, whose declared errors are the same in both.

Let a and b be the parameters of the two logs and e the declared errors: of each thrust curve (at its knots, and in the cells of
``null.any_curve`` beside them) and of each rudder, which both logs share, and of the velocity's scale and the sensors' mounting, of which each log has its own. Chi-squared of each log, with all other numbers eliminated, is a quadratic form of (a, e) and of (b, e). Their sum with one prior of e
has the normal matrix N. An error e* moves the estimate by -N^-1 P e*, of the prior's precision P, so that the errors inside their box |e_i| <= b_i
move a sum w'(b - a) by at most the support function of the box.

Source: docs/theory.md, "Statements", shallow water; Rockafellar, *Convex Analysis*, 1970, section 13 (support functions).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.cross_products import RIDGE, Gram
from ivsid.diagnosis.estimation.other_log import SHARED
from ivsid.diagnosis.plant.declared_readings import FIXED

Array = NDArray[np.float64]
# Declared errors with a bound of which each log has its own: the speed of sound in the water scales a velocity, and a sensor is mounted again.
OWN: Final = FIXED


@dataclass(frozen=True)
class OneLog:
    """What one log tells of some parameters and of the declared errors: chi-squared is x'Sx - 2 r'x + const.

    Attributes:
        errors: names of the declared errors, with the bound of each in standard deviations of its prior; 0 for one without a bound of its own.
        S: information on the relative changes of the parameters from the fitted ones, then on the whole errors in standard deviations
            of their priors, the priors themselves left out, shape (x, x).
        r: shape (x,).
    """

    errors: Mapping[str, float]
    S: Array
    r: Array


def one_log(g: Gram, base: Sequence[int], values: Mapping[str, float], box: Array | None = None) -> OneLog:
    """Eliminates all columns of a base but some parameters and the declared errors, each with its own prior.

    Args:
        g: cross-products at a fit.
        base: columns that are fitted.
        values: fitted values of the parameters by id.
        box: bound of each error of the base that has one, else 0, in unit lengths, shape (base,); no bounds by default.
    """
    bounds = dict(zip(base, np.zeros(len(base)) if box is None else box, strict=True))
    errors = [k for k in base if g.names[k].startswith((*SHARED, *OWN))]
    x = [*g.at(list(values)), *errors]
    others = [k for k in base if k not in set(x)]
    total, score = g.total, g.score.sum(axis=0)
    # Errors are whole errors, so the part that the hypothesis holds of them goes back into the score.
    score = score + total[:, errors] @ g.centre[errors] - g.prior * g.centre
    cross = g.regression(x, others)
    # Numbers that are kept have the ridge of a base as well; their priors join later, once for both logs.
    S = total[np.ix_(x, x)] + RIDGE * np.eye(len(x)) - total[np.ix_(x, others)] @ cross
    r = score[x] - cross.T @ score[others]
    r[len(values) :] += (g.prior * g.centre)[errors]
    size = np.r_[np.array(list(values.values())) * g.unit[x[: len(values)]], g.prior[errors] ** -0.5]
    return OneLog(
        {g.names[k]: float(bounds[k] * g.prior[k] ** 0.5) for k in errors}, S * np.outer(size, size), r * size
    )


@dataclass(frozen=True)
class Changes:
    """Relative changes of parameters from one log to another.

    Attributes:
        mean: natural logarithms of the ratios, shape (parameters,).
        covariance: with the priors of the declared errors, shape (parameters, parameters).
        noise: that of the noise alone, shape (parameters, parameters).
        moved: changes by each declared error at its bound, shape (parameters, errors).
    """

    mean: Array
    covariance: Array
    noise: Array
    moved: Array

    def of(self, count: int) -> Changes:
        """The first parameters alone, beside the others."""
        return Changes(
            self.mean[:count], self.covariance[:count, :count], self.noise[:count, :count], self.moved[:count]
        )

    def worst(self, weight: Array) -> float:
        """Most that declared errors inside their bounds move a weighted sum of the changes."""
        return float(np.abs(weight @ self.moved).sum())


def changes(first: OneLog, second: OneLog, ratio: Array) -> Changes:
    """Joint least squares over the parameters of both logs and one set of the errors that they share.

    Args:
        first: a log.
        second: another; each may lack errors that the other has.
        ratio: natural logarithms of the fitted parameters' ratios, second over first, shape (parameters,).
    """
    logs = (first, second)
    box = {_key(k, e): bound for k, log in enumerate(logs) for e, bound in log.errors.items()}
    n, names = len(ratio), {key: j for j, key in enumerate(box)}
    size = 2 * n + len(names)
    N, s = np.zeros((size, size)), np.zeros(size)
    for k, log in enumerate(logs):
        at = [*range(k * n, (k + 1) * n), *(2 * n + names[_key(k, e)] for e in log.errors)]
        N[np.ix_(at, at)] += log.S
        s[at] += log.r
    told = N.copy()
    N[2 * n :, 2 * n :] += np.eye(len(names))
    between = np.hstack([-np.eye(n), np.eye(n), np.zeros((n, len(names)))])
    gain = np.linalg.solve(N, between.T).T
    return Changes(
        ratio + gain @ s, gain @ between.T, gain @ told @ gain.T, gain[:, 2 * n :] * np.array(list(box.values()))
    )


def _key(log: int, error: str) -> tuple[int, str]:
    """An error that both logs share has one key."""
    return (log if error.startswith(OWN) else 0), error
