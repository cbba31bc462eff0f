"""Whether two logs hold samples of one run: what the second says of the first is then no evidence of its own."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.log import Log

# Rows of the shorter log that are looked for in the other one, about.
# Source: resource: a share is known to three hundredths
LOOKED_FOR: Final = 1000
# Share of its rows from which on two logs are one run.
# Source: definition: a tenth; two runs of a simulation without noise may begin alike
ONE_RUN: Final = 0.1
# Different rows of a log from which on those in common say anything.
# Source: definition: a log at rest has one or a few, which any run may hold
FEWEST: Final = 20
# Odd multiplier that mixes the bits of a row's columns.
# Source: definition: the fraction of the golden ratio in 64 bits (Knuth, The Art of Computer Programming 3, section 6.4)
MIXED: Final = np.uint64(0x9E3779B97F4A7C15)


def shared_rows(train: Log, test: Log) -> float:
    """Share of the shorter log's different rows that stand in the other one, by all columns that both have and whatever the zero of its clock.

    A row that comes again, of a vehicle at rest or of a reading that is held, counts once: any run may hold it.

    Args:
        train: a log.
        test: another.
    """
    columns = sorted(train.columns.keys() & test.columns.keys())
    if not columns:
        return 0.0
    rows = [_rows(log, columns) for log in (train, test)]
    # A row that is looked at in one log is looked at in the other, since its own number says so.
    every = max(min(x.size for x in rows) // LOOKED_FOR, 1)
    one, other = (np.unique(x[x % every == 0]) for x in rows)
    few = min(one.size, other.size)
    return np.intersect1d(one, other, assume_unique=True).size / few if few >= FEWEST else 0.0


def one_run(train: Log, test: Log) -> bool:
    """Whether two logs hold samples of one run."""
    return shared_rows(train, test) >= ONE_RUN


def note(train: Log, test: Log) -> str:
    """A sentence where two logs hold samples of one run, or nothing."""
    share = shared_rows(train, test)
    if share < ONE_RUN:
        return ""
    if train.same_samples(test):
        said = f"{test.name} has the same samples as {train.name}"
    else:
        said = f"{test.name} and {train.name} have {100 * share:.0f} % of the shorter one's rows in common"
    return f"{said}: what the extended model gains on it proves nothing, and no cause is asked of it; give a log of another run"


def _rows(log: Log, columns: list[str]) -> NDArray[np.uint64]:
    """A number of each row that depends on every bit of its samples, shape (n,)."""
    found = np.zeros(log.t.size, dtype=np.uint64)
    for name in columns:
        # Both zeros are one.
        bits = (np.ascontiguousarray(log.columns[name], dtype=np.float64) + 0.0).view(np.uint64)
        found = (found ^ bits) * MIXED
        found ^= found >> np.uint64(29)
    return found
