"""Readings under effects of sensors: lever arms, scales, delays and the like."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.plant.propulsion import WHOLE
from ivsid.effects import Given, Reading, acting
from ivsid.effects.quantity import Quantity

Array = NDArray[np.float64]
# Delay of velocities that filters follow, in their memory.
# Source: geometry: over twice the memory errors grow from pass to pass, over all of it three fifths of one are handed on, and over half of it a third
FOLLOWED: Final = 0.5
NAMES: Final = ("u", "v", "r", "ax", "ay", "rdot")


def exact_readings(points: Points, nudot: Array, specific: Array, ambient: Array | float) -> dict[str, Array]:
    """Readings u, v [m/s], r [rad/s], ax, ay [m/s^2], rdot [rad/s^2] and psi [rad] of exact sensors at the origin, shape (n,) each, by name.

    Args:
        points: states at samples, then over steps, of length 2 n.
        nudot: the model's accelerations there, shape (3, 2 n).
        specific: reading of an accelerometer at the origin, and rdot, shape (3, n).
        ambient: rdot of the ambient moment at samples, shape (n,).
    """
    n = nudot.shape[1] // 2
    exact = (*points.nu[:, :n], specific[0], specific[1], nudot[2, :n] + ambient)
    return {**dict(zip(NAMES, exact, strict=True)), "psi": points.psi[:n]}


def lateness(given: Sequence[Given], h: float, memory: float) -> int:
    """Steps, to the nearest whole one, of the delay of a hypothesis's velocities beyond what the filters follow.

    Args:
        given: its effects.
        h: step [s].
        memory: of the filters of u and v [s].
    """
    found = [0.0]

    def at(delay: float) -> tuple[Array, ...]:
        found.append(delay)
        return tuple(np.zeros((3, 1)))

    c: dict[str, Quantity] = {**{q: np.zeros(1) for q in (*NAMES, "psi", "r_v", "r_true", "thrust")}, "at": at}
    for reading, numbers in acting(given, Reading):
        if reading.sensor == "velocity":
            reading.function(c, numbers)
    return max(0, round(max(found) / h) - int(FOLLOWED * memory / h + WHOLE))


def added_readings(
    given: Sequence[Given], points: Points, nudot: Array, exact: Mapping[str, Array], h: float, later: int = 0
) -> dict[str, Array]:
    """The numbers that effects of sensors add to u, v [m/s], r [rad/s], ax, ay [m/s^2] and rdot [rad/s^2], shape (n,) each, by name.

    Args:
        given: effects of a hypothesis, of which those of sensors act here.
        points: states at samples, then over steps, of length 2 n.
        nudot: the model's accelerations there, shape (3, 2 n).
        exact: readings of exact sensors at the origin, shape (n,) each, by name.
        h: step [s].
        later: steps by which each sample has later readings of the velocities than its own.
    """
    n = nudot.shape[1] // 2
    readings = acting(given, Reading)
    if not readings and not later:
        return {q: np.zeros(n) for q in NAMES}
    nu = points.nu[:, :n]
    c: dict[str, Any] = dict(exact)
    c |= {"r_v": nu[2], "r_true": nu[2], "thrust": points.thrusts[:, :n].sum(axis=0)}
    c["at"] = lambda delay: _earlier(nu, nudot, delay - later * h, h)
    if later:
        c["u"], c["v"], c["r_v"] = c["at"](0.0)
    for reading, numbers in sorted(readings, key=lambda q: q[0].order):
        c.update(reading.function(c, numbers))
    return {q: np.asarray(c[q] - exact[q], dtype=np.float64) for q in NAMES}


def _earlier(nu: Array, nudot: Array, delay: float, h: float) -> tuple[Array, ...]:
    """Velocities a delay before each sample, or ahead of it by a negative one, shape (n,) each.

    Within the step that ends at the sample they go back along the model's own acceleration, which is that of the sample before at the begin of
    the step, that over the step in its middle, and linear in time.
    """
    n = nu.shape[1]
    if -h < delay < -WHOLE * h:
        # The sample after this one is predicted with its reading, which has to be compared with what it does not know.
        first, over = nudot[:, :n], nudot[:, n:]
        return tuple(nu - delay * (over - (1.0 + delay / h) * (over - first)))
    whole = int(np.floor(delay / h + WHOLE))
    back = delay - whole * h
    # The state at the end of a step is predicted from its start.
    none = np.zeros((3, 1))
    step = np.concatenate([none, nudot[:, n : 2 * n - 1]], axis=1)
    change = np.concatenate([none, nudot[:, n : 2 * n - 1] - nudot[:, : n - 1]], axis=1)
    # Both samples around the moment count, weighted by how near they are, so that a delay grows past a whole sample without a jump.
    before = np.concatenate([nu[:, :1], nu[:, :-1]], axis=1)
    share = back / h
    then = (1 - share) * (nu - back * step) + share * (before + (h - back) * step) - share * (h - back) * change
    # The first and the last of them stay where there are no others.
    return tuple(then[:, np.clip(np.arange(n) - whole, 0, n - 1)])
