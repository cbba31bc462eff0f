"""What of a cause's scores no declared error inside its bound makes, in a few directions beside each other.

A direction is what least squares leaves of a cause's columns beside the base and the cells, for one weight of the priors of the thrust errors.
A large weight keeps the whole signature: the noise says little, and the errors have their whole effect. A small one keeps what lies beside the
cells: errors do little, and the noise says more. Which of them shows a cause depends on the cause, and the best is a sum of several. A further
direction is what the bounds themselves leave of a cause at its size (``null.beyond_box``).

Let z = D'y be the scores of the directions D, with y = A e + n, errors |e_i| <= b_i and noise n. The errors move z inside a convex set K,
whose support function is the worst sum of ``any_curve``. The distance of z from K, in the noise of z, is at most that from the true D'A e: its
square is chi-squared with as many degrees of freedom as there are directions, at most. The distance itself is the largest of
(u'z - h(u)) / |u| over all u (duality), so that any u bounds it from below.

Source: docs/theory.md, "Any thrust curve inside its accuracy"; Rockafellar, *Convex Analysis*, 1970, section 13 (support functions); Wolfe,
"Finding the nearest point in a polytope", Mathematical Programming 11, 1976.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import nnls
from scipy.special import chdtrc, chdtri

from ivsid.diagnosis.estimation.cross_products import RIDGE
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.null.any_curve import LEAST, AnyCurve
from ivsid.diagnosis.null.beyond_box import BeyondBox

Array = NDArray[np.float64]
# Weights of the priors of the thrust errors: sets of directions, of which each is taken together and the best counts.
# Source: geometry: a standard deviation of a fifth of the bound holds the errors fast, and one of twice the bound lets them go; and the prior itself
TOGETHER: Final = ((10.0, 0.1), (1.0,))
# The same for a cause that is itself a change of a thrust curve, each alone: beside free cells little but its course inside a cell is left of it,
# which true curves have as well. A saw's teeth at their bounds looked like a saturation of 9 standard deviations there.
# Source: geometry: as above, and the prior itself
ALONE: Final = ((10.0,), (1.0,))
# Eigenvalues of the correlation of the directions' noise below this share of the largest are one direction twice.
# Source: geometry: directions that differ by less than a hundredth of their length
SAME: Final = 1e-4
# Steps towards the nearest point, and the relative gap at which they end.
# Source: resource: any step gives a bound, the last ones hardly more
STEPS: Final = 60
GAP: Final = 1e-2
# Weight of the sum of a point's shares, beside which their distance is small.
# Source: geometry: leaves a thousandth of the sum open
WHOLE: Final = 1e3
# Shares below this do not belong to a point.
# Source: definition: rounding of a least-squares solution
NO_SHARE: Final = 1e-12


class Directions:
    """Directions of causes beside any thrust curve.

    Args:
        free: the base beside it.
    """

    def __init__(self, free: AnyCurve) -> None:
        self.free = free
        names, base = free.g.names, free.projection.base
        # Errors at the knots have no bound here: the cells alone make any curve.
        self._errors = (free.box > 0) | np.array([names[k].startswith(("~thrust.", "~hysteresis.")) for k in base])
        self._soft = ~self._errors & (free.g.prior[base] > 0)
        self._beyond = BeyondBox(free)
        self._factors: dict[float, tuple[Array, bool]] = {}

    def left(self, s: Scored) -> float:
        """Fall of chi-squared of a family by its own numbers alone that is as rare as what no declared error inside its bound makes of its scores.

        It may exceed the whole fall: a soft prior takes of a cause what the bound of the same error does not.

        Args:
            s: the family.
        """
        free, soft = self.free, self._soft
        g, columns = free.beside(s)
        physics = s.candidate.effect.acts
        curve = physics.at_thruster and not (physics.late or physics.in_time)
        sets = ALONE if curve else TOGETHER
        base = free.projection.base
        # Errors of the log without the part that the hypothesis holds: the bounds are those of the whole errors.
        score = g.score.sum(axis=0) + g.total @ g.centre
        left = []
        made = [
            np.concatenate([self.direction(g.total, columns, weight) for weight in weights], axis=1) for weights in sets
        ]
        size = np.zeros(len(g.prior))
        size[columns] = np.asarray(s.theta) * g.unit[columns]
        beyond = self._beyond.of(g.total, size)
        made += [beyond[:, None]] if beyond.any() else []
        for D in made:
            moved = D.T @ g.total[:, base]
            # Errors that have a deviation and no bound are noise.
            noise = D.T @ g.total @ D + (moved[:, soft] / g.prior[base][soft]) @ moved[:, soft].T
            length = np.sqrt(np.maximum(np.diag(noise), LEAST))
            values, vectors = np.linalg.eigh(noise / np.outer(length, length))
            kept = values > SAME * values.max()
            root = (vectors[:, kept] / np.sqrt(values[kept])).T / length
            far = distance(free, root @ moved, root @ (D.T @ score))
            left.append(as_rare(s.count, int(kept.sum()), far**2, len(made)))
        return max(left)

    def direction(self, total: Array, columns: Sequence[int], weight: float) -> Array:
        """What least squares leaves of columns, as coefficients of all columns, shape (all, columns).

        Args:
            total: cross-products of all columns, those of the base first.
            columns: of the cause.
            weight: of the priors of thrust errors, and of what has a bound.
        """
        base = self.free.projection.base
        if weight not in self._factors:
            held = self.free.g.prior[base] * np.where(self._errors, weight, 1.0) + RIDGE
            self._factors[weight] = cho_factor(self.free.g.total[np.ix_(base, base)] + np.diag(held))
        D = np.zeros((len(total), len(columns)))
        D[list(columns)] = np.eye(len(columns))
        D[base] = -cho_solve(self._factors[weight], total[np.ix_(base, list(columns))])
        return D


def as_rare(count: int, freedom: int, square: float, times: int = 1) -> float:
    """Chi-squared of some degrees of freedom that is as rare as that of others, of which the best of several counts.

    Args:
        count: degrees of freedom.
        freedom: those of the given one.
        square: the given chi-squared.
        times: number of which it is the best.
    """
    chance = times * float(chdtrc(freedom, square))
    if chance < LEAST:
        # Both grow alike from there on: their ratio nears one.
        return float(square * min(chdtri(count, LEAST) / chdtri(freedom, LEAST / times), 1.0))
    return float(chdtri(count, min(chance, 1.0)))


def distance(free: AnyCurve, moved: Array, z: Array) -> float:
    """Distance of scores from all that declared errors inside their bounds make of them, from below.

    Args:
        free: with the bounds.
        moved: of each score by a unit of each error of the base, shape (scores, base).
        z: the scores, in their own noise, shape (scores,).
    """
    best, towards = 0.0, z
    points = np.zeros((z.size, 0))
    for _ in range(STEPS):
        length = float(np.linalg.norm(towards))
        if length <= best * (1.0 + GAP) or length < NO_SHARE:
            break
        point = moved @ free.worst_errors(moved.T @ towards)
        best = max(best, float(towards @ (z - point)) / length)
        points = np.column_stack([points, point])
        # The nearest point of all means of those that were found.
        shares, _ = nnls(np.vstack([points, np.full(points.shape[1], WHOLE)]), np.r_[z, WHOLE])
        points, shares = points[:, shares > NO_SHARE], shares[shares > NO_SHARE]
        towards = z - points @ shares
    return best
