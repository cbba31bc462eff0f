"""What the vehicle file declares, as signatures: sensor biases and scale, smooth thrust errors, the rudders' accuracy."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.signatures import Columns, Signatures
from ivsid.diagnosis.plant.physics import water
from ivsid.diagnosis.plant.thruster_forces import blade_force

Array = NDArray[np.float64]
# Thrust errors are one wave or a sum of a few: the standard deviation of each, in units of the bound.
SHARE: Final = 0.6
# A step of a thrust error, in units of its bound.
SLIGHT: Final = 0.05


def nuisances(s: Signatures) -> Columns:
    """The errors that one unit of each declared error would leave, with its standard deviation as ``prior``."""
    out = Columns()
    _sensors(s, out)
    p = s.states.points
    u_c, v_c, _, _ = water(s.h, p)
    relative = (p.nu[0] - u_c, p.nu[1] - v_c, p.nu[2])
    _blades(s, out, relative)
    _thrusts(s, out, relative)
    return out


def _sensors(s: Signatures, out: Columns) -> None:
    predictor, log = s.predictor, s.predictor.log
    sensors = predictor.vehicle.sensors
    none = np.zeros_like(s.states.nudot)
    if sensors.acceleration is not None:
        for k, name in enumerate(("ax", "ay")):
            size = sensors.acceleration.axis(k)[0] + 0.6 * sensors.acceleration.accuracy
            if log.acceleration[k] is not None and size:
                for j, wave in enumerate(predictor.slow):
                    out.add(f"~bias.{name}.{j}", predictor.answer(none, reading={name: wave}), size)
    if sensors.yaw_rate is not None and log.psi is not None:
        size = sensors.yaw_rate.axis(0)[0] + 0.6 * sensors.yaw_rate.accuracy
        if size:
            for j, wave in enumerate(predictor.slow):
                out.add(f"~bias.r.{j}", predictor.misread(s.h, s.states, {"r": wave * 1e-3}, mass=s.mass) / 1e-3, size)
    if sensors.velocity is not None and sensors.velocity.scale_factor_error:
        out.add("~scale.velocity", s.reading("sensor.velocity.scale")[0], 0.7 * sensors.velocity.scale_factor_error)


def _blades(s: Signatures, out: Columns, relative: tuple[Array, Array, Array]) -> None:
    """The same share of all of a blade's force."""
    predictor, p = s.predictor, s.states.points
    for k, thruster in enumerate(predictor.vehicle.thrusters):
        if thruster.rudder is not None and thruster.rudder.accuracy:
            force = blade_force(predictor.vehicle, k, p, p.thrusts[k], relative)
            out.add(f"~rudder.{thruster.name}", predictor.answer(s.mass.solve(force)), SHARE * thruster.rudder.accuracy)


def _thrusts(s: Signatures, out: Columns, relative: tuple[Array, Array, Array]) -> None:
    predictor, p = s.predictor, s.states.points
    for k, thruster in enumerate(predictor.vehicle.thrusters):
        angle, (x, y) = predictor.driving.turned[k], thruster.position
        c, sine = np.cos(angle), np.sin(angle)
        # A loss by inflow takes the same share of the error as of the thrust, which is small.
        shares = np.stack([c, sine, x * sine - y * c])
        blade = blade_force(predictor.vehicle, k, p, p.thrusts[k], relative)
        for j, shape in enumerate(predictor.driving.shapes(s.h, k)):
            force = shares * shape
            if thruster.rudder is not None:
                # The stream on the blade has the error, too.
                pushed = p.thrusts[k] + SLIGHT * shape
                force = force + (blade_force(predictor.vehicle, k, p, pushed, relative) - blade) / SLIGHT
            out.add(f"~thrust.{thruster.name}.{j}", predictor.answer(s.mass.solve(force)), SHARE)
