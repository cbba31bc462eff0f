"""A model in surge, sway and yaw in one form for every target: total masses, centre of gravity, damping, thrusters, causes.

In the form of Fossen: M nudot_r + C(nu_r) nu_r + D(nu_r) nu_r = tau, with nu_r relative to the water.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from ivsid.diagnosis import Diagnosis, extended_vehicle
from ivsid.effects import EFFECTS, PAPER_TERMS, fitted
from ivsid.errors import IvsidError
from ivsid.exports.number import Number, exact, one_line
from ivsid.identification import Identification
from ivsid.intervals import Interval
from ivsid.vehicle import Vehicle, parse_vehicle

# Radius of gyration of a hull in yaw, as a share of its length. Only the sum of the rigid and the added inertia moves a hull in the plane.
# Source: Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2021, and the otter of his MSS: R66 = 0.25 L
GYRATION: Final = 0.25
NEEDED: Final = ("mass.surge", "mass.sway", "inertia.yaw")
PAPER_IDS: Final = frozenset(t.id for t in PAPER_TERMS)


@dataclass(frozen=True)
class Planar:
    """A model in surge, sway and yaw, in body axes forward, starboard, down.

    Attributes:
        vehicle: hull and thrusters.
        source: of the numbers, for the head of a file.
        numbers: all of them by id or id.part, keys of thrusters as id.NAME.
        shared: ids of a column that sway shares with surge.
    """

    vehicle: Vehicle
    source: str
    numbers: Mapping[str, Number]
    shared: frozenset[str]

    @property
    def title(self) -> str:
        """The vehicle's name on one line."""
        return one_line(self.vehicle.name)

    def get(self, id_: str, unit: str = "") -> Number:
        """A number, or an exact 0 where the model has none."""
        return self.numbers.get(id_, exact(0.0, unit))

    def of_thruster(self, id_: str, name: str) -> Number | None:
        """A number of one thruster, its own before that of all."""
        return self.numbers.get(f"{id_}.{name}", self.numbers.get(id_))

    @property
    def mass(self) -> float:
        """Rigid body [kg]."""
        return self.vehicle.hull.mass

    @property
    def centre(self) -> tuple[float, float]:
        """Centre of gravity with the fitted couplings, forward and to starboard [m]: m x_G - Y_rdot moves it as m x_G does."""
        x, y = self.vehicle.hull.centre_of_gravity
        return x + self.get("coupling.cg_x").value / self.mass, y + self.get("coupling.cg_y").value / self.mass

    @property
    def surge(self) -> Number:
        """Mass and added mass in surge [kg]."""
        return self.numbers["mass.surge"]

    @property
    def sway(self) -> Number:
        """Mass and added mass in sway [kg]; in the paper's model a Munk coefficient is what sway has beyond surge."""
        if "mass.sway" not in self.shared:
            return self.numbers["mass.sway"]
        return self.surge + self.get("added_mass.munk", "kg")

    @property
    def yaw(self) -> Number:
        """Moment of inertia with its added part about the origin [kg m^2]."""
        return self.numbers["inertia.yaw"]

    @property
    def rigid_inertia(self) -> float:
        """Moment of inertia of the rigid body about its centre of gravity [kg m^2], at most the whole: the data tell the sum alone."""
        x, y = self.centre
        whole = self.yaw.value - self.mass * (x * x + y * y)
        length = self.vehicle.hull.length
        return whole if length is None else min(whole, self.mass * (GYRATION * length) ** 2)

    @property
    def rigid_about_origin(self) -> Number:
        """Moment of inertia of the rigid body about the origin [kg m^2]: the sum in floats, and an interval that holds the true one, too."""
        x, y = self.centre
        whole = self.rigid_inertia + self.mass * (x * x + y * y)
        squares = Interval(x, x).square() + Interval(y, y).square()
        ends = Interval(self.rigid_inertia, self.rigid_inertia) + Interval(self.mass, self.mass) * squares
        return Number(whole, "kg m^2", ends=ends.hull(Interval(whole, whole)))

    @property
    def added(self) -> tuple[Number, Number, Number]:
        """Added masses in surge and sway [kg], added inertia in yaw about the origin [kg m^2], positive."""
        rigid = exact(self.mass, "kg")
        return (
            (self.surge - rigid).called("-X_udot"),
            (self.sway - rigid).called("-Y_vdot"),
            (self.yaw - self.rigid_about_origin).called("-N_rdot"),
        )

    @property
    def moment(self) -> Number:
        """N_uv beside the Munk moment of unequal masses, which an engine with added masses has by itself [kg]."""
        whole = (self.sway - self.surge) - self.get("added_mass.munk", "kg") - self.get("drag.lift.yaw", "kg")
        return whole.called("N_uv beside the Munk moment")

    def damping(self, id_: str) -> Number | None:
        """A damping number, with the column that the paper's model shares, or None."""
        if id_ in self.shared:
            return self.numbers["drag.surge.quadratic"]
        return self.numbers.get(id_)


