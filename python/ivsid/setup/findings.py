"""All checks in turn, each on the log without the faults that were named before it, and the rule by which a fault refuses a log."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Final

from ivsid.errors import IvsidError
from ivsid.intervals.apart import Apart
from ivsid.log import GivenLog, Log, log_of
from ivsid.setup.angles import angles
from ivsid.setup.demands import demands
from ivsid.setup.finding import Check, SetupFinding
from ivsid.setup.histories import HISTORIES
from ivsid.setup.limits import LIMITED, limits
from ivsid.setup.motion import motion
from ivsid.setup.response import response
from ivsid.setup.scale import scale
from ivsid.setup.suspects import SUSPECTS
from ivsid.setup.windows import shortened
from ivsid.vehicle import GivenVehicle, Vehicle, vehicle_of

CHECKS: Final[tuple[Check, ...]] = (demands, motion, limits, angles, response, scale)
# Ids of all findings, as [setup] accept takes them.
IDS: Final = tuple(
    dict.fromkeys(("setup.demand.unit", *(s.id for s in SUSPECTS), *(f"setup.{n}.limit" for n in LIMITED), *HISTORIES))
)


def setup_findings(vehicle: GivenVehicle, log: GivenLog) -> tuple[SetupFinding, ...]:
    """Faults of the set-up of a vehicle file and a log: wrong signs, axes and units, thrusters that are reversed or swapped.

    Args:
        vehicle: a checked vehicle, the path of its file, or a shipped one's name.
        log: a checked log, its path, or a table in memory.

    Returns:
        The plainest first; nothing where the log does not tell.

    Raises:
        IvsidError: an unusable file, or an id in ``[setup] accept`` that is none.

    Source: docs/theory.md, "Set-up".
    """
    vehicle = vehicle_of(vehicle)
    log = log_of(log, vehicle.log)
    unknown = [i for i in vehicle.setup.accept if i not in IDS]
    if unknown:
        raise IvsidError(f"[setup] accept names {unknown[0]}, which is no finding; use {', '.join(IDS)}")
    found: list[SetupFinding] = []
    log = shortened(log)
    for check in CHECKS:
        checked = check(vehicle, log)
        found += checked.findings
        log = checked.log
    return tuple(found)


def examined(
    vehicle: Vehicle, logs: Sequence[Log], progress: Callable[[str], None] = lambda _: None
) -> tuple[SetupFinding, ...]:
    """Faults of the set-up in any of the logs, for whatever is computed from them: commands and functions alike.

    Args:
        vehicle: a checked vehicle.
        logs: checked logs, at least one; several are examined at once.
        progress: told of each fault.

    Raises:
        IvsidError: a fault beyond doubt that the vehicle file does not accept.
    """
    *first, last = [partial(setup_findings, vehicle, log) for log in logs]
    beside = [Apart(task) for task in first]
    ended = last()
    found = (*(f for task in beside for f in task.result()), *ended)
    refuse(found, vehicle)
    for f in found:
        progress(f"set-up: {f.sentence}")
    return found


def refuse(findings: Iterable[SetupFinding], vehicle: Vehicle) -> None:
    """Refuses a set-up with a fault that is beyond doubt: one that is ``certain`` and not accepted.

    A fault is certain if two channels of the log contradict each other until it is mended, or if the vehicle file's own statements rule the
    readings out by far. One that rests on the modelled forces is only reported.

    Raises:
        IvsidError: the fault, the key to change, and how to go on all the same.
    """
    for f in findings:
        if f.certain and f.id not in vehicle.setup.accept:
            raise IvsidError(
                f'{f.line}; if it is right as it is, state [setup] accept = ["{f.id}"] in the vehicle file'
            )
