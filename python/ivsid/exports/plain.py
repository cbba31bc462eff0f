"""YAML: every number of the model with unit, symbol and interval, in the names and signs of ivsid."""

from __future__ import annotations

import json
import math
from typing import Final

from ivsid.exports.number import Number
from ivsid.exports.planar import Planar
from ivsid.exports.target import Body, Target
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Thruster


def write(model: Planar) -> Body:
    """The body of a YAML file; strings are those of JSON, which YAML takes."""
    x, y = model.vehicle.hull.centre_of_gravity
    hull = model.vehicle.hull
    lines = [
        f"name: {json.dumps(model.vehicle.name)}",
        "axes: {body: [forward, starboard, down], earth: [north, east, down]}",
        "hull:",
        f"  mass: {hull.mass!r}  # kg",
        f"  centre_of_gravity: [{x!r}, {y!r}]  # m",
        *(
            f"  {k}: {v!r}  # m"
            for k, v in (("length", hull.length), ("beam", hull.beam), ("draught", hull.draught))
            if v is not None
        ),
        f"model: {'paper' if model.vehicle.model.terms == 'paper' else 'terms'}",
        "numbers:",
        *(f"  {json.dumps(k)}: {_number(n)}" for k, n in model.numbers.items()),
        "thrusters:",
        *(line for t in model.vehicle.thrusters for line in _thruster(t)),
    ]
    return Body("\n".join(lines), frozenset(model.numbers))


def _number(n: Number) -> str:
    lower, upper = (None, None) if n.ends is None else (n.ends.lower, n.ends.upper)
    ends = ", ".join(
        f"{k}: {'null' if e is None or not math.isfinite(e) else repr(e)}"
        for k, e in (("lower", lower), ("upper", upper))
    )
    return f"{{value: {n.value!r}, {ends}, unit: {json.dumps(n.unit)}, symbol: {json.dumps(n.symbol)}}}"


def _thruster(t: Thruster) -> list[str]:
    """A thruster with its keys, as the vehicle file has them; a table in newtons."""
    kept = t.model_dump(exclude_none=True, exclude={"table"}, mode="json")
    if t.table is not None:
        demand, thrust = ThrustCurve(t).points
        kept["table"] = {"demand": demand, "thrust": thrust}
    first, *rest = [f"{k}: {json.dumps(v)}" for k, v in kept.items()]
    return [f"  - {first}", *(f"    {line}" for line in rest)]


TARGET: Final = Target("yaml", "other programs", lambda _: "model.yaml", write, ("#", ""))
