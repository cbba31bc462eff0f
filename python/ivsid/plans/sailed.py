"""A programme as a vehicle sails it: the log that the fit's estimate, or a given truth, would leave."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import EFFECTS, terms_of
from ivsid.errors import IvsidError
from ivsid.identification import Identification
from ivsid.log import Log
from ivsid.programme.manoeuvres import Segment
from ivsid.programme.scenario import Scenario
from ivsid.programme.trials import fastest_turn
from ivsid.simulation import simulate
from ivsid.vehicle import Vehicle

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Sailed:
    """A programme that a vehicle sailed.

    Attributes:
        log: as its sensors saw it.
        x: north of the start [m], shape (n,).
        y: east of the start [m], shape (n,).
        psi: heading [rad], shape (n,).
        hardest: the largest accelerations as shares of the stated limits; 0 where none is stated.
        spin: the largest yaw rate as a share of what anybody would believe.
    """

    log: Log
    x: Array
    y: Array
    psi: Array
    hardest: float
    spin: float

    @property
    def reach(self) -> float:
        """The farthest from the start [m]."""
        return float(np.hypot(self.x, self.y).max())


def estimate_of(fit: Identification) -> dict[str, float]:
    """The fit's point estimate.

    Raises:
        IvsidError: a fit without an estimate of each parameter.
    """
    if not fit.estimate or not all(np.isfinite(x) for x in fit.estimate.values()):
        raise IvsidError(
            f"the fit ({fit.method}, {fit.status}) has no point estimate to plan with: {fit.reason or 'its set is empty'}; identify again"
        )
    return dict(fit.estimate)


def usual(fit: Identification) -> dict[str, float]:
    """A vessel of usual size inside the fit's intervals, for a fit whose estimate no simulation follows.

    Sizes are those of the catalogue for a hull of this mass; the nearest number of the interval takes their place where they lie outside.
    """
    form = fit.options["form"]
    own = fit.vehicle.hull.mass if form == "added" else 0.0
    found = {}
    for term in terms_of(fit.vehicle, form):
        id_ = (
            term.id.replace("added_mass.s", "mass.s") if term.id in ("added_mass.surge", "added_mass.sway") else term.id
        )
        size = EFFECTS[id_].parameters[0].scaled(fit.vehicle.hull.mass) if id_ in EFFECTS else 0.0
        p = fit.parameters.get(term.id)
        value = size - own if id_ != term.id else size
        found[term.id] = value if p is None else min(max(value, p.lower), p.upper)
    return found


def truth_of(fit: Identification, values: Mapping[str, float]) -> dict[str, float]:
    """Parameters of the fit's form as a scenario's truth, with total masses."""
    if fit.options["form"] != "added":
        return dict(values)
    mass = fit.vehicle.hull.mass
    shared = ("added_mass.surge", "added_mass.sway")
    return {k.replace("added_", "") if k in shared else k: x + mass if k in shared else x for k, x in values.items()}


def scenario_of(segments: Sequence[Segment], seconds: float, rate: float, truth: Mapping[str, float]) -> Scenario:
    """A programme as a scenario; segments are repeated until its end."""
    return Scenario.model_validate(
        {"duration": seconds, "rate": rate, "truth": dict(truth), "segments": tuple(segments)}
    )


def sail(vehicle: Vehicle, scenario: Scenario, seed: int, *, noise: str = "gaussian") -> Sailed | None:
    """The programme sailed by a vehicle of the scenario's truth; None where its motion does not settle.

    Args:
        vehicle: its thrusters and sensors, whose errors are drawn.
        scenario: programme and truth.
        seed: of all draws.
        noise: kind of the sensors' noise.
    """
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            made = simulate(vehicle, scenario.model_copy(update={"noise": noise}), seed)
    except IvsidError:
        return None
    if not np.isfinite(made.exact["r"]).all():
        return None
    x, y, psi = (made.exact[name] for name in ("x", "y", "psi"))
    limits, step = vehicle.sensors.limits, np.diff(made.t)
    stated = {"u": limits.acceleration, "v": limits.acceleration, "r": limits.yaw_acceleration}
    shares = [float(np.abs(np.diff(made.exact[n]) / step).max()) / most for n, most in stated.items() if most]
    name = hashlib.sha256(f"{seed} {scenario.model_dump_json()}".encode()).hexdigest()
    return Sailed(
        Log("plan.csv", name, made.t, made.columns),
        x - x[0],
        y - y[0],
        psi,
        max(shares, default=0.0),
        float(np.abs(made.exact["r"]).max()) / fastest_turn(vehicle),
    )
