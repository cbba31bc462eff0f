"""Sequential looks at null logs: they are examined until they decide, and their scores are kept.

Source: docs/theory.md, "Confirmation".
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from ivsid.diagnosis.null.cache import keep, kept
from ivsid.diagnosis.null.calibration import LOOKS, Trial, scores
from ivsid.diagnosis.null.tail import NullTest, null_test
from ivsid.effects import own_digest


@dataclass(frozen=True)
class Looks:
    """Null logs that may be looked at.

    Attributes:
        seed: of the null logs.
        most: null logs at most; 0 leaves the threshold of theory.
        folder: of the cache, or None.
        progress: told of the null logs that are done.
    """

    seed: int
    most: int
    folder: Path | None = None
    progress: Callable[[str], None] = lambda _: None

    def decided(
        self, trial: Callable[[], Trial], key_of_trial: Callable[[], str], none: NullTest, near: Sequence[float]
    ) -> NullTest:
        """Scores of as many null logs as it takes to decide about all strengths that are close to their threshold.

        Args:
            trial: makes the null logs and their examination, if any have to be simulated.
            key_of_trial: makes the key of the cache, if there is one.
            none: without any scores, with the level and the first threshold.
            near: strengths that are close.
        """
        # An effect that was registered without a file has no digest: the cache could not tell it from another of the same id.
        folder = None if own_digest() is None else self.folder
        key = "" if folder is None else key_of_trial()
        known = None if folder is None else kept(folder, key, none.level)
        nulls = used = none if known is None else replace(known, first=none.first)
        before = nulls.strengths.size
        looks = sorted({*(count for count in LOOKS if count < self.most), self.most})
        more: Generator[tuple[float, bool]] | None = None
        try:
            for count in looks:
                start = nulls.strengths.size
                # The whole of a step is that of its look: few findings ask for the last one.
                doubt = "" if count == looks[-1] else f": {self.most} at most, where these leave doubt"
                if start < count:
                    self.progress(f"null logs {start} of {count}{doubt}")
                    if more is None:
                        more = scores(trial(), self.seed, range(start, self.most))
                    every = []
                    for one in islice(more, count - start):
                        every.append(one)
                        self.progress(f"null logs {start + len(every)} of {count}{doubt}")
                    nulls = nulls.joined(null_test(every, none.level))
                used = nulls.first_of(count)
                if not used.usable or all(used.decides(s, len(looks)) for s in near):
                    break
        finally:
            if more is not None:
                more.close()
        if folder is not None and nulls.strengths.size > before:
            keep(folder, key, nulls)
        return replace(used, cached=min(before, used.strengths.size))
