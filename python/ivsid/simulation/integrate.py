"""Integration: the classical Runge-Kutta method with fixed steps, and its error estimated by halving them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError
from ivsid.simulation.compiled import Steps
from ivsid.simulation.equations import Rates
from ivsid.simulation.propulsion import INSIDE, Propulsion

# The motion has settled if halving the step moves no velocity by more than this share of its largest value.
# Source: measured: make constants
TOLERANCE: Final = 1e-5
# A movement below this [m/s, rad/s] counts as none: velocities near 0 would never settle in relative terms.
# Source: physics: far below the resolution of any velocity sensor or gyro.
FLOOR: Final = 1e-9
# Runge-Kutta steps a sample at which a motion that has not settled is refused.
# Source: resource: bounds the time of a simulation at 64 times that of one step a sample.
MOST_STEPS: Final = 64
# A coarse run ends early only if it is off by more than the allowance and the rounding of the comparison.
# Source: definition: far above the relative rounding of float64, 2^-53, far below 1.
CERTAIN: Final = 1 + 1e-9
# At the most steps a thrust with kinks, which lowers the order of the method, may miss the tolerance by this factor.
# Source: measured: make constants
KINKED: Final = 10.0

Pose = tuple[float, float, float, float, float, float]


class Helm(Protocol):
    """The source of the commands, sample by sample in order."""

    def __call__(self, k: int, state: Pose) -> tuple[list[float], list[float]]:
        """Demands of the thrusters and angles [rad] of rudders and azimuth thrusters from sample k on."""


@dataclass(frozen=True)
class Path:
    """A motion at the samples.

    Attributes:
        states: u, v, r, psi, x, y, shape (n, 6).
        rates: udot, vdot, rdot just after the sample, shape (n, 3).
        demands: of the thrusters in their own units, shape (n, thrusters).
        angles: of rudders and azimuth thrusters [rad], shape (n, thrusters).
        thrust: sum of the thrusts [N], shape (n,).
        steps: Runge-Kutta steps per sample.
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
    steps_of: Steps,
    make: Callable[[], tuple[Propulsion, Helm]],
    times: Sequence[float],
    start: Pose,
    outside: NDArray[np.float64],
) -> Path:
    """Integrates with one step per sample, then with twice as many, until halving the step moves no velocity by more than is allowed.

    Args:
        rates: the compiled equations.
        steps_of: the same equations as Runge-Kutta steps.
        make: returns thrusters and helm in their state before the log; called once for each run.
        times: of the samples [s], increasing, shape (n,).
        start: u, v, r, psi, x, y at the first sample.
        outside: X, Y, N and wind north, east, each held from its sample to the next, shape (n, 5).

    Raises:
        IvsidError: the motion grows without bound, or does not settle.
    """
    steps = 1
    coarse: Path | None = None
    while True:
        fine = run(rates, steps_of, *make(), times, start, outside, 2 * steps)
        moved = None
        last = 4 * steps > MOST_STEPS
        allowed = np.zeros(3)
        if fine is not None:
            allowed = np.maximum(TOLERANCE * np.abs(fine.states[:, :3]).max(axis=0), FLOOR)
            if steps == 1:
                # Only the states of the first run are used, and only up to the first that is too far off.
                coarse = run(rates, steps_of, *make(), times, start, outside, 1, (fine.states, 15 * allowed * CERTAIN))
        if coarse is not None and fine is not None:
            # The method is of order 4, so that the error of the finer run is 1/15 of the difference (Richardson).
            size = len(coarse.states)
            moved = np.abs(fine.states[:size, :3] - coarse.states[:, :3]).max(axis=0) / 15
            if last and (moved > allowed).any():
                # Kinks of a thrust lower the order: the difference itself then estimates the error, and the allowance grows.
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


def run(  # noqa: PLR0912 - one loop over the samples; its parts would pass a dozen numbers to each other
    rates: Rates,
    steps_of: Steps,
    propulsion: Propulsion,
    helm: Helm,
    times: Sequence[float],
    start: Pose,
    outside: NDArray[np.float64],
    steps: int,
    near: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None,
) -> Path | None:
    """One run with ``steps`` Runge-Kutta steps per sample; None if it grows without bound.

    Args:
        rates: as ``settle``, and so are steps_of, times, start and outside.
        steps_of: see there.
        propulsion: the thrusters in their state before the log.
        helm: the source of the commands.
        times: see there.
        start: see there.
        outside: see there.
        steps: Runge-Kutta steps per sample.
        near: states of another run and the allowed distances of u, v, r from them. The path then holds states alone, up to the
            first that is further off.
    """
    state = start
    states, accelerations, demands, angles, totals = [], [], [], [], []
    external = outside.tolist()
    last = len(times) - 1
    others = [] if near is None else near[0][:, :3].tolist()
    most_u, most_v, most_r = (np.inf,) * 3 if near is None else near[1].tolist()
    steady, varied = steps_of.steady, steps_of.varied
    try:
        for k, time in enumerate(times):
            demand, angle = helm(k, state)
            propulsion.demand(time, demand)
            end = times[k + 1] if k < last else time
            fixed = external[k]
            states.append(state)
            if near is None:
                inside = INSIDE * (end - time)
                thrust = propulsion.now(time + inside)
                rate = rates(time + inside, *state, *fixed, *thrust, *angle)
                accelerations.append(rate[:3])
                demands.append(demand)
                angles.append(angle)
                totals.append(sum(thrust))
            else:
                u, v, r = others[k]
                if abs(state[0] - u) > most_u or abs(state[1] - v) > most_v or abs(state[2] - r) > most_r:
                    break
            if k == last:
                break
            # Time is cut at delayed demands and events, so that no step crosses a jump.
            if propulsion.steady:
                # Thrusts hold between the samples and are looked up once.
                if near is not None:
                    thrust = propulsion.now(time)
                tail = steps_of.held(*fixed, *thrust, *angle)
                h = (end - time) / steps
                for j in range(steps):
                    state = steady(time + j * h, h, *state, *tail)
            else:
                cuts = [time, end] if propulsion.plain else [time, *propulsion.breaks(time, end), end]
                for low, high in pairwise(cuts):
                    h = (high - low) / steps
                    for j in range(steps):
                        at = low + j * h
                        first, middle, final = propulsion.over(at, h)
                        state = varied(at, h, *state, *fixed, *angle, *first, *middle, *final)
            if not -1e9 < state[0] + state[1] + state[2] < 1e9:
                raise OverflowError
    except (OverflowError, ValueError, ZeroDivisionError):
        return None
    count = len(times)
    return Path(
        np.array(states),
        np.array(accelerations),
        np.array(demands).reshape(count, -1),
        np.array(angles).reshape(count, -1),
        np.array(totals, dtype=np.float64),
        steps,
        (np.nan, np.nan, np.nan),
    )
