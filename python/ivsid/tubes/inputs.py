"""The course of a log as a tube needs it: steps, forces at all moments of each step, and measured states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import Reading, causes
from ivsid.errors import IvsidError
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.propulsion.actuation import Push
from ivsid.propulsion.lag import GAP
from ivsid.rows.forces import KnownForces
from ivsid.sensors.bounds import BoundedLog, bound_log
from ivsid.vehicle import Vehicle

Array: TypeAlias = NDArray[np.float64]
VELOCITIES: Final = ("u", "v", "r")
# Holds the roundings of a difference of two times: one of 2^-53 each, and the difference's own.
# Source: theorem: standard model of floating-point arithmetic, Higham 2002, section 2.2
DIFFERENCE: Final = 2.0**-50


@dataclass(frozen=True)
class Course:
    """A log with n rows.

    Attributes:
        log: the log.
        h: lengths of the steps [s], shape (n - 1,).
        whole: steps without a gap whose forces are known, shape (n - 1,).
        force: X, Y [N], N [N m] at all moments of each step, shape (n - 1, 3).
        centre: the same without errors, shape (n - 1, 3).
        errors: reaches of independent errors, one a thruster and one a channel of the ambient force, each of shape (n - 1, 3).
        measured: u, v, r at the rows, shape (n, 3); entire where they are missing.
        heading: psi [rad] at the rows, shape (n,), or None.
        statistical: sentences on readings that are estimates; a tube that starts from them is not guaranteed.
        assumes: sentences that the forces and readings rely on.
    """

    log: Log
    h: IntervalArray
    whole: NDArray[np.bool_]
    force: IntervalArray
    centre: Array
    errors: tuple[Array, ...]
    measured: IntervalArray
    heading: IntervalArray | None
    statistical: tuple[str, ...]
    assumes: tuple[str, ...]


def course_of(vehicle: Vehicle, log: Log) -> Course:
    """The course of a log.

    Raises:
        IvsidError: a missing column or section, a model with causes beside its terms, or a force that depends on the motion.
    """
    beside = [n for g in causes(vehicle) if not isinstance(g.effect.acts, Reading) for n in g.named]
    if beside:
        raise IvsidError(
            f"the model holds {', '.join(beside)} beside its terms, and a tube follows terms alone; leave it out of [model.fitted], or "
            "widen [ambient] by it"
        )
    bounded = bound_log(log, vehicle)
    log = bounded.log
    for name in VELOCITIES:
        log.column(name, "as the start of a tube")
        if name not in bounded.channels:
            section = "yaw_rate" if name == "r" else "velocity"
            raise IvsidError(
                f"vehicle file {vehicle.source or vehicle.name} has no [sensors.{section}]; it is needed to bound column {name}"
            )
    steps = np.diff(log.t)
    reach = 2 * log.time_error + DIFFERENCE * steps
    force, centre, errors, there, assumes = _forces(vehicle, bounded)
    ambient = np.array([bounded.ambient[0], bounded.ambient[0], bounded.ambient[1]])
    if ambient.any():
        shape = (steps.size, 3)
        force = force + IntervalArray(np.broadcast_to(-ambient, shape).copy(), np.broadcast_to(ambient, shape).copy())
        errors += [np.broadcast_to(np.eye(3)[k] * ambient, shape).copy() for k in range(3) if ambient[k]]
        assumes += (
            f"the ambient force never exceeds {bounded.ambient[0]:g} N in surge and in sway, nor {bounded.ambient[1]:g} N m in yaw",
        )
    return Course(
        log,
        IntervalArray(np.nextafter(steps - reach, -np.inf), np.nextafter(steps + reach, np.inf)),
        (steps <= GAP * log.period) & there,
        force,
        centre,
        tuple(errors),
        IntervalArray.stack([bounded.channels[n] for n in VELOCITIES], axis=1),
        bounded.channels.get("psi"),
        bounded.statistical,
        (
            f"the readings of {log.name} from which tubes start stay inside their sensor bounds",
            "the vehicle's parameters are the same in both logs",
            *assumes,
            *bounded.statistical,
        ),
    )


def _forces(
    vehicle: Vehicle, bounded: BoundedLog
) -> tuple[IntervalArray, Array, list[Array], NDArray[np.bool_], tuple[str, ...]]:
    """Forces of all thrusters over the steps, their middles and errors, where they are known, and what they rely on."""
    log, held = bounded.log, vehicle.log.demand == "hold"
    n = log.t.size - 1
    if not vehicle.thrusters:
        known = KnownForces(bounded, vehicle).part(0, n + 1)
        logged = IntervalArray.stack(list(known.steps), axis=1)
        ends = known.present[:-1] & known.present[1:]
        there = ends if known.whole is None else ends & known.whole
        logged = _filled(logged, there)
        return logged, logged.midpoint, [np.eye(3)[k] * logged.radius for k in range(3)], there, known.assumes
    total = IntervalArray(np.zeros((n, 3)))
    centre, there = np.zeros((n, 3)), np.ones(n, dtype=bool)
    errors: list[Array] = []
    assumes: list[str] = []
    for thruster in vehicle.thrusters:
        push = Push(thruster, log, held=held)
        thrust, shares = push.ranges()
        # A held demand needs its first row alone; a change on a straight line or a lag needs both.
        known_rows = (
            push.there[:-1]
            if held and push.lagged is None and push.turned is None
            else push.there[:-1] & push.there[1:]
        )
        there &= known_rows if push.whole is None else known_rows & push.whole
        finite = np.asarray(np.isfinite(thrust.lower) & np.isfinite(thrust.upper))
        there &= finite
        thrust = _filled(thrust, finite)
        total = total + IntervalArray.stack([thrust * s for s in shares], axis=1)
        middle = np.stack([np.broadcast_to(s.midpoint, (n,)) for s in shares], axis=1)
        centre = centre + thrust.midpoint[:, None] * middle
        errors.append(np.ascontiguousarray(thrust.radius[:, None] * middle))
        assumes += push.assumes
        a = thruster.accuracy
        assumes.append(
            f"the thrust of {thruster.name} stays within {a.absolute!r} N + {a.relative!r} |T| of its curve, as any function of time"
        )
    demands = "demands hold from each row to the next" if held else "demands change on straight lines from row to row"
    return total, centre, errors, there, (demands, *assumes)


def _filled(x: IntervalArray, there: NDArray[np.bool_]) -> IntervalArray:
    """Zero where a force is not known: no step there is followed."""
    known = there if x.ndim == 1 else there[:, None]
    return IntervalArray(np.where(known, x.lower, 0.0), np.where(known, x.upper, 0.0))