def planar_of(result: Identification | Diagnosis | Vehicle) -> Planar:
    """The model of a result, or of a vehicle file with numbers.

    Raises:
        IvsidError: a model without numbers, or without a mass in every direction.
    """
    if isinstance(result, Diagnosis):
        return planar_of(parse_vehicle(extended_vehicle(result), "model.toml"))
    vehicle = result.vehicle if isinstance(result, Identification) else result
    numbers = _of_vehicle(vehicle)
    source = vehicle.source or vehicle.name
    if isinstance(result, Identification):
        numbers |= _of_fit(result)
        source = f"{result.method} of {result.log_name}"
    paper = vehicle.model.terms == "paper"
    shared = {i for i in ("mass.sway", "drag.sway.quadratic") if paper and i not in numbers}
    missing = [i for i in NEEDED if i not in numbers and i not in shared]
    if missing:
        raise IvsidError(
            f"{vehicle.source or vehicle.name}: the model has no number for {', '.join(missing)}; export the folder of identify or diagnose, or give "
            "[model.fitted] with them"
        )
    return Planar(vehicle, source, numbers, frozenset(shared))


def _of_vehicle(vehicle: Vehicle) -> dict[str, Number]:
    """Numbers of ``[model]`` and of the keys of thrusters."""
    numbers = {k: exact(v, *_unit(k)) for k, v in vehicle.model.values.items()}
    for given in fitted(vehicle):
        for k, value in given.named.items():
            numbers[k] = Number(value, *_unit(k), _ends(vehicle, k))
    for thruster in vehicle.thrusters:
        for effect in EFFECTS.values():
            name = f"{effect.id}.{thruster.name}"
            if effect.key is None or name in numbers or effect.id in numbers:
                continue
            stated: float | None = getattr(thruster, effect.key.name)
            if stated is not None:
                ends = _ends(vehicle, name) or _ends(vehicle, effect.id)
                numbers[name] = Number(effect.key(stated), *_unit(effect.id), ends)
    return numbers


def _of_fit(fit: Identification) -> dict[str, Number]:
    """Numbers of an identification; those of the added-mass form with the rigid mass."""
    if not fit.parameters:
        raise IvsidError(
            f"the fit ({fit.method}, {fit.status}) has no parameters to export: {fit.reason or 'its set is empty'}; identify again"
        )
    numbers = {}
    for k, p in fit.parameters.items():
        bounded = p.lower <= p.upper
        value = p.midpoint if bounded and p.upper - p.lower < float("inf") else fit.estimate.get(k, p.midpoint)
        made = Number(value, p.unit, p.symbol, Interval(p.lower, p.upper) if bounded else None)
        added = k.startswith("added_mass.") and k != "added_mass.munk"
        numbers[k.replace("added_mass.", "mass.") if added else k] = (
            made + exact(fit.vehicle.hull.mass, "kg") if added else made
        )
    return numbers


def _ends(vehicle: Vehicle, name: str) -> Interval | None:
    entry = vehicle.model.fitted.get(name)
    if entry is None or (entry.lower is None and entry.upper is None):
        return None
    low = float("-inf") if entry.lower is None else entry.lower
    return Interval(low, float("inf") if entry.upper is None else entry.upper)


def _unit(name: str) -> tuple[str, str]:
    """Unit and symbol of a number by its name."""
    for effect in EFFECTS.values():
        for form in (effect, effect.measured):
            if form is not None and name in form.parts:
                parameter = form.parameters[form.parts.index(name)]
                return parameter.unit, parameter.symbol
        if effect.per_thruster and name.rpartition(".")[0] == effect.id:
            return effect.parameters[0].unit, effect.parameters[0].symbol
    return "", ""
