"""``ivsid allan``: noise coefficients of a static recording, ready for a vehicle file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ivsid.files.records import envelope
from ivsid.report import figures, page
from ivsid.report.page import Cells, Part, Report, Section
from ivsid.report.tables import allan_record
from ivsid.sensors.allan import AllanDeviation, allan_deviation
from ivsid.sensors.allan_fit import NAMES
from ivsid.sensors.noise import rule_for
from ivsid.vehicle import Sensors
from ivsid.workflow.allan_recording import read_recording
from ivsid.workflow.allan_words import allan_notes, data_sheet_rows, half_width, sensors_toml
from ivsid.workflow.curves import allan_series, recording_series
from ivsid.workflow.first_screens import analysed
from ivsid.workflow.progress import Progress, silent


def allan(
    log: str | Path,
    *,
    columns: Sequence[str] = (),
    time: str | None = None,
    unit: Sequence[str] = (),
    progress: Progress = silent,
) -> Report:
    """Reads a static recording and analyses every inertial channel.

    Args:
        log: the recording.
        columns: channels; every inertial one by default.
        time: name of the time column [s]; found by its name by default.
        unit: of the rates and accelerations (deg/s, deg/h, g, mg); that of a header, else SI, by default.
        progress: told of each step.

    Raises:
        IvsidError: an unusable recording, in one sentence.
    """
    progress("reading")
    recording = read_recording(log, columns, time, unit)
    curves = {}
    for k, (name, channel) in enumerate(recording.channels.items()):
        progress(f"channels {k} of {len(recording.channels)}: {name}")
        curves[name] = allan_deviation(name, channel.values, recording.period)
    samples = next(iter(recording.channels.values())).values.size
    duration = samples * recording.period
    groups: dict[tuple[str, str], dict[str, AllanDeviation]] = {}
    for name, curve in curves.items():
        channel = recording.channels[name]
        groups.setdefault((channel.quantity, channel.unit), {})[name] = curve
    drawings = tuple(
        figures.allan_curves(c, f"allan_{q}", f"Allan deviation, {q.replace('_', ' ')}", u)
        for (q, u), c in groups.items()
    )
    snippet = sensors_toml(curves, recording.channels)
    said = [n for a in curves.values() for n in allan_notes(a, recording.channels[a.channel].unit)]
    notes = [*recording.notes, *said]
    walks = sum(a.rate_random_walk > 0 for a in curves.values())
    rule = rule_for(Sensors(), 2 * samples * len(curves) + 4 * walks)
    record = {
        **envelope("allan", {Path(log).name: recording.sha256}),
        "samples": samples,
        "period": recording.period,
        "channels": {
            n: {"quantity": c.quantity, "unit": c.unit, "si": c.factor, **r}
            for (n, r), c in zip(allan_record(curves).items(), recording.channels.values(), strict=True)
        },
        "sigmas": rule.sigmas,
        "confidence": rule.confidence,
        "bounds": {n: half_width(a, rule.sigmas, duration) for n, a in curves.items()},
        "toml": snippet,
        "notes": notes,
    }
    rows = coefficient_rows(curves, record["bounds"], {n: c.unit for n, c in recording.channels.items()})
    sheet = data_sheet_rows(curves, recording.channels)
    sections = (
        Section(
            "Coefficients",
            (
                coefficient_table(rows),
                band_table(curves),
                *([page.table(["channel", "N", "floor/0.664"], sheet, "As data sheets give them")] if sheet else []),
                page.bullets([*notes, *_reading(rule.sigmas)]),
            ),
        ),
        Section("Curves", allan_series(curves, {n: c.unit for n, c in recording.channels.items()})),
        Section("The recording", (recording_series(recording),)),
        Section("For the vehicle file", (page.code(snippet),)),
    )
    summary = f"{samples} samples at {1 / recording.period:.4g} Hz, {duration:.4g} s; {len(curves)} channels."
    lines = [
        *(_line(a, recording.channels[n].unit, float(record["bounds"][n])) for n, a in curves.items()),
    ]
    lines += [f"  {r[0]:<10} as data sheets give it: N {r[1]}, floor/0.664 {r[2]}" for r in sheet]
    lines += [f"  note: {n}" for n in notes]
    return Report(
        f"Allan analysis of {Path(log).name}",
        summary,
        record,
        sections,
        drawings,
        {"sensors.toml": snippet},
        tuple(lines),
        analysed(
            curves, record["bounds"], {n: c.unit for n, c in recording.channels.items()}, samples * recording.period
        ),
    )


def _line(a: AllanDeviation, unit: str, bound: float) -> str:
    low, high = a.bands["bias_instability"]
    kind = "flicker" if a.flicker else f"T {a.bias_time:.4g} s" + ("" if a.resolved else ", not resolved")
    return (
        f"  {a.channel:<10} [{unit}] N {a.random_walk:.4g}, B {a.bias_instability:.4g} in [{low:.4g}, {high:.4g}] ({kind}), "
        f"K {a.rate_random_walk:.4g}, floor/0.664 {a.floor:.4g}, half-width {bound:.4g}"
    )


def _reading(sigmas: float) -> list[str]:
    return [
        "N: random walk; B: standard deviation of a first-order Gauss-Markov bias of correlation time T, fitted to the curve from the time on at "
        "which the white part starts; or the coefficient of flicker noise, where that explains more",
        "a hump that is not resolved inside the record makes B what the fit tolerates, not a measurement: record for longer",
        "sigma_c: eq. 15 of the paper, its 3 sigma is no bound for a whole log",
        "K: rate random walk, where the record shows one beside the bias; the 95 % bands hold each number with the others free",
        f"half-width: {sigmas:.2f} (N/sqrt(dt) + B + K sqrt(duration)), which every sample of a log of this length keeps with probability 0.999",
    ]


def coefficient_rows(
    curves: Mapping[str, AllanDeviation], bounds: Mapping[str, float], units: Mapping[str, str]
) -> list[list[object]]:
    """One row for each channel in its unit, for tables."""
    return [
        [
            n,
            units[n],
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
        "N [unit·√s]",
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
    return page.table(["channel", "N", "B", "T [s]", "K [unit/√s]"], rows, "95 % bands")


def _banded(value: float, band: tuple[float, float]) -> str:
    return f"{value:.4g} [{band[0]:.4g}, {band[1]:.4g}]".replace("inf]", "∞)")
