"""Figures of tubes: bounds of all consistent trajectories, what members attain of them, and the readings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ivsid.report.figures.canvas import COLOURS, Drawing, blank, finish, thin

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ivsid.tubes import Tube
    from ivsid.tubes.bounds import Run

LABELS = ("u [m/s]", "v [m/s]", "r [rad/s]", "heading [rad]", "north [m]", "east [m]")


def tube(result: Tube, run: Run, name: str, *, components: tuple[int, ...] | None = None) -> Drawing:
    """The tube of one length of window: a panel for each component that is followed, or for those that are asked for."""
    shown = result.components if components is None else components
    figure = blank(tube_size(len(shown)), layout="constrained")
    draw_tube(figure, result, run, shown)
    word = "guaranteed under the stated assumptions" if result.guaranteed else "not guaranteed"
    restart = (
        "Without restarts" if run.horizon.length is None else f"Restarted from the measured state every {run.name}"
    )
    text = f"{restart}; the tube is {word}, the inner bound is an estimate. {run.outside} rows have a reading outside."
    return finish(name, f"Trajectories that the data allow: {run.name}", text, figure)


def tube_size(panels: int) -> tuple[float, float]:
    """Width and height of a figure of a tube [inch]."""
    return 8.5, 1.4 + 1.6 * panels


def draw_tube(figure: Figure, result: Tube, run: Run, components: tuple[int, ...]) -> None:
    """Draws the tube, the inner bound and the readings of some components into a figure."""
    for k, axes in zip(components, np.atleast_1d(figure.subplots(len(components), 1, sharex=True)), strict=True):
        _panel(axes, result, run, k)
    figure.axes[-1].set_xlabel("time [s]")
    figure.axes[0].legend(fontsize=8, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, frameon=False)


def _panel(axes: Axes, result: Tube, run: Run, k: int) -> None:
    bounds, s = run.horizon.bounds, thin(result.t.size)
    there = np.isfinite(bounds.lower[:, k]) & np.isfinite(bounds.upper[:, k])
    low, high = (np.where(there, e[:, k], np.nan)[s] for e in (bounds.lower, bounds.upper))
    axes.fill_between(result.t[s], low, high, color=COLOURS[0], alpha=0.3, lw=0, label="tube")
    if run.inner is not None:
        least, most = (e[s, k] for e in run.inner)
        axes.fill_between(result.t[s], least, most, color=COLOURS[1], alpha=0.6, lw=0, label="attained by members")
    if k < 3:
        _readings(axes, result, run, k)
        known = np.isfinite(result.measured.lower[:, k]) & np.isfinite(result.measured.upper[:, k])
        if there[s].any() and known.any():
            # A tube that knows nothing any more would flatten everything else.
            reach = 4 * float(np.abs(result.measured[:, k].midpoint[known]).max()) + 0.5
            axes.set_ylim(max(float(np.nanmin(low)), -reach), min(float(np.nanmax(high)), reach))
    axes.set_ylabel(LABELS[k])
    axes.grid(True, alpha=0.3)


def _readings(axes: Axes, result: Tube, run: Run, k: int) -> None:
    s, x = thin(result.t.size), result.measured[:, k]
    known = np.isfinite(x.lower) & np.isfinite(x.upper)
    low, high = (np.where(known, e, np.nan)[s] for e in (x.lower, x.upper))
    axes.fill_between(result.t[s], low, high, color=COLOURS[5], lw=0.5, label="measured, with its bar")
    for f in (f for f in run.refuted if f.component == "uvr"[k]):
        middle = 0.5 * (f.measured[0] + f.measured[1])
        axes.plot(f.end, middle, "x", color=COLOURS[3], ms=9, mew=2, label="first reading outside")
