"""Figures of fits: parameter intervals, predicted forces, simulated motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ivsid.report.figures.canvas import COLOURS, FORCE_LABEL, Drawing, blank, finish, thin
from ivsid.report.scaling import narrow_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ivsid.identification import Identification
    from ivsid.validation import ForceCheck, MotionCheck


def intervals(fits: Sequence[Identification], name: str = "parameters") -> Drawing:
    """Parameter intervals of one or more methods."""
    figure = blank(intervals_size(fits), layout="constrained")
    draw_intervals(figure, fits)
    return finish(
        name,
        "Parameter intervals by method",
        "Green: guaranteed under the stated assumptions. Red: not guaranteed. An arrow marks what runs off the axis.",
        figure,
    )


def _ids(fits: Sequence[Identification]) -> list[str]:
    return list(dict.fromkeys(i for f in fits for i in (*f.parameters, *f.estimate)))


def intervals_size(fits: Sequence[Identification]) -> tuple[float, float]:
    """Width and height of a figure of intervals [inch]."""
    return 8.5, 1.0 + 0.42 * len(fits) * max(len(_ids(fits)), 1) ** 0.5 + 1.2


def draw_intervals(figure: Figure, fits: Sequence[Identification]) -> None:
    """Draws the intervals into a figure, a panel for each parameter."""
    ids = _ids(fits)
    panels = np.atleast_1d(figure.subplots(1, max(len(ids), 1)))
    for axes, id_ in zip(panels, ids, strict=False):
        ends = narrow_axis([(f.parameters[id_].lower, f.parameters[id_].upper) for f in fits if id_ in f.parameters])
        for row, fit in enumerate(fits):
            colour = COLOURS[2] if fit.guaranteed else COLOURS[3]
            p = fit.parameters.get(id_)
            if p is not None and np.isfinite([p.lower, p.upper]).all():
                axes.plot([p.lower, p.upper], [row, row], color=colour, lw=4, solid_capstyle="butt")
                axes.plot([p.lower, p.upper], [row, row], "|", color=colour, ms=10)
                if ends is not None:
                    # A wide interval runs off, so that the narrow ones can be read.
                    axes.plot([ends[0]] * (p.lower < ends[0]), [row] * (p.lower < ends[0]), "<", color=colour, ms=6)
                    axes.plot([ends[1]] * (p.upper > ends[1]), [row] * (p.upper > ends[1]), ">", color=colour, ms=6)
            else:
                axes.text(
                    0.5,
                    row,
                    "no bound" if p else fit.status,
                    transform=axes.get_yaxis_transform(),
                    ha="center",
                    va="center",
                    fontsize=7,
                )
        unit = next((f.parameters[id_].unit for f in fits if id_ in f.parameters), "")
        axes.set_xlabel(f"{id_} [{unit}]", fontsize=8)
        axes.set_yticks(
            range(len(fits)), [f.method for f in fits] if axes is panels[0] else [""] * len(fits), fontsize=8
        )
        axes.set_ylim(len(fits) - 0.4, -0.6)
        if ends is not None:
            axes.set_xlim(*ends)
        axes.tick_params(axis="x", labelsize=7)
        axes.grid(True, axis="x", alpha=0.3)


def force_mid(check: ForceCheck, name: str, title: str) -> Drawing:
    """Mid-values of the predicted force against the measured one (paper Figs 4-5)."""
    figure = blank((8.5, 4.2), layout="constrained")
    axes = figure.add_subplot()
    s = thin(check.time.size)
    axes.plot(check.time[s], check.measured[s].midpoint, color=COLOURS[5], lw=1, label="measured")
    axes.plot(check.time[s], check.predicted_mid[s], color=COLOURS[0], lw=0.6, alpha=0.8, label="predicted, mid-value")
    _time_axes(axes, check)
    unit = "N m" if check.channel == "yaw" else "N"
    caption = (
        f"Error: mean {check.mean:.3g} {unit}, standard deviation {check.sigma:.3g} {unit} over {check.time.size} rows."
    )
    return finish(name, title, caption, figure)


def force_bounds(check: ForceCheck, name: str, title: str, *, guaranteed: bool) -> Drawing:
    """Bounds of the predicted force against the measured one (paper Figs 6-7)."""
    figure = blank((8.5, 4.2), layout="constrained")
    draw_bounds(figure.add_subplot(), check)
    word = "guaranteed under the stated assumptions" if guaranteed else "not guaranteed"
    caption = f"{100 * check.coverage:.1f} % of the measured values lie inside; {check.falsified} rows contradict the parameters. Bounds {word}."
    return finish(name, title, caption, figure)


def draw_bounds(axes: Axes, check: ForceCheck) -> None:
    """Draws the bounds of the predicted force and the measured one."""
    s = thin(check.time.size)
    bounds = (check.predicted.lower[s], check.predicted.upper[s])
    if np.isfinite(bounds).all():
        axes.fill_between(check.time[s], *bounds, color=COLOURS[0], alpha=0.35, lw=0, label="predicted bounds")
    axes.plot(check.time[s], check.measured[s].midpoint, color=COLOURS[5], lw=1, label="measured")
    _time_axes(axes, check)


def _time_axes(axes: Axes, check: ForceCheck) -> None:
    axes.set_xlabel("time [s]")
    axes.set_ylabel(FORCE_LABEL[check.channel])
    axes.grid(True, alpha=0.3)
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False, fontsize=8)


def motion(check: MotionCheck, name: str = "motion") -> Drawing:
    """Simulated against measured velocities, window by window."""
    figure = blank((8.5, 5.4), layout="constrained")
    for k, (label, axes) in enumerate(
        zip(("u [m/s]", "v [m/s]", "r [rad/s]"), figure.subplots(3, 1, sharex=True), strict=True)
    ):
        s = thin(check.time.size)
        axes.plot(check.time[s], check.measured[s, k], color=COLOURS[5], lw=0.8, label="measured")
        axes.plot(check.time[s], check.simulated[s, k], ".", ms=1.2, color=COLOURS[1], label="simulated")
        axes.set_ylabel(label)
        axes.grid(True, alpha=0.3)
    axes.set_xlabel("time [s]")
    figure.axes[0].legend(fontsize=8, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False)
    window = check.window.get("velocity", 0.0)
    text = ", ".join(f"{k} {v:.3g}" for k, v in check.rms.items())
    return finish(
        name,
        "Simulated against measured motion",
        f"Restarted from the measured state every {window:g} s. Rms: {text}.",
        figure,
    )
