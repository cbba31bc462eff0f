"""``ivsid tube``: bounds of every trajectory that a fit allows, under the demands of a log or of a scenario."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ivsid import simulation, tubes
from ivsid.errors import IvsidError
from ivsid.files.records import envelope
from ivsid.identification import Identification, read_identification
from ivsid.log import Log, read_log
from ivsid.programme.scenario import read_scenario
from ivsid.report import figures, page
from ivsid.report.page import First, Report, Section
from ivsid.report.series import Line, Panel, series
from ivsid.tubes import Tube
from ivsid.tubes.bounds import NAMES, PARTS, UNITS, WINDOWS, Run, record_of, widths
from ivsid.tubes.equations import equations_of
from ivsid.workflow.log_files import csv
from ivsid.workflow.progress import Progress, silent
from ivsid.workflow.set_up import with_setup


def tube(
    fit: str | Path,
    log: str | Path,
    *,
    channels: str | None = None,
    windows: Sequence[float] = WINDOWS,
    parts: int = PARTS,
    cells: int = 1,
    yaw_cells: int = 1,
    inner: bool = True,
    check: bool = False,
    progress: Progress = silent,
) -> Report:
    """Reads a fit and a log or a scenario, follows the tubes and reports.

    Without ``channels`` all of them are followed, or surge alone where the fit leaves a parameter of the others without an interval.

    Raises:
        IvsidError: an unusable file, in one sentence.
    """
    progress("reading")
    known = read_identification(fit)
    data = _log_of(known, Path(log), progress)
    followed, less = (channels, "") if channels is not None else _followed(known)
    result = tubes.tube(
        known,
        data,
        channels=followed,
        windows=windows,
        parts=parts,
        cells=cells,
        yaw_cells=yaw_cells,
        inner=inner,
        check=check,
        # The log of a scenario follows the vehicle file by construction.
        examine=Path(log).suffix != ".toml",
        progress=progress,
    )
    progress("drawing")
    drawings = tuple(figures.tube(result, r, _file(r)) for r in result.runs if r.horizon.windows)
    table = _table(result)
    sections = (
        Section("Tubes", (table, *(page.drawing(d) for d in drawings))),
        Section("In detail", tuple(_series(result, r) for r in result.runs if r.horizon.windows)),
        Section("Readings outside", (_refuted(result),)),
        Section("Assumptions", (page.bullets(result.assumes),)),
    )
    inputs = [
        (Path(known.vehicle.source or "vehicle.toml").name, known.vehicle.sha256),
        (known.log_name, known.log_sha256),
        (result.log_name, result.log_sha256),
    ]
    summary, lines = f"{summary_of(result)}{less}", lines_of(result)
    record = {**envelope("tube", inputs), **record_of(result)}
    title = f"Trajectories of {known.vehicle.name} that the data allow"
    files = {"tube.csv": _csv(result)}
    report = Report(title, summary, record, sections, drawings, files, lines, _first(result))
    return with_setup(report, result.setup)


def _log_of(fit: Identification, path: Path, progress: Progress) -> Log:
    """The log, or that of a scenario as the fit's estimate sails it: its demands are what counts."""
    if path.suffix != ".toml":
        return read_log(path, fit.vehicle.log)
    scenario = read_scenario(path)
    progress(f"demands of {path.name} by the estimate of the fit")
    mass = fit.vehicle.hull.mass if fit.options["form"] == "added" else 0.0
    truth = {
        k.replace("added_mass.", "mass.") if k in ("added_mass.surge", "added_mass.sway") else k: x
        + (mass if k in ("added_mass.surge", "added_mass.sway") else 0.0)
        for k, x in fit.estimate.items()
    }
    made = simulation.simulate(fit.vehicle, scenario.model_copy(update={"truth": truth, "noise": "none"}))
    return Log(path.name, hashlib.sha256(path.read_bytes()).hexdigest(), made.t, made.columns)


def _followed(fit: Identification) -> tuple[str, str]:
    """The channels that the fit's parameters allow, and a sentence where these are not all."""
    try:
        equations_of(fit, (True, True, True))
    except IvsidError as error:
        reason = str(error).partition(", and a tube")[0].partition(";")[0]
        return "surge", f" Of the velocities u alone is followed, with v and r as measured: {reason}."
    return "all", ""


def _file(run: Run) -> str:
    return "tube_whole" if run.horizon.length is None else f"tube_{run.horizon.length:g}s"


def summary_of(result: Tube) -> str:
    """The verdict in one or two sentences."""
    proved = all(w.proved == w.last for r in result.runs for w in r.horizon.windows)
    word = "proved to hold" if result.guaranteed else "computed to hold, from a fit without a guarantee,"
    held = f"The tubes are {word} the track of every vehicle that {result.fit.log_name} allows, under the demands of {result.log_name}."
    if result.refuted:
        first = next(f for r in result.runs for f in r.refuted)
        held += f" The reading of {first.component} at {first.end:g} s lies outside: the model, its bounds or an assumption is wrong over the {first.end - first.start:.3g} s before it."
    else:
        held += " Every reading meets them."
    return held if proved else held + " Part of a window has no bound: its tube ends where nothing more is proved."


