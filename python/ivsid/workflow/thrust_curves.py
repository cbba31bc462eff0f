"""``ivsid thrust``: candidates for a thrust curve from a bollard-pull table."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ivsid.errors import IvsidError, meant
from ivsid.files import units
from ivsid.files.records import envelope
from ivsid.log import open_source
from ivsid.propulsion.bollard import PUBLISHED_CUBIC, Bollard, Fit, examine
from ivsid.report import figures, page
from ivsid.report.page import Part, Report, Section
from ivsid.report.tables import bollard_record
from ivsid.workflow.curves import thrust_series
from ivsid.workflow.first_screens import pulled
from ivsid.workflow.progress import Progress, silent

DEMANDS = ("demand", "pwm", "command", "throttle", "rpm")
THRUSTS = ("thrust", "force")


def thrust(
    path: str | Path,
    *,
    demand_column: str | None = None,
    thrust_column: str | None = None,
    unit: str | None = None,
    progress: Progress = silent,
) -> Report:
    """Reads a bollard-pull table, fits the candidates and recommends one.

    Args:
        path: the table.
        demand_column: name of the demand's column; found by its name by default.
        thrust_column: name of the thrust's column, likewise.
        unit: of the thrust; the unit in the column's name, or N, by default.
        progress: told of each step.

    Raises:
        IvsidError: an unusable table, in one sentence.
    """
    progress("reading")
    with open_source(path) as source:
        demand_name = _column(source.columns, demand_column, DEMANDS, "demand", path)
        thrust_name = _column(source.columns, thrust_column, THRUSTS, "thrust", path)
        symbol = unit or _unit(thrust_name)
        factor = units.factor(symbol, units.FORCE, f"column {thrust_name}")
        cells = source.numeric([demand_name, thrust_name])
        digest = source.sha256
    demand, force = cells[demand_name], cells[thrust_name] * factor
    if demand.size != force.size:
        raise IvsidError(
            f"{path}: {demand_name} and {thrust_name} have {demand.size} and {force.size} rows; a table pairs them"
        )
    there = np.isfinite(demand) & np.isfinite(force)
    demand, force = demand[there], force[there]
    if demand.size < 3:
        raise IvsidError(f"{path} has {demand.size} complete rows; a thrust table needs at least 3")
    order = np.argsort(demand, kind="stable")
    demand, force = demand[order], force[order]
    if (np.diff(demand) == 0).any():
        twice = demand[:-1][np.diff(demand) == 0][0]
        raise IvsidError(f"{path}: demand {twice:g} stands more than once; average its thrusts into one row")
    percent = demand[0] >= 0 and demand[-1] <= 100
    progress("fitting")
    table = examine(demand, force, PUBLISHED_CUBIC if percent else None)
    demand_unit = _given_unit(demand_name) or ("%" if percent else demand_name)
    drawing = figures.thrust_curve(table, demand_unit=demand_unit)
    snippet = thruster_toml(table)
    candidates = {f.name: candidate_toml(table, f) for f in table.fits}
    record = {
        **envelope("thrust", {Path(path).name: digest}),
        "unit": symbol,
        **bollard_record(table),
        "toml": snippet,
        "candidates": candidates,
    }
    best = table.recommended
    summary = (
        f"{demand.size} points, thrust {force.min():.4g} to {force.max():.4g} N; use the {best.name} "
        f"({'it goes through every point' if best.passes else f'largest residual {best.largest:.3g} N'})."
    )
    notes = [*_notes(table, percent)]
    sections = (
        Section(
            "Candidates",
            (
                fit_table(table),
                thrust_series(table, f"demand [{demand_unit}]" if demand_unit != demand_name else demand_name),
                page.bullets(notes),
            ),
        ),
        Section("For the vehicle file", (page.code(snippet),)),
        Section(
            "The candidates for the vehicle file, each with an accuracy that holds every point",
            tuple(page.code(f"# {name}\n{text}") for name, text in candidates.items()),
        ),
    )
    lines = [
        *(f"  {f.name:<38} rms {f.rms:8.4g} N, largest {f.largest:8.4g} N" for f in table.fits),
        *(f"  note: {n}" for n in notes),
    ]
    return Report(
        f"Thrust model of {Path(path).name}",
        summary,
        record,
        sections,
        (drawing,),
        {"thruster.toml": snippet},
        tuple(lines),
        pulled(table),
    )


def fit_table(table: Bollard) -> Part:
    """One row for each candidate."""
    rows = [
        [
            f.name,
            ", ".join(f"{c:.5g}" for c in f.coefficients or f.quadratic or ()) or "–",
            *((0.0, 0.0) if f.passes else (f.rms, f.largest)),
        ]
        for f in table.fits
    ]
    return page.table(
        ["model", "coefficients, highest first", "rms residual [N]", "largest residual [N], the accuracy it needs"],
        rows,
    )


def _notes(table: Bollard, percent: bool) -> list[str]:
    notes = []
    published = next((f for f in table.fits if f.name == "published cubic"), None)
    if published is not None:
        worst = int(abs(published.residual).argmax())
        notes.append(
            f"the published cubic misses the table by {published.residual[worst]:+.3g} N at {table.demand[worst]:g} %, where the table "
            f"says {table.thrust[worst]:.4g} N: a cause of its own in a diagnosis (thruster.curve)"
        )
    if not percent:
        notes.append("the published cubic (eq. 18) is left out: its demand is a percentage, this table's is not")
    if table.dead_band is not None:
        notes.append(f"no thrust between demands {table.dead_band[0]:g} and {table.dead_band[1]:g}: a dead band")
    if not table.monotone:
        notes.append("the thrust does not grow with every demand; the table is followed as it is")
    forward, reverse = table.thrust.max(), -table.thrust.min()
    if reverse > 0:
        notes.append(
            f"forward and reverse differ: {forward:.4g} N against {reverse:.4g} N, ratio {reverse / forward:.3g}"
        )
    return notes


def thruster_toml(table: Bollard) -> str:
    """A thruster's table for a vehicle file, its demands from the middle of the dead band where that is not zero.

    Its thrusts are printed with six digits; the accuracy beside them bounds the rounding.
    """
    neutral = 0.0
    if table.dead_band is not None and not table.dead_band[0] <= 0 <= table.dead_band[1]:
        neutral = 0.5 * (table.dead_band[0] + table.dead_band[1])
    demand = ", ".join(f"{d - neutral:.12g}" for d in table.demand)
    printed = [f"{t:.6g}" for t in table.thrust]
    lost = max(abs(float(p) - t) for p, t in zip(printed, table.thrust.tolist(), strict=True))
    curve = f"table = {{ demand = [{demand}], thrust = [{', '.join(printed)}] }}"
    return _thruster(curve, neutral, lost * (1 + 1e-9))


def candidate_toml(table: Bollard, fit: Fit) -> str:
    """A candidate for a vehicle file, with the accuracy that holds every point of the table."""
    if not fit.coefficients and fit.quadratic is None:
        return thruster_toml(table)
    if fit.quadratic is not None:
        curve = f"quadratic = {{ forward = {fit.quadratic[0]!r}, reverse = {fit.quadratic[1]!r} }}"
    else:
        curve = f"polynomial = [{', '.join(repr(c) for c in fit.coefficients)}]"
    ends = f"demand_range = [{table.demand[0] - fit.neutral:.12g}, {table.demand[-1] - fit.neutral:.12g}]"
    # A polynomial in the file's own doubles is evaluated once more, and rounds once more.
    return _thruster(f"{curve}\n{ends}", fit.neutral, fit.band + 1e-9 * float(abs(table.thrust).max()))


def _thruster(curve: str, neutral: float, accuracy: float) -> str:
    shift = f"neutral = {neutral:g}\n" if neutral else ""
    bound = f"accuracy = {{ absolute = {accuracy!r} }}\n" if accuracy else ""
    return f'[[thrusters]]\nname = "name"\nposition = [0.0, 0.0]\nazimuth = 0.0\n{shift}{curve}\n{bound}'


def _column(columns: Sequence[str], given: str | None, hints: tuple[str, ...], what: str, path: str | Path) -> str:
    if given is not None:
        if given not in columns:
            raise IvsidError(f"{path} has no column {given}; {meant(given, columns)}it has {', '.join(columns)}")
        return given
    for hint in hints:
        found = [c for c in columns if hint in c.lower()]
        if found:
            return found[0]
    raise IvsidError(
        f"{path} has no column that looks like a {what} ({', '.join(hints)}); name it with --{what}-column (it has {', '.join(columns)})"
    )


def _given_unit(name: str) -> str | None:
    found = re.search(r"[\(\[]([^\)\]]+)[\)\]]", name)
    return found.group(1).strip() if found else None


def _unit(name: str) -> str:
    """The unit in a header such as ``Force (Kg f)``; newton where there is none."""
    given = _given_unit(name)
    if given is None:
        return "N"
    compact = given.replace(" ", "").lower()
    return next((u for u in units.FORCE if u.lower() == compact), given)
