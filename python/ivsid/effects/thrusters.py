"""Thrusters: changes of a thrust between its demand and the water."""

from __future__ import annotations

from typing import Final

import numpy as np

from ivsid.effects.effect import Drive, Effect, Inflow, Key, Numbers, Parameter, Response, Thrust
from ivsid.effects.forms import Grid
from ivsid.effects.functions import after
from ivsid.effects.quantity import Quantity

# Typical limit of a thrust, in the largest thrust of the vehicle's curves.
# Source: definition: a limit that takes the last third of the curve
CAPPED: Final = 2.0 / 3.0


def _asymmetry(thrust: Quantity, drive: Drive, p: Numbers) -> Quantity:
    # The side is the sign of the arm; a thruster on the centre line has none.
    side = (drive.y > 0) - (drive.y < 0)
    return thrust * (1.0 - side * p[0])


def _failure(thrust: Quantity, drive: Drive, p: Numbers) -> Quantity:
    index, loss, start = p
    return thrust * (1.0 - loss * after(drive.time, start)) if drive.index == round(index) else thrust


def _deadband(thrust: Quantity, drive: Drive, p: Numbers) -> Quantity:
    return _where(abs(drive.demand) < p[0], 0.0, thrust)


def _saturation(thrust: Quantity, _drive: Drive, p: Numbers) -> Quantity:
    return min(max(thrust, -p[0]), p[0]) if isinstance(thrust, float) else np.clip(thrust, -p[0], p[0])


def _reverse(thrust: Quantity, _drive: Drive, p: Numbers) -> Quantity:
    return _where(thrust < 0, thrust * (1.0 - p[0]), thrust)


def _sag(thrust: Quantity, drive: Drive, p: Numbers) -> Quantity:
    # An empty battery gives no thrust; without the bound at 0 the thrust would reverse.
    return thrust * np.maximum(1.0 - p[0] * drive.time, 0.0)


def _sag_measured(thrust: Quantity, drive: Drive, p: Numbers) -> Quantity:
    # T is multiplied by (voltage / first voltage) ^ p if the voltage is logged.
    return thrust if drive.voltage is None else thrust * drive.voltage ** p[0]


def _curve(thrust: Quantity, drive: Drive, p: Numbers) -> Quantity:
    return thrust + p[0] * thrust * (1.0 - abs(thrust) / drive.reference)


def _advance(thrust: Quantity, inflow: Quantity, p: Numbers) -> Quantity:
    return thrust - abs(thrust) * inflow * p[0]


def _where(condition: Quantity, yes: Quantity, no: Quantity) -> Quantity:
    return np.where(condition, yes, no) if isinstance(condition, np.ndarray) else (yes if condition else no)


def _one(
    unit: str,
    typical: float,
    *,
    signed: bool = False,
    inverse: bool = False,
    lowest: float | None = None,
    exclusive: bool = False,
    of_thrust: float = 0.0,
) -> tuple[Parameter, ...]:
    return (
        Parameter(
            "",
            "",
            unit,
            typical,
            signed=signed,
            inverse=inverse,
            lowest=lowest,
            exclusive=exclusive,
            of_thrust=of_thrust,
        ),
    )


ONE_FACTOR: Final = Effect(
    "thruster.gain",
    "every thrust differs by one factor: density of the water, battery, wear",
    _one("1", 0.05, signed=True),
    Thrust(lambda thrust, _drive, p: thrust * (1.0 + p[0])),
    equivalents=("mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic"),
    one_factor=True,
    separate="weigh the vehicle, tow it, or repeat the bollard pull",
    per_thruster=True,
)

