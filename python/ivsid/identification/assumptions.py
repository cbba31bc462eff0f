"""The sentences that the guarantee of an identification relies on."""

from __future__ import annotations

from collections.abc import Sequence

from ivsid.effects import Given, causes
from ivsid.rows import RegressionRows
from ivsid.sensors.bounds import BoundedLog
from ivsid.vehicle import Vehicle


def assumptions(rows: RegressionRows, bounded: BoundedLog, vehicle: Vehicle, allowed: int = 0) -> tuple[str, ...]:
    """The assumptions of parameter intervals, a sentence each.

    Args:
        rows: with the sentences of their kinds.
        bounded: with the rule of the sensor bounds and the sentences of the log.
        vehicle: with the accuracy of its thrusters.
        allowed: number of rows that may be wrong.
    """
    lines = [bounded.rule.sentence, _force_accuracy(vehicle)]
    if allowed:
        lines.append(f"all but {allowed} rows of each set of parameters that share rows hold")
    if bounded.ambient != (0.0, 0.0):
        force, moment = bounded.ambient
        lines.append(f"ambient force within {force:.3g} N and moment within {moment:.3g} N m")
    for thruster in vehicle.thrusters:
        if thruster.outside == "hold":
            lines.append(f"beyond its table the thrust of {thruster.name} keeps the end values")
    if vehicle.thrusters:
        hold = "held from its row to the next" if vehicle.log.demand == "hold" else "linear from its row to the next"
        lines.append(f"each demand is {hold}")
    else:
        lines.append("between two rows each logged force lies between their values")
    absent = [f"{', '.join(g.named)} acts in no row" for g in causes(vehicle)]
    return (*lines, *absent, *bounded.statistical, *bounded.log.assumes, *rows.assumes, "model structure")


def cause_notes(left_out: Sequence[Given]) -> tuple[str, ...]:
    """A sentence on the causes of a model that no interval row can hold, or nothing.

    Args:
        left_out: causes of the vehicle file's ``[model.fitted]``.
    """
    if not left_out:
        return ()
    names = ", ".join(n for g in left_out for n in g.named)
    return (
        f"the rows leave out {names} of [model.fitted]: the intervals are those of a model without, so nothing is guaranteed",
    )


def _force_accuracy(vehicle: Vehicle) -> str:
    if not vehicle.thrusters:
        return "accuracy of the logged forces"
    each = {t.name: f"{t.accuracy.absolute!r} N + {t.accuracy.relative!r} |T|" for t in vehicle.thrusters}
    return "thrust accuracy: " + "; ".join(f"{name} within {bound}" for name, bound in each.items())
