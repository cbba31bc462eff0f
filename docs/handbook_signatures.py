"""The signature of each effect in the handbook: the standard boat sails a standard programme with it, and the plain model is fitted.

The effect has its typical size and the sensors no noise. Nothing of the diagnosis stands in it but how a force is ordered along a quantity.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from ivsid.diagnosis.statements.binning import ordered_by
from ivsid.effects import (
    CHANNELS,
    PLAIN_TERMS,
    Effect,
    Reading,
    State,
)
from ivsid.programme.scenario import parse_scenario
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.simulation import Simulated, simulate
from ivsid.vehicle import parse_vehicle

Array = NDArray[np.float64]
BOAT = """
name = "standard boat"
[hull]
mass = 50
length = 1.2
[[thrusters]]
name = "port"
position = [-0.35, -0.28]
table = { demand = [-100, -60, -30, 0, 30, 60, 100], thrust = [-30.0, -14.0, -5.0, 0.0, 6.0, 18.0, 40.0] }
[[thrusters]]
name = "starboard"
position = [-0.35, 0.28]
table = { demand = [-100, -60, -30, 0, 30, 60, 100], thrust = [-30.0, -14.0, -5.0, 0.0, 6.0, 18.0, 40.0] }
[sensors]
[sensors.velocity]
accuracy = 0.002
[sensors.acceleration]
random_walk = 0.002
[sensors.yaw_rate]
random_walk = 0.001
[sensors.heading]
accuracy = 0.005
[sensors.position]
accuracy = 0.5
"""
TRUTH = {
    "mass.surge": 58.0,
    "mass.sway": 75.0,
    "inertia.yaw": 9.0,
    "drag.surge.quadratic": 28.0,
    "drag.sway.quadratic": 150.0,
}
HELM = "yaw_gain = 30.0\ndifferential_limit = 40.0\n"
# Steps, a coast, astern, zigzags, circles both ways at two speeds, a turn on the spot: nearly all that excites anything.
PROGRAMME = "".join(
    f'[[segments]]\nmanoeuvre = "{kind}"\nduration = {seconds}\n{numbers}'
    for kind, seconds, numbers in (
        ("steps", 32, f"demand = [90.0, 30.0, 60.0, 8.0]\nperiod = 8.0\n{HELM}"),
        ("zigzag", 24, f"demand = 60.0\nyaw_rate = 0.45\nperiod = 4.0\n{HELM}"),
        ("coast", 14, ""),
        ("steady", 10, f"demand = -60.0\n{HELM}"),
        ("circle", 18, f"demand = 70.0\nyaw_rate = -0.5\n{HELM}"),
        ("circle", 18, f"demand = 35.0\nyaw_rate = 0.35\n{HELM}"),
        ("circle", 16, f"demand = 0.0\nyaw_rate = 0.7\n{HELM}"),
        ("prbs", 20, f"demand = 45.0\namplitude = 35.0\ndifferential = 8.0\nperiod = 2.5\n{HELM}"),
    )
)
SECONDS, RATE = 152.0, 10.0
SCALE = np.array([0.15, 0.15, 0.03])
BAND = 0.35
# A claim that is wrong by this share, for the terms of the plain model.
CLAIM = 0.1


@dataclass(frozen=True)
class Signature:
    """The force or residual that an effect leaves.

    Attributes:
        channel: of the figure.
        unit: of the residual.
        time: [s].
        whole: with the plain model's parameters at their true values.
        left: after they are fitted anew.
        quantity: that orders it best, with its values.
        share: of the energy that the fit leaves; None for a kinematic residual, which no fit touches.
    """

    channel: str
    unit: str
    time: Array
    whole: Array
    left: Array
    quantity: str
    values: Array
    share: float | None


def values_of(effect: Effect) -> dict[str, float]:
    """Typical numbers; times stand in the middle of the programme."""
    return {
        name: 0.5 * SECONDS if p.draw == "time" else (0.6 if p.draw == "angle" else p.typical)
        for name, p in zip(effect.parts, effect.parameters, strict=True)
    }


def sailed(effect: Effect | None) -> Simulated:
    """The programme, with an effect or without."""
    vehicle = parse_vehicle(BOAT, "boat.toml")
    head = f'duration = {SECONDS}\nrate = {RATE}\nnoise = "none"\n[truth]\n'
    text = head + "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items()) + PROGRAMME
    numbers = {} if effect is None or effect.plain else values_of(effect)
    return simulate(vehicle, parse_scenario(text, "programme.toml"), 1, numbers)


def signature(effect: Effect) -> Signature:
    """The signature of the effect in the standard programme."""
    made = sailed(effect)
    c, t = made.columns, made.t
    state = State(
        c["u"],
        c["v"],
        c["r"],
        c["ax"] + c["v"] * c["r"],
        c["ay"] - c["u"] * c["r"],
        made.exact["rdot"],
        ax=c["ax"],
        ay=c["ay"],
    )
    thrust = thrusts(c)
    quantities = {
        "u": c["u"],
        "v": c["v"],
        "r": c["r"],
        "heading": np.mod(c["psi"], 2 * np.pi),
        "thrust ahead": thrust[0],
        "turning moment": thrust[2],
        "udot": state.udot,
        "vdot": state.vdot,
        "rdot": state.rdot,
        "u v": c["u"] * c["v"],
        "u r": c["u"] * c["r"],
        "time": t,
    }
    quantities = {k: low(x) if k not in ("heading", "time") else x for k, x in quantities.items()}
    if isinstance(effect.acts, Reading):
        # The error of differencing at a jump of thrust stands in both, and cancels.
        rows = low(kinematic(c, t) - kinematic(made.exact, t))
        k = int(np.argmax(rows.std(axis=1) + np.abs(rows.mean(axis=1))))
        return finished(f"K{k + 1}", ("m/s²", "m/s²", "rad/s")[k], t, rows[k], rows[k], quantities, None)
    columns = np.stack(
        [np.stack([term.columns(state).get(ch, 0.0) * np.ones(t.size) for ch in CHANNELS]) for term in PLAIN_TERMS]
    )
    theta = np.array([TRUTH[term.id] for term in PLAIN_TERMS])
    if effect.plain:
        # The claim is short of the truth, and is not fitted.
        theta = theta * np.array([1 - CLAIM if term.id == effect.id else 1.0 for term in PLAIN_TERMS])
    free = [k for k, term in enumerate(PLAIN_TERMS) if term.id != effect.id]
    columns, force = low(columns), low(thrust)
    whole = np.einsum("k,kcn->cn", theta, columns) - force
    A = (columns[free] / SCALE[:, None]).reshape(len(free), -1).T
    moved = np.linalg.lstsq(A, (whole / SCALE[:, None]).ravel(), rcond=1e-9)[0]
    left = whole - np.einsum("k,kcn->cn", moved, columns[free])
    energy = ((whole / SCALE[:, None]) ** 2).sum(axis=1)
    rest = ((left / SCALE[:, None]) ** 2).sum(axis=1)
    # The channel with the largest remainder; without any remainder, the one with the largest force.
    k = int(np.argmax(rest if rest.sum() > 1e-3 * energy.sum() else energy))
    share = float(rest.sum() / energy.sum())
    return finished(("X", "Y", "N")[k], "N m" if k == 2 else "N", t, whole[k], left[k], quantities, share)


def kinematic(c: Mapping[str, Array], t: Array) -> Array:
    """K1, K2, K3 of readings, shape (3, n)."""
    u, v, psi = (np.gradient(c[n], t) for n in ("u", "v", "psi"))
    return np.stack([c["ax"] - u + c["v"] * c["r"], c["ay"] - v - c["u"] * c["r"], c["r"] - psi])


def finished(
    channel: str, unit: str, t: Array, whole: Array, left: Array, quantities: dict[str, Array], share: float | None
) -> Signature:
    """With the quantity that orders the remainder best."""
    size = float(np.abs(whole).max())
    shown = left if float(np.abs(left).max()) > 0.02 * size else whole
    if share is None and float(np.ptp(whole)) < 0.05 * size:
        name = "time"
    else:
        # Rounded numbers do not depend on the last digit of a machine's sine.
        name = ordered_by(np.round(shown / size, 5), {k: np.round(x, 6) for k, x in quantities.items()})
    return Signature(channel, unit, t, whole, left, name, quantities[name], share)


def thrusts(columns: dict[str, Array]) -> Array:
    """Nominal forces of the demands: X, Y, N, shape (3, n)."""
    total = np.zeros((3, columns["u"].size))
    for t in parse_vehicle(BOAT, "boat.toml").thrusters:
        push = ThrustCurve(t).value(columns[f"demand_{t.name}"])
        x, y = t.position
        c, s = np.cos(t.azimuth), np.sin(t.azimuth)
        total += np.stack([push * c, push * s, push * (x * s - y * c)])
    return total


def low(x: Array) -> Array:
    """Low-passed without a shift in time."""
    return np.asarray(sosfiltfilt(butter(4, BAND, fs=RATE, output="sos"), x, axis=-1))
