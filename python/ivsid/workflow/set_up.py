"""Faults of the set-up, told first in the report of a command."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ivsid.report import page
from ivsid.report.page import Report, Section
from ivsid.setup import SetupFinding


def with_setup(report: Report, findings: Sequence[SetupFinding]) -> Report:
    """A report that names faults of the set-up first: in its summary, its lines and its page."""
    if not findings:
        return report
    lines = [f.line for f in findings]
    return replace(
        report,
        summary=f"The set-up is doubtful, so that what follows may be about a wrong set-up: {lines[0]}. {report.summary}",
        sections=(Section("Set-up", (page.bullets(lines),)), *report.sections),
        lines=(*(f"set-up: {line}" for line in lines), *report.lines),
    )
