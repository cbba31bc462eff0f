"""Figures of measurements: a log, Allan deviations, a bollard-pull table, towing runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ivsid.propulsion.thrust import table_curve
from ivsid.report.figures.canvas import COLOURS, Drawing, blank, finish, thin

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ivsid.log import Log
    from ivsid.propulsion.bollard import Bollard
    from ivsid.sensors.allan import AllanDeviation


def channels(log: Log, name: str = "log") -> Drawing:
    """The channels of a log as measured: demands, velocities and rates, accelerations."""
    figure = blank(channels_size(log), layout="constrained")
    draw_channels(figure, log)
    return finish(name, f"The log {log.name}", f"{log.t.size} samples, median step {log.period:.4g} s.", figure)


def _groups(log: Log) -> list[tuple[str, list[str]]]:
    groups: list[tuple[str, list[str]]] = [
        ("demand", [c for c in log.columns if c.startswith("demand_")]),
        ("u, v [m/s], r [rad/s]", [c for c in ("u", "v", "r") if c in log.columns]),
        ("acceleration [m/s²]", [c for c in ("ax", "ay", "udot", "vdot") if c in log.columns]),
    ]
    if not groups[1][1]:
        groups[1] = ("x, y [m], psi [rad]", [c for c in ("x", "y", "psi") if c in log.columns])
    return [g for g in groups if g[1]] or [("channels", list(log.columns)[: len(COLOURS)])]


def channels_size(log: Log) -> tuple[float, float]:
    """Width and height of a figure of a log [inch]."""
    return 8.5, 1.6 * len(_groups(log)) + 0.8


def draw_channels(figure: Figure, log: Log) -> None:
    """Draws the channels into a figure, a panel for each group."""
    groups = _groups(log)
    panels = np.atleast_1d(figure.subplots(len(groups), 1, sharex=True))
    s = thin(log.t.size)
    for axes, (label, names) in zip(panels, groups, strict=True):
        for k, column in enumerate(names):
            values: NDArray[np.float64] = log.columns[column]
            axes.plot(log.t[s], values[s], lw=0.7, color=COLOURS[k % len(COLOURS)], label=column)
        axes.set_ylabel(label, fontsize=8)
        axes.legend(fontsize=7, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, frameon=False)
        axes.grid(True, alpha=0.3)
    panels[-1].set_xlabel("time [s]")


def allan_curves(curves: Mapping[str, AllanDeviation], name: str, title: str, unit: str) -> Drawing:
    """Allan deviation against averaging time with its band and the fitted model (paper Figs 1-2)."""
    figure = blank((7.5, 4.6), layout="constrained")
    axes = figure.add_subplot()
    for k, (channel, a) in enumerate(curves.items()):
        colour = COLOURS[k % len(COLOURS)]
        axes.loglog(a.taus, a.deviation, ".", color=colour, label=channel)
        axes.fill_between(a.taus, *a.band, color=colour, alpha=0.2)
        axes.loglog(a.taus, a.model(a.taus), "-", color=colour, lw=1, label=_read_off(a))
        parts = (
            (a.random_walk / np.sqrt(a.taus), ":"),
            (np.sqrt(np.maximum(a.model(a.taus) ** 2 - a.random_walk**2 / a.taus, 0.0)), "--"),
        )
        for part, style in parts:
            seen = np.nan_to_num(part) > 0.2 * a.deviation.min()
            axes.loglog(a.taus[seen], part[seen], style, color=colour, lw=0.7)
    axes.set_xlabel("averaging time [s]")
    axes.set_ylabel(f"Allan deviation [{unit}]")
    axes.grid(True, which="both", alpha=0.3)
    axes.legend(fontsize=7)
    caption = (
        "Points: overlapping Allan deviation with its 95 % band. Full lines: random walk N (dotted), Gauss-Markov bias B, T and rate "
        "random walk K (both dashed) fitted together, from the shortest averaging time of the fit on; what was read off stands in the legend."
    )
    return finish(name, title, caption, figure)


def _read_off(a: AllanDeviation) -> str:
    kind = "flicker" if a.flicker else f"T {a.bias_time:.3g} s"
    words = f"fit: N {a.random_walk:.3g}, B {a.bias_instability:.3g}, {kind}"
    return words + (f", K {a.rate_random_walk:.3g}" if a.rate_random_walk else "")


def thrust_curve(
    table: Bollard, name: str = "thrust", title: str = "Thrust against demand", demand_unit: str = "%"
) -> Drawing:
    """Bollard-pull points with the candidate curves, and the residuals of these."""
    figure = blank((8.5, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    fine = np.linspace(table.demand[0], table.demand[-1], 600)
    left.plot(table.demand, table.thrust, "o", ms=3, color=COLOURS[5], label="table")
    shown = [f for f in table.fits if "published" in f.name or "degree 3" in f.name or not f.coefficients]
    for k, fit in enumerate(shown):
        curve = (
            np.polyval(fit.coefficients, fine) if fit.coefficients else table_curve(table.demand, table.thrust)(fine)
        )
        left.plot(fine, curve, color=COLOURS[k], lw=1.2, label=fit.name)
        right.plot(table.demand, fit.residual, ".-", color=COLOURS[k], lw=1, label=f"{fit.name}: rms {fit.rms:.3g} N")
    left.set_ylabel("thrust [N]")
    right.set_ylabel("model minus table [N]")
    for axes in (left, right):
        axes.set_xlabel(f"demand [{demand_unit}]")
        axes.grid(True, alpha=0.3)
        axes.legend(fontsize=7)
    return finish(
        name, title, "Left: the bollard-pull table and the candidate models. Right: what each model misses.", figure
    )


def drag_curve(
    speed: NDArray[np.float64], force: NDArray[np.float64], coefficients: tuple[float, float], name: str
) -> Drawing:
    """Towing runs with a least-squares drag of a linear and a quadratic part."""
    figure = blank((7.5, 4.2), layout="constrained")
    axes = figure.add_subplot()
    fine = np.linspace(speed.min(), speed.max(), 400)
    linear, quadratic = coefficients
    axes.plot(speed, force, "o", ms=3, color=COLOURS[5], label="towing runs, means")
    label = f"{linear:.3f} u {quadratic:+.3f} u|u|"
    axes.plot(fine, linear * fine + quadratic * fine * np.abs(fine), color=COLOURS[0], lw=1.2, label=label)
    axes.set_xlabel("speed [m/s]")
    axes.set_ylabel("force on the hull [N]")
    axes.grid(True, alpha=0.3)
    axes.legend(fontsize=8)
    return finish(name, "Force of the water on the hull", "Least squares, for comparison: not a bound.", figure)
