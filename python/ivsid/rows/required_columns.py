"""The columns of a log that each parameter needs, found by evaluating its term on names in place of numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ivsid.effects import CHANNELS, Place, State, Term
from ivsid.errors import meant
from ivsid.log import Log
from ivsid.vehicle import Vehicle


@dataclass(frozen=True)
class Uses:
    """The names of the quantities in an expression; every operator unites them."""

    names: frozenset[str]

    def _with(self, other: object) -> Uses:
        return Uses(self.names | other.names) if isinstance(other, Uses) else self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = _with

    def __neg__(self) -> Uses:
        return self

    def __abs__(self) -> Uses:
        return self

    def square(self) -> Uses:
        """``x^2``."""
        return self

    signed_square = astern_square = tanh = sqrt = cos = sin = square

    def cross_flow(self, other: Uses, half: float, power: int) -> Uses:
        """Flow along the hull is made of sway and yaw rate."""
        return self._with(other)


def needed_by(terms: Sequence[Term], vehicle: Vehicle) -> dict[str, tuple[str, ...]]:
    """The velocity, demand and force columns that a model needs, each with the ids of the parameters that need it.

    Args:
        terms: the model.
        vehicle: with its thrusters.
    """
    quantity = {n: Uses(frozenset({n})) for n in ("u", "v", "r", "udot", "vdot", "rdot")}
    named = {n: Uses(frozenset({n})) for n in ("psi", "x", "y", "t")}
    state = State(**quantity, place=Place(**named))
    wanted: dict[str, dict[str, None]] = {}

    def add(column: str, id_: str) -> None:
        wanted.setdefault(column, {})[id_] = None

    for term in terms:
        columns = term.columns(state)
        for channel in CHANNELS:
            if channel not in columns:
                continue
            for name in sorted(getattr(columns[channel], "names", ())):
                # An acceleration may be measured or follow from its velocity.
                add(name.removesuffix("dot"), term.id)
            for column in _forces(vehicle, channel):
                add(column, term.id)
    return {column: tuple(ids) for column, ids in wanted.items()}


def _forces(vehicle: Vehicle, channel: str) -> list[str]:
    if vehicle.thrusters:
        turning = [f"azimuth_{t.name}" for t in vehicle.thrusters if t.steering == "azimuth"]
        turning += [f"rudder_{t.name}" for t in vehicle.thrusters if t.rudder is not None]
        return [f"demand_{t.name}" for t in vehicle.thrusters] + turning
    return [{"surge": "force_X", "sway": "force_Y", "yaw": "moment_N"}[channel]]


def lacking(log: Log, terms: Sequence[Term], vehicle: Vehicle) -> str | None:
    """One sentence about missing columns of a log and the parameters that need them; None where the log has all."""
    wanted = needed_by(terms, vehicle)
    missing = {c: ids for c, ids in wanted.items() if c not in log.columns}
    if not missing:
        return None
    parts = "; ".join(f"{c} ({_meaning(c)}needed for {_some(ids)})" for c, ids in missing.items())
    has = ", ".join(log.columns) or "none that is known"
    # A channel that has its name is none that was meant for another.
    near = "".join(f"for {c}, {hint}" for c in missing if (hint := meant(c, log.ignored)))
    return (
        f"{log.name} cannot serve: it has no column {parts}; {near}it has {has}: add what is missing, or map it under [log] in the "
        f"vehicle file{_pose(missing)}"
    )


def _pose(missing: Iterable[str]) -> str:
    """The way to velocities from the pose, for a log that lacks one."""
    if not {"u", "v", "r"} & set(missing):
        return ""
    return (
        "; velocities follow from x, y, psi where the vehicle file has [sensors.position] and [sensors.heading] accuracy and "
        "[sensors.limits] acceleration and yaw_acceleration"
    )


def _meaning(column: str) -> str:
    for prefix, what in (("demand_", "demand"), ("azimuth_", "direction"), ("rudder_", "rudder angle")):
        if column.startswith(prefix):
            return f"the {what} of thruster {column.removeprefix(prefix)}, "
    return ""


def _some(ids: Sequence[str], most: int = 4) -> str:
    return ", ".join(ids[:most]) + (f" and {len(ids) - most} more" if len(ids) > most else "")
