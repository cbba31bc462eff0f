"""Quality of the channels of a log: held values, gaps, drop-outs and outliers are reported, and none is mended."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.log.record import GAP, Quality, longest_run, median_step, steps_in
from ivsid.memory.order import median
from ivsid.memory.pieces import array_pieces, kept, over_pieces, pieces

Array = NDArray[np.float64]

HOLDABLE: Final = (
    *("u", "v", "r", "udot", "vdot", "rdot", "ax", "ay", "x", "y", "psi"),
    *("velocity_north", "velocity_east"),
)
# Outlier threshold, as a multiple of the median step between samples. Gaussian noise alone exceeds it with the probability 2e-41: its
# median step is 0.95 standard deviations, and the step itself has 1.41.
# Source: theorem: quantiles of the normal distribution
SPIKE: Final = 20.0
# Step before that to a sample, or after that from it, in the same direction and as a share of it, from which on the sample is a corner.
# Source: geometry: between 1, a force that turns round at the sample, and 0, an outlier among equal samples
FLANK: Final = 0.5
# Steps that the median of a channel is taken of.
# Source: resource: bounds the time of the median on long logs
SOME: Final = 100_000
# Smallest share of the runs of a slower sensor that have one of two neighbouring lengths. Repeats by chance, of probability p, give
# 1 - p^2, and at most 1 - (1 - p)^3 for REGULAR: they never pass both.
# Source: theorem: geometric distribution of the lengths of runs
ALIKE: Final = 0.85
# Smallest share of the repeats of a slower sensor that have one of three neighbouring distances.
# Source: theorem: geometric distribution of the lengths of runs, with ALIKE
REGULAR: Final = 0.9
# Share by which two changes may differ and be one step of a coarse scale: a scale is stated in rounded numbers.
# Source: geometry: a step of 0.001 in numbers of seven digits
SAME_CHANGE: Final = 1e-3
# Least line, as a share of the changes, at which they keep the time of a sensor that is slower than the log.
# Source: theorem: times that are rounded up to rows keep sin(pi / p) / (pi / p) of a period of p rows, 0.64 and more, and K changes at any time 1 / sqrt(K)
PERIODIC: Final = 0.5


def without_held(name: str, values: Array) -> tuple[Array, int, str | None]:
    """A channel without the repeats of a zero-order hold, which are no measurements.

    The repeats become missing samples if the channel holds each value as a rule, as a slower sensor in a faster log does.

    Args:
        name: of the channel.
        values: shape (n,); NaN is a missing sample.

    Returns:
        The values, the number of repeats that are missing now, and a note for the user on how equal values are taken, or None.
    """
    if name not in HOLDABLE:
        return values, 0, None
    # Without equal neighbours nothing is held, and this look at them needs no memory.
    if not _repeats(values):
        return values, 0, None
    missing = np.isnan(values)
    there = None if not missing.any() else np.flatnonzero(~missing)
    present = values if there is None else values[there]
    if present.size < 2:
        return values, 0, None
    new = np.empty(present.shape, dtype=bool)
    new[0] = True
    np.not_equal(present[1:], present[:-1], out=new[1:])
    if new.all():
        return values, 0, None
    if not _held(np.flatnonzero(new)):
        return values, 0, None
    if _coarse(present, new):
        return (
            values,
            0,
            f"{name} is on a coarse scale; its equal values are taken as measurements, each at its own row",
        )
    repeats = np.flatnonzero(~new)
    runs = np.diff(np.flatnonzero(new))
    kept = values.copy()
    kept[repeats if there is None else there[repeats]] = np.nan
    if np.median(runs) >= 2:
        note = f"{name} holds each value over {runs.mean():.3g} rows; only the first of each run is a measurement"
    else:
        which = (
            "1 row, which is not taken as a measurement"
            if repeats.size == 1
            else f"{repeats.size} rows, which are not taken as measurements"
        )
        note = f"{name} repeats its value in {which}"
    return kept, int(repeats.size), note


def _repeats(values: Array) -> bool:
    """Whether a sample equals the one before it, missing ones left out."""
    last = np.nan
    for part in pieces(values.size):
        here = values[part]
        here = here[~np.isnan(here)]
        if here.size:
            if here[0] == last or (here[1:] == here[:-1]).any():
                return True
            last = here[-1]
    return False


def _held(first: NDArray[np.intp]) -> bool:
    """Whether runs of equal values, which begin at these samples, are those of a slower sensor.

    Runs of a slower sensor are long as a rule, or have two neighbouring lengths only. With some lost readings and a time at rest, most
    runs have two neighbouring lengths, and repeats come at regular distances. A coarse but live channel repeats by chance, with runs
    of any length or at any distance (``_coarse`` asks where its runs are long). One value for ever is a vehicle at rest.
    """
    runs = np.diff(first)
    if runs.size < 4 or runs.max() < 2:
        return False
    if np.median(runs) >= 2 or runs[1:].max() - runs[1:].min() <= 1:
        return True
    distances = np.diff(first[:-1][runs > 1])
    if distances.size < 8 or _share(runs, 2) < ALIKE:
        return False
    return _share(distances, 3) >= REGULAR


def _coarse(values: Array, new: NDArray[np.bool_]) -> bool:
    """Whether long runs of equal values are those of a live channel that is read on a coarse scale.

    Such a channel leaves one step of its scale for the next, and at any time. A slower sensor passes over steps, or, of a vehicle at rest, changes
    at the time of its readings.

    Args:
        values: shape (n,), without missing ones.
        new: shape (n,), whether a value differs from the one before.
    """
    values, new = values[:SOME], new[:SOME]
    first = np.flatnonzero(new)
    changes = np.abs(np.diff(values[first]))
    if changes.size < 2:
        return False
    step = float(np.median(changes))
    if np.mean(np.abs(changes / step - 1) < SAME_CHANGE) < ALIKE:
        return False
    lines = np.abs(np.fft.rfft(new.astype(np.float64)))
    # A reading that equals the one before makes a run longer, and no run is shorter than a period.
    slowest = min(int(new.size / np.median(np.diff(first))), lines.size - 1)
    return float(lines[slowest:].max()) < PERIODIC * first.size


def _share(lengths: NDArray[np.intp], neighbours: int) -> float:
    """The largest share of the lengths that lie in a window of ``neighbours`` successive values."""
    count = np.bincount(lengths)
    window = np.convolve(count, np.ones(neighbours, dtype=count.dtype))
    return float(window.max() / lengths.size)


@dataclass(frozen=True)
class Steps:
    """The usual and the longest time between two samples [s]."""

    usual: float
    longest: float

    @staticmethod
    def of(t: Array) -> Steps:
        """The steps of a clock [s]; 0 where it has one sample."""
        if t.size < 2:
            return Steps(0.0, 0.0)
        return Steps(median_step(t), max(float(steps_in(t, p).max()) for p in pieces(t.size - 1)))


def examine(
    name: str, t: Array, values: Array, held: int, source: str, steps: Steps | None = None
) -> tuple[Quality, list[str]]:
    """The quality of a channel on its clock, and notes for the user.

    Args:
        name: of the channel.
        t: its clock [s].
        values: on it; NaN is a missing sample.
        held: number of repeats of a zero-order hold, which are missing samples by now.
        source: name of the file, for messages.
        steps: of the clock, where they are known already.

    Raises:
        IvsidError: a channel without any sample.
    """
    gone = array_pieces(values.size, lambda part: np.isnan(values[part]))
    missing = int(np.count_nonzero(gone))
    if missing == values.size:
        raise IvsidError(f"{source}: column {name} has no sample at all; fill it or leave the column out")
    notes = []
    if missing:
        notes.append(f"{name} misses {missing} of {gone.size} samples, at most {longest_run(gone)[0]} in a row")
        there = array_pieces(values.size, lambda part: ~gone[part])
        times, present = kept(t, there), kept(values, there)
    else:
        times, present = t, values
    spikes = _spikes(name, present)
    if spikes.size:
        notes.append(
            f"{name} has {spikes.size} sample{'s' * (spikes.size > 1)} far from both neighbours, the first at t = "
            f"{times[spikes[0]]:.6g} s ({present[spikes[0]]:.4g}); {'they are' if spikes.size > 1 else 'it is'} used as "
            "measured: leave them empty where they are faults"
        )
    mine = Steps.of(times) if missing or steps is None else steps
    quality = Quality(
        samples=present.size,
        rate=1.0 / mine.usual if mine.usual else 0.0,
        missing=missing,
        longest=mine.longest,
        held=held,
        outliers=int(spikes.size),
        first_outlier=float(times[spikes[0]]) if spikes.size else None,
        lower=float(present.min()),
        upper=float(present.max()),
    )
    return quality, notes


def _spikes(name: str, values: Array) -> NDArray[np.intp]:
    """Samples far from both neighbours on the same side. Demands, which may jump, and angles, which wrap, have none."""
    none = np.zeros(0, dtype=np.intp)
    if name.startswith(("demand_", "azimuth_", "rudder_")) or name in ("psi", "wind_direction") or values.size < 8:
        return none
    some = np.arange(0, values.size - 1, 1 + (values.size - 1) // SOME)
    # A part of a long channel gives its median step. A channel of few decimals often repeats its value: then the median is that of the
    # steps that are not zero.
    usual = float(np.median(np.abs(values[some + 1] - values[some])))
    if usual == 0.0:
        size = array_pieces(values.size - 1, lambda part: np.abs(steps_in(values, part)))
        moved = kept(size, array_pieces(size.size, lambda part: size[part] > 0))
        usual = median(moved.size, lambda part: moved[part]) if moved.size else 0.0
    if usual == 0.0:
        return none
    limit = SPIKE * usual

    def alone(part: slice) -> NDArray[np.intp]:
        first, last = max(part.start - 1, 0), min(part.stop + 2, values.size - 1)
        step = steps_in(values, slice(first, last))
        to, off = step[:-1], step[1:]
        far = (np.abs(to) > limit) & (np.abs(off) > limit) & (np.signbit(to) != np.signbit(off)) & ~corners(step)
        # A step beside the part says whether it leads to a corner, and its own sample is another part's.
        found = np.flatnonzero(far) + (first + 1)
        return np.asarray(found[(found > part.start) & (found <= part.stop)], dtype=np.intp)

    return np.concatenate(over_pieces(pieces(values.size - 2), alone))


def corners(step: Array) -> NDArray[np.bool_]:
    """Whether each sample between two steps is a corner, where a force turns round: the step before or after leads to it, shape (steps - 1,).

    Args:
        step: steps from sample to sample, shape (steps,).
    """
    leads = np.signbit(step[1:]) == np.signbit(step[:-1])
    size = np.abs(step)
    found = np.zeros(step.size - 1, dtype=bool)
    found[1:] |= leads[:-1] & (size[:-2] >= FLANK * size[1:-1])
    found[:-1] |= leads[1:] & (size[2:] >= FLANK * size[1:-1])
    return found


def gaps(t: Array) -> list[str]:
    """A note about steps of time that are gaps, where there are any."""
    longest = GAP * median_step(t)
    found = [(int((s > longest).sum()), float(s.max())) for s in (steps_in(t, p) for p in pieces(t.size - 1))]
    count = sum(n for n, _ in found)
    if not count:
        return []
    return [f"{count} gaps in time, the longest {max(most for _, most in found):.3g} s; nothing is filled in"]
