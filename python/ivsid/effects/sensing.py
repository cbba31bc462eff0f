"""Sensors: changes of a reading before its noise.

They act in this order: delay, lever arm, misalignment, then leak, scale and bias.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final, TypeAlias

from ivsid.effects.effect import Effect, Numbers, Parameter, Reading
from ivsid.effects.forms import Grid
from ivsid.effects.quantity import Quantity

Channels: TypeAlias = Mapping[str, Quantity]


def _delay(c: Channels, p: Numbers) -> dict[str, Quantity]:
    u, v, r = c["at"](p[0])
    return {"u": u, "v": v, "r_v": r}


def _velocity_arm(c: Channels, p: Numbers) -> dict[str, Quantity]:
    return {"u": c["u"] - p[1] * c["r_v"], "v": c["v"] + p[0] * c["r_v"]}


def _misalignment(c: Channels, p: Numbers) -> dict[str, Quantity]:
    cosine, sine = math.cos(p[0]), math.sin(p[0])
    return {"u": c["u"] * cosine + c["v"] * sine, "v": c["v"] * cosine - c["u"] * sine}


def _velocity_scale(c: Channels, p: Numbers) -> dict[str, Quantity]:
    return {"u": c["u"] * (1.0 + p[0]), "v": c["v"] * (1.0 + p[0])}


def _acceleration_arm(c: Channels, p: Numbers) -> dict[str, Quantity]:
    r, rdot = c["r_true"], c["rdot"]
    return {"ax": c["ax"] - p[0] * r * r - p[1] * rdot, "ay": c["ay"] + p[0] * rdot - p[1] * r * r}


def _bias(c: Channels, p: Numbers) -> dict[str, Quantity]:
    return {"ax": c["ax"] + p[0], "ay": c["ay"] + p[1]}


VELOCITY_SCALE: Final = Effect(
    "sensor.velocity.scale",
    "the speed sensor reads in wrong units by a few per cent: speed of sound, calibration",
    (Parameter("", "", "1", 0.02, signed=True),),
    Reading(_velocity_scale, "velocity", 4),
    needs=("ax|udot",),
    equivalents=("drag.surge.quadratic", "mass.surge"),
    confusable=("drag.surge.quadratic",),
    separate="strong accelerations with an accelerometer, or a measured position",
)

FAMILY: Final[tuple[Effect, ...]] = (
    Effect(
        "sensor.acceleration.bias",
        "the accelerometer reads a constant too much",
        (
            Parameter("x", "", "m/s^2", 0.02, signed=True),
            Parameter("y", "", "m/s^2", 0.01, signed=True),
        ),
        Reading(_bias, "acceleration", 5),
        needs=("ax|udot", "ay|vdot"),
        equivalents=("wind.steady",),
        confusable=("sensor.attitude_leak", "wind.steady"),
        separate="any motion on two headings",
    ),
    Effect(
        "sensor.acceleration.lever_arm",
        "the accelerometer stands off the origin",
        (Parameter("x", "", "m", 0.08, signed=True), Parameter("y", "", "m", 0.05, signed=True)),
        Reading(_acceleration_arm, "acceleration", 1),
        needs=("ax|udot", "ay|vdot"),
        confusable=("sensor.velocity.lever_arm", "coupling.cg_x"),
        turning=True,
        separate="a zigzag with measured accelerations",
    ),
    Effect(
        "sensor.attitude_leak",
        "gravity leaks into the accelerometer through a pitch that follows the thrust",
        (Parameter("", "", "m/s^2 per N", 2.0e-4, signed=True),),
        Reading(lambda c, p: {"ax": c["ax"] + p[0] * c["thrust"]}, "acceleration", 3),
        needs=("ax|udot",),
        confusable=("sensor.acceleration.bias", "mass.surge"),
        separate="thrust steps with measured accelerations",
    ),
    Effect(
        "sensor.yaw_rate.bias",
        "the gyro reads a constant too much",
        (Parameter("", "", "rad/s", 0.01, signed=True),),
        Reading(lambda c, p: {"r": c["r"] + p[0]}, "yaw_rate", 5),
        needs=("psi",),
        confusable=("drag.yaw.linear", "drag.yaw.quadratic"),
        turning=True,
        separate="a heading that does not come from the gyro",
    ),
    Effect(
        "sensor.yaw_rate.scale",
        "the gyro reads in wrong units by a few per cent",
        (Parameter("", "", "1", 0.02, signed=True),),
        Reading(lambda c, p: {"r": c["r"] * (1.0 + p[0])}, "yaw_rate", 4),
        needs=("psi",),
        confusable=("sensor.yaw_rate.bias",),
        turning=True,
        separate="turns both ways, with a heading that does not come from the gyro",
    ),
    VELOCITY_SCALE,
    Effect(
        "sensor.velocity.misalignment",
        "the speed sensor is turned about the vertical",
        (Parameter("", "", "rad", 0.026, signed=True),),
        Reading(_misalignment, "velocity", 2),
        needs=("ay|vdot",),
        confusable=("drag.lift.sway",),
        turning=True,
        separate="accelerations straight ahead",
    ),
    Effect(
        "sensor.velocity.lever_arm",
        "the speed sensor stands off the origin",
        (Parameter("x", "", "m", 0.1, signed=True), Parameter("y", "", "m", 0.05, signed=True)),
        Reading(_velocity_arm, "velocity", 1),
        needs=("ay|vdot",),
        confusable=("sensor.velocity.delay", "drag.sway.yaw_rate"),
        turning=True,
        separate="a zigzag with measured accelerations",
    ),
    Effect(
        "sensor.velocity.delay",
        "the speed reading is late: filtering, averaging of pings",
        (Parameter("", "", "s", 0.1, lowest=0.0),),
        Reading(_delay, "velocity", 0),
        needs=("ax|udot", "ay|vdot"),
        confusable=("sensor.velocity.lever_arm", "thruster.lag"),
        searched=Grid("seconds"),
        separate="a PRBS or a zigzag with measured accelerations",
    ),
)
