"""The checked log, and the quality of its channels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.display.shown import Result
from ivsid.display.table import Cells
from ivsid.errors import IvsidError, meant
from ivsid.memory.order import median
from ivsid.memory.pieces import array_pieces

# Largest share of a log that a needed channel may be missing in a row.
# Source: definition: a channel that is away longer is missing for most of the log
LIMIT_MISSING: Final = 0.5
# Smallest gap, as a multiple of the usual step: one lost sample makes a step of 2, two lost samples make a step of 3.
# Source: definition: one lost sample is bridged, two are not
GAP: Final = 2.5


@dataclass(frozen=True)
class Clock:
    """The own clock of a channel that came from another clock than the rows.

    Attributes:
        samples: number of its samples.
        interval: the shortest step between them [s].
    """

    samples: int
    interval: float


@dataclass(frozen=True)
class StepRange:
    """The range of a channel's readings over each step from a row to the next, samples between the two included.

    Attributes:
        lower: shape (n - 1,), rounding and decimals included; NaN where it is not known.
        upper: shape (n - 1,).
        assumes: a sentence that the range relies on.
    """

    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    assumes: str


@dataclass(frozen=True)
class Quality:
    """Quality of one channel as the file has it.

    Attributes:
        samples: number of measurements, without the repeats of held values and missing cells.
        rate: the usual number of measurements a second [Hz].
        missing: rows without a measurement, the repeats of held values included.
        longest: the longest time between two measurements [s].
        held: rows that repeat the measurement before them under a zero-order hold.
        outliers: measurements further from both neighbours than ``quality.SPIKE`` times the usual step.
        first_outlier: time of the first of them [s], or None.
        lower: smallest value.
        upper: largest value.
    """

    samples: int
    rate: float
    missing: int
    longest: float
    held: int
    outliers: int
    first_outlier: float | None
    lower: float
    upper: float


@dataclass(frozen=True, repr=False)
class Log(Result):
    """A checked log.

    Attributes:
        name: of the file.
        sha256: SHA-256 of its bytes; of a file that was read in parts, ``parts:`` and the hash of those.
        t: times [s], strictly increasing, shape (n,); from the first row where the file's are epochs or not in seconds.
        columns: channels by name, shape (n,) each; NaN is a missing sample.
        ignored: names of columns that no channel uses.
        notes: sentences about missing, held or uneven samples, none of which is mended.
        rounding: bounds on the errors of values beside the rounding of their decimals, by channel, shape (n,). They hold the error of
            a conversion, the change between samples under a stated rate, and the range of a demand within its row.
        time_rounding: the same for the times [s].
        assumes: sentences that the values rely on, where channels came from several clocks.
        derived: computed channels, with the channels that they were computed from.
        clocks: of channels that came from another clock than the rows.
        quality: by channel, as the file has it.
        over: ranges of forces and of thrusters' angles over the steps from row to row, where the log has samples between the rows.
        by_rate: channels whose ``rounding`` bounds the change of the quantity itself, not of its reading, under a stated rate.
        certain: of angles that were followed through whole turns, the reading error [rad] below which the turns are certain.
        began: the first stamp [s since 1970], to order logs by date; None where the stamps are no dates.
    """

    name: str
    sha256: str
    t: NDArray[np.float64]
    columns: Mapping[str, NDArray[np.float64]]
    ignored: tuple[str, ...] = ()
    notes: tuple[str, ...] = field(default=())
    rounding: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    time_rounding: float = 0.0
    assumes: tuple[str, ...] = ()
    derived: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    clocks: Mapping[str, Clock] = field(default_factory=dict)
    quality: Mapping[str, Quality] = field(default_factory=dict)
    over: Mapping[str, StepRange] = field(default_factory=dict)
    by_rate: tuple[str, ...] = ()
    certain: Mapping[str, float] = field(default_factory=dict)
    began: float | None = None

    def _heading(self) -> str:
        return f"{self.name}: {self.t.size} rows over {self.t[-1] - self.t[0]:.6g} s, median step {self.period:.4g} s"

    def _cells(self) -> Cells:
        kept = {n: x[~np.isnan(x)] for n, x in self.columns.items()}
        return {
            "channel": list(kept),
            "missing": [self.t.size - x.size for x in kept.values()],
            "smallest": [float(x.min()) if x.size else None for x in kept.values()],
            "largest": [float(x.max()) if x.size else None for x in kept.values()],
        }

    def _columns(self) -> Mapping[str, object]:
        return {"t": self.t, **self.columns}

    @cached_property
    def period(self) -> float:
        """The median step of time [s]."""
        return median_step(self.t)

    @property
    def time_error(self) -> float:
        """Bound on the distance of a time from its decimals [s]."""
        return float(np.spacing(max(abs(self.t[0]), abs(self.t[-1])))) + self.time_rounding

    def same_samples(self, other: Log) -> bool:
        """Whether another log has the same samples, whatever its file and the zero of its clock."""
        shared = self.columns.keys() & other.columns.keys()
        return (
            self.t.size == other.t.size
            and bool(shared)
            and all(np.array_equal(self.columns[c], other.columns[c], equal_nan=True) for c in sorted(shared))
        )

    def error(self, name: str, rows: slice | None = None) -> NDArray[np.float64]:
        """Bound on the distance of each value of a column from its decimals and conversions.

        Args:
            name: of the column.
            rows: all by default.

        Returns:
            In the unit of the column, one for each row; that of 0 where the value is missing.
        """
        if rows is None:
            return array_pieces(self.t.size, partial(self.error, name))
        values = self.columns[name][rows]
        lost: NDArray[np.float64] = np.spacing(np.abs(np.where(np.isnan(values), 0.0, values)))
        if name in self.rounding:
            lost = lost + np.nan_to_num(self.rounding[name][rows])
        return lost

    def column(self, name: str, why: str) -> NDArray[np.float64]:
        """A column that is needed.

        Args:
            name: of the column.
            why: its purpose, for messages: "by the equations of motion".

        Returns:
            Shape (n,); NaN is a missing sample.

        Raises:
            IvsidError: the log has no such column, or it is missing for more than half of the log in a row.
        """
        if name not in self.columns:
            has = ", ".join(self.columns) or "none that is known"
            raise IvsidError(
                f"{self.name} has no column {name}, which is needed {why}; {meant(name, [*self.columns, *self.ignored])}it has {has}: "
                "add it, or map it under [log] in the vehicle file"
            )
        values = self.columns[name]
        longest, at = longest_run(np.isnan(values))
        if longest > LIMIT_MISSING * values.size:
            raise IvsidError(
                f"{self.name}: column {name} misses {longest} samples in a row from t = {self.t[at]:.6g} s, more than half of the "
                f"log, and is needed {why}; cut the log to the part that has it, or give another log"
            )
        return values


def steps_in(t: NDArray[np.float64], part: slice) -> NDArray[np.float64]:
    """The steps from row to row of a part of all steps."""
    return np.diff(t[part.start : part.stop + 1])


def median_step(t: NDArray[np.float64]) -> float:
    """The median step [s] of a clock with at least two samples."""
    return median(t.size - 1, partial(steps_in, t))


def longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Length and start of the longest stretch of true values; (0, 0) where there is none."""
    if not flags.any():
        return 0, 0
    edges = np.flatnonzero(np.diff(np.r_[0, flags.astype(np.int8), 0]))
    if not edges.size:
        return 0, 0
    lengths = edges[1::2] - edges[::2]
    longest = int(np.argmax(lengths))
    return int(lengths[longest]), int(edges[2 * longest])
