"""Bounds of the sensors and limits of the motion: from a still stretch of the logs, or guesses from their scatter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.proposal.found import Found
from ivsid.sensors.allan import MINIMUM_SAMPLES, allan_deviation

Array = NDArray[np.float64]

# Shortest stretch at rest that noise is fitted to [s].
# Source: resource: a stretch of half a minute shows the noise of a sample, and little of a bias
SHORTEST: Final = 30.0
# Largest speed or yaw rate of a vessel at rest, as a share of the largest one of the logs.
# Source: definition: a guess that the proposed file calls one
REST: Final = 0.05
# Bounds as a multiple of the scatter: 5.2 standard deviations bound 6000 Gaussian errors with a probability of 0.999.
# Source: theorem: union bound over Gaussian errors
SIGMAS: Final = 5.2
# Bias instability where no still stretch shows one, as a share of the scatter of a sample.
# Source: definition: a guess that the proposed file calls one
BIAS: Final = 0.1
# Limits as a multiple of the largest value seen.
# Source: definition: a guess that the proposed file calls one
MARGIN: Final = 1.5
# Time over which speeds are averaged before their changes count as accelerations [s].
# Source: physics: a second of averaging takes most of the noise out, and little of the motion of a vessel
SPAN: Final = 1.0
# Bound of a channel that shows no scatter, as a share of its range: it is held, rounded or smoothed.
# Source: definition: a guess that the proposed file calls one
UNSEEN: Final = 0.01
# Standard deviation of second differences of white noise, as a multiple of its own.
# Source: theorem: 1 + 4 + 1 variances
SECOND: Final = 6.0**0.5
# Median of the absolute value of a Gaussian variable, as a multiple of its standard deviation.
# Source: theorem: quantile 3/4 of the normal distribution
MEDIAN: Final = 0.6745

# Least proposed bounds of angles [rad]: filters smooth them until no scatter is left, and their constant errors stay.
# Source: physics: a good compass is off by half a degree, a level by a quarter
LEAST: Final = {"heading": 0.009, "attitude": 0.0045}

# The reason of a bound that no reading shows.
NO_SCATTER: Final = "a guess: a hundredth of the range, since the readings show no scatter"

VELOCITIES: Final = ("u", "v", "velocity_north", "velocity_east")
# The channels of each sensor that has one bound.
BOUNDED: Final = {
    "velocity": VELOCITIES,
    "heading": ("psi",),
    "position": ("x", "y"),
    "attitude": ("roll", "pitch", "qw", "qx", "qy", "qz"),
    "yaw_acceleration": ("rdot",),
    "force": ("force_X", "force_Y"),
    "moment": ("moment_N",),
}
INERTIAL: Final = {"acceleration": ("ax", "ay", "udot", "vdot"), "yaw_rate": ("r",)}


@dataclass(frozen=True)
class Stretch:
    """A stretch of a log at rest: the number of the log, and its first and last time [s]."""

    log: int
    first: float
    last: float


@dataclass(frozen=True)
class Number:
    """A proposed number with its key and its reason."""

    key: str
    value: float
    reason: str


@dataclass(frozen=True)
class Run:
    """The channels and demands of one log."""

    name: str
    channels: Mapping[str, Found]
    demands: Mapping[str, Found]


def sensors_of(runs: Sequence[Run]) -> tuple[dict[str, list[Number]], Stretch | None]:
    """Numbers for each section below ``[sensors]``, limits included, and the still stretch behind them."""
    still = still_stretch(runs)
    sections: dict[str, list[Number]] = {}
    for sensor, names in BOUNDED.items():
        seen = [scatter(r.channels[n]) for r in runs for n in names if n in r.channels]
        if sensor == "heading" and not seen:
            seen = [2 * scatter(r.channels[n]) for r in runs for n in BOUNDED["attitude"][2:] if n in r.channels]
        if seen and max(seen) > 0:
            value = _up(SIGMAS * max(seen))
            reason = "a guess: 5.2 times the scatter from sample to sample, which shows no constant error"
            if value < LEAST.get(sensor, 0.0):
                reason = f"a guess: the constant error of a good sensor; the scatter from sample to sample, times 5.2, is {value:g}"
                value = LEAST[sensor]
            sections[sensor] = [Number("accuracy", value, reason)]
        elif (wide := _range(runs, names)) > 0:
            sections[sensor] = [Number("accuracy", _up(UNSEEN * wide), NO_SCATTER)]
    for sensor, names in INERTIAL.items():
        numbers = _inertial(runs, names, still)
        if numbers:
            sections[sensor] = numbers
    limits = _limits(runs)
    if limits:
        sections["limits"] = limits
    return sections, still


def unbounded(runs: Sequence[Run], sections: Mapping[str, list[Number]], still: Stretch | None) -> list[str]:
    """Sentences on bounds that the logs do not show: what is assumed in their place, and how to state them."""
    words = []
    for sensor, names in {**BOUNDED, **INERTIAL}.items():
        there = list(dict.fromkeys(r.channels[n].match.column for r in runs for n in names if n in r.channels))
        keys = "random_walk and bias_instability" if sensor in INERTIAL else "accuracy"
        if there and sensor not in sections:
            words.append(
                f"{', '.join(there)} never changes, so no bound of it is proposed: write {keys} under [sensors.{sensor}] from the sensor's data sheet, or leave the column out"
            )
        elif there and any(n.reason == NO_SCATTER for n in sections[sensor]):
            words.append(
                f"{', '.join(there)} shows no scatter, so a hundredth of its range is assumed as its bound: write {keys} under [sensors.{sensor}] from the sensor's data sheet"
            )
    guessed = [s for s in INERTIAL if s in sections]
    if still is None and guessed:
        words.append(
            f"no log rests for {SHORTEST:g} s, so the noise of {' and '.join(guessed)} is a guess from its scatter, and its bias a tenth of that: give a log at rest beside "
            "these (ivsid init RUN DECK), or the numbers of `ivsid allan`"
        )
    constant = [s for s in BOUNDED if s in sections and s not in ("heading", "attitude")]
    if constant:
        words.append(
            f"the bounds of {' and '.join(constant)} come from the scatter, and assume no constant error: add the sensor's own under [sensors.{constant[0]}]"
            + (", and so on" if len(constant) > 1 else "")
        )
    return words


def _range(runs: Sequence[Run], names: Sequence[str]) -> float:
    """The largest range of the channels [SI]; 0 where none changes."""
    seen = [r.channels[n] for r in runs for n in names if n in r.channels]
    spans = [
        float(np.nanmax(f.values) - np.nanmin(f.values)) * abs(f.factor) for f in seen if np.isfinite(f.values).any()
    ]
    return max(spans, default=0.0)


def still_stretch(runs: Sequence[Run]) -> Stretch | None:
    """The longest stretch in which demands do not change and the vessel hardly moves; None where all are too short."""
    largest = {
        n: max(
            (float(np.nanmax(np.abs(r.channels[n].values), initial=0.0)) for r in runs if n in r.channels), default=0.0
        )
        for n in (*VELOCITIES, "r")
    }
    speed = max(largest[n] for n in VELOCITIES)
    best: Stretch | None = None
    for k, run in enumerate(runs):
        moving = [n for n in (*VELOCITIES, "r") if n in run.channels]
        if not moving or speed == 0:
            continue
        first = max(run.channels[n].t[0] for n in moving)
        grid = np.arange(first, min(run.channels[n].t[-1] for n in moving), SPAN)
        if grid.size < 2:
            continue
        rest = np.ones(grid.size - 1, dtype=bool)
        for n in moving:
            limit = REST * (speed if n != "r" else largest["r"])
            mean = _means(run.channels[n], grid)
            rest &= ~(np.abs(mean) > limit) & np.isfinite(mean)
        for f in run.demands.values():
            ok = np.isfinite(f.values)
            at = np.clip(np.searchsorted(f.t[ok], grid, side="right") - 1, 0, None)
            changed = np.r_[0.0, np.cumsum(np.abs(np.diff(f.values[ok])))]
            rest &= np.diff(changed[at]) == 0
        edges = np.flatnonzero(np.diff(np.r_[0, rest.astype(np.int8), 0]))
        for a, b in zip(edges[::2], edges[1::2], strict=True):
            found = Stretch(k, float(grid[a]), float(grid[b]))
            if found.last - found.first >= SHORTEST and (
                best is None or found.last - found.first > best.last - best.first
            ):
                best = found
    return best


def _means(found: Found, grid: Array) -> Array:
    """Means of a channel over each step of a grid; NaN where it has no sample."""
    ok = np.isfinite(found.values)
    place = np.searchsorted(grid, found.t[ok], side="right") - 1
    inside = (place >= 0) & (place < grid.size - 1)
    total = np.bincount(place[inside], found.values[ok][inside], grid.size - 1)
    count = np.bincount(place[inside], minlength=grid.size - 1)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(count > 0, total / count, np.nan), dtype=np.float64)


def scatter(found: Found) -> float:
    """Standard deviation of a channel from sample to sample, in SI units, by its second differences; repeats of held values do not count."""
    values = found.values[np.isfinite(found.values)] * abs(found.factor)
    if found.meaning.channel == "psi":
        values = np.unwrap(values)
    new = values[np.r_[True, np.diff(values) != 0]] if values.size else values
    if new.size < 5:
        return 0.0
    resolution = float(np.min(np.abs(np.diff(new))))
    noise = float(np.median(np.abs(np.diff(new, 2)))) / MEDIAN / SECOND
    return max(noise, resolution / 2)


def _inertial(runs: Sequence[Run], names: Sequence[str], still: Stretch | None) -> list[Number]:
    """Noise coefficients of an inertial sensor: the largest over its axes."""
    if still is not None:
        there = runs[still.log].channels
        fits = [made for n in names if n in there and (made := _fitted(n, there[n], still)) is not None]
        if fits:
            reason = f"from {runs[still.log].name} at rest, {still.first:.4g} to {still.last:.4g} s"
            walk, bias, time = (max(f[k] for f in fits) for k in range(3))
            return [
                Number("random_walk", _up(walk), reason),
                Number("bias_instability", _up(bias), reason),
                Number("bias_time", float(f"{time:.3g}"), reason),
            ]
    seen = [(scatter(r.channels[n]), r.channels[n]) for r in runs for n in names if n in r.channels]
    seen = [s for s in seen if s[0] > 0]
    if not seen:
        held = [r.channels[n] for r in runs for n in names if n in r.channels]
        if (wide := _range(runs, names)) <= 0:
            return []
        period = float(np.median(np.diff(held[0].t)))
        return [
            Number("random_walk", _up(UNSEEN * wide * period**0.5), NO_SCATTER),
            Number("bias_instability", _up(BIAS * UNSEEN * wide), NO_SCATTER),
        ]
    sigma, found = max(seen, key=lambda s: s[0])
    period = float(np.median(np.diff(found.t)))
    return [
        Number("random_walk", _up(sigma * period**0.5), "a guess: the scatter from sample to sample"),
        Number(
            "bias_instability",
            _up(BIAS * sigma),
            "a guess: a tenth of that scatter; `ivsid allan` on a static recording measures it",
        ),
    ]


def _fitted(name: str, found: Found, still: Stretch) -> tuple[float, float, float] | None:
    """N, B and T of a channel at rest, by its Allan deviation; None where the stretch has too little."""
    inside = (found.t >= still.first) & (found.t <= still.last) & np.isfinite(found.values)
    values, t = found.values[inside] * abs(found.factor), found.t[inside]
    if values.size < MINIMUM_SAMPLES:
        return None
    try:
        made = allan_deviation(name, values, float((t[-1] - t[0]) / (t.size - 1)))
    except IvsidError:
        return None
    return made.random_walk, made.bias_instability, made.bias_time


def _limits(runs: Sequence[Run]) -> list[Number]:
    """Limits of accelerations from the largest changes of averaged speeds."""
    reason = "a guess: half more than the largest seen in the logs"
    made = []
    for key, names, second in (
        ("acceleration", VELOCITIES, ("x", "y")),
        ("yaw_acceleration", ("r",), ("psi",)),
    ):
        seen = [_change(r.channels[n], 1) for r in runs for n in names if n in r.channels]
        seen = seen or [_change(r.channels[n], 2) for r in runs for n in second if n in r.channels]
        if seen and max(seen) > 0:
            made.append(Number(key, _up(MARGIN * max(seen)), reason))
    return made


def _change(found: Found, order: int) -> float:
    """The largest difference of means over a second, of first or second order."""
    values = found.values * abs(found.factor)
    if found.meaning.channel == "psi":
        ok = np.isfinite(values)
        values = np.where(ok, 0.0, np.nan)
        values[ok] = np.unwrap(found.values[ok] * abs(found.factor))
    grid = np.arange(found.t[0], found.t[-1], SPAN)
    if grid.size < order + 2:
        return 0.0
    mean = _means(Found(found.match, found.table, found.t, values, found.stated), grid)
    return float(np.nanmax(np.abs(np.diff(mean, order)), initial=0.0)) / SPAN**order


def _up(value: float) -> float:
    """Rounded up to two digits: a bound is not rounded down."""
    if value <= 0:
        return 0.0
    scale = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(f"{np.ceil(value / scale) * scale:.2g}")
