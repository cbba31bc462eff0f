"""Signatures of the errors that a vehicle file declares: sensor biases and scale, smooth thrust errors, the rudders' accuracy."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.signatures import Signatures
from ivsid.diagnosis.plant.declared_readings import deviations, unit
from ivsid.diagnosis.plant.physics import water
from ivsid.diagnosis.plant.thrust_errors import BOUNDED
from ivsid.diagnosis.plant.thruster_forces import blade_force

Array = NDArray[np.float64]
# Difference of a thrust error from which its effect on a rudder is taken, in units of its bound.
# Source: geometry: a rudder's force is nearly linear in the stream's speed over this much of a thrust error
BLADE_STEP: Final = 0.05
# Difference of an error of a reading from which its signature is taken, in its standard deviation.
# Source: geometry: below the noise of the sensor; the model is smooth over it
READING_STEP: Final = 0.1


def nuisances(s: Signatures) -> Columns:
    """Signatures of one unit of each declared error, with its standard deviation as ``prior``."""
    out = Columns()
    _sensors(s, out)
    relative = through_water(s)
    _blades(s, out, relative)
    _thrusts(s, out, relative)
    return out


def through_water(s: Signatures) -> tuple[Array, Array, Array]:
    """u, v [m/s] and r [rad/s] relative to the water, at the states of the signatures."""
    p = s.states.points
    u_c, v_c, _, _ = water(s.h, p)
    return p.nu[0] - u_c, p.nu[1] - v_c, p.nu[2]


def _sensors(s: Signatures, out: Columns) -> None:
    """Errors of readings, by the model's answer to a wrong reading."""
    predictor, log = s.predictor, s.predictor.log
    measured = {q for q, a in zip(("ax", "ay", "rdot"), log.acceleration, strict=True) if a is not None} | {"u", "v"}
    # Without a heading nothing holds the yaw rate against its gyro, and without a gyro the heading is the only reading.
    measured |= set() if log.psi is None else {"psi"} if log.turned else {"r", "psi"}
    measured |= {"x", "y"} if len(predictor.axes) > 3 else set()
    exact = predictor.exact(s.states)
    for name, size in deviations(predictor.vehicle, earth=log.earth):
        added = {q: x for q, x in unit(name, exact, predictor.slow, earth=log.earth).items() if q in measured}
        if added:
            step = READING_STEP * size
            wrong = predictor.misread(s.states, {q: step * x for q, x in added.items()}, mass=s.mass)
            # A constant heading is nothing where no force is fixed to the earth.
            if np.any(wrong):
                out.add(name, wrong / step, size)


def _blades(s: Signatures, out: Columns, relative: tuple[Array, Array, Array]) -> None:
    """An error of each rudder's force, the same share of all of it."""
    predictor, p = s.predictor, s.states.points
    for k, thruster in enumerate(predictor.vehicle.thrusters):
        if thruster.rudder is not None and thruster.rudder.accuracy:
            force = blade_force(predictor.vehicle, k, p, p.thrusts[k], relative)
            out.add(
                f"~rudder.{thruster.name}", predictor.answer(s.mass.solve(force)), BOUNDED * thruster.rudder.accuracy
            )


def _thrusts(s: Signatures, out: Columns, relative: tuple[Array, Array, Array]) -> None:
    """Errors of each thruster's curve."""
    for k, thruster in enumerate(s.predictor.vehicle.thrusters):
        errors = s.predictor.propulsion.errors[k]
        answers = thrust_answers(s, k, s.predictor.driving.slopes(s.h, k), relative)
        for name, answer, spread in zip(errors.names(thruster.name), answers, errors.spreads.tolist(), strict=True):
            out.add(name, answer, spread)


def thrust_answers(s: Signatures, k: int, errors: Array, relative: tuple[Array, Array, Array]) -> Iterator[Array]:
    """Signatures of errors of one thruster's thrust.

    Args:
        s: signatures at a hypothesis.
        k: index of the thruster.
        errors: of its thrust [N], shape (errors, 2 n).
        relative: u, v, r relative to the water.
    """
    predictor, p = s.predictor, s.states.points
    thruster = predictor.vehicle.thrusters[k]
    angle, (x, y) = predictor.driving.turned[k], thruster.position
    c, sine = np.cos(angle), np.sin(angle)
    blade = blade_force(predictor.vehicle, k, p, p.thrusts[k], relative)
    # A blade that errs brings that share of what the thrust moves it by as well.
    whole = 1.0 + s.h.declared_errors.get(f"~rudder.{thruster.name}", 0.0)
    # The loss by inflow of an error is small: it takes the same share of the error as of the thrust.
    shares = np.stack([c, sine, x * sine - y * c])
    pushed = s.mass.solve(shares)
    for error in errors:
        process = pushed * error
        if thruster.rudder is not None:
            # The stream on the blade changes with the thrust, and with it the blade's force.
            more = blade_force(predictor.vehicle, k, p, p.thrusts[k] + BLADE_STEP * error, relative)
            process = process + s.mass.solve(whole * (more - blade)) / BLADE_STEP
        yield predictor.answer(process)
