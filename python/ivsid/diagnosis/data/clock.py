"""The step of the uniform clock, and the channels that come often enough for it."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from ivsid.diagnosis.data.outliers import USUAL, outliers
from ivsid.errors import IvsidError
from ivsid.log import Log

# Highest rate of the clock [Hz]; a quicker log is thinned.
# Source: physics: the motion of a hull and of its thrusters has time constants above 0.1 s, which two samples and more resolve
HIGHEST_RATE: Final = 25.0
# Highest rate of the clock [Hz] where demands are looked up inside its steps; the readings of a quicker log are averaged over steps of ``LONGEST_MEAN`` at most.
# Source: physics: the motion of a hull has time constants above 0.1 s, so that means over a step of that length show it
HIGHEST_MEAN_RATE: Final = 12.5
# Longest step of the clock over which readings are averaged [s].
# Source: physics: the time constants of a hull's motion; at 13 Hz, in means over 0.15 s, a sound vessel had structure of eight standard deviations in the
# change of its thrust, and none in its readings themselves
LONGEST_MEAN: Final = 0.1
# Largest usual turn in a step over which readings are averaged [rad].
# Source: physics: sin x and x differ by 0.2 % at 0.1 rad, and so does the mean of a velocity from that at the middle of the step
LARGEST_MEAN_TURN: Final = 0.1
# Longest step of the clock [s]; a log whose velocities come more rarely is refused.
# Source: physics: thrusters and yaw of a hull of 1 m settle within a second or two, which a rarer velocity does not follow
LONGEST_STEP: Final = 1.0
# Tolerance of both limits, as a factor: a clock is stated in round numbers and stamped in rounded ones.
# Source: definition: one per cent
CLOCK_TOLERANCE: Final = 1.01
# A channel is rare if the time between its samples exceeds the step by this factor: a rare velocity sets the clock, another rare channel is left out.
# Source: geometry: halfway between a sample in every step and a sample in every second step
RARE: Final = 1.5
# The usual step and the mean step of the whole log are the same clock if they differ by less than this share.
# Source: geometry: stamps rounded to 0.1 ms are off by this share of a step of 0.1 s
SAME_STEP: Final = 1e-3
# Shortest log [s].
# Source: geometry: two half-minutes, the fewest between which coefficients can scatter (candidates.intervals.scatter)
SHORTEST: Final = 60.0
# Largest usual turn from one sample to the next [rad]: the forces of a step are evaluated at one heading.
# Source: physics: sin x and x differ by 1.5 % at 0.3 rad, and the direction of a force is off by less in the middle of a step
LARGEST_TURN: Final = 0.3


def check_usable(log: Log) -> None:
    """Refuses a log that no diagnosis can follow.

    Raises:
        IvsidError: the log lacks a velocity, or is shorter than a minute.
    """
    for name in ("u", "v", "r"):
        log.column(name, "by every equation of motion")
    if log.t[-1] - log.t[0] < SHORTEST:
        raise IvsidError(
            f"{log.name} lasts {log.t[-1] - log.t[0]:.3g} s; a diagnosis needs at least {SHORTEST:.0f} s, so give a longer log"
        )


def usual_step(log: Log, name: str) -> float:
    """The median time between two samples of a channel [s]; 0 if it has no two of them."""
    there = np.isfinite(log.columns[name]) if name in log.columns else np.zeros(0, dtype=bool)
    return float(np.median(np.diff(log.t[there]))) if there.sum() > 2 else 0.0


def rarest_velocity(log: Log) -> str:
    """The name of the velocity that is read most rarely."""
    return max(("u", "v", "r"), key=lambda name: usual_step(log, name))


def first_reading(log: Log) -> float:
    """The time of the first reading of the velocity that is read most rarely [s]."""
    return float(log.t[int(np.argmax(np.isfinite(log.columns[rarest_velocity(log)])))])


def paced(log: Log, *, inside: bool) -> tuple[Log, float, int, list[str]]:
    """The log without channels that come too rarely and without outliers, the step of its clock [s], readings in a step, and notes for the reader.

    Args:
        log: as read.
        inside: whether demands are looked up inside the steps of the clock.

    Raises:
        IvsidError: velocities come less than once a second, or the vehicle turns too far between two samples.
    """
    # The median step is rounded as the time stamps are; the mean over the whole log is not.
    h = log.period
    whole = (log.t[-1] - log.t[0]) / max(round((log.t[-1] - log.t[0]) / h), 1)
    h = float(whole) if abs(whole / h - 1) < SAME_STEP else h
    notes = []
    slowest = max(usual_step(log, name) for name in ("u", "v", "r"))
    if slowest > RARE * h:
        if slowest > LONGEST_STEP * CLOCK_TOLERANCE:
            raise IvsidError(
                f"{log.name} has a velocity every {slowest:.3g} s; a diagnosis needs one a second at least, so log u, v and r faster"
            )
        h = slowest
        notes.append(f"the clock is that of the slowest velocity: {1 / h:.3g} samples a second")
    count, turning = 1, float(np.nanquantile(np.abs(log.columns["r"]), USUAL))
    if inside and slowest <= RARE * h and 1 / h > HIGHEST_MEAN_RATE * CLOCK_TOLERANCE:
        most = min(LARGEST_MEAN_TURN / max(turning * h, 1e-300), CLOCK_TOLERANCE * LONGEST_MEAN / h)
        count = max(1, int(min(np.ceil(1 / h / HIGHEST_MEAN_RATE), most)))
    if count > 1:
        h *= count
        notes.append(f"means of {count} readings are used: {1 / h:.3g} a second are enough for the motion of a hull")
    if 1 / h > HIGHEST_RATE * CLOCK_TOLERANCE:
        thin = int(np.ceil(1 / h / HIGHEST_RATE))
        h *= thin
        notes.append(f"every {thin}th sample is used: {1 / h:.3g} a second are enough for the motion of a hull")
    turned = h * turning
    if turned > LARGEST_TURN:
        raise IvsidError(
            f"{log.name}: the vehicle turns by {turned:.3g} rad from one sample to the next, and a diagnosis follows {LARGEST_TURN:g}; log "
            f"{np.ceil(10 * turning / LARGEST_TURN) / 10:g} rows a second or more, or give a log of slower turns"
        )
    rare = [n for n in ("ax", "ay", "udot", "vdot", "rdot", "psi", "x", "y") if usual_step(log, n) > RARE * h]
    if rare:
        notes.append(f"{', '.join(rare)} come too rarely to be used")
    columns = {k: x for k, x in log.columns.items() if k not in rare}
    for name in ("u", "v", "r", "x", "y", "psi"):
        if name in columns and (wild := outliers(columns[name], turns=name == "psi")).any():
            columns[name] = np.where(wild, np.nan, columns[name])
            notes.append(f"{int(wild.sum())} samples of {name} stand far out from both neighbours and are left out")
    return replace(log, columns=columns), h, count, notes
