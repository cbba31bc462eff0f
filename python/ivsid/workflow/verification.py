"""``ivsid verify``: the certificates of an identification, checked in exact arithmetic."""

from __future__ import annotations

from pathlib import Path

from ivsid import verification
from ivsid.files.records import envelope
from ivsid.report import page
from ivsid.report.page import Card, First, Report, Section
from ivsid.verification import Verification
from ivsid.workflow.progress import Progress, silent

# Failures that the terminal shows; result.json holds all.
# Source: resource: lines of a terminal
MOST_FAILURES = 12


def verify(result: str | Path, log: str | Path, *, progress: Progress = silent) -> Report:
    """Checks the certificates of a result against its log, and reports the verdict.

    Raises:
        IvsidError: a file that cannot be read.
    """
    progress("recomputing rows and multipliers in fractions")
    verdict = verification.verify(result, log, progress=progress)
    lines = verdict_lines(verdict)
    sections = [
        Section(
            "Proved",
            (
                page.bullets(
                    [
                        f"certificates that hold: {verdict.certificates}",
                        f"rows recomputed from the log in fractions: {verdict.rows}",
                        "beyond the log and the vehicle file's assumptions the proof rests on nothing but this checker",
                        f"in the result, but not part of the proof: {', '.join(verdict.not_proved)}",
                    ]
                ),
            ),
        )
    ]
    if verdict.not_checked:
        sections.insert(0, Section("Not checked", (page.bullets(verdict.not_checked),)))
    if verdict.failures:
        sections.insert(0, Section("Failed", (page.bullets(verdict.failures),)))
    return Report(
        "Verification of an identification",
        lines[0],
        {**envelope("verify", verdict.inputs), **verdict.record()},
        tuple(sections),
        (),
        {},
        tuple(lines[1:]),
        _first(verdict),
    )


def _first(verdict: Verification) -> First:
    """The first screen: whether the result follows from the log, and what to do next."""
    words, tone, following = {
        "proved": (
            "The result is proved",
            "good",
            "Keep the result, the log and the vehicle file together: whoever has them can prove it again.",
        ),
        "not_checked": (
            "Part of the result cannot be checked",
            "open",
            "See below which rows the checker cannot recompute, and identify without them for a proof.",
        ),
    }.get(
        verdict.status,
        (
            "The result does not follow from this log",
            "bad",
            "Check that the log and the result belong together; if they do, identify again.",
        ),
    )
    facts = (
        ("certificates that hold", str(verdict.certificates)),
        ("rows recomputed from the log", str(verdict.rows)),
        ("checks that failed", str(len(verdict.failures))),
    )
    return First(
        words, tone, "", (Card("The proof", "In exact arithmetic, by a program of its own.", facts),), (following,)
    )


def verdict_lines(verdict: Verification) -> list[str]:
    """The verdict for the terminal."""
    if verdict.proved:
        rows = f"{verdict.wrong} row{'s' * (verdict.wrong > 1)}"
        statement = (
            f"{verdict.claim}, if at most {rows} of each set of parameters that share rows are wrong"
            if verdict.wrong
            else verdict.claim
        )
        return [
            f"PROVED: {verdict.result_name} ({statement}) follows from {verdict.log_name}: {verdict.certificates} certificates "
            f"over {verdict.rows} rows hold in exact arithmetic"
        ]
    if verdict.status == "not_checked":
        return [
            f"NOT CHECKED: {verdict.result_name} ({verdict.claim}) holds if its rows do, but not all of them can be recomputed from {verdict.log_name}",
            *(f"  {sentence}" for sentence in verdict.not_checked),
        ]
    lines = [
        f"NOT PROVED: {verdict.result_name} does not follow from {verdict.log_name}; {len(verdict.failures)} checks failed"
    ]
    lines += [f"  {f}" for f in verdict.failures[:MOST_FAILURES]]
    if len(verdict.failures) > MOST_FAILURES:
        lines.append(f"  and {len(verdict.failures) - MOST_FAILURES} more (result.json)")
    return lines
