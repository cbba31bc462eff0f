"""Examinations: what is asked of a null log, as it was asked of the log itself."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from ivsid.diagnosis.candidates.families import score
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.round import Round


class Examination(Protocol):
    """What is asked of a null log.

    Attributes:
        level: probability with which a null log may exceed the threshold.
        surveyed: ids of the effects whose signatures are needed.
    """

    @property
    def level(self) -> float:
        """Probability with which a null log may exceed the threshold."""

    @property
    def surveyed(self) -> frozenset[str]:
        """Ids of the effects whose signatures are needed."""

    def __call__(self, fit: Fit) -> tuple[float, bool]:
        """The largest strength in a fitted null log, minus the natural logarithm of a chance, and whether it passed the first threshold."""


@dataclass(frozen=True)
class Families:
    """The test of all families.

    Attributes:
        test: with the threshold of the Gaussian draws.
    """

    test: Threshold

    @property
    def level(self) -> float:
        """Probability of any false finding."""
        return self.test.calibration.level

    @property
    def surveyed(self) -> frozenset[str]:
        """Ids of the tested families."""
        return self.test.visible

    def __call__(self, fit: Fit) -> tuple[float, bool]:
        """The strength of the strongest family, and whether one passed the test."""
        tested = tuple(c for c in fit.candidates if c.variants and c.id in self.test.visible)
        fit, scored = score(replace(fit, candidates=tested))
        real = [s for s in scored if s.physical]
        # As in the test of the log, what is below the threshold has to stand beside any thrust curve inside its accuracy.
        here = Round(fit, scored, self.test.calibration.chance, self.test.seen)
        chances = [s.chance if s.chance > here.chance else replace(s, fall=here.left(s)).chance for s in real]
        strength = -float(np.log(max(min(chances, default=1.0), 1e-300)))
        return strength, bool(self.test.screened(here).passed)
