"""The checked log, and what is known of the quality of its channels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError

# A needed channel may be slow or drop out, but not be away for most of the log.
LIMIT_MISSING: Final = 0.5
# A step this much longer than the usual one is a gap.
GAP: Final = 2.5


@dataclass(frozen=True)
class Clock:
    """The samples behind a channel that came from another clock than the rows: how many, and the shortest step [s]."""

    samples: int
    interval: float


@dataclass(frozen=True)
class Sweep:
    """Between which readings a channel stood over each step from a row to the next, whatever the log has between the two.

    Attributes:
        lower: shape (n - 1,), rounding and decimals included; NaN where it is not known.
        upper: shape (n - 1,).
        assumes: what that rests on.
    """

    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    assumes: str


@dataclass(frozen=True)
class Quality:
    """What is known of one channel; nothing here was changed in the data.

    Attributes:
        samples: measurements, without held repeats and missing cells.
        rate: the usual number of measurements a second [Hz].
        missing: rows without a measurement, held repeats included.
        longest: the longest time between two measurements [s].
        held: rows that only repeat the measurement before.
        outliers: measurements that stand out from both neighbours far more than the channel's usual step.
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


@dataclass(frozen=True)
class Log:
    """A checked log.

    Attributes:
        name: of the file.
        sha256: hash of its bytes.
        t: times [s], strictly increasing, shape (n,); from the first row where the file's are epochs or not in seconds.
        columns: the contract's columns, shape (n,) each; NaN is a missing sample.
        ignored: names of columns that were not understood.
        notes: sentences about what is missing, held or uneven; never silently mended.
        rounding: how far a value may be from the sensor's, beside the reading of its decimals: what a conversion lost, what
            the channel can have moved between its samples, between which demands a demand changed within its row; shape (n,).
        time_rounding: the same for the times [s].
        assumes: sentences that the values rely on, where channels came from several clocks.
        derived: channels that were computed, with those that they were computed from.
        clocks: of channels that came from another clock than the rows.
        quality: by channel, as the file has it.
        over: forces and the angles of thrusters over the steps from row to row, where the log has more than the rows tell.
        by_rate: channels whose ``rounding`` is what the quantity itself, not its reading, can have moved under a stated rate.
        certain: of angles that were followed through whole turns, the error of a reading [rad] below which that is sure.
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
    over: Mapping[str, Sweep] = field(default_factory=dict)
    by_rate: tuple[str, ...] = ()
    certain: Mapping[str, float] = field(default_factory=dict)

    @property
    def period(self) -> float:
        """The median step of time [s]."""
        return float(np.median(np.diff(self.t)))

    @property
    def time_error(self) -> float:
        """How far a time may be from what its decimals say [s]."""
        return float(np.spacing(np.abs(self.t).max())) + self.time_rounding

    def error(self, name: str, rows: slice = slice(None)) -> NDArray[np.float64]:
        """How far each value of a column may be from what its decimals say; 0 where it is missing. Of some rows, or of all."""
        values = self.columns[name][rows]
        lost: NDArray[np.float64] = np.spacing(np.abs(np.where(np.isnan(values), 0.0, values)))
        if name in self.rounding:
            lost = lost + np.nan_to_num(self.rounding[name][rows])
        return lost

    def column(self, name: str, why: str) -> NDArray[np.float64]:
        """A column that is needed, or one sentence that says so."""
        if name not in self.columns:
            has = ", ".join(self.columns) or "none that is known"
            raise IvsidError(
                f"{self.name} has no column {name}, which is needed {why}; it has {has}: "
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


def longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Length and start of the longest stretch of true values; (0, 0) where there is none."""
    edges = np.flatnonzero(np.diff(np.r_[0, flags.astype(np.int8), 0]))
    if not edges.size:
        return 0, 0
    lengths = edges[1::2] - edges[::2]
    longest = int(np.argmax(lengths))
    return int(lengths[longest]), int(edges[2 * longest])
