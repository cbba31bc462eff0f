"""Cases of one mechanism: all of them in the nightly run, evenly spaced ones in the gate."""

import os
from collections.abc import Iterable, Sequence
from typing import TypeVar

Case = TypeVar("Case")
# The nightly run draws fresh seeds, and examines every case of the tests that are marked as sampled.
NIGHTLY = "IVSID_SEED" in os.environ


def spaced(cases: Iterable[Case], gate: int) -> Sequence[Case]:
    """All cases in the nightly run; in the gate this many of them, from the first to the last. The test is marked ``sampled``."""
    every = list(cases)
    if NIGHTLY or len(every) <= gate:
        return every
    return [every[round(k * (len(every) - 1) / max(gate - 1, 1))] for k in range(gate)]
