"""``ivsid allan``: noise coefficients of a static recording, ready for a vehicle file."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ivsid.errors import IvsidError, meant
from ivsid.files.records import envelope
from ivsid.log import open_source
from ivsid.report import figures, page
from ivsid.report.page import Cells, Part, Report, Section
from ivsid.report.tables import allan_record
from ivsid.sensors.allan import AllanDeviation, allan_deviation
from ivsid.sensors.allan_fit import NAMES
from ivsid.sensors.noise import rule_for
from ivsid.vehicle import Sensors
from ivsid.workflow.progress import Progress, silent

TIMES = ("t", "t_s", "time", "time_s", "timestamp", "stamp")
# The quantity of a column by its name: (quantity, unit, pattern).
QUANTITIES = (
    ("acceleration", "m/s^2", re.compile(r"^(ax|ay|az|udot|vdot|acc.*)$", re.IGNORECASE)),
    ("yaw_rate", "rad/s", re.compile(r"^(r|p|q|gyr.*|yaw_?rate.*)$", re.IGNORECASE)),
)


@dataclass(frozen=True)
class Recording:
    """A gap-free stretch of a static recording at a steady rate."""

    channels: Mapping[str, NDArray[np.float64]]
    period: float
    notes: tuple[str, ...]
    sha256: str


def allan(
    log: str | Path, *, columns: Sequence[str] = (), time: str | None = None, progress: Progress = silent
) -> Report:
    """Reads a static recording and analyses every inertial channel.

    Args:
        log: the recording.
        columns: channels; every inertial one by default.
        time: name of the time column [s]; found by its name by default.
        progress: told of each step.

    Raises:
        IvsidError: an unusable recording, in one sentence.
    """
    progress("reading")
    recording = _record(log, columns, time)
    curves = {}
    for k, (name, values) in enumerate(recording.channels.items()):
        progress(f"channels {k} of {len(recording.channels)}: {name}")
        curves[name] = allan_deviation(name, values, recording.period)
    samples = len(next(iter(recording.channels.values())))
    groups: dict[tuple[str, str], dict[str, AllanDeviation]] = {}
    for name, curve in curves.items():
        groups.setdefault(_quantity(name), {})[name] = curve
    drawings = tuple(
        figures.allan_curves(c, f"allan_{q}", f"Allan deviation, {q.replace('_', ' ')}", u)
        for (q, u), c in groups.items()
    )
    snippet = sensors_toml(curves)
    walks = sum(a.rate_random_walk > 0 for a in curves.values())
    rule = rule_for(Sensors(), 2 * samples * len(curves) + 4 * walks)
    record = {
        **envelope("allan", {Path(log).name: recording.sha256}),
        "samples": samples,
        "period": recording.period,
        "channels": allan_record(curves),
        "sigmas": rule.sigmas,
        "confidence": rule.confidence,
        "bounds": {
            n: rule.sigmas
            * (
                a.random_walk / np.sqrt(recording.period)
                + a.bias_instability
                + a.rate_random_walk * np.sqrt(samples * recording.period)
            )
            for n, a in curves.items()
        },
        "toml": snippet,
        "notes": recording.notes,
    }
    rows = coefficient_rows(curves, record["bounds"])
    sections = (
        Section(
            "Coefficients",
            (coefficient_table(rows), band_table(curves), page.bullets([*_reading(rule.sigmas), *recording.notes])),
        ),
        Section("Curves", tuple(page.drawing(d) for d in drawings)),
        Section("For the vehicle file", (page.code(snippet),)),
    )
    summary = f"{samples} samples at {1 / recording.period:.4g} Hz, {samples * recording.period:.4g} s; {len(curves)} channels."
    lines = [
        *(
            f"  {r[0]:<10} N {r[2]:.4g}, B {r[3]:.4g} (T {r[4]:.4g} s{'' if r[5] else ', not resolved'}), K {curves[str(r[0])].rate_random_walk:.4g}, "
            f"sigma_c {r[7]:.4g}, half-width {r[9]:.4g} {r[1]}"
            for r in rows
        ),
    ]
    lines += [f"  note: {n}" for n in recording.notes]
    return Report(
        f"Allan analysis of {Path(log).name}",
        summary,
        record,
        sections,
        drawings,
        {"sensors.toml": snippet},
        tuple(lines),
    )


def _reading(sigmas: float) -> list[str]:
    return [
        "N: random walk; B: standard deviation of a first-order Gauss-Markov bias of correlation time T, fitted to the curve",
        "a hump that is not resolved inside the record makes B what the fit tolerates, not a measurement: record for longer",
        "sigma_c: eq. 15 of the paper, its 3 sigma is no bound for a whole log",
        "K: rate random walk, where the record shows one beside the bias; the 95 % bands hold each number with the others free",
        f"half-width: {sigmas:.2f} (N/sqrt(dt) + B + K sqrt(duration)), which every sample of a log of this length keeps with probability 0.999",
    ]


def coefficient_rows(curves: Mapping[str, AllanDeviation], bounds: Mapping[str, float]) -> list[list[object]]:
    """One row for each channel, for tables."""
    return [
        [
            n,
            _quantity(n)[1],
            a.random_walk,
            a.bias_instability,
            a.bias_time,
            a.resolved,
            a.floor,
            a.sigma_c,
            3 * a.sigma_c,
            float(bounds[n]),
        ]
        for n, a in curves.items()
    ]


def coefficient_table(rows: Sequence[Cells]) -> Part:
    """The coefficients as a table of the report."""
    header = [
        "channel",
        "unit",
        "N [unit/√s]",
        "B [unit]",
        "T [s]",
        "hump resolved",
        "floor/0.664",
        "σ_c (eq. 15)",
        "3 σ_c",
        "half-width",
    ]
    return page.table(header, rows)


def band_table(curves: Mapping[str, AllanDeviation]) -> Part:
    """The coefficients with their 95 % bands."""
    rows = [[channel, *(_banded(getattr(a, name), a.bands[name]) for name in NAMES)] for channel, a in curves.items()]
    return page.table(["channel", "N", "B", "T [s]", "K [unit/s/√s]"], rows, "95 % bands")


def _banded(value: float, band: tuple[float, float]) -> str:
    return f"{value:.4g} [{band[0]:.4g}, {band[1]:.4g}]".replace("inf]", "∞)")


def _quantity(name: str) -> tuple[str, str]:
    return next(((q, u) for q, u, pattern in QUANTITIES if pattern.match(name)), ("other", "unit of the column"))


def sensors_toml(curves: Mapping[str, AllanDeviation]) -> str:
    """The sensor sections of a vehicle file; it has no place for an accelerometer's z axis and a gyro's x and y axes."""
    lines: list[str] = []

    def number(x: float) -> str:
        return f"{x:.4g}"

    def pair(values: list[float]) -> str:
        return number(values[0]) if len(values) == 1 else f"[{', '.join(number(v) for v in values)}]"

    accelerations = [
        a
        for n, a in curves.items()
        if _quantity(n)[0] == "acceleration" and not re.search(r"z", n.split("_")[-1] if "_" in n else n)
    ][:2]
    rates = [a for n, a in curves.items() if _quantity(n)[0] == "yaw_rate"]
    yaw = next((a for a in rates if re.search(r"(^r$|z)", a.channel)), rates[-1] if rates else None)
    for section, found in (("acceleration", accelerations), ("yaw_rate", [yaw] if yaw else [])):
        if found:
            lines += [
                f"[sensors.{section}]  # from {', '.join(a.channel for a in found)}",
                f"random_walk = {pair([a.random_walk for a in found])}",
                f"bias_instability = {pair([a.bias_instability for a in found])}",
                f"bias_time = {pair([a.bias_time for a in found])}",
            ]
            walk = max(a.rate_random_walk for a in found)
            lines += [f"rate_random_walk = {number(walk)}"] if walk else []
            lines.append("")
    return "\n".join(lines)


def _record(path: str | Path, columns: Sequence[str], time: str | None) -> Recording:
    with open_source(path) as source:
        names = source.columns
        name = time or next((c for c in TIMES if c in names), None)
        if name is None or name not in names:
            raise IvsidError(
                f"{path} has no time column {name or 'among ' + ', '.join(TIMES)}; name it with --time (it has {', '.join(names[:12])})"
            )
        t = source.numeric([name])[name]
        if t.size < 2 or not np.isfinite(t).all() or (np.diff(t) <= 0).any():
            raise IvsidError(f"{path}: column {name} must increase strictly without missing cells; sort the recording")
        chosen = list(columns) or [c for c in names if c != name and _quantity(c)[0] != "other"]
        chosen = chosen or [c for c in names if c != name]
        missing = [c for c in chosen if c not in names]
        if missing or not chosen:
            raise IvsidError(
                f"{path} has no column {', '.join(missing) or 'to analyse'}; {meant(missing[0], names) if missing else ''}it has {', '.join(names)}"
            )
        values = source.numeric(chosen)
        digest = source.sha256
    if any(v.size != t.size for v in values.values()):
        raise IvsidError(
            f"{path}: the chosen columns stand on several clocks; choose those of one with --columns and --time"
        )
    steps = np.diff(t)
    usual = float(np.median(steps))
    complete = np.all([np.isfinite(v) for v in values.values()], axis=0)
    broken = np.flatnonzero(np.r_[True, (steps > 2.5 * usual) | ~complete[1:] | ~complete[:-1], True])
    lengths = np.diff(broken)
    longest = int(np.argmax(lengths))
    part = slice(int(broken[longest]), int(broken[longest + 1]))
    notes = []
    if lengths[longest] < t.size:
        notes.append(f"only the longest stretch without gaps is used: {lengths[longest]} of {t.size} samples")
    span = t[part]
    if span.size < 2:
        raise IvsidError(f"{path} has no stretch without gaps; an Allan deviation needs a steady rate")
    period = float((span[-1] - span[0]) / (span.size - 1))
    jitter = float(np.diff(span).std() / period)
    if jitter > 0.01:
        notes.append(
            f"the sampling is uneven (standard deviation of the step {100 * jitter:.0f} % of its mean); its mean is taken as the period"
        )
    return Recording({c: v[part] for c, v in values.items()}, period, tuple(notes), digest)
