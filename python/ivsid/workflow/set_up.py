"""The set-up of a vehicle file and its logs, examined before a command computes, and told first in its report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ivsid.files.records import sealed
from ivsid.files.seal import KEY
from ivsid.log import Log
from ivsid.report import page
from ivsid.report.page import Report, Section
from ivsid.setup import SetupFinding, refuse, setup_findings
from ivsid.vehicle import Vehicle
from ivsid.workflow.progress import Progress


def examined(vehicle: Vehicle, logs: Sequence[Log], progress: Progress) -> tuple[SetupFinding, ...]:
    """Faults of the set-up in any of the logs, told as they are found.

    Raises:
        IvsidError: a fault beyond doubt that the vehicle file does not accept.
    """
    found: list[SetupFinding] = []
    for log in logs:
        found += setup_findings(vehicle, log)
    refuse(found, vehicle)
    for f in found:
        progress(f"set-up: {f.sentence}")
    return tuple(found)


def with_setup(report: Report, findings: Sequence[SetupFinding]) -> Report:
    """A report that names faults of the set-up first: in its summary, its lines, its page and under ``setup`` of its record."""
    record = {**report.record, "setup": [f.record() for f in findings]}
    if KEY in record:
        record = sealed(record)
    if not findings:
        return replace(report, record=record)
    lines = [f.line for f in findings]
    return replace(
        report,
        record=record,
        summary=f"The set-up is doubtful, so that what follows may be about a wrong set-up: {lines[0]}. {report.summary}",
        sections=(Section("Set-up", (page.bullets(lines),)), *report.sections),
        lines=(*(f"set-up: {line}" for line in lines), *report.lines),
    )
