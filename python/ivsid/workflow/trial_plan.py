"""``ivsid plan``: the demands of a next trial, as a scenario that ``ivsid simulate`` runs."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path

from ivsid import plans
from ivsid.files.records import envelope
from ivsid.identification import read_identification
from ivsid.plans import Plan
from ivsid.plans.narrowing import OPEN
from ivsid.programme.scenario import Scenario
from ivsid.report import figures, page
from ivsid.report.page import Card, First, Part, Report, Section
from ivsid.workflow.progress import Progress, silent

SCENARIO = "plan.toml"


def plan(
    fit: str | Path,
    *,
    seconds: float | None = None,
    separate: tuple[str, str] | None = None,
    fence: float | None = None,
    feedback: bool = False,
    window: float | Sequence[float] | None = None,
    rate: float = 20.0,
    seed: int | None = None,
    progress: Progress = silent,
) -> Report:
    """Reads a fit, plans a trial and reports; arguments as of ``ivsid.plan``.

    Raises:
        IvsidError: an unusable file, or a trial that cannot be planned, in one sentence.
    """
    progress("reading")
    known = read_identification(fit)
    number = 1 if seed is None else seed
    made = plans.plan(
        known,
        seconds=seconds,
        separate=separate,
        fence=math.inf if fence is None else fence,
        feedback=feedback,
        window=window,
        rate=rate,
        seed=number,
        progress=progress,
    )
    progress("drawing")
    summary, lines = summary_of(made), lines_of(made)
    drawing = figures.plan(made, "plan")
    sections = (
        Section("The trial", (page.drawing(drawing), _programme(made))),
        Section("Beside the library", (_library(made),)),
        Section("Assumptions", (page.bullets(_assumes(made)),)),
    )
    inputs = [
        (Path(known.vehicle.source or "vehicle.toml").name, known.vehicle.sha256),
        (known.log_name, known.log_sha256),
    ]
    record = {**envelope("plan", inputs, number), **made.record()}
    files = {
        SCENARIO: scenario_text(made.scenario, f"Planned for {known.vehicle.name} from the fit of {known.log_name}.")
    }
    title = f"A trial of {known.vehicle.name} that tells more"
    return Report(title, summary, record, sections, (drawing,), files, lines, _first(made))


def scenario_text(scenario: Scenario, comment: str) -> str:
    """A scenario as a file: what differs from the defaults of each key."""
    lines = [
        f"# {comment}",
        f"duration = {scenario.duration!r}",
        f"rate = {scenario.rate!r}",
        f"seed = {scenario.seed}",
        f"noise = {json.dumps(scenario.noise)}",
        "",
        "[truth]",
        *(f"{json.dumps(k)} = {v!r}" for k, v in scenario.truth.items()),
    ]
    for segment in scenario.segments:
        lines += ["", "[[segments]]"]
        for key, value in segment.model_dump(exclude_defaults=True).items():
            shown = list(value) if isinstance(value, tuple) else value
            lines.append(f"{key} = {json.dumps(shown)}")
    return "\n".join(lines) + "\n"


def summary_of(made: Plan) -> str:
    """What the trial is predicted to reach, in one or two sentences."""
    p = made.predicted
    if made.purpose == "separate":
        words = f"{made.scenario.duration:g} s are predicted to tell {made.causes[0]} and {made.causes[1]} apart by {p.median:.3g} standard deviations ({p.least:.3g} to {p.most:.3g})."
    else:
        before = "" if made.before is None else f" from {_share(made.before)}"
        words = f"{made.scenario.duration:g} s are predicted to bring the {made.quantity}{before} to {_share(p.median)} ({_share(p.least)} to {_share(p.most)})."
    beside = made.best_rival
    if beside is not None:
        words += f" The best of the library, {beside[0]}, gives {_worth(made, beside[1])}."
    return words


def _share(x: float) -> str:
    count = int(x // OPEN)
    percent = 100 * (x - count * OPEN)
    return f"{percent:{'.0f' if percent >= 1000 else '.3g'}} %" + (
        f" beside {count} open one{'s' * (count > 1)}" if count else ""
    )


def _worth(made: Plan, x: float) -> str:
    """What a manoeuvre reaches, in the words of the summary."""
    return _share(x) if made.purpose == "narrow" else f"{x:.3g}"


def lines_of(made: Plan) -> tuple[str, ...]:
    """The fence, and what follows, for the terminal."""
    f = made.fence
    lines = []
    if math.isfinite(f.radius):
        proof = (
            "proved for every consistent vehicle"
            if f.whole
            else f"proved for the first {f.proved_until:.3g} s; {f.reason}"
        )
        lines.append(
            f"  fence of {f.radius:g} m: {proof}; {f.inside} of {f.members} simulated members stay inside, the farthest {f.farthest:.3g} m"
        )
    lines += [f"  note: {n}" for n in made.notes]
    lines.append(f"  next: sail {SCENARIO}, or ivsid simulate VEHICLE {SCENARIO}")
    return tuple(lines)


def _programme(made: Plan) -> Part:
    rows, start = [], 0.0
    for s in made.scenario.segments:
        rows.append(
            [start, s.duration, s.period, _levels(s.demand), _levels(s.differential), s.sway, _levels(s.rudder)]
        )
        start += s.duration
    header = ["start [s]", "for [s]", "change every [s]", "demand", "differential", "sway", "rudder [rad]"]
    return page.table(header, rows, f"The programme, as it stands in {SCENARIO}.")


def _levels(x: float | tuple[float, ...]) -> str:
    return ", ".join(f"{q:.4g}" for q in x) if isinstance(x, tuple) else f"{x:.4g}"


def _library(made: Plan) -> Part:
    rows: list[list[object]] = [["planned", _worth(made, made.predicted.median), 1.0]]
    rows += [[name, _worth(made, value), made.gain(value)] for name, value in made.rivals.items() if value is not None]
    left = [name for name, value in made.rivals.items() if value is None]
    caption = "Each for the same time, on logs of the fit's estimate."
    if left:
        caption += f" {', '.join(left)}: beyond the fence, the stated limits of acceleration, or any believable turn."
    return page.table(["manoeuvre", made.quantity, "planned is better by"], rows, caption)


def _assumes(made: Plan) -> list[str]:
    said = [
        "values are predictions, by logs of the fit's estimate with drawn errors of sea, sensors and thrusters",
        "the stated limits of acceleration hold on the planned trial: the estimate uses "
        f"{100 * made.sailed.hardest:.0f} % of them",
    ]
    said += made.notes
    return [*said, f"fence: {made.fence.reason}"] if made.fence.reason else said


def _first(made: Plan) -> First:
    f, p = made.fence, made.predicted
    facts = [(made.quantity, f"{_worth(made, p.median)} ({_worth(made, p.least)} to {_worth(made, p.most)})")]
    if made.best_rival is not None:
        facts.append((f"best of the library: {made.best_rival[0]}", _worth(made, made.best_rival[1])))
    if math.isfinite(f.radius):
        facts.append((f"fence of {f.radius:g} m", "proved" if f.whole else f"proved for {f.proved_until:.3g} s"))
    beside = made.best_rival
    better = beside is None or made.gain(beside[1]) > 1
    verdict = "A trial that tells more" if better else "The library's best tells as much"
    following = (
        f"Sail {SCENARIO}, then identify its log and compare.",
        f"Try it first: ivsid simulate VEHICLE {SCENARIO}.",
    )
    return First(verdict, "good" if better else "open", "", (Card("Predicted", "", tuple(facts)),), following, ())
