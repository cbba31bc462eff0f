"""How far each regressor of the dictionary stands out of a log.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import beyond
from ivsid.diagnosis.null.frequencies import Scatter, as_rare

Array = NDArray[np.float64]
# Information of a regressor in unit length below which the model explains it.
# Source: measured: make constants
EXPLAINED: Final = 1e-6


@dataclass(frozen=True)
class Standing:
    """Scores of regressors beside a base.

    Attributes:
        real: whether the model leaves anything of each, shape (regressors,).
        information: of all together, with the scatter of the noise, shape (regressors, regressors).
        length: roots of its diagonal, shape (regressors,).
        scores: in standard deviations, shape (regressors,).
        moved: how far each error inside the box moves them, shape (base, regressors).
        falls: of chi-squared by each alone, at the least, shape (regressors,).
    """

    real: NDArray[np.bool_]
    information: Array
    length: Array
    scores: Array
    moved: Array
    falls: Array

    @classmethod
    def of(cls, p: Projection, at: Sequence[int], most: Callable[[Array], Array], more: Scatter | None = None) -> Self:
        """Scores of regressors beside a base.

        Args:
            p: least squares on the base.
            at: indices of the regressors.
            most: what declared errors move sums by at most, from what a unit of each moves them by.
            more: how the scores scatter beyond what they do in white noise.
        """
        columns = list(at)
        H = p.information(columns)
        real = np.diag(H) > EXPLAINED
        if more is not None:
            H = H + more.more
        d = np.sqrt(np.maximum(np.diag(H), 1e-300))
        scores = np.where(real, p.left_score[columns] / d, 0.0)
        moved = p.held_back(columns) / d
        worst = most(moved)
        falls = np.array([beyond(float(s * s), float(abs(s) * w)) for s, w in zip(scores, worst, strict=True)])
        if more is not None:
            falls = as_rare(falls, 1, more.freedom)
        return cls(real, H, d, scores, moved, falls)
