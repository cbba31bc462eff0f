"""Share of the simulation's error in position that a cause explains, on the other log.

Both models start from the measured state and run freely for a minute. The model without a cause is fitted again, so that the other numbers
take what they can of it.

The interval is Student's, of the mean logarithm of the ratio over parts of two minutes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.statements.windows import RUNAWAY, drift
from ivsid.diagnosis.statements.without import without

Array = NDArray[np.float64]
# Length of a free run [s].
# Source: definition: the key ``after`` of result.json
AFTER: Final = 60.0
# Time whose runs count as one draw [s]: a run reaches a minute beyond its start, so that every other minute is free of the one before.
# Source: definition: two free runs
TOGETHER: Final = 120.0
# Draws from which a share is told.
# Source: definition: fewer than two have no scatter
FEWEST: Final = 2
# Time between the starts of two free runs [s].
# Source: resource: runs that overlap cost memory, and their steps are shared
APART: Final = 10.0


# Least distance [m].
# Source: definition: keeps logarithms finite
LEAST: Final = 1e-9
# Probability with which the interval of a share holds it.
# Source: definition: equal tails of 2.5 %
HELD: Final = 0.95


@dataclass(frozen=True)
class Share:
    """Error in position with and without a cause.

    Attributes:
        without: usual distance after a minute of the model without the cause [m]: geometric mean over two-minute parts of their medians.
        held: the same of the extended model [m].
        interval: 95 % interval of the share of the squared distance that the cause explains, by the scatter of
            two-minute parts.
    """

    without: float
    held: float
    interval: tuple[float, float]

    @property
    def share(self) -> float:
        """Share of the squared distance that the cause explains; negative where the model without it runs closer."""
        return 1.0 - (self.held / max(self.without, 1e-300)) ** 2

    @property
    def told(self) -> bool:
        """Whether the log tells that the share is not zero."""
        return not self.interval[0] <= 0.0 <= self.interval[1]

    def record(self) -> dict[str, object]:
        """The entry ``matters`` of a finding in result.json."""
        return {
            "after": AFTER,
            "distance_without": self.without,
            "distance_with": self.held,
            "share": self.share,
            "interval": list(self.interval),
        }


def shares(
    predictor: Predictor, plain: Fit, last: Fit, ids: Sequence[str], out: Sequence[str] = ()
) -> Mapping[str, Share]:
    """Shares of causes, by id; none without a position and a heading, or where the log is too short.

    Args:
        predictor: of the other log.
        plain: fit of the model without causes.
        last: fit with every cause that was found.
        ids: of the causes.
        out: causes that were found and that the extended model leaves out.
    """
    log = predictor.log
    if not ids or log.place is None or log.psi is None:
        return {}
    held = _off(predictor, without(plain, last, out).h)
    count = held.size
    if count < FEWEST:
        return {}
    found = {}
    for id_ in (i for i in ids if i not in out):
        bare = _off(predictor, without(plain, last, (id_, *out)).h)
        # A run that diverges is off by no distance that could be shared.
        if max(float(bare.max()), float(held.max())) >= RUNAWAY:
            continue
        logs = np.log(held / bare)
        reach = float(stdtrit(count - 1, 0.5 + 0.5 * HELD)) * float(np.std(logs, ddof=1)) / np.sqrt(count)
        ends = 1.0 - np.exp(2.0 * (float(logs.mean()) + np.array([reach, -reach])))
        found[id_] = Share(_middle(bare), _middle(held), (float(ends[0]), float(ends[1])))
    return found


def _middle(off: Array) -> float:
    """Geometric mean of the distances of the parts [m]: one stretch where every model runs away does not decide."""
    return float(np.exp(np.mean(np.log(off))))


def _off(predictor: Predictor, h: Hypothesis) -> Array:
    """Median distance after free runs on a log, by part of ``TOGETHER`` [m]; the last part that is not full is left out."""
    # Errors of TRAIN's sensors and thrusters are no part of the model.
    bare = replace(h, declared_errors={})
    states = predictor.settle(predictor.start(bare), 2)
    off = drift(predictor, states, AFTER, APART)
    runs = round(TOGETHER / APART)
    parts = off[: off.size // runs * runs].reshape(-1, runs)
    return np.asarray(np.maximum(np.median(parts, axis=1), LEAST))
