"""Meaning of a parameter's id, written down a second time: its column in each equation of motion (docs/theory.md, "Rows").

Columns are made of ``+``, ``-``, ``*`` and the methods that ``Range`` and ``Motion`` share.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Final, TypeAlias

from ivsid.vehicle import Vehicle
from ivsid.verification.decimals import stated
from ivsid.verification.errors import UncheckedError
from ivsid.verification.rational import Range, cosine, sided, sine, tanh, to_range

CHANNELS: Final = ("surge", "sway", "yaw")

Operand: TypeAlias = "Motion | Range | Fraction | int"
# A Range, a Motion or an Unknown: the columns are written once for all of them, by the operators that they share.
Quantity: TypeAlias = Any


@dataclass(frozen=True)
class Motion:
    """A value with its rate of change."""

    value: Range
    rate: Range

    def __add__(self, other: Operand) -> Motion:
        o = moving(other)
        return Motion(self.value + o.value, self.rate + o.rate)

    __radd__ = __add__

    def __neg__(self) -> Motion:
        return Motion(-self.value, -self.rate)

    def __sub__(self, other: Operand) -> Motion:
        return self + (-moving(other))

    def __rsub__(self, other: Operand) -> Motion:
        return moving(other) - self

    def __mul__(self, other: Operand) -> Motion:
        o = moving(other)
        return Motion(self.value * o.value, self.rate * o.value + self.value * o.rate)

    __rmul__ = __mul__

    def __abs__(self) -> Motion:
        return Motion(abs(self.value), sided(self.rate.largest()))

    def square(self) -> Motion:
        """``x^2``."""
        return Motion(self.value.square(), self.value * self.rate * 2)

    def signed_square(self) -> Motion:
        """``x |x|``."""
        return Motion(self.value.signed_square(), abs(self.value) * self.rate * 2)

    def cube(self) -> Motion:
        """``x^3``."""
        return Motion(self.value.cube(), self.value.square() * self.rate * 3)

    def negative_part(self) -> Motion:
        """``min(x, 0)``, whose rate is that of x or 0."""
        return Motion(self.value.negative_part(), self.rate.hull(Range(0)))


def moving(x: Operand) -> Motion:
    """A constant as a motion."""
    return x if isinstance(x, Motion) else Motion(to_range(x), Range(0))


@dataclass(frozen=True)
class State:
    """u, v [m/s], r [rad/s] and their derivatives; specific forces [m/s^2] where they are measured; the heading [rad].

    Each is a ``Range`` or a ``Motion``; an acceleration may be a ``columns.Unknown``.
    """

    u: Quantity
    v: Quantity
    r: Quantity
    udot: Quantity
    vdot: Quantity
    rdot: Quantity
    measured_ax: Quantity = None
    measured_ay: Quantity = None
    psi: Quantity = None

    @property
    def ax(self) -> Quantity:
        """``udot - v r``."""
        return self.udot - self.v * self.r if self.measured_ax is None else self.measured_ax

    @property
    def ay(self) -> Quantity:
        """``vdot + u r``."""
        return self.vdot + self.u * self.r if self.measured_ay is None else self.measured_ay


Columns = dict[str, Quantity]
Column = Callable[[State], Columns]


def _astern(u: Quantity) -> Quantity:
    negative = u.negative_part()
    if isinstance(u, Motion):
        return Motion(negative.value.signed_square(), abs(negative.value) * u.rate * 2)
    return negative.signed_square()


def _friction(u: Quantity) -> Quantity:
    scaled = u * 50
    if isinstance(scaled, Motion):
        value = tanh(scaled.value)
        return Motion(value, (1 - value.square()) * scaled.rate)
    return tanh(scaled)


def _cos(x: Quantity) -> Quantity:
    return Motion(cosine(x.value), -(sine(x.value) * x.rate)) if isinstance(x, Motion) else cosine(x)


def _sin(x: Quantity) -> Quantity:
    return Motion(sine(x.value), cosine(x.value) * x.rate) if isinstance(x, Motion) else sine(x)


def _north(s: State) -> Columns:
    """A force of 1 N to the north acts as (cos psi, -sin psi) on X, Y; on the left-hand side its sign is reversed."""
    return {} if s.psi is None else {"surge": -_cos(s.psi), "sway": _sin(s.psi)}


def _east(s: State) -> Columns:
    return {} if s.psi is None else {"surge": -_sin(s.psi), "sway": -_cos(s.psi)}


_TERMS: Final[dict[str, tuple[str, str, Column]]] = {
    "mass.surge": ("m - X_udot", "kg", lambda s: {"surge": s.udot, "sway": s.u * s.r}),
    "mass.sway": ("m - Y_vdot", "kg", lambda s: {"surge": -(s.v * s.r), "sway": s.vdot}),
    "inertia.yaw": ("I_z - N_rdot", "kg m^2", lambda s: {"yaw": s.rdot}),
    "coupling.cg_x": (
        "m x_G - Y_rdot",
        "kg m",
        lambda s: {"surge": -s.r.square(), "sway": s.rdot, "yaw": s.ay},
    ),
    "coupling.cg_y": ("m y_G", "kg m", lambda s: {"surge": -s.rdot, "sway": -s.r.square(), "yaw": -s.ax}),
    "added_mass.munk": ("X_udot - Y_vdot", "kg", lambda s: {"yaw": s.u * s.v}),
    "drag.surge.quadratic": ("-X_|u|u", "kg/m", lambda s: {"surge": s.u.signed_square()}),
    "drag.sway.quadratic": ("-Y_|v|v", "kg/m", lambda s: {"sway": s.v.signed_square()}),
    "drag.surge.linear": ("-X_u", "kg/s", lambda s: {"surge": s.u}),
    "drag.surge.cubic": ("-X_uuu", "kg s/m^2", lambda s: {"surge": s.u.cube()}),
    "friction.coulomb": ("F_c", "N", lambda s: {"surge": _friction(s.u)}),
    "drag.surge.astern": ("X_a", "kg/m", lambda s: {"surge": _astern(s.u)}),
    "drag.surge.sideslip": ("-X_vv", "kg/m", lambda s: {"surge": s.v.square()}),
    "drag.sway.linear": ("-Y_v", "kg/s", lambda s: {"sway": s.v}),
    "drag.sway.cubic": ("-Y_vvv", "kg s/m^2", lambda s: {"sway": s.v.cube()}),
    "drag.sway.yaw_rate": ("-Y_r", "kg m/s", lambda s: {"sway": s.r}),
    "drag.yaw.linear": ("-N_r", "N m s", lambda s: {"yaw": s.r}),
    "drag.yaw.quadratic": ("-N_|r|r", "N m s^2", lambda s: {"yaw": s.r.signed_square()}),
    "drag.yaw.cubic": ("-N_rrr", "N m s^3", lambda s: {"yaw": s.r.cube()}),
    "drag.lift.sway": ("-Y_|u|v", "kg/m", lambda s: {"sway": abs(s.u) * s.v}),
    "drag.lift.yaw": ("-N_uv", "kg", lambda s: {"yaw": s.u * s.v}),
}
_WIND: Final[dict[str, tuple[str, str, Column]]] = {
    "wind.steady.north": ("", "N", _north),
    "wind.steady.east": ("", "N", _east),
}
_PLAIN: Final = ("mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic")
_SHARED_MASS: Final[Column] = lambda s: {"surge": s.ax, "sway": s.ay}  # noqa: E731 - beside its table
_SHARED_DRAG: Final[Column] = lambda s: {"surge": s.u.signed_square(), "sway": s.v.signed_square()}  # noqa: E731
_ADDED: Final = {"mass.surge": ("added_mass.surge", "-X_udot"), "mass.sway": ("added_mass.sway", "-Y_vdot")}


@dataclass(frozen=True)
class Meaning:
    """A parameter of the model: its symbol, its unit, its columns."""

    symbol: str
    unit: str
    columns: Column


def model(vehicle: Vehicle, form: str) -> dict[str, Meaning]:
    """The parameters of the vehicle file's model by id.

    Raises:
        UncheckedError: an id without a meaning here, such as an effect of the user's own.
    """
    terms = vehicle.model.terms
    if terms == "paper":
        id_, symbol = ("mass.surge", "m - X_udot") if form == "total" else _ADDED["mass.surge"]
        return {
            id_: Meaning(symbol, "kg", _SHARED_MASS),
            "drag.surge.quadratic": Meaning("-X_|u|u", "kg/m", _SHARED_DRAG),
            "inertia.yaw": Meaning(*_TERMS["inertia.yaw"]),
        }
    made: dict[str, Meaning] = {}
    for id_ in _PLAIN if terms is None else terms:
        if id_ == "wind.steady":
            made |= {part: Meaning(*meant) for part, meant in _WIND.items()}
            continue
        if id_ != "drag.cross_flow" and id_ not in _TERMS:
            raise UncheckedError(
                f"the model holds {id_}, an effect of one's own whose physics the checker does not have"
            )
        meaning = _cross_flow(vehicle) if id_ == "drag.cross_flow" else Meaning(*_TERMS[id_])
        if form == "added" and id_ in _ADDED:
            name, symbol = _ADDED[id_]
            made[name] = Meaning(symbol, meaning.unit, meaning.columns)
        else:
            made[id_] = meaning
    return made


def rigid_body(s: State, mx: Range, my: Range, mass: Range | None) -> Columns:
    """The known left-hand side: coupling by a centre of gravity off the origin, and the mass in the form ``added``."""
    known: Columns = {}
    if mass is not None:
        known = {"surge": s.ax * mass, "sway": s.ay * mass}
    for channel, part in (
        ("surge", -(s.r.square() * mx) - s.rdot * my),
        ("sway", s.rdot * mx - s.r.square() * my),
        ("yaw", s.ay * mx - s.ax * my),
    ):
        known[channel] = known[channel] + part if channel in known else part
    return known


def _cross_flow(vehicle: Vehicle) -> Meaning:
    half = Fraction(stated(vehicle.text)["hull"]["length"]) / 2

    def columns(s: State) -> Columns:
        if isinstance(s.v, Motion):
            rate = _flow_rate(s.v, s.r, half)
            return {
                "sway": Motion(_flow_force(s.v.value, s.r.value, half), rate[0]),
                "yaw": Motion(_flow_moment(s.v.value, s.r.value, half), rate[1]),
            }
        return {"sway": _flow_force(s.v, s.r, half), "yaw": _flow_moment(s.v, s.r, half)}

    return Meaning("rho C_d T / 2", "kg/m^2", columns)


def _integral(v: Fraction, r: Fraction, half: Fraction, power: int) -> Fraction:
    """The integral of x^power (v + x r)|v + x r| from -half to half, in closed form."""
    if abs(v) >= abs(r) * half:
        sign = 1 if v >= 0 else -1
        return sign * (2 * half * v * v + 2 * half**3 * r * r / 3) if power == 0 else sign * 4 * v * r * half**3 / 3
    low, high = v - r * half, v + r * half
    first = (high * high * abs(high) - low * low * abs(low)) / (3 * r)
    return first if power == 0 else (high**3 * abs(high) - low**3 * abs(low)) / (4 * r * r) - v * first / r


def _flow_force(v: Range, r: Range, half: Fraction) -> Range:
    """Force of the cross-flow, monotone in v and even in r: it grows with |r| where v > 0 and falls where v < 0."""
    low = _integral(v.lower, r.mignitude if v.lower >= 0 else r.magnitude, half, 0)
    return Range(low, _integral(v.upper, r.magnitude if v.upper >= 0 else r.mignitude, half, 0))


def _flow_moment(v: Range, r: Range, half: Fraction) -> Range:
    """Moment of the cross-flow, monotone in r and even in v: it grows with |v| where r > 0 and falls where r < 0."""
    low = _integral(v.mignitude if r.lower >= 0 else v.magnitude, r.lower, half, 1)
    return Range(low, _integral(v.magnitude if r.upper >= 0 else v.mignitude, r.upper, half, 1))


def _flow_rate(v: Motion, r: Motion, half: Fraction) -> tuple[Range, Range]:
    """Rates of force and moment: the derivatives are twice the integrals of x^k |v + x r|, k = 0 to 2, which grow with |v|, |r|.

    Those of k = 0 and 2 are never negative.
    """
    speed, turn = v.value.magnitude, r.value.magnitude
    if speed >= turn * half:
        plain, first, second = 2 * half * speed, 2 * half**3 * turn / 3, 2 * half**3 * speed / 3
    else:
        plain = turn * half**2 + speed**2 / turn
        first = speed * half**2 - speed**3 / (3 * turn**2)
        second = turn * half**4 / 2 + speed**4 / (6 * turn**3)
    across = sided(2 * first)
    return Range(0, 2 * plain) * v.rate + across * r.rate, across * v.rate + Range(0, 2 * second) * r.rate
