"""The classical Runge-Kutta method with fixed steps, and how far halving them moves the result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.simulation.equations import Rates
from ivsid.simulation.propulsion import Propulsion

# The motion is taken as settled where halving the step moves no velocity by more than this share of its largest value.
TOLERANCE: Final = 1e-5
# ... or by less than this [m/s, rad/s]: far below any sensor.
FLOOR: Final = 1e-9
MOST_STEPS: Final = 64
# At the most steps, so many times the tolerance is enough.
KINKED: Final = 10.0
# Times at which a jump may stand are looked at from inside the step.
_INSIDE: Final = 1e-9

Pose = tuple[float, float, float, float, float, float]


class Helm(Protocol):
    """Who commands: demands and angles at a sample, from what is known then."""

    def __call__(self, k: int, state: Pose) -> tuple[list[float], list[float]]:
        """Demands of the thrusters and angles [rad] of rudders and azimuth thrusters from sample k on."""


@dataclass(frozen=True)
class Path:
    """A motion at the samples.

    Attributes:
        states: u, v, r, psi, x, y, shape (n, 6).
        rates: udot, vdot, rdot just after the sample, shape (n, 3).
        demands: shape (n, thrusters).
        angles: shape (n, thrusters).
        thrust: sum of the thrusts [N], shape (n,).
        steps: Runge-Kutta steps a sample.
        error: estimated largest error of u, v [m/s], r [rad/s], by halving the step.
    """

    states: NDArray[np.float64]
    rates: NDArray[np.float64]
    demands: NDArray[np.float64]
    angles: NDArray[np.float64]
    thrust: NDArray[np.float64]
    steps: int
    error: tuple[float, float, float]


def settle(
    rates: Rates,
    make: Callable[[], tuple[Propulsion, Helm]],
    times: Sequence[float],
    start: Pose,
    outside: NDArray[np.float64],
    halves: tuple[Callable[..., tuple[float, ...]], Rates] | None = None,
) -> Path:
    """Integrates with one step a sample, then with twice as many, until halving the step changes nothing that matters.

    Args:
        rates: the compiled equations.
        make: thrusters and helm in their state before the log, anew for each run.
        times: of the samples [s], increasing.
        start: u, v, r, psi, x, y at the first.
        outside: X, Y, N and wind north, east, each held from its sample to the next, shape (n, 5).
        halves: the equations in two, for thrusts that hold from sample to sample.

    Raises:
        IvsidError: the motion grows without bound, or does not settle.
    """
    steps = 1
    coarse = run(rates, *make(), times, start, outside, steps, halves)
    while True:
        fine = run(rates, *make(), times, start, outside, 2 * steps, halves)
        moved = None
        if coarse is not None and fine is not None:
            # The method is of fourth order: the finer run is 15 times as close to the truth as the two are to each other.
            moved = np.abs(fine.states[:, :3] - coarse.states[:, :3]).max(axis=0) / 15
            allowed = np.maximum(TOLERANCE * np.abs(fine.states[:, :3]).max(axis=0), FLOOR)
            if 4 * steps > MOST_STEPS and (moved > allowed).any():
                # Where a thrust has kinks of its own the order is lost: the difference itself estimates what is left, and less is asked.
                moved, allowed = 15 * moved, KINKED * allowed
            if (moved <= allowed).all():
                u, v, r = (float(q) for q in moved)
                return replace(fine, error=(u, v, r))
        steps *= 2
        if steps >= MOST_STEPS:
            if moved is None:
                raise IvsidError("the simulated motion grows without bound; look at the true values and the demands")
            raise IvsidError(
                f"the motion does not settle with {steps} steps a sample (halving the step still moves it by "
                f"{moved.max():.2g}); give a higher rate, or look for a gain, drag or lag far too strong"
            )
        coarse = fine


def run(
    rates: Rates,
    propulsion: Propulsion,
    helm: Helm,
    times: Sequence[float],
    start: Pose,
    outside: NDArray[np.float64],
    steps: int,
    halves: tuple[Callable[..., tuple[float, ...]], Rates] | None = None,
) -> Path | None:
    """One run with ``steps`` Runge-Kutta steps a sample; None where it grows without bound."""
    state = start
    states, accelerations, demands, angles, totals = [], [], [], [], []
    held = outside.tolist()
    last = len(times) - 1
    try:
        for k, time in enumerate(times):
            demand, angle = helm(k, state)
            propulsion.demand(time, demand)
            end = times[k + 1] if k < last else time
            inside = _INSIDE * (end - time)
            thrust = propulsion.now(time + inside)
            fixed = held[k]
            rate = rates(time + inside, *state, *fixed, *thrust, *angle)
            states.append(state)
            accelerations.append(rate[:3])
            demands.append(demand)
            angles.append(angle)
            totals.append(sum(thrust))
            if k == last:
                break
            # No jump is stepped over: the sample's time is cut where a delayed demand or an event arrives.
            if propulsion.steady:
                # Nothing changes between the samples but the state: thrusts are looked up once.
                tail = (*fixed, *thrust, *angle)
                moving = rates
                if halves is not None:
                    tail, moving = halves[0](*tail), halves[1]
                tails = tail, tail, tail
                h = (end - time) / steps
                for j in range(steps):
                    state = _step(moving, state, time + j * h, h, tails)
                if not -1e9 < state[0] + state[1] + state[2] < 1e9:
                    raise OverflowError
                continue
            cuts = [time, end] if propulsion.plain else [time, *propulsion.breaks(time, end), end]
            for low, high in pairwise(cuts):
                h = (high - low) / steps
                for j in range(steps):
                    at = low + j * h
                    first, middle, final = propulsion.over(at, h)
                    tails = (*fixed, *first, *angle), (*fixed, *middle, *angle), (*fixed, *final, *angle)
                    state = _step(rates, state, at, h, tails)
            if not -1e9 < state[0] + state[1] + state[2] < 1e9:
                raise OverflowError
    except (OverflowError, ValueError, ZeroDivisionError):
        return None
    return Path(
        np.array(states),
        np.array(accelerations),
        np.array(demands).reshape(len(times), -1),
        np.array(angles).reshape(len(times), -1),
        np.array(totals, dtype=np.float64),
        steps,
        (np.nan, np.nan, np.nan),
    )


def _step(
    rates: Rates,
    state: Pose,
    t: float,
    h: float,
    tails: tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]],
) -> Pose:
    """Written out for six numbers: a loop over them would take longer than the equations.

    The tails are what follows the state in the arguments of the equations, at the start, the middle and the end of the step.
    """
    first, middle, last = tails
    half = 0.5 * h
    u, v, r, p, x, y = state
    a1, b1, c1, d1, e1, f1 = rates(t + _INSIDE * h, u, v, r, p, x, y, *first)
    a2, b2, c2, d2, e2, f2 = rates(
        t + half,
        u + half * a1,
        v + half * b1,
        r + half * c1,
        p + half * d1,
        x + half * e1,
        y + half * f1,
        *middle,
    )
    a3, b3, c3, d3, e3, f3 = rates(
        t + half,
        u + half * a2,
        v + half * b2,
        r + half * c2,
        p + half * d2,
        x + half * e2,
        y + half * f2,
        *middle,
    )
    a4, b4, c4, d4, e4, f4 = rates(
        t + h - _INSIDE * h,
        u + h * a3,
        v + h * b3,
        r + h * c3,
        p + h * d3,
        x + h * e3,
        y + h * f3,
        *last,
    )
    s = h / 6.0
    return (
        u + s * (a1 + 2.0 * (a2 + a3) + a4),
        v + s * (b1 + 2.0 * (b2 + b3) + b4),
        r + s * (c1 + 2.0 * (c2 + c3) + c4),
        p + s * (d1 + 2.0 * (d2 + d3) + d4),
        x + s * (e1 + 2.0 * (e2 + e3) + e4),
        y + s * (f1 + 2.0 * (f2 + f3) + f4),
    )
