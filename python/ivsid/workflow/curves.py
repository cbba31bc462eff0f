"""Curves of measurements that a reader zooms into: Allan deviations, static recordings, thrust against demand."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.propulsion.bollard import Bollard
from ivsid.propulsion.thrust import table_curve
from ivsid.report.page import Part
from ivsid.report.series import ALIKE, Across, Line, Panel, series
from ivsid.sensors.allan import AllanDeviation
from ivsid.workflow.allan_recording import Recording

Array = NDArray[np.float64]

# Demands of a drawn curve between the points of its table.
# Source: resource: a page of some kilobytes
FINE: Final = 400
# Candidates that are drawn: there are colours for so many.
# Source: definition: roles of lines that are alike
MOST_CURVES: Final = len(ALIKE)


def allan_series(curves: Mapping[str, AllanDeviation], units: Mapping[str, str]) -> tuple[Part, ...]:
    """Allan deviations with their bands and fits, a figure for each set of averaging times.

    Args:
        curves: by channel.
        units: of the readings, by channel.
    """
    sets: dict[bytes, list[str]] = {}
    for name, a in curves.items():
        sets.setdefault(a.taus.tobytes(), []).append(name)
    return tuple(
        series(
            f"allan-{k + 1}",
            "Allan deviation",
            "Points: overlapping Allan deviation; beside them the ends of its 95 % band. Line: random walk, bias and rate random walk fitted together, "
            "from the shortest averaging time of the fit on.",
            curves[names[0]].taus,
            [_deviation(name, curves[name], units[name]) for name in names],
            across=Across("averaging time [s]", log=True),
        )
        for k, names in enumerate(sets.values())
    )


def _deviation(name: str, a: AllanDeviation, unit: str) -> Panel:
    lines = (
        Line("deviation", "measured", a.deviation, dots=True),
        Line("band, lower end", "before", a.band[0]),
        Line("band, upper end", "before", a.band[1]),
        Line("fit", "after", a.model(a.taus)),
    )
    return Panel(f"{name} [{unit}]", lines, log=True)


def recording_series(recording: Recording) -> Part:
    """The readings over time, as they were recorded: steps, drifts and motions of the sensor show here."""
    size = next(iter(recording.channels.values())).values.size
    panels = [
        Panel(f"{name} [{c.unit}]", (Line("recorded", "measured", c.values),), robust=True)
        for name, c in recording.channels.items()
    ]
    caption = f"{size} samples at {1 / recording.period:.4g} Hz, from the first one that was used."
    return series("recording", "The recording", caption, np.arange(size, dtype=np.float64) * recording.period, panels)


def thrust_series(table: Bollard, demand: str) -> Part:
    """Bollard-pull points with the candidate curves, and what each of these misses.

    Args:
        table: with its candidates.
        demand: label of the demand, with its unit.
    """
    grid = np.unique(np.r_[table.demand, np.linspace(table.demand[0], table.demand[-1], FINE)])
    at = np.searchsorted(grid, table.demand)
    others = sorted((f for f in table.fits if f is not table.recommended), key=lambda f: f.rms)
    shown = [table.recommended, *others][:MOST_CURVES]
    curves, missed = [Line("table", "measured", _placed(table.thrust, at, grid.size), dots=True)], []
    for role, fit in zip(ALIKE, shown, strict=False):
        if fit.coefficients:
            curve = np.asarray(np.polyval(fit.coefficients, grid - fit.neutral), dtype=np.float64)
        elif fit.quadratic is not None:
            n = grid - fit.neutral
            curve = np.asarray(np.where(n > 0, fit.quadratic[0], fit.quadratic[1]) * n * np.abs(n), dtype=np.float64)
        else:
            curve = table_curve(table.demand, table.thrust)(grid)
        curves.append(Line(fit.name, role, curve))
        missed.append(Line(fit.name, role, _placed(fit.residual, at, grid.size), dots=True))
    panels = [Panel("thrust [N]", tuple(curves)), Panel("model minus table [N]", tuple(missed))]
    caption = "The points of the table, the recommended curve, and the candidates that miss least; below, what each misses at the points."
    return series("thrust", "Thrust against demand", caption, grid, panels, across=Across(demand))


def _placed(values: Array, at: NDArray[np.intp], size: int) -> Array:
    """Values at their places on a grid, shape (size,); NaN between them."""
    made = np.full(size, np.nan)
    made[at] = values
    return made
