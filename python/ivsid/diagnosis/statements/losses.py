"""Losses on the other log: quantities in which the extended model is worse than the plain one by more than chance.

Both models are simulated over the same windows, so that each window gives a pair of errors. Without a loss the logarithm of their ratio
is as often above zero as below it by as much. Seven quantities are tested at once.

Source: Wilcoxon, "Individual comparisons by ranking methods", Biometrics Bulletin 1, 1945; Holm, "A simple sequentially rejective multiple
test procedure", Scandinavian Journal of Statistics 6, 1979.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

Array = NDArray[np.float64]
# Chance of calling any quantity worse on a log where none is.
# Source: definition: the level of a whole verdict
LEVEL: Final = 0.01
# Factor of an error, in the mean of its logarithm, below which a loss is none.
# Source: definition: nobody acts on a simulation that is worse by a fiftieth
MATERIAL: Final = 1.02
# Least error that is compared, in any unit.
# Source: definition: keeps logarithms finite
LEAST: Final = 1e-12
# Numbers up to which the distribution of their signed ranks is counted out.
# Source: resource: the counts are quadratic in them, and the normal distribution is true to 1e-3 beyond
EXACT: Final = 50
# Largest error that is compared, in any unit.
# Source: definition: keeps logarithms finite
MOST: Final = 1e12


def gains(pairs: Mapping[str, tuple[Array, Array]]) -> dict[str, float]:
    """Quantities that are better, with the chance of such ranks without a gain: the losses of the two models the other way round."""
    return losses({name: (after, before) for name, (before, after) in pairs.items()})


def losses(pairs: Mapping[str, tuple[Array, Array]]) -> dict[str, float]:
    """Quantities that are worse, with the chance of such ranks without a loss.

    Args:
        pairs: errors before and after in the same windows, each of shape (windows,), by quantity.
    """
    chances = {name: _chance(*pair) for name, pair in pairs.items()}
    found = {}
    for rank, (name, chance) in enumerate(sorted(chances.items(), key=lambda c: c[1])):
        if chance * (len(chances) - rank) > LEVEL:
            break
        found[name] = chance
    return found


def _chance(before: Array, after: Array) -> float:
    """Chance of ranks like these, or clearer ones, if errors after are no larger."""
    # A model that runs away has no error: it is worse than any that has one.
    after, before = (np.clip(np.nan_to_num(x, nan=MOST, posinf=MOST), LEAST, MOST) for x in (after, before))
    ratio = np.log(after / before)
    if not ratio.size or ratio.mean() < np.log(MATERIAL):
        return 1.0
    return signed_ranks(ratio[ratio != 0.0])


def signed_ranks(x: Array) -> float:
    """Chance that the ranks of the positive of some numbers sum to as much as here, or more, if each is as likely positive as negative.

    Exact for up to EXACT numbers without ties, by the normal distribution with a correction for continuity and for ties else.

    Args:
        x: none of them zero, shape (n,).
    """
    n, size = x.size, np.abs(x)
    order, of = np.unique(size, return_inverse=True)
    ties = np.bincount(of, minlength=order.size)
    rank = (np.cumsum(ties) - (ties - 1) / 2)[of]
    positive = float(rank[x > 0].sum())
    if n <= EXACT and (ties == 1).all():
        ways = np.ones(1)
        for k in range(1, n + 1):
            # Each further rank is among the positive, or it is not.
            ways = 0.5 * (np.r_[ways, np.zeros(k)] + np.r_[np.zeros(k), ways])
        return float(ways[round(positive) :].sum())
    variance = n * (n + 1) * (2 * n + 1) / 24 - float((ties**3 - ties).sum()) / 48
    return float(ndtr(-(positive - n * (n + 1) / 4 - 0.5) / np.sqrt(variance)))
