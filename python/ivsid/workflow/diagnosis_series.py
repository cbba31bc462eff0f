"""Time series, curves and bars of a diagnosis: where each cause acts, and both models on the other log."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import Final

import numpy as np

from ivsid.diagnosis import Claim, Diagnosis, Evidence, Finding
from ivsid.intervals import shown
from ivsid.report import drawn, page, series
from ivsid.report.drawn import Bar, Bars, Dots
from ivsid.report.figures import MISSING, QUANTITY, stretch
from ivsid.report.page import Part
from ivsid.report.series import ALIKE, Line, Mark, Panel
from ivsid.workflow.diagnosis_screen import size

# Half-width of the tube of a measured velocity, in standard deviations of its white noise.
# Source: theorem: two-sided 99.9 % quantile of the standard normal distribution, 3.29
TUBE: Final = 3.3
# Samples of a finding that the page leads to, and the time between two of them [s].
# Source: definition: what a line of the page holds
SAMPLES: Final = 6
BETWEEN: Final = 5.0
# Time that is shown around a sample [s].
# Source: definition: the response of a small hull to a step
AROUND: Final = 10.0
NO_FORCE: Final = "It changes what the accelerometers read and pushes nothing, so that no figure of forces shows it."
VELOCITIES: Final = ("surge velocity u [m/s]", "sway velocity v [m/s]", "yaw rate r [rad/s]")
FORCES: Final = ("missing force X [N]", "missing force Y [N]", "missing moment N [N m]")
TRAIN, TEST = "train", "test"


def train_series(result: Diagnosis, seen: Sequence[Evidence]) -> Part:
    """The log in which causes are looked for: motion, demands, and the force of each cause."""
    log = result.selection.last.noise.predictor.log
    panels = [_measured(k, log.nu[k], log.noise.get("uvr"[k], 0.0)) for k in range(3)]
    demands = [
        Line(t.name, role, x) for t, role, x in zip(result.vehicle.thrusters, cycle(ALIKE), log.demands, strict=False)
    ]
    panels.append(Panel("demands, in units of the log", tuple(demands)))
    acting = [e for e in seen if e.acts]
    for e in acting:
        title = f"{MISSING[e.channel]} [{e.unit}], {e.effect}"
        if e.effect == "unknown":
            panels.append(
                Panel(title, (Line("missing with everything that was found", "before", e.after),), robust=True)
            )
            continue
        lines = (
            Line("missing if it alone is taken out", "before", e.after + e.own),
            Line("missing with it", "after", e.after),
            Line("force of the cause", "cause", e.own),
        )
        panels.append(Panel(title, lines, robust=True))
    marks = [Mark(f"Most of {e.effect}", *_window(e)) for e in acting]
    caption = "As measured, with 99.9 % of the stated white noise as a tube; below, the force that the model lacks without a cause and with it, and the cause's own, below 0.35 Hz."
    return series.series(TRAIN, f"The log {result.inputs[1][0]}", caption, log.t, panels, marks)


def test_series(result: Diagnosis) -> Part:
    """Both models on the other log: motion, and the force that they lack."""
    gain = result.gain
    both = result.verdict != "adequate"
    panels = []
    for k in range(3):
        lines = [
            _measured(k, gain.measured[k], float(gain.noise[k])).lines[0],
            Line("plain model", "before", gain.motion[0, k]),
        ]
        panels.append(Panel(VELOCITIES[k], tuple(lines + [Line("extended model", "after", gain.motion[1, k])] * both)))
    for k in range(3):
        lines = [Line("plain model", "before", gain.residual[0, k])] + [
            Line("extended model", "after", gain.residual[1, k])
        ] * both
        panels.append(Panel(FORCES[k], tuple(lines), robust=True))
    s = stretch(gain)
    marks = [Mark("Where the models differ most", float(gain.time[s][0]), float(gain.time[s][-1]))] if both else []
    caption = "Each model restarts from the measured state every 10 s; the tube holds 99.9 % of the stated white noise. Below, the force that each model lacks, below 0.35 Hz."
    return series.series(TEST, f"The other log, {gain.log}", caption, gain.time, panels, marks)


def finding_parts(f: Finding, e: Evidence | None) -> list[Part]:
    """Links to the samples that show a finding, its intervals as bars, and its force against what orders it."""
    parts: list[Part] = []
    if e is not None and not e.acts:
        parts.append(page.text(NO_FORCE))
    if e is not None and e.acts:
        parts.append(page.jump("Show it in the log:", [("where most of it is", TRAIN, *_window(e)), *_samples(e)]))
    numbers = [
        _bars(name, b.unit, [("the log", b.lower, b.upper, size(b), b.guaranteed)], [("no effect", 0.0)])
        for name, b in f.parameters.items()
        if "ratio" not in f.evidence and not b.stands_for
    ]
    if numbers:
        parts.append(drawn.bars("Intervals of its numbers.", numbers))
    if e is not None and e.acts:
        label = f"{MISSING[e.channel]} [{e.unit}]"
        after, own = e.means[1], e.own_means
        dots = [Dots("missing with it", "after", after.centre, after.mean, 2 * after.error)]
        if e.effect != "unknown":
            dots = [
                Dots(
                    "missing if it alone is taken out", "before", after.centre, after.mean + own.mean, 2 * after.error
                ),
                *dots,
                Dots("force of the cause", "cause", own.centre, own.mean),
            ]
        caption = "Means over the whole log in bins of equally many samples, with two standard errors, along the quantity that orders the cause best."
        parts.append(drawn.curve(f"{e.effect} in {e.channel}", caption, QUANTITY[e.quantity], label, dots))
    return parts


def claim_bars(claims: Sequence[Claim]) -> Part:
    """Claims of the vehicle file as points beside the log's own intervals."""
    numbers = []
    for c in claims:
        rows = [
            (label, b.lower, b.upper, size(b), b.guaranteed)
            for label, b in (("other claims held", c.beside), ("the log alone", c.alone))
            if b is not None
        ]
        if rows:
            numbers.append(_bars(c.parameter, c.unit, rows, [("claimed", c.value)]))
    return drawn.bars(
        "The claimed numbers beside the intervals of the log; an arrow marks what runs off the axis.", numbers
    )


