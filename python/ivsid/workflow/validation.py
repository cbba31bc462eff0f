"""``ivsid validate``: a fit against another log."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ivsid import validation
from ivsid.identification import read_identification
from ivsid.log import read_log
from ivsid.log.record import steps_in
from ivsid.memory.pieces import array_pieces, pieces
from ivsid.report import figures, page
from ivsid.report.figures import Drawing
from ivsid.report.page import Part, Report, Section
from ivsid.report.series import Line, Panel, series
from ivsid.report.tables import validation_record
from ivsid.validation import ForceCheck, Validation
from ivsid.workflow.first_screens import validated
from ivsid.workflow.progress import Progress, silent
from ivsid.workflow.set_up import with_setup

TITLES = {"surge": "force X", "sway": "force Y", "yaw": "moment N"}


def validate(fit: str | Path, log: str | Path, *, tubes: bool | None = None, progress: Progress = silent) -> Report:
    """Reads a fit and a log, validates and reports.

    Args:
        fit: folder or result.json of ``identify``.
        log: of another run.
        tubes: whether readings are compared with the tubes of every consistent vehicle; None does so for logs of moderate length.
        progress: told of each step.

    Raises:
        IvsidError: an unusable file, in one sentence.
    """
    progress("reading")
    known = read_identification(fit)
    data = read_log(log, known.vehicle.log)
    result = validation.validate(known, data, tubes=tubes, progress=progress)
    progress("drawing")
    drawings = validation_drawings(result)
    summary = validation_summary(result)
    sections = (
        Section(
            "Predicted against measured force and moment", (validation_table(result), *map(force_series, result.forces))
        ),
        Section("Simulated against measured motion", (motion_table(result), *motion_series(result))),
        Section("Readings against the tubes of the fit", (tube_part(result),)),
        Section("Assumptions", (page.bullets([*known.assumes, *result.tubes.assumes, *result.notes]),)),
    )
    report = Report(
        f"Validation of {known.vehicle.name}",
        summary,
        validation_record(result),
        sections,
        drawings,
        {},
        tuple(validation_lines(result)),
        validated(result),
    )
    return with_setup(report, result.setup)


def _finite(ends: NDArray[np.float64]) -> NDArray[np.float64]:
    """The ends that are finite; the others are missing."""
    return array_pieces(ends.size, lambda p: np.where(np.isfinite(ends[p]), ends[p], np.nan))


def force_series(f: ForceCheck) -> Part:
    """Predicted and measured force of a channel in time, and the rest between them."""
    unit = "N m" if f.channel == "yaw" else "N"
    lines = (
        Line("measured", "measured", array_pieces(f.time.size, lambda p: f.measured[p].midpoint)),
        Line("predicted", "after", f.predicted_mid),
        Line("lower bound", "third", _finite(f.predicted.lower)),
        Line("upper bound", "third", _finite(f.predicted.upper)),
    )
    rest = Line(
        "predicted less measured",
        "before",
        array_pieces(f.time.size, lambda p: f.predicted_mid[p] - f.measured[p].midpoint),
    )
    title = TITLES[f.channel]
    panels: tuple[Panel, ...] = (
        Panel(f"{title} [{unit}]", lines, robust=True),
        Panel(f"error of {title} [{unit}]", (rest,), robust=True),
    )
    time = f.time
    if not all((steps_in(time, p) >= 0).all() for p in pieces(time.size - 1)):
        # Rows of several kinds or windows stand one after the other.
        order = np.argsort(time, kind="stable")
        time = time[order]
        panels = tuple(replace(p, lines=tuple(replace(q, values=q.values[order]) for q in p.lines)) for p in panels)
    caption = f"{100 * f.coverage:.4g} % of the measured values lie inside the bounds; {f.falsified} rows contradict the parameters."
    return series(f.channel, f"Predicted {title} against measured", caption, time, panels, beside=3)


def motion_series(result: Validation) -> list[Part]:
    """Simulated and measured velocities in time; nothing where no motion was simulated."""
    m = result.motion
    if m.reason is not None:
        return []
    names = ("surge velocity u [m/s]", "sway velocity v [m/s]", "yaw rate r [rad/s]")
    panels = [
        Panel(n, (Line("measured", "measured", m.measured[:, k]), Line("simulated", "after", m.simulated[:, k])))
        for k, n in enumerate(names)
    ]
    caption = f"Restarted from the measured state every {m.window.get('velocity', 0.0):g} s."
    return [series("motion", "Simulated motion against measured", caption, m.time, panels, beside=3)]


def validation_drawings(result: Validation, prefix: str = "") -> tuple[Drawing, ...]:
    """Mid-values and bounds of each channel, and the motion if it was simulated."""
    drawings = []
    for f in result.forces:
        title = TITLES[f.channel]
        drawings.append(
            figures.force_mid(f, f"{prefix}{f.channel}_mid", f"Predicted mid-values of {title} against measured")
        )
        guaranteed = result.fit.guaranteed and bool(result.fit.parameters)
        drawings.append(
            figures.force_bounds(
                f, f"{prefix}{f.channel}_bounds", f"Predicted bounds of {title} against measured", guaranteed=guaranteed
            )
        )
    if result.motion.reason is None:
        drawings.append(figures.motion(result.motion, f"{prefix}motion"))
    return tuple(drawings)


def validation_summary(result: Validation) -> str:
    """The verdict in one sentence."""
    wrong = sum(f.falsified for f in result.forces)
    total = sum(f.time.size for f in result.forces)
    fit = f"the fit ({result.fit.method}, {result.fit.status})"
    shown = result.tubes.clearest
    moved = "" if shown is None else f"no consistent vehicle moves {shown.words}"
    if wrong:
        return f"{wrong} of {total} rows of {result.log_name} contradict {fit}{moved and '; '}{moved}."
    if moved:
        return f"No row of {result.log_name} contradicts {fit} alone, and its motion does: {moved}."
    motion = {"": "", "all": ", nor does its motion", "surge": ", nor does its motion in surge"}[result.tubes.channels]
    return f"No row of {result.log_name} contradicts {fit} within the stated bounds{motion}."


def validation_lines(result: Validation) -> list[str]:
    """The errors of each channel, for the terminal."""
    lines = []
    for f in result.forces:
        unit = "N m" if f.channel == "yaw" else "N"
        lines.append(
            f"  {TITLES[f.channel]:<9} error mean {f.mean:+.4g} {unit}, sigma {f.sigma:.4g} {unit}; "
            f"{100 * f.coverage:.1f} % of measured values inside the bounds"
        )
    if result.tubes.outside:
        counts = ", ".join(f"{n} {name}" for name, n in outside_of(result))
        lines.append(
            f"  readings outside of the tubes{' of surge' if result.tubes.channels == 'surge' else ''}: {counts}"
        )
    motion = result.motion
    lines.append(
        f"  motion: {motion.reason}"
        if motion.reason
        else "  motion rms: " + ", ".join(f"{k} {v:.4g}" for k, v in motion.rms.items())
    )
    return lines


def validation_table(result: Validation) -> Part:
    """Errors of the predicted force [N] and moment [N m] of each channel."""
    rows = [
        [
            f.channel,
            "N m" if f.channel == "yaw" else "N",
            f.time.size,
            f.mean,
            f.sigma,
            f.mean_absolute,
            100 * f.coverage,
            f.falsified,
        ]
        for f in result.forces
    ]
    header = [
        "channel",
        "unit",
        "rows",
        "mean error",
        "sigma",
        "mean |error|",
        "inside bounds [%]",
        "contradicting rows",
    ]
    return page.table(header, rows)


def outside_of(result: Validation) -> list[tuple[str, int]]:
    """Rows with a reading outside, by the windows in words."""
    return [("without restarts" if k is None else f"in windows of {k:g} s", n) for k, n in result.tubes.outside.items()]


def tube_part(result: Validation) -> Part:
    """Readings that no consistent vehicle reaches, or why no tube was followed."""
    found = result.tubes
    if found.reason is not None:
        return page.text(f"No tube was followed: {found.reason}.")
    if not found.refuted:
        return page.text(f"Every reading meets the tubes ({', '.join(name for name, _ in outside_of(result))}).")
    rows = [
        [
            f.component,
            f.start,
            f.end,
            f"[{f.measured[0]:.6g}, {f.measured[1]:.6g}]",
            f"[{f.tube[0]:.6g}, {f.tube[1]:.6g}]",
        ]
        for f in found.refuted
    ]
    caption = (
        f"Rows with a reading outside: {', '.join(f'{n} {name}' for name, n in outside_of(result))}. For each kind of window the first of "
        "them, over the shortest window that shows it. ivsid tube draws the tubes."
    )
    return page.table(["component", "start [s]", "reading [s]", "measured", "tube"], rows, caption)


def motion_table(result: Validation) -> Part:
    """Errors of the simulated motion: rms and median over windows."""
    motion = result.motion
    if motion.reason:
        return page.text(f"No simulated motion: {motion.reason}.")
    units = {"u": "m/s", "v": "m/s", "r": "rad/s", "position": "m"}
    rows = [
        [k, units[k], motion.window["position" if k == "position" else "velocity"], motion.rms[k], motion.median[k]]
        for k in motion.rms
    ]
    return page.table(["quantity", "unit", "window [s]", "rms error", "median over windows"], rows)
