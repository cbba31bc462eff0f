"""Free runs of a fit over windows: by the equations of its terms alone, or by the simulator where its model has further causes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import WITH_HEADING, Reading, causes, of_kind, terms_of
from ivsid.errors import IvsidError
from ivsid.identification import Identification
from ivsid.log import Log
from ivsid.programme.scenario import Start
from ivsid.simulation import follow
from ivsid.validation.dynamics import Dynamics

Array: TypeAlias = NDArray[np.float64]
# From the first rows of k windows and their steps to u, v, r, shape (k, steps + 1, 3).
Runs: TypeAlias = Callable[[NDArray[np.int64], int], Array]


def runs_of(fit: Identification, log: Log, nu: Array, force: Array) -> Runs:
    """Free runs from the measured state under the logged demands.

    Args:
        fit: with an estimate of every parameter.
        log: its columns.
        nu: u, v, r at the rows, shape (n, 3).
        force: nominal X, Y [N], N [N m] of the thrusters at the rows, shape (n, 3).

    Raises:
        IvsidError: a model that cannot be simulated, or a cause that needs what the log lacks.
    """
    vehicle = fit.vehicle
    # Terms that turn with the heading need the pose, which the simulator follows.
    turning = {t.id for several in WITH_HEADING.values() for t in several} & fit.estimate.keys()
    if turning or any(not isinstance(g.effect.acts, Reading) for g in causes(vehicle)):
        return _with_causes(fit, log, nu)
    added = fit.options["form"] == "added"
    mass = vehicle.hull.mass
    x_g, y_g = vehicle.hull.centre_of_gravity
    model = Dynamics(
        terms_of(vehicle, fit.options["form"]), fit.estimate, mass * x_g, mass * y_g, mass if added else 0.0
    )

    def runs(starts: NDArray[np.int64], count: int) -> Array:
        at = starts[:, None] + np.arange(count + 1)
        return model.runs(nu[starts], force[at[:, :-1]], np.diff(log.t[at], axis=1))

    return runs


def _with_causes(fit: Identification, log: Log, nu: Array) -> Runs:
    """Free runs by the simulator, whose equations hold every cause."""
    vehicle, columns = fit.vehicle, log.columns
    given = causes(vehicle)
    if not vehicle.thrusters:
        raise IvsidError("a model with further causes is simulated by its thrusters, and the vehicle file has none")
    lacking = {n for g in given for n in g.effect.needs if n in ("psi", "x", "y") and n not in columns}
    lacking |= {n for g in given for n in g.effect.needs if n in ("wind_speed", "wind_direction", "voltage")}
    moving = [n for g in given if not of_kind([g], Reading) for n in g.named]
    if lacking:
        raise IvsidError(
            f"{', '.join(moving)} needs {', '.join(sorted(lacking))}, which the simulated windows do not have"
        )
    mass = vehicle.hull.mass
    values = {
        k.replace("added_mass.", "mass.") if k in ("added_mass.surge", "added_mass.sway") else k: v
        + (mass if k in ("added_mass.surge", "added_mass.sway") else 0.0)
        for k, v in fit.estimate.items()
    }
    demands = {t.name: _held(columns[f"demand_{t.name}"]) for t in vehicle.thrusters}
    angles = {
        t.name: _held(columns[name])
        for t in vehicle.thrusters
        for name in (f"rudder_{t.name}", f"azimuth_{t.name}")
        if name in columns
    }
    pose = {n: columns[n] for n in ("psi", "x", "y") if n in columns}

    def run(first: int, count: int) -> Array:
        end = first + count + 1
        where = {n: float(x[first]) for n, x in pose.items() if np.isfinite(x[first])}
        start = Start(u=float(nu[first, 0]), v=float(nu[first, 1]), r=float(nu[first, 2]), **where)
        moved = follow(
            vehicle,
            values,
            log.t[:end],
            {k: x[:end] for k, x in demands.items()},
            start,
            {k: x[:end] for k, x in angles.items()},
            first=first,
        )
        return np.stack([moved[n] for n in ("u", "v", "r")], axis=1)

    return lambda starts, count: np.stack([run(int(k), count) for k in starts])


def _held(x: Array) -> Array:
    """A column with the last sample in the place of each missing one, and the first before it."""
    known = np.flatnonzero(np.isfinite(x))
    if not known.size:
        return np.zeros_like(x)
    last = np.maximum.accumulate(np.where(np.isfinite(x), np.arange(x.size), known[0]))
    return np.asarray(x[last])
