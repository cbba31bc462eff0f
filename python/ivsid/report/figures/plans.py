"""Figure of a plan: the track that its demands lead to, inside the fence, and the demands themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ivsid.report.figures.canvas import COLOURS, Drawing, blank, finish, thin

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ivsid.plans import Plan


def plan(result: Plan, name: str) -> Drawing:
    """Track on the left, demands on the right."""
    figure = blank((9.5, 4.2), layout="constrained")
    draw_plan(figure, result)
    fence = result.fence
    kept = f"{fence.inside} of {fence.members} simulated members stay inside." if np.isfinite(fence.radius) else ""
    text = f"The track is that of the fit's estimate, from the start at the origin. {kept}".strip()
    return finish(name, "The planned trial", text, figure)


def draw_plan(figure: Figure, result: Plan) -> None:
    """Draws track and demands into a figure."""
    left, right = figure.subplots(1, 2)
    sailed, s = result.sailed, thin(result.sailed.x.size)
    left.plot(sailed.y[s], sailed.x[s], color=COLOURS[0], lw=1.2)
    left.plot(0.0, 0.0, "o", color=COLOURS[5], ms=5)
    if np.isfinite(result.fence.radius):
        turn = np.linspace(0.0, 2 * np.pi, 200)
        left.plot(
            result.fence.radius * np.sin(turn), result.fence.radius * np.cos(turn), "--", color=COLOURS[3], lw=1.0
        )
    left.set_aspect("equal", "datalim")
    left.set_xlabel("east [m]")
    left.set_ylabel("north [m]")
    t = sailed.log.t - sailed.log.t[0]
    for k, thruster in enumerate(result.fit.vehicle.thrusters):
        demand = sailed.log.columns[f"demand_{thruster.name}"]
        right.step(t[s], demand[s], where="post", color=COLOURS[k % len(COLOURS)], lw=0.9, label=thruster.name)
    right.set_xlabel("time [s]")
    right.set_ylabel("demand")
    right.legend(fontsize=8)
    for axes in (left, right):
        axes.grid(True, alpha=0.3)
