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


def lateness(given: Sequence[Given], h: float) -> int | None:
    """Whole steps by which the velocities of a hypothesis are read late, or None where no effect delays them.

    Args:
        given: its effects.
        h: step [s].
    """
    found: list[int] = []

    def at(delay: float) -> tuple[Array, ...]:
        found.append(int(np.floor(delay / h + WHOLE)))
        return tuple(np.zeros((3, 1)))

    c: dict[str, Quantity] = {**{q: np.zeros(1) for q in (*NAMES, "psi", "r_v", "r_true", "thrust")}, "at": at}
    for reading, numbers in acting(given, Reading):
        if reading.sensor == "velocity":
            reading.function(c, numbers)
    return max(found, default=None)


def added_readings(
    given: Sequence[Given],
    points: Points,
    nudot: Array,
    exact: Mapping[str, Array],
    h: float,
    late: int | None = None,
) -> dict[str, Array]:
    """The numbers that effects of sensors add to u, v [m/s], r [rad/s], ax, ay [m/s^2] and rdot [rad/s^2], shape (n,) each, by name.

    Args:
        given: effects of a hypothesis, of which those of sensors act here.
        points: states at samples, then over steps, of length 2 n.
        nudot: accelerations there, shape (3, 2 n).
        exact: readings of exact sensors at the origin, shape (n,) each, by name.
        h: step [s].
        late: steps by which the velocities' readings are looked at later, to what ``exact`` has at a sample; None where they stand at their own samples.
    """
    n = nudot.shape[1] // 2
    readings = acting(given, Reading)
    if not readings and not late:
        return {q: np.zeros(n) for q in NAMES}
    nu = points.nu[:, :n]
    c: dict[str, Any] = dict(exact)
    c |= {"r_v": nu[2], "r_true": nu[2], "thrust": points.thrusts[:, :n].sum(axis=0)}

    def at(delay: float) -> tuple[Array, ...]:
        return _earlier(nu, nudot, delay, h) if late is None else _carried_back(nu, nudot, delay - late * h, h)

    c["at"] = at
    if late:
        c["u"], c["v"], c["r_v"] = at(0.0)
    for reading, numbers in sorted(readings, key=lambda q: q[0].order):
        c.update(reading.function(c, numbers))
    return {q: np.asarray(c[q] - exact[q], dtype=np.float64) for q in NAMES}


def _earlier(nu: Array, nudot: Array, delay: float, h: float) -> tuple[Array, ...]:
    """Velocities a delay before each sample, shape (n,) each.

    Within the step that ends at the sample they go back along the model's own acceleration, which is that of the sample before at the begin of
    the step, that over the step in its middle, and linear in time.
    """
    whole = int(np.floor(delay / h + WHOLE))
    back = delay - whole * h
    step, change = _last_step(nudot)
    # Both samples around the moment count, weighted by how near they are, so that a delay grows past a whole sample without a jump.
    before = np.concatenate([nu[:, :1], nu[:, :-1]], axis=1)
    share = back / h
    then = (1 - share) * (nu - back * step) + share * (before + (h - back) * step) - share * (h - back) * change
    return tuple(_moved(then, whole))


def _carried_back(nu: Array, nudot: Array, delay: float, h: float) -> tuple[Array, ...]:
    """The same, or ahead of the samples by a negative delay, from each sample alone: a state between the two is not filtered with the later reading."""
    whole = int(np.floor(delay / h + WHOLE))
    back = delay - whole * h
    step, change = _last_step(nudot)
    return tuple(_moved(nu - back * step - back * (1.0 - back / h) * change, whole))


def _last_step(nudot: Array) -> tuple[Array, Array]:
    """Accelerations over the step that ends at each sample, and less those at its start, shape (3, n) each: a state is predicted from there."""
    n = nudot.shape[1] // 2
    none = np.zeros((3, 1))
    step = np.concatenate([none, nudot[:, n : 2 * n - 1]], axis=1)
    return step, np.concatenate([none, nudot[:, n : 2 * n - 1] - nudot[:, : n - 1]], axis=1)


def _moved(x: Array, whole: int) -> Array:
    """Values some samples before each, or after it where they are fewer than none, shape (3, n); the first and the last stay where there are no others."""
    n = x.shape[1]
    return np.asarray(x[:, np.clip(np.arange(n) - whole, 0, n - 1)])
