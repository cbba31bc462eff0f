"""Figures of parameter intervals that narrow along a log."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ivsid.report.figures.canvas import COLOURS, Drawing, blank, finish
from ivsid.report.scaling import robust_range

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ivsid.identification import Following


def narrowing(result: Following) -> Drawing:
    """A panel for each parameter: its interval after each moment of the log."""
    figure = blank(narrowing_size(result), layout="constrained")
    draw_narrowing(figure, result)
    word = "guaranteed under the stated assumptions" if result.guaranteed else "not guaranteed"
    text = f"The interval of each parameter by the rows so far, {word}. Open ends leave the panel."
    return finish("narrowing", "Parameter intervals along the log", text, figure)


def narrowing_size(result: Following) -> tuple[float, float]:
    """Width and height of the figure [inch]."""
    return 8.5, 1.0 + 1.3 * max(len(_ids(result)), 1)


def draw_narrowing(figure: Figure, result: Following) -> None:
    """Draws the intervals over time into a figure."""
    ids = _ids(result)
    panels = np.atleast_1d(figure.subplots(max(len(ids), 1), 1, sharex=True))
    for id_, axes in zip(ids, panels, strict=False):
        _panel(axes, result, id_)
    panels[-1].set_xlabel("time [s]")


def _ids(result: Following) -> list[str]:
    return list(next((m.parameters for m in result.moments if m.parameters), {}))


def _panel(axes: Axes, result: Following, id_: str) -> None:
    there = [m for m in result.moments if m.parameters]
    time = np.array([m.time for m in there])
    ends = np.array([[m.parameters[id_].lower, m.parameters[id_].upper] for m in there])
    # An open end is drawn far outside of the panel, whose range the finite ends set.
    finite = np.where(np.isfinite(ends), ends, np.nan)
    shown = robust_range(list(finite.T)) if np.isfinite(finite).any() else None
    low, high = shown or (-1.0, 1.0)
    reach = max(high - low, 1e-12 * max(abs(low), abs(high)), 1e-300)
    drawn = np.clip(ends, low - 10 * reach, high + 10 * reach)
    axes.fill_between(time, drawn[:, 0], drawn[:, 1], step="post", color=COLOURS[0], alpha=0.3, lw=1)
    axes.set_ylim(low - 0.1 * reach, high + 0.1 * reach)
    for change in result.changes:
        axes.axvline(change.time, color=COLOURS[3], lw=1)
    unit = there[0].parameters[id_].unit
    axes.set_ylabel(f"{id_}\n[{unit}]", fontsize=7)
    axes.grid(True, alpha=0.3)
