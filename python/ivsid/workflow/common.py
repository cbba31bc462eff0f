"""Sections that several reports share."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

import numpy as np
import polars as pl
from numpy.typing import NDArray

from ivsid.identification import Identification, in_words
from ivsid.intervals import outward_decimal
from ivsid.log import Quality
from ivsid.report import page
from ivsid.validation import Validation

Progress: TypeAlias = Callable[[str], None]

MEANING = {
    "enclosed": "every parameter that is consistent with the log lies in these intervals",
    "empty": "no parameter is consistent with every row: the model, the thrust accuracy or a sensor bound is wrong",
    "unbounded": "the log leaves some direction open; the ends that are given hold",
    "not_proved": "numbers without a proof: they enclose nothing",
    "not_applicable": "the method's own conditions do not hold on these data",
}


# Directions that the terminal shows; a log that bounds nothing leaves dozens.
MOST_DIRECTIONS = 6


def silent(_: str) -> None:
    """Progress for nobody."""


def shown(lower: float, upper: float, digits: int = 6) -> str:
    """An interval for people, rounded outward; open ends as words."""
    return f"[{_end(lower, digits, up=False)}, {_end(upper, digits, up=True)}]"


def _end(x: float, digits: int, *, up: bool) -> str:
    if not math.isfinite(x):
        return "no bound"
    if x == 0:
        return "0"
    places = digits - 1 - math.floor(math.log10(abs(x)))
    scaled = float(f"{x:.{digits}g}")
    if (scaled < x) if up else (scaled > x):
        scaled += (1 if up else -1) * 10.0**-places
    text = f"{scaled:.{digits}g}"
    # Rounding to a few digits is done in floats: where it landed on the wrong side, the exact decimal is shown.
    safe = Fraction(text) >= Fraction(x) if up else Fraction(text) <= Fraction(x)
    return text if safe else outward_decimal(x, up=up)


def method_table(fits: Sequence[Identification]) -> dict[str, Any]:
    """One row a method and parameter."""
    rows: list[list[Any]] = []
    for fit in fits:
        ids = list(fit.parameters) or ["–"]
        for k, id_ in enumerate(ids):
            p = fit.parameters.get(id_)
            bounds = shown(p.lower, p.upper) if p else "–"
            width = p.width if p and math.isfinite(p.width) else None
            head = [fit.method, fit.status, fit.guaranteed] if k == 0 else ["", "", ""]
            rows.append([*head, id_, p.unit if p else "", bounds, width])
    return page.table(["method", "status", "guaranteed", "parameter", "unit", "interval", "width"], rows)


def parameter_lines(fit: Identification) -> list[str]:
    """What the terminal shows of an identification."""
    lines = [
        f"method {fit.method}: {fit.status}, {'guaranteed' if fit.guaranteed else 'NOT guaranteed'}; {MEANING[fit.status]}"
    ]
    lines += [f"  {id_:<24} {shown(p.lower, p.upper):>32} {p.unit}" for id_, p in fit.parameters.items()]
    if fit.status == "empty" and fit.estimate:
        lines.append("  parameter of least inflation: " + ", ".join(f"{k} {v:.5g}" for k, v in fit.estimate.items()))
    if fit.inflation is not None:
        room = (
            "the data agree with the model with room to spare"
            if fit.inflation < 1
            else "by this factor all bounds would have to grow"
        )
        lines.append(f"  inflation {fit.inflation:.3g}: {room}")
    if fit.reason:
        lines.append(f"  {fit.reason}")
    for direction in fit.directions[:MOST_DIRECTIONS]:
        lines.append("  left open along: " + " ".join(f"{v:+.3g} {k}" for k, v in direction.items()))
    if len(fit.directions) > MOST_DIRECTIONS:
        lines.append(f"  and along {len(fit.directions) - MOST_DIRECTIONS} more (result.json)")
    lines += [f"  {line}" for line in (*freedom_lines(fit), *claim_lines(fit), *_culprits(fit))]
    return lines


def freedom_lines(fit: Identification) -> list[str]:
    """What the data do determine, where they leave something open."""
    if fit.status != "unbounded" or not fit.directions:
        return []
    if not fit.determined:
        return ["nothing is determined: every combination of the parameters that are left open is free"]
    alone = [next(iter(c)) for c in fit.determined if len(c) == 1]
    mixed = [in_words(c) for c in fit.determined if len(c) > 1]
    words = (
        [f"of what is left open, only {', '.join(mixed)} {'is' if len(mixed) == 1 else 'are'} determined"]
        if mixed
        else []
    )
    return words + ([f"determined by itself: {', '.join(alone)}"] if alone else [])


def claim_lines(fit: Identification) -> list[str]:
    """What the vehicle file claims of its parameters, against their intervals."""
    lines = []
    for claim in fit.claims:
        p = fit.parameters[claim["parameter"]]
        verdict = "is contradicted by" if claim["contradicted"] else "is consistent with"
        word = " (proved)" if claim["contradicted"] and fit.guaranteed else ""
        lines.append(f"the claimed {claim['parameter']} = {claim['value']!r} {verdict} {shown(p.lower, p.upper)}{word}")
    return lines


def _culprits(fit: Identification) -> list[str]:
    """The samples that contradict each other."""
    places = dict.fromkeys((r["channel"], r["time"], r["duration"]) for c in fit.falsifying for r in c["rows"])
    if not places:
        return []
    names = [f"{c} at {t:.6g} s" + (f" over {d:.4g} s" if d else "") for c, t, d in list(places)[:MOST_DIRECTIONS]]
    more = f" and {len(places) - MOST_DIRECTIONS} more (report.html)" if len(places) > MOST_DIRECTIONS else ""
    return [f"rows that contradict each other: {', '.join(names)}{more}"]


def validation_table(result: Validation) -> dict[str, Any]:
    """Errors of the predicted force and moment."""
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


def motion_table(result: Validation) -> dict[str, Any]:
    """Errors of the simulated motion."""
    motion = result.motion
    if motion.reason:
        return page.text(f"No simulated motion: {motion.reason}.")
    units = {"u": "m/s", "v": "m/s", "r": "rad/s", "position": "m"}
    rows = [
        [k, units[k], motion.window["position" if k == "position" else "velocity"], motion.rms[k], motion.median[k]]
        for k in motion.rms
    ]
    return page.table(["quantity", "unit", "window [s]", "rms error", "median over windows"], rows)


def quality_table(quality: Mapping[str, Quality]) -> dict[str, Any]:
    """What each channel of a log is worth, as it came."""
    rows = [
        [n, q.samples, q.rate, q.missing, q.longest, q.held, q.outliers, q.lower, q.upper] for n, q in quality.items()
    ]
    header = [
        "channel",
        "measurements",
        "usual rate [Hz]",
        "rows without",
        "longest wait [s]",
        "held repeats",
        "outliers",
        "smallest",
        "largest",
    ]
    return page.table(header, rows, "Nothing is filled in, and no outlier is taken out.")


def csv(t: NDArray[np.float64], columns: dict[str, NDArray[np.float64]]) -> str:
    """A log as CSV text; the decimals read back as the same doubles."""
    return pl.DataFrame({"t": t, **columns}).write_csv()


def parquet(t: NDArray[np.float64], columns: dict[str, NDArray[np.float64]]) -> bytes:
    """A log as a Parquet file; missing samples are NaN."""
    buffer = io.BytesIO()
    pl.DataFrame({"t": t, **columns}).write_parquet(buffer)
    return buffer.getvalue()
