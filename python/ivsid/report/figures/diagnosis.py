"""Figures of a diagnosis: signatures of findings, force and motion before and after, and distances between causes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ivsid.report.figures.canvas import COLOURS, Drawing, blank, finish, fixed, thin
from ivsid.report.scaling import robust_range

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ivsid.diagnosis import Evidence, Finding, Isolability
    from ivsid.diagnosis.statements.comparison import Gain


def separation(result: Isolability, name: str = "separation") -> Drawing | None:
    """Distances of causes in a log, and with the manoeuvre that increases them most; None if no manoeuvre was tried."""
    if not result.advice:
        return None
    figure = blank((8.5, 1.3 + 0.42 * len(result.advice)), layout="constrained")
    axes = figure.add_subplot()
    least = 0.1
    for row, advice in enumerate(result.advice):
        best = advice.best
        now = max(advice.d, least)
        if best is not None:
            then = max(best.d, least)
            axes.plot([now, then], [row, row], color="0.6", lw=1.2, zorder=1)
            axes.plot([then], [row], "o", color=COLOURS[0], label="with the best manoeuvre")
            axes.annotate(best.trial, (then, row), xytext=(6, 0), textcoords="offset points", fontsize=7, va="center")
        axes.plot([now], [row], "s", color=COLOURS[3], label="this log alone")
    axes.axvline(5.0, color=COLOURS[5], lw=0.8, ls="--")
    axes.set_xscale("log")
    left, right = axes.get_xlim()
    axes.set_xlim(left, right * 3)
    axes.set_yticks(range(len(result.advice)), [", ".join(a.ids) for a in result.advice], fontsize=7)
    axes.set_ylim(len(result.advice) - 0.5, -0.5)
    axes.set_xlabel("distance d of the closest two")
    axes.grid(True, axis="x", which="both", alpha=0.25)
    handles = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles.keys(), fontsize=8, loc="outside upper left", ncols=2, frameon=False)
    return finish(
        name,
        "Manoeuvres that tell causes apart",
        "Distance of the two closest causes of each set at their typical sizes: the expected loss of fit when one is taken for the other, in standard deviations. Right of the dashed line "
        "(5) they are told apart. What lies at the left end is one column of the equations, and no manoeuvre separates it.",
        figure,
    )


QUANTITY = {
    "u": "surge velocity u [m/s]",
    "v": "sway velocity v [m/s]",
    "r": "yaw rate r [rad/s]",
    "heading": "heading [rad]",
    "thrust ahead": "thrust ahead [N]",
    "turning thrust": "moment of the thrusters [N m]",
    "udot": "surge acceleration [m/s²]",
    "rdot": "yaw acceleration [rad/s²]",
    "u v": "u v [m²/s²]",
    "u r": "u r [m/s²]",
    "change of thrust": "change of thrust ahead [N/s]",
    "change of turning thrust": "change of the thrusters' moment [N m/s]",
    "north": "place north [m]",
    "east": "place east [m]",
    "time": "time [s]",
}
# Width and height of the figure of the missing force [inch].
# Source: resource: a panel for each channel on one page
RESIDUAL_SIZE = (8.5, 5.4)
MISSING = {"surge": "missing force X", "sway": "missing force Y", "yaw": "missing moment N"}


def signature(e: Evidence, name: str) -> Drawing:
    """The force missing without a finding, the force of the finding, and the rest: in time, and against the quantity that orders it."""
    figure = blank((9.5, 4.0))
    left, right = figure.subplots(1, 2, width_ratios=(1.5, 1))
    figure.subplots_adjust(left=0.09, right=0.99, bottom=0.13, top=0.92, wspace=0.15)
    first, end = e.window
    s = slice(first, end, max(1, (end - first) // 1500))
    unknown = e.effect == "unknown"
    rows = [("missing", COLOURS[3], e.after, e.means[1].mean)]
    if not unknown:
        taken_out = (
            "missing if it alone is taken out",
            COLOURS[3],
            e.after + e.own,
            e.means[1].mean + e.own_means.mean,
        )
        rows = [taken_out, ("missing with it", COLOURS[0], e.after, e.means[1].mean)]
    for label, colour, values, mean in rows:
        left.plot(e.time[s], values[s], color=colour, lw=1.0, label=label)
        m = e.means[1]
        right.errorbar(m.centre, mean, yerr=2 * m.error, fmt="o", ms=3.5, lw=1, color=colour, capsize=2)
    if not unknown:
        left.plot(e.time[s], e.own[s], color=COLOURS[5], lw=1.3, ls="--", label="force of the cause")
        right.plot(e.own_means.centre, e.own_means.mean, color=COLOURS[5], lw=1.3, ls="--")
    for axes in (left, right):
        axes.axhline(0.0, color="0.7", lw=0.8, zorder=0)
        axes.grid(True, alpha=0.3)
    left.set_xlabel("time [s]")
    left.set_ylabel(f"{MISSING[e.channel]} [{e.unit}]")
    right.set_xlabel(QUANTITY[e.quantity])
    figure.legend(fontsize=8, loc="upper left", bbox_to_anchor=(0.13, 1.0), ncols=3, frameon=False)
    before, after, _ = e.rms
    what = (
        f"Nothing in the catalogue explains it. Rms: {after:.3g} {e.unit}."
        if unknown
        else f"Rms: {after:.3g} {e.unit} with it; {before:.3g} {e.unit} without it where all other numbers are fitted anew."
    )
    return finish(
        name,
        "Residual without a named cause" if unknown else f"{e.effect} in {e.channel}",
        f"Force that the model lacks in TRAIN, low-passed at 0.35 Hz, all other numbers held. Left: the stretch that holds most of the cause. Right: means over the whole log in bins of equally many samples, with two standard errors, "
        f"along the quantity that orders it best. {what}",
        figure,
    )


def ratios(f: Finding, name: str = "ratios") -> Drawing:
    """Ratios of masses and drags between the two logs, and the factor that all of them share."""
    each, deviation = f.evidence["ratio"], f.evidence["ratio_deviation"]
    (bound,) = f.parameters.values()
    figure = blank((8.5, 1.2 + 0.42 * len(each)), layout="constrained")
    axes = figure.add_subplot()
    axes.axvspan(bound.lower, bound.upper, color=COLOURS[0], alpha=0.25, lw=0, label="the factor of all")
    for row, (id_, ratio) in enumerate(each.items()):
        axes.errorbar([ratio], [row], xerr=3 * ratio * deviation[id_], fmt="o", ms=4, color=COLOURS[3], capsize=3)
    axes.axvline(1.0, color="0.4", lw=0.8, ls="--", label="no change")
    axes.set_yticks(range(len(each)), list(each), fontsize=8)
    axes.set_ylim(len(each) - 0.5, -0.5)
    axes.set_xlabel("TEST over TRAIN")
    axes.grid(True, axis="x", alpha=0.3)
    figure.legend(fontsize=8, loc="outside upper left", ncols=2, frameon=False)
    return finish(
        name,
        f"{f.effect}: all masses and drags by one factor",
        "Each parameter of the extended model fitted to the other log, over that of this log, with three standard deviations; the band is the factor's "
        f"interval, {bound.lower:.4g} to {bound.upper:.4g}.",
        figure,
    )


def net_force(gain: Gain, name: str = "net_force") -> Drawing:
    """Mass times acceleration on the other log: measured, of the plain model, and of the extended model."""
    figure = blank((8.5, 5.8))
    s = stretch(gain)
    for k, (label, axes) in enumerate(
        zip(("X [N]", "Y [N]", "N [N m]"), figure.subplots(3, 1, sharex=True), strict=True)
    ):
        for word, colour, width, style, row in _LINES:
            axes.plot(gain.time[s], gain.net[row, k, s], lw=width, color=colour, ls=style, label=word)
        axes.set_ylabel(label)
        axes.grid(True, alpha=0.3)
    axes.set_xlabel("time [s]")
    handles = figure.axes[0].get_legend_handles_labels()
    figure.legend(*handles, fontsize=8, loc="upper left", bbox_to_anchor=(0.17, 1.0), ncols=3, frameon=False)
    return finish(
        name,
        f"Force on {gain.log}",
        "Mass times measured acceleration, and what each model says of it at the measured states, low-passed at 0.35 Hz; the minute in which the two models differ most.",
        fixed(figure),
    )


_LINES = (
    ("measured", COLOURS[5], 1.6, "-", 0),
    ("plain model", COLOURS[3], 1.0, "-", 1),
    ("extended model", COLOURS[0], 1.0, "--", 2),
)


def stretch(gain: Gain, seconds: float = 60.0) -> slice:
    """The stretch in which the models differ most, each channel scaled by its standard deviation."""
    n = gain.time.size
    step = (gain.time[-1] - gain.time[0]) / max(n - 1, 1)
    count = min(max(round(seconds / step), 2), n)
    size = np.maximum(gain.net[0].std(axis=1), 1e-12)[:, None]
    apart = np.cumsum(np.r_[0.0, (((gain.net[1] - gain.net[2]) / size) ** 2).sum(axis=0)])
    first = int(np.argmax(apart[count:] - apart[: n - count + 1]))
    return slice(first, first + count, max(1, count // 1500))


def force_residual(gain: Gain, name: str = "force_residual") -> Drawing:
    """Missing force on the other log, before and after, low-passed."""
    figure = blank(RESIDUAL_SIZE)
    draw_residual(figure, gain)
    text = "; ".join(f"{q} {b:.3g} before, {a:.3g} after" for q, (b, a) in gain.force_rms.items())
    return finish(
        name,
        f"Force residuals on {gain.log}",
        f"Low-passed at 0.35 Hz without a shift in time; a triangle marks what the axis cuts off. Rms: {text}.",
        fixed(figure),
    )


def draw_residual(figure: Figure, gain: Gain) -> None:
    """Draws the missing force into a figure, a panel for each channel."""
    s = thin(gain.residual.shape[2])
    for k, (label, axes) in enumerate(
        zip(("X [N]", "Y [N]", "N [N m]"), figure.subplots(3, 1, sharex=True), strict=True)
    ):
        for j, (word, colour) in enumerate((("before", COLOURS[3]), ("after", COLOURS[0]))):
            axes.plot(gain.time[s], gain.residual[j, k, s], lw=0.7, color=colour, label=word)
        _cut(axes, gain.time, gain.residual[:, k])
        axes.set_ylabel(f"missing {label}")
        axes.grid(True, alpha=0.3)
    axes.set_xlabel("time [s]")
    figure.axes[0].legend(fontsize=8, loc="lower left", bbox_to_anchor=(0.06, 1.0), ncols=2, frameon=False)


def _cut(axes: Axes, time: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
    """An axis that spikes do not set; a triangle stands where one leaves it."""
    ends = robust_range([rows])
    if ends is None:
        return
    axes.set_ylim(*ends)
    for row, colour in zip(rows, (COLOURS[3], COLOURS[0]), strict=True):
        for beyond, end, marker in ((row < ends[0], ends[0], "v"), (row > ends[1], ends[1], "^")):
            axes.plot(time[beyond], np.full(int(beyond.sum()), end), marker, ms=3, color=colour, ls="none")


def gain(gain: Gain, name: str = "gain") -> Drawing:
    """Velocities on the other log: measured, simulated by the plain model, and by the extended model."""
    figure = blank((8.5, 5.8))
    s = stretch(gain, 120.0)
    for k, (label, axes) in enumerate(
        zip(("u [m/s]", "v [m/s]", "r [rad/s]"), figure.subplots(3, 1, sharex=True), strict=True)
    ):
        for word, colour, width, style, row in _LINES:
            values = gain.measured[k] if row == 0 else _broken(gain, row - 1, k)
            axes.plot(gain.time[s], values[s], lw=width, color=colour, ls=style, label=word)
        axes.set_ylabel(label)
        axes.grid(True, alpha=0.3)
    axes.set_xlabel("time [s]")
    handles = figure.axes[0].get_legend_handles_labels()
    figure.legend(*handles, fontsize=8, loc="upper left", bbox_to_anchor=(0.17, 1.0), ncols=3, frameon=False)
    text = "; ".join(f"{q} {b:.3g} before, {a:.3g} after" for q, (b, a) in gain.simulation_rms.items())
    return finish(
        name,
        f"Simulated motion on {gain.log}",
        f"Each model restarts from the measured state every 10 s; the two minutes in which they differ most. Medians of the rms over the whole log: {text}.",
        fixed(figure),
    )


def _broken(gain: Gain, row: int, k: int) -> NDArray[np.float64]:
    """A simulated velocity with a gap where a window ends, so that no line is drawn across the restart."""
    values: NDArray[np.float64] = gain.motion[row, k].copy()
    n = gain.time.size
    count = max(round(10.0 * (n - 1) / (gain.time[-1] - gain.time[0])), 1)
    values[count - 1 :: count] = np.nan
    return values