def lines_of(result: Tube) -> tuple[str, ...]:
    """Widths of each component, for the terminal."""
    lines = []
    for run in result.runs:
        for k in result.components:
            w = widths(run, k)
            if w["median_width"] is None:
                continue
            ratio = w.get("median_ratio")
            beside = "" if ratio is None else f"; outer / inner {ratio:.3f} median, {w['largest_ratio']:.3f} worst"
            lines.append(
                f"  {run.name:<6} {NAMES[k]:<3} width {w['median_width']:.4g} {UNITS[k]} median, {w['largest_width']:.4g} worst{beside}"
            )
        lines += [
            f"  outside: {f.component} at {f.end:g} s, measured [{f.measured[0]:.5g}, {f.measured[1]:.5g}], tube [{f.tube[0]:.5g}, {f.tube[1]:.5g}], from the state at {f.start:g} s"
            for f in run.refuted
        ]
        ends = [w for w in run.horizon.windows if w.proved < w.last]
        if ends:
            lines.append(f"  {run.name}: no bound is proved after {result.t[ends[0].proved]:g} s")
    if result.checked is not None:
        lines.append(
            f"  checker: {result.checked.proved} of {result.checked.parts} parts of steps proved once more in exact arithmetic"
        )
    return tuple(lines)


def _table(result: Tube) -> page.Part:
    rows = []
    for run in result.runs:
        for k in result.components:
            w = widths(run, k)
            rows.append(
                [
                    run.name,
                    NAMES[k],
                    UNITS[k],
                    w["median_width"],
                    w["largest_width"],
                    w.get("median_ratio"),
                    w.get("largest_ratio"),
                    run.outside,
                ]
            )
    header = [
        "window",
        "component",
        "unit",
        "median width",
        "largest width",
        "outer / inner, median",
        "worst",
        "rows outside",
    ]
    caption = "The inner bound is what extreme members attain, in plain floats: the ratio bounds from above how much wider than necessary the tube is."
    return page.table(header, rows, caption)


def _refuted(result: Tube) -> page.Part:
    rows = [
        [
            r.name,
            f.component,
            f.start,
            f.end,
            f"[{f.measured[0]:.6g}, {f.measured[1]:.6g}]",
            f"[{f.tube[0]:.6g}, {f.tube[1]:.6g}]",
        ]
        for r in result.runs
        for f in r.refuted
    ]
    if not rows:
        return page.text("Every measured interval meets its tube.")
    caption = "The shortest window before the first reading outside: no consistent vehicle moves from the state at its start to that reading."
    return page.table(["window", "component", "start [s]", "reading [s]", "measured", "tube"], rows, caption)


def _series(result: Tube, run: Run) -> page.Part:
    bounds = run.horizon.bounds
    panels = []
    for k in result.components:
        low, high = (np.where(np.isfinite(e[:, k]), e[:, k], np.nan) for e in (bounds.lower, bounds.upper))
        lines = [Line("lower bound", "third", low), Line("upper bound", "third", high)]
        if k < 3:
            x = result.measured[:, k]
            known = np.isfinite(x.lower) & np.isfinite(x.upper)
            lines.append(Line("measured", "measured", np.where(known, 0.5 * (x.lower + x.upper), np.nan)))
        panels.append(Panel(f"{NAMES[k]} [{UNITS[k]}]", tuple(lines), robust=True))
    caption = f"{len(run.horizon.windows)} windows; {run.outside} rows have a reading outside."
    return series(f"tube-{_file(run).removeprefix('tube_')}", f"Tube: {run.name}", caption, result.t, panels, beside=2)


def _first(result: Tube) -> First:
    verdict = "A reading contradicts the fit" if result.refuted else "No reading contradicts the fit"
    following = (
        ("Look for the cause: ivsid diagnose VEHICLE LOG OTHER_LOG.",)
        if result.refuted
        else ("Use the tubes where a bound counts, and a window no longer than the one that is still narrow enough.",)
    )
    return First(verdict, "bad" if result.refuted else "good" if result.guaranteed else "open", "", (), following, ())


def _csv(result: Tube) -> str:
    """Bounds by row; empty where there are none."""
    columns: dict[str, np.ndarray] = {}
    for run in result.runs:
        end = "whole" if run.horizon.length is None else f"{run.horizon.length:g}s"
        for k in result.components:
            bounds = run.horizon.bounds
            columns[f"{NAMES[k]}_lower_{end}"] = bounds.lower[:, k]
            columns[f"{NAMES[k]}_upper_{end}"] = bounds.upper[:, k]
    return csv(result.t, columns)