def change_bars(result: Diagnosis) -> list[Part]:
    """Masses and drags of the other log over those of this one; nothing where the logs do not tell."""
    if result.change is None:
        return []
    numbers = []
    for id_, (ratio, deviation) in result.change.ratio.items():
        half = TUBE * ratio * deviation
        words = f"{shown(ratio - half, ratio + half, 3)[1:-1].replace(', ', ' to ')} (statistical)"
        numbers.append(
            _bars(id_, "ratio", [(f"{ratio:.3g}", ratio - half, ratio + half, words, False)], [("no change", 1.0)])
        )
    words = "The extended model fitted to each log: each number of the other log over that of this one, with the noise alone; errors of the thrust curves move all of them together."
    return [drawn.bars(words, numbers)]


def row_links(rows: Sequence[dict[str, object]]) -> Part:
    """Links to the rows that contradict each other."""
    links = []
    for r in rows:
        start, long = float(str(r["time"])), float(str(r["duration"]))
        links.append((f"{r['channel']} at {start:.5g} s", TRAIN, start - AROUND, start + long + AROUND))
    return page.jump("The rows that contradict each other:", links)


def _measured(k: int, values: np.ndarray, noise: float) -> Panel:
    return Panel(VELOCITIES[k], (Line("measured", "measured", values, TUBE * noise),))


def _window(e: Evidence) -> tuple[float, float]:
    return float(e.time[e.window[0]]), float(e.time[min(e.window[1], e.time.size) - 1])


def _samples(e: Evidence) -> list[tuple[str, str, float, float]]:
    """The samples with most of a cause's force, each apart from the others."""
    rest = np.abs(e.own)
    found = []
    for _ in range(SAMPLES):
        k = int(np.argmax(rest))
        t = float(e.time[k])
        found.append((f"{t:.5g} s: {e.own[k]:+.3g} {e.unit}", TRAIN, t - AROUND, t + AROUND))
        rest = np.where(np.abs(e.time - t) < BETWEEN, -1.0, rest)
        if rest.max() < 0:
            break
    return found


def _bars(
    name: str, unit: str, rows: Sequence[tuple[str, float, float, str, bool]], points: Sequence[tuple[str, float]]
) -> Bars:
    return Bars(f"{name} [{unit}]", tuple(Bar(*row) for row in rows), tuple(points))
