"""Confirmation of findings that are close to their threshold, by simulated null logs.

Null logs are examined until they decide about every finding that is close, and all of them only where doubt is left. They make the threshold
stricter, and never looser.

Source: docs/theory.md, "Null logs"; Clopper and Pearson, "The use of confidence or fiducial limits illustrated in the case of the binomial",
Biometrika 26, 1934.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.cache import keep, kept, key_of
from ivsid.diagnosis.null.calibration import LOOKS, NullTest, null_test, scores, trial_of
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.selection.rivals import Found
from ivsid.effects import own_digest

# Null logs at most, by default: two of them exceed a threshold of 0.5 %.
# Source: resource: a minute on two processors
NULL_LOGS: Final = 400
# A finding is close if it is less strong than this multiple of its threshold, in minus the logarithm of the chance. The null logs of a
# stronger finding would follow a plain model that is far from the motion.
# Source: measured: make constants
CLOSE: Final = 3.0


@dataclass(frozen=True)
class Confirmation:
    """Outcome of the confirmation.

    Attributes:
        test: the test with the stricter threshold.
        nulls: scores of the null logs, or None if no finding was close.
        note: sentence for the notes of the result, or an empty string.
    """

    test: Threshold
    nulls: NullTest | None = None
    note: str = ""

    @property
    def stricter(self) -> bool:
        """Whether null logs made the threshold stricter than the Gaussian draws did."""
        return self.nulls is not None and self.nulls.usable and self.test.calibration.chance < self.nulls.first

    def record(self) -> dict[str, object]:
        """The entry ``calibration`` of result.json."""
        out = self.test.calibration.record()
        if self.nulls is None:
            return out
        said = self.nulls.record()
        return {
            **out,
            "method": f"{out['method']}; null logs of this programme, simulated forward, where a finding is close",
            "achieved": said["achieved"],
            "simulated": {**said, "gaussian_threshold": self.nulls.first},
        }


def strength(test: Threshold, found: Found) -> float:
    """Minus the natural logarithm of the chance of a finding's fall of chi-squared."""
    return -float(np.log(max(test.chance(found.first, found.fall), 1e-300)))


def confirmed(
    fit: Fit,
    test: Threshold,
    found: Sequence[Found],
    seed: int,
    most: int,
    folder: Path | None,
    progress: Callable[[str], None] = lambda _: None,
) -> Confirmation:
    """Confirms the findings that are close to the threshold.

    Args:
        fit: of the plain model.
        test: with the threshold of the Gaussian draws.
        found: causes that passed the test.
        seed: of the null logs.
        most: null logs at most; 0 leaves the threshold of the Gaussian draws.
        folder: of the cache, or None.
        progress: told of the null logs that are done.
    """
    asked = -float(np.log(test.calibration.chance))
    near = [s for s in (strength(test, f) for f in found) if s < CLOSE * asked]
    if not near or most <= 0:
        return Confirmation(test)
    if own_digest() is None:
        # An effect that was registered without a file has no digest: the cache could not tell it from another of the same id.
        folder = None
    key = (
        ""
        if folder is None
        else key_of(
            fit.noise.predictor.vehicle,
            fit.noise.predictor.log,
            seed,
            test.calibration.level,
            test.visible,
            test.calibration.chance,
        )
    )
    known = None if folder is None else kept(folder, key, test.calibration.level)
    nulls = NullTest(np.zeros(0), np.zeros(0, dtype=bool), test.calibration.level) if known is None else known
    before = nulls.strengths.size
    looks = sorted({*(count for count in LOOKS if count < most), most})
    level = test.calibration.level
    more: Generator[tuple[float, bool]] | None = None
    try:
        for count in looks:
            start = nulls.strengths.size
            if start < count:
                if more is None:
                    progress(f"null logs {start} of {most}")
                    more = scores(trial_of(fit, test, seed), seed, range(start, most))
                every = []
                for one in islice(more, count - start):
                    every.append(one)
                    progress(f"null logs {start + len(every)} of {most}")
                nulls = nulls.joined(null_test(every, level))
            used = nulls.first_of(count)
            if not used.usable or all(used.decides(s, len(looks)) for s in near):
                break
    finally:
        if more is not None:
            more.close()
    if folder is not None and nulls.strengths.size > before:
        keep(folder, key, nulls)
    used = replace(used, cached=min(before, used.strengths.size), first=test.calibration.chance)
    if not used.usable:
        return Confirmation(test, used, "null logs of this programme leave its motion: the Gaussian draws stand alone")
    chance = min(test.calibration.chance, float(np.exp(-used.threshold())))
    return Confirmation(replace(test, calibration=replace(test.calibration, chance=chance)), used)
