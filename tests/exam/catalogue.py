"""The examiner's own list of what can be hidden: sizes and units from the table of docs/effects.md, scaled after Froude.

A number is drawn as its kind says: ``size`` and ``signed`` are a multiple of the typical size, ``inverse`` divides by it, ``factor``
counts from 1; ``north`` and ``east`` share a drawn direction; ``angle`` is any, ``time`` lies within the log, ``thruster`` is one of the
vehicle's, ``about`` lies within a quarter of its typical value, ``fixed`` stays. The power is that of the length with which the number grows.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

# Mass [kg] to which typical sizes belong.
REFERENCE = 58.0
# part: (typical, power of the length, kind)
Parts = Mapping[str, tuple[float, float, str]]


def one(typical: float, power: float, kind: str = "size") -> Parts:
    return {"": (typical, power, kind)}


EFFECTS: dict[str, Parts] = {
    "coupling.cg_x": one(1.5, 4, "signed"),
    "coupling.cg_y": one(0.5, 4, "signed"),
    "added_mass.munk": one(6.0, 3),
    "payload.step": {"mass": (5.0, 3, "signed"), "time": (0.0, 0, "time")},
    "drag.surge.linear": one(4.0, 2.5),
    "drag.surge.cubic": one(8.0, 1.5),
    "drag.surge.hump": {"height": (8.0, 3, "size"), "speed": (0.9, 0.5, "about"), "width": (0.3, 0.5, "about")},
    "friction.coulomb": one(1.0, 3),
    "drag.surge.astern": one(10.0, 2),
    "drag.surge.sideslip": one(30.0, 2),
    "drag.sway.linear": one(8.0, 2.5),
    "drag.sway.cubic": one(300.0, 1.5),
    "drag.sway.yaw_rate": one(4.0, 3.5, "signed"),
    "drag.yaw.linear": one(1.0, 4.5),
    "drag.yaw.quadratic": one(2.0, 5),
    "drag.yaw.cubic": one(4.0, 5.5),
    "drag.cross_flow": one(25.0, 1),
    "drag.lift.sway": one(10.0, 2),
    "drag.lift.yaw": one(-3.0, 3, "signed"),
    "current.steady": {"north": (0.08, 0.5, "north"), "east": (0.05, 0.5, "east")},
    "current.oscillating": {
        "north": (0.05, 0.5, "north"),
        "east": (0.0, 0.5, "east"),
        "period": (200.0, 0.5, "fixed"),
        "phase": (0.0, 0, "angle"),
    },
    "wind.steady": {"north": (1.0, 3, "north"), "east": (0.6, 3, "east")},
    "wave.force": {
        "amplitude": (2.0, 3, "size"),
        "period": (4.0, 0.5, "fixed"),
        "phase": (0.0, 0, "angle"),
        "direction": (0.0, 0, "angle"),
    },
    "environment.shallow_water": one(0.2, 0, "factor"),
    "tether.tension": {
        "force": (1.5, 3, "size"),
        "anchor_north": (10.0, 1, "anchor_north"),
        "anchor_east": (0.0, 1, "anchor_east"),
        "arm": (-0.5, 1, "fixed"),
    },
    "fouling.drift": one(3.3e-4, -0.5),
    "thruster.gain": one(0.05, 0, "signed"),
    "thruster.asymmetry": one(0.05, 0),
    "thruster.failure": {
        "thruster": (0.0, 0, "thruster"),
        "loss": (0.15, 0, "share"),
        "time": (0.0, 0, "time"),
    },
    "thruster.deadband": one(8.0, 0),
    "thruster.saturation": one(30.0, 3, "inverse"),
    "thruster.lag": one(0.25, 0.5),
    "thruster.shaft_lag": one(0.25, 0.5),
    "thruster.delay": one(0.1, 0.5),
    "thruster.advance_loss": one(0.08, -0.5),
    "thruster.reverse_loss": one(0.2, 0),
    "thruster.voltage_sag": one(2.5e-4, -0.5),
    "thruster.curve": one(0.1, 0, "signed"),
    "sensor.acceleration.bias": {"x": (0.02, 0, "signed"), "y": (0.01, 0, "signed")},
    "sensor.acceleration.lever_arm": {"x": (0.08, 1, "signed"), "y": (0.05, 1, "signed")},
    "sensor.attitude_leak": one(2.0e-4, -3, "signed"),
    "sensor.yaw_rate.bias": one(0.01, -0.5, "signed"),
    "sensor.yaw_rate.scale": one(0.02, 0, "signed"),
    "sensor.velocity.scale": one(0.02, 0, "signed"),
    "sensor.velocity.misalignment": one(0.026, 0, "signed"),
    "sensor.velocity.lever_arm": {"x": (0.1, 1, "signed"), "y": (0.05, 1, "signed")},
    "sensor.velocity.delay": one(0.1, 0.5),
}
# Causes of no list: a drag with the cube of speed, one that depends on the place, a moment and a side force with speed, and a drag
# ahead that grows with the square of the yaw rate (X_rru of Abkowitz 1964), a hump of the wave resistance (Havelock 1909), and a bent
# skeg, which turns to one side whichever way the hull drifts, and a wind's moment, which repeats after half a turn, or
# its force ahead past a deck house, which repeats after a third of one, a motor that loses thrust as it grows warm, a thruster that does
# so as the hull moves, motors that warm with their load and cool down again, a gyro that feels accelerations sideways,
# liquid that swings in a tank, thrusters in each other's wash, thrusts that change no faster than they can, a drag that follows late, and a
# gyro that does.
OUTSIDE: dict[str, Parts] = {
    "x.cubic": one(12.0, 3),
    "x.shear": one(8.0, 3),
    "x.torque": one(0.8, 4),
    "x.side": one(4.0, 3),
    "x.turning": one(20.0, 3.5),
    "x.hump": one(8.0, 3),
    "x.skeg": one(6.0, 3),
    "x.windage": one(0.5, 4),
    "x.house": one(2.0, 4),
    "x.heat": {"thruster": (0.0, 0, "thruster"), "loss": (0.2, 0, "share"), "pace": (60.0, 0.5, "about")},
    "x.tunnel": {"thruster": (0.0, 0, "thruster"), "loss": (0.3, 0, "share"), "pace": (1.0, 0.5, "about")},
    "x.warm": {"loss": (0.15, 0, "share"), "pace": (90.0, 0.5, "about")},
    "x.gyro": one(0.006, -0.5),
    "x.cross": {"loss": (0.2, 0, "share")},
    "x.slew": {"pace": (1.0, 0.5, "about")},
    "x.lazy": {"size": (10.0, 2, "size"), "pace": (3.0, 0.5, "about")},
    "x.slosh": {"share": (0.1, 0, "share"), "period": (2.0, 0.5, "about")},
    "x.late": one(0.05, 0.5),
}
# Claims without which an effect is the same as other masses and drags: docs/theory.md, "Equivalent effects".
CLAIMED = {"thruster.gain": ("mass.surge",)}
# Seeds from which on a cause is drawn: cases of earlier seeds, which tests and pages name, stay what they were when it joined.
SINCE = {
    "thruster.shaft_lag": 90000,
    **dict.fromkeys(("drag.surge.cubic", "drag.sway.cubic", "drag.yaw.cubic", "x.turning"), 91000),
    "x.hump": 95000,
    **dict.fromkeys(("drag.surge.hump", "x.skeg"), 148000),
    "x.windage": 181000,
    "x.house": 195000,
    "x.heat": 201000,
    **dict.fromkeys(("x.tunnel", "x.warm", "x.gyro"), 280000),
    "x.slosh": 290000,
    **dict.fromkeys(("x.cross", "x.slew", "x.lazy"), 300000),
    "x.late": 310000,
}
# Causes outside of the catalogue that joined it, with their names in it, and the seeds before which they are drawn as outside.
# The hump was drawn in another shape than that of the catalogue, so that the numbers of the two are not compared.
JOINED = {"x.cubic": "drag.surge.cubic", "x.hump": "drag.surge.hump"}
UNTIL = {"x.cubic": 91000, "x.hump": 148000}
# Effects that differ between the logs: in one depth, masses and drags are what they are.
ON_TEST_ALONE = ("environment.shallow_water",)


def drawn_by(seed: int) -> list[str]:
    """Effects among which the case of a seed is drawn."""
    return [i for i in EFFECTS if seed >= SINCE.get(i, 0)]


def outside_by(seed: int) -> list[str]:
    """Causes outside of the catalogue among which the case of a seed is drawn."""
    return [i for i in OUTSIDE if SINCE.get(i, 0) <= seed < UNTIL.get(i, math.inf)]


def possible(id_: str, sides: tuple[float, ...]) -> bool:
    """Whether a vehicle with thrusters at these arms [m] to starboard can have the effect."""
    return id_ != "thruster.asymmetry" or min(sides) < 0 < max(sides)


def drawn(
    id_: str, size: float, mass: float, thrusters: int, duration: float, rng: np.random.Generator
) -> dict[str, float]:
    """Numbers by id and part at a multiple of the typical size."""
    parts = {**EFFECTS, **OUTSIDE}[id_]
    length = (mass / REFERENCE) ** (1 / 3)
    angle, sign = float(rng.uniform(0, 2 * math.pi)), float(rng.choice([-1.0, 1.0]))
    reach = math.hypot(*(q for q, _, kind in parts.values() if kind in ("north", "east")))
    out = {}
    for part, (typical, power, kind) in parts.items():
        scaled = typical * length**power
        match kind:
            case "size":
                value = scaled * size
            case "signed":
                value = scaled * size * sign
            case "inverse":
                value = scaled / size
            case "factor":
                value = 1 + scaled * size
            case "share":
                value = min(scaled * size, 1.0)
            case "north":
                value = reach * length**power * size * math.cos(angle)
            case "east":
                value = reach * length**power * size * math.sin(angle)
            # The anchor of a tether stays where it is, whatever the pull: its size is the force alone.
            case "anchor_north":
                value = 10.0 * length * math.cos(angle)
            case "anchor_east":
                value = 10.0 * length * math.sin(angle)
            case "about":
                value = scaled * float(rng.uniform(0.75, 1.25))
            case "angle":
                value = float(rng.uniform(0, 2 * math.pi))
            case "time":
                value = float(rng.uniform(0.25, 0.75)) * duration
            case "thruster":
                value = float(rng.integers(thrusters))
            case _:
                value = scaled
        out[f"{id_}.{part}" if part else id_] = value
    return out
