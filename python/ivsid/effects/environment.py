"""The environment: current, wind, waves, depth, tether, growth."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Final

from ivsid.effects.drag import SURGE_QUADRATIC, SWAY_QUADRATIC
from ivsid.effects.effect import Change, Current, Effect, Force, Numbers, Parameter, Terms
from ivsid.effects.forms import Anchored, Harmonic
from ivsid.effects.functions import cos, sin, sqrt, square
from ivsid.effects.inertia import MASS_SURGE, MASS_SWAY
from ivsid.effects.quantity import Quantity
from ivsid.effects.terms import Columns, Place, State, Term
from ivsid.errors import IvsidError

# Above its anchor a tether hangs straight down and has no horizontal pull: within this distance [m] the pull fades.
# Source: definition: the effect tether.tension of the catalogue.
TETHER_RADIUS: Final = 0.05
# The parameters that shallow water changes by one factor.
SHALLOW_SCALED: Final = (MASS_SURGE.id, MASS_SWAY.id, SURGE_QUADRATIC.id, SWAY_QUADRATIC.id)


def _place(state: State) -> Place:
    if state.place is None:
        raise IvsidError("the term depends on heading or place; give columns psi, x, y with their sensors")
    return state.place


def earth_to_body(place: Place, north: Quantity, east: Quantity) -> tuple[Quantity, Quantity]:
    """Surge and sway of a vector that is given north and east, in its unit."""
    c, s = cos(place.psi), sin(place.psi)
    return north * c + east * s, east * c - north * s


def _steady(p: Numbers, _t: Quantity) -> tuple[Quantity, Quantity, Quantity, Quantity]:
    return p[0], p[1], 0.0, 0.0


def _oscillating(p: Numbers, t: Quantity) -> tuple[Quantity, Quantity, Quantity, Quantity]:
    north, east, period, phase = p
    w = 2 * math.pi / period
    wave, rate = sin(t * w + phase), cos(t * w + phase) * w
    return wave * north, wave * east, rate * north, rate * east


def _wind_column(north: float, east: float) -> Callable[[State], Columns]:
    def columns(state: State) -> Columns:
        surge, sway = earth_to_body(_place(state), north, east)
        return {"surge": -surge, "sway": -sway}

    return columns


def _apparent(state: State) -> tuple[Quantity, Quantity, Quantity]:
    place = _place(state)
    if place.wind_surge is None:
        raise IvsidError(
            "the wind is not known; give columns wind_speed and wind_direction, or the wind.steady of earth axes"
        )
    return place.wind_surge, place.wind_sway, sqrt(square(place.wind_surge) + square(place.wind_sway))


def _wind_surge(state: State) -> Columns:
    surge, _, speed = _apparent(state)
    return {"surge": -(speed * surge)}


def _wind_sway(state: State) -> Columns:
    _, sway, speed = _apparent(state)
    return {"sway": -(speed * sway)}


def _wave(state: State, p: Numbers) -> Columns:
    amplitude, period, phase, direction = p
    place = _place(state)
    size = sin(place.t * (2 * math.pi / period) + phase) * amplitude
    surge, sway = earth_to_body(place, size * math.cos(direction), size * math.sin(direction))
    return {"surge": surge, "sway": sway}


def _tether(state: State, p: Numbers) -> Columns:
    force, anchor_north, anchor_east, arm = p
    place = _place(state)
    # The arm is short beside the tether: the direction of the pull is taken at the origin.
    north, east = anchor_north - place.x, anchor_east - place.y
    distance = sqrt(square(north) + square(east) + TETHER_RADIUS**2)
    surge, sway = earth_to_body(place, north / distance * force, east / distance * force)
    return {"surge": surge, "sway": sway, "yaw": sway * arm}


def _shallow(plain: Mapping[str, Quantity], p: Numbers, _t: Quantity) -> dict[str, Quantity]:
    return {id_: plain[id_] * p[0] for id_ in SHALLOW_SCALED if id_ in plain}


def _fouling(plain: Mapping[str, Quantity], p: Numbers, t: Quantity) -> dict[str, Quantity]:
    id_ = SURGE_QUADRATIC.id
    return {id_: plain[id_] * (t * p[0] + 1.0)} if id_ in plain else {}


WIND_TERMS: Final = (
    Term("wind.steady.north", "", "N", _wind_column(1.0, 0.0)),
    Term("wind.steady.east", "", "N", _wind_column(0.0, 1.0)),
)

_MEASURED_WIND: Final = Effect(
    "wind.steady",
    "wind on the hull above water, from the measured wind",
    (
        Parameter("surge", "", "N/(m/s)^2", 0.02),
        Parameter("sway", "", "N/(m/s)^2", 0.04),
    ),
    Terms(
        (
            Term("wind.steady.surge", "rho_a A c_x / 2", "N/(m/s)^2", _wind_surge),
            Term("wind.steady.sway", "rho_a A c_y / 2", "N/(m/s)^2", _wind_sway),
        )
    ),
    needs=("psi", "wind_speed", "wind_direction"),
    confusable=("current.steady",),
    separate="full turns at rest and at speed",
)

STEADY_CURRENT: Final = Effect(
    "current.steady",
    "the water moves at a constant velocity over ground",
    (Parameter("north", "V_N", "m/s", 0.08, draw="north"), Parameter("east", "V_E", "m/s", 0.05, draw="east")),
    Current(_steady),
    needs=("psi",),
    equivalents=("wind.steady",),
    confusable=("wind.steady", "drag.surge.linear"),
    separate="two or more headings, each at two speeds",
    stated="current",
)

SHALLOW_WATER: Final = Effect(
    "environment.shallow_water",
    "little water under the keel: masses and drags grow alike",
    (Parameter("", "", "1", 1.2, none=1.0, lowest=0.0, exclusive=True),),
    Change(_shallow),
    needs=("depth",),
    equivalents=SHALLOW_SCALED,
    separate="the same programme in deep water",
    hidden="one log at one depth does not tell it from other masses and drags",
)

FAMILY: Final[tuple[Effect, ...]] = (
    STEADY_CURRENT,
    Effect(
        "current.oscillating",
        "the water moves to and fro: a tide or a seiche",
        (
            Parameter("north", "", "m/s", 0.05, draw="north"),
            Parameter("east", "", "m/s", 0.0, draw="east"),
            Parameter("period", "", "s", 200.0, draw="fixed", lowest=0.0, exclusive=True),
            Parameter("phase", "", "rad", 0.0, draw="angle"),
        ),
        Current(_oscillating),
        needs=("psi",),
        confusable=("fouling.drift", "wave.force"),
        searched=Harmonic("flow"),
        separate="a log of several periods, on more than one heading",
    ),
    Effect(
        "wind.steady",
        "wind pushes the hull with a force that keeps its direction over ground",
        (Parameter("north", "", "N", 1.0, draw="north"), Parameter("east", "", "N", 0.6, draw="east")),
        Terms(WIND_TERMS),
        needs=("psi",),
        equivalents=("current.steady", "sensor.acceleration.bias"),
        confusable=("current.steady",),
        separate="full turns at rest and at speed; speed changes on each heading",
        measured=_MEASURED_WIND,
    ),
    Effect(
        "wave.force",
        "a regular swell pushes to and fro along its direction",
        (
            Parameter("amplitude", "", "N", 2.0),
            Parameter("period", "", "s", 4.0, draw="fixed", lowest=0.0, exclusive=True),
            Parameter("phase", "", "rad", 0.0, draw="angle"),
            Parameter("direction", "", "rad", 0.0, draw="angle"),
        ),
        Force(_wave),
        needs=("psi",),
        searched=Harmonic("force"),
        separate="a log of more than twenty periods",
    ),
    SHALLOW_WATER,
    Effect(
        "tether.tension",
        "a tether pulls toward its anchor with a constant force, which fades within some 0.05 m of it",
        (
            Parameter("force", "", "N", 1.5),
            Parameter("anchor_north", "", "m", 10.0, draw="north"),
            Parameter("anchor_east", "", "m", 0.0, draw="east"),
            Parameter("arm", "", "m", -0.5, draw="fixed"),
        ),
        Force(_tether),
        needs=("psi", "x", "y"),
        confusable=("wind.steady", "drag.surge.linear"),
        searched=Anchored(),
        separate="go round the anchor",
    ),
    Effect(
        "fouling.drift",
        "growth or weed makes the drag in surge increase with time",
        (Parameter("", "", "1/s", 3.3e-4),),
        Change(_fouling),
        confusable=("thruster.voltage_sag", "drag.surge.linear"),
        separate="the same programme at the start and the end; turns on the spot need thrust without drag",
    ),
)
