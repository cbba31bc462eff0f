"""The sentences that the guarantee of an identification relies on."""

from __future__ import annotations

from collections.abc import Sequence

from ivsid.effects import Given, causes
from ivsid.propulsion.carried import carried_by
from ivsid.rows import RegressionRows
from ivsid.sensors.bounds import BoundedLog
from ivsid.vehicle import Vehicle
from ivsid.vehicle.carried import ends_of, with_keys


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
    lines += carried_sentence(vehicle, bounded)
    absent = [f"{', '.join(g.named)} acts in no row" for g in left_out(vehicle, bounded)]
    return (*lines, *absent, *bounded.statistical, *bounded.log.assumes, *rows.assumes, "model structure")


def carried_sentence(vehicle: Vehicle, bounded: BoundedLog) -> list[str]:
    """A sentence on the numbers of ``[model.fitted]`` that the rows take into account, or nothing."""
    numbers, carried = vehicle.model.fitted, _carried(vehicle, bounded)
    # A key of a thruster takes one number, and no interval.
    one = {n for n in with_keys(vehicle)[1] if n.startswith("thruster.")}
    ranges = {n: (f.value or 0.0,) * 2 if n in one else ends_of(f) for n, f in numbers.items() if n in carried}
    if not ranges:
        return []
    each = [f"{n} is {a!r}" if a == b else f"{n} lies in [{a!r}, {b!r}]" for n, (a, b) in ranges.items()]
    return [f"the causes of [model.fitted] act as stated: {'; '.join(each)}"]


def left_out(vehicle: Vehicle, bounded: BoundedLog) -> tuple[Given, ...]:
    """The causes of the vehicle file's ``[model.fitted]`` that no row takes into account."""
    carried = _carried(vehicle, bounded)
    return tuple(g for g in causes(vehicle) if not carried.issuperset(g.named))


def _carried(vehicle: Vehicle, bounded: BoundedLog) -> set[str]:
    return {*bounded.carried, *carried_by(with_keys(vehicle)[0])[1]}


def cause_notes(left_out: Sequence[Given]) -> tuple[str, ...]:
    """A sentence on the causes of a model that no interval row can hold, or nothing.

    Args:
        left_out: causes of the vehicle file's ``[model.fitted]``.
    """
    if not left_out:
        return ()
    names = ", ".join(n for g in left_out for n in g.named)
    return (
        f"the rows leave out {names} of [model.fitted], which no interval row can hold in this log: the intervals are those of a model without, so "
        "nothing is guaranteed",
    )


def _force_accuracy(vehicle: Vehicle) -> str:
    if not vehicle.thrusters:
        return "accuracy of the logged forces"
    each = {t.name: f"{t.accuracy.absolute!r} N + {t.accuracy.relative!r} |T|" for t in vehicle.thrusters}
    return "thrust accuracy: " + "; ".join(f"{name} within {bound}" for name, bound in each.items())