FAMILY: Final[tuple[Effect, ...]] = (
    ONE_FACTOR,
    Effect(
        "thruster.asymmetry",
        "the two sides push unequally",
        _one("1", 0.05, signed=True),
        Thrust(_asymmetry),
        equivalents=("thruster.failure",),
        equivalent_odds=(0.3,),
        confusable=("coupling.cg_y",),
        asks=("both_sides",),
        turning=True,
        separate="straight runs at several thrusts",
    ),
    Effect(
        "thruster.failure",
        "one thruster loses a share of its thrust at a time",
        (
            Parameter("thruster", "", "1", 0.0, draw="thruster"),
            Parameter("loss", "", "1", 0.15, most=1.0),
            Parameter("time", "", "s", 0.0, draw="time"),
        ),
        Thrust(_failure, timed=True),
        confusable=("thruster.asymmetry",),
        separate="straight runs before and after",
    ),
    Effect(
        "thruster.deadband",
        "no thrust below a demand: the motor does not start",
        _one("demand", 8.0, lowest=0.0),
        Thrust(_deadband),
        confusable=("friction.coulomb",),
        searched=Grid("demand"),
        key=Key("dead_band"),
        separate="demands just above and just below",
        per_thruster=True,
    ),
    Effect(
        "thruster.saturation",
        "a current limit caps the thrust",
        _one("N", 30.0, inverse=True, lowest=0.0, exclusive=True, of_thrust=CAPPED),
        Thrust(_saturation),
        confusable=("thruster.advance_loss", "thruster.curve"),
        searched=Grid("thrust"),
        key=Key("limit"),
        separate="full demand at rest, as in a bollard pull",
        per_thruster=True,
    ),
    Effect(
        "thruster.lag",
        "rotor and drive need time to follow their demand",
        _one("s", 0.25, lowest=0.0),
        Response("lag"),
        equivalents=("thruster.delay", "thruster.shaft_lag"),
        confusable=("thruster.delay", "sensor.velocity.delay"),
        key=Key("time_constant"),
        separate="steps, sampled faster than a third of the time constant",
        per_thruster=True,
    ),
    Effect(
        "thruster.shaft_lag",
        "the shaft needs time to follow its demand, and the thrust follows the square of its speed",
        _one("s", 0.25, lowest=0.0),
        Response("shaft"),
        equivalents=("thruster.lag", "thruster.delay"),
        confusable=("thruster.lag", "thruster.delay"),
        separate="large steps both ways: the thrust of a shaft rises late and falls early, that of a lag does both alike",
        per_thruster=True,
    ),
    Effect(
        "thruster.delay",
        "the demand arrives late: network or transport",
        _one("s", 0.1, lowest=0.0),
        Response("delay"),
        equivalents=("thruster.lag", "thruster.shaft_lag"),
        confusable=("thruster.lag", "sensor.velocity.delay"),
        separate="steps, sampled faster than a third of the delay",
        per_thruster=True,
    ),
    Effect(
        "thruster.advance_loss",
        "thrust falls with the speed of the water that comes in",
        _one("s/m", 0.08),
        Inflow(_advance),
        confusable=("drag.surge.linear", "thruster.curve", "thruster.saturation"),
        key=Key("advance_loss"),
        separate="high thrust at rest against high thrust at speed; a zigzag",
        per_thruster=True,
    ),
    Effect(
        "thruster.reverse_loss",
        "thrust astern is weaker than the curve says",
        _one("1", 0.2),
        Thrust(_reverse),
        confusable=("drag.surge.astern",),
        key=Key("reverse_factor", share_left=True),
        separate="turns on the spot and braking, with demands of both signs",
        per_thruster=True,
    ),
    Effect(
        "thruster.voltage_sag",
        "the battery runs down and every thrust with it",
        _one("1/s", 2.5e-4),
        Thrust(_sag, timed=True),
        confusable=("fouling.drift", "payload.step"),
        separate="the same programme at the start and the end; turns on the spot need thrust without drag",
        measured=Effect(
            "thruster.voltage_sag",
            "thrust follows the supply's voltage by a power",
            (Parameter("power", "", "1", 1.0),),
            Thrust(_sag_measured, timed=True),
            needs=("voltage",),
        ),
    ),
    Effect(
        "thruster.curve",
        "the shape of the thrust curve is wrong between rest and full thrust",
        _one("1", 0.1, signed=True),
        Thrust(_curve),
        confusable=("thruster.advance_loss", "drag.surge.linear", "friction.coulomb"),
        asks=("largest_thrust",),
        separate="a bollard pull",
        per_thruster=True,
    ),
)
