"""Parameter intervals of an identification in words and tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from ivsid.identification import Identification, Narrower, in_words
from ivsid.intervals import shown
from ivsid.report import drawn, page
from ivsid.report.drawn import Bar, Bars
from ivsid.report.page import Cells, Part

# Statuses of an identification in words.
MEANING = {
    "enclosed": "every parameter that is consistent with the log lies in these intervals",
    "empty": "no parameter is consistent with every row: the model, the thrust accuracy or a sensor bound is wrong",
    "unbounded": "the log leaves some direction open; the ends that are given hold",
    "not_proved": "numbers without a proof: they enclose nothing",
    "not_applicable": "the method's own conditions do not hold on these data",
}

# Directions that the terminal shows; a log that bounds no parameter leaves dozens.
# Source: resource: lines of a terminal
MOST_DIRECTIONS = 6


# Digits of the narrowest interval.
# Source: definition: those of the terminal, which shows six
MOST_DIGITS: Final = 6
# Share of its width by which rounding may widen an interval on a page.
# Source: definition: invisible in a figure
NARROW: Final = 0.05


def brief(lower: float, upper: float) -> str:
    """An interval in as few digits as do not widen it by more than a twentieth, four at the least, rounded outward; words without any end."""
    if lower == -math.inf and upper == math.inf:
        return "no bound"
    digits = 4
    while (
        digits < MOST_DIGITS and math.isfinite(upper - lower) and _lost(lower, upper, digits) > NARROW * (upper - lower)
    ):
        digits += 1
    return shown(lower, upper, digits)


def bounded(lower: float, upper: float, unit: str) -> str:
    """The interval of a parameter with its unit, or that it has no end."""
    words = brief(lower, upper)
    return f"{words} {unit}" if words.startswith("[") else words


def _lost(lower: float, upper: float, digits: int) -> float:
    """What rounding outward adds to the width of an interval."""
    low, high = (float(end) for end in shown(lower, upper, digits)[1:-1].split(", "))
    return high - low - (upper - lower)


def method_table(fits: Sequence[Identification]) -> Part:
    """One row for each method and parameter; a sentence for a single one without parameters."""
    if len(fits) == 1 and not fits[0].parameters:
        return page.text(f"Method {fits[0].method}, {fits[0].status}: no parameter has an interval.")
    rows: list[Cells] = []
    for fit in fits:
        ids = list(fit.parameters) or ["–"]
        for k, id_ in enumerate(ids):
            p = fit.parameters.get(id_)
            bounds = brief(p.lower, p.upper) if p else "–"
            width = p.width if p and math.isfinite(p.width) else None
            head = [fit.method, fit.status, fit.guaranteed] if k == 0 else ["", "", ""]
            rows.append([*head, id_, p.unit if p else "", bounds, width])
    return page.table(["method", "status", "guaranteed", "parameter", "unit", "interval", "width"], rows)


def status_line(fit: Identification) -> str:
    """Method and status of one of several identifications, for the terminal."""
    return f"method {fit.method}: {fit.status}, {'guaranteed' if fit.guaranteed else 'NOT guaranteed'}; {MEANING[fit.status]}"


def parameter_bars(fits: Sequence[Identification]) -> Part:
    """The intervals of each parameter, one bar a method, beside what the vehicle file claims."""
    claims = {c["parameter"]: float(c["value"]) for f in fits for c in f.claims}
    numbers = []
    for id_ in dict.fromkeys(i for f in fits for i in f.parameters):
        with_it = [(f, f.parameters[id_]) for f in fits if id_ in f.parameters]
        rows = tuple(Bar(f.method, p.lower, p.upper, brief(p.lower, p.upper), f.guaranteed) for f, p in with_it)
        points = (("claimed", claims[id_]),) if id_ in claims else ()
        numbers.append(Bars(f"{id_} [{with_it[0][1].unit}]", rows, points))
    return drawn.bars(
        "Green: guaranteed under the stated assumptions. Red: not guaranteed. An arrow marks what runs off the axis, which the narrow intervals set.",
        numbers,
    )


def parameter_lines(fit: Identification) -> list[str]:
    """Intervals of an identification, for the terminal."""
    lines = [f"  {id_:<24} {shown(p.lower, p.upper):>32} {p.unit}" for id_, p in fit.parameters.items()]
    if fit.status == "empty" and fit.estimate:
        numbers = ", ".join(f"{k} {v:.5g}" for k, v in fit.estimate.items())
        strange = any("the parameter of least inflation" in note for note in fit.notes)
        lines.append(f"  parameter of least inflation{' (of no vessel, see the note)' if strange else ''}: {numbers}")
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
    lines += [f"  {line}" for line in (*physical_lines(fit), *freedom_lines(fit), *claim_lines(fit), *_culprits(fit))]
    return lines


def freedom_lines(fit: Identification) -> list[str]:
    """The parameters and combinations that the data determine, if they leave some direction open."""
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


def physical_lines(fit: Identification) -> list[str]:
    """Bounds of every vessel that no parameter of the intervals keeps."""
    word = " (proved)" if fit.guaranteed else ""
    return [
        f"no vessel has these parameters: {f['says']}{word}; look at masses, thrust curves, units and signs of the vehicle file"
        for f in fit.physical
    ]


def narrower_lines(more: Narrower) -> list[str]:
    """What the same log would say with other options, where the sign of a parameter is open."""
    option = f"--rows both --window {','.join(f'{w:g}' for w in more.windows)}"
    lines = []
    if more.parameters:
        numbers = ", ".join(f"{k} {shown(p.lower, p.upper, 4)} {p.unit}" for k, p in more.parameters.items())
        lines.append(f"narrower by {option}, which adds rows of this log and no assumption: {numbers}")
    if more.beyond:
        lines.append(
            f"add --physical, which narrows {', '.join(more.beyond)}: ends of these intervals are of no vessel; the bounds that every vessel keeps then are "
            "an assumption"
        )
    if more.asked and not more.tried and not more.windows:
        lines.append(
            "the log is too long to try what narrows intervals of an open sign: --rows both, several windows as --window 0.5,2,10, and --physical"
        )
    return lines


def claim_lines(fit: Identification) -> list[str]:
    """Numbers of the vehicle file's model against the intervals of their parameters."""
    lines = []
    for claim in fit.claims:
        p = fit.parameters[claim["parameter"]]
        verdict = "is contradicted by" if claim["contradicted"] else "is consistent with"
        word = " (proved)" if claim["contradicted"] and fit.guaranteed else ""
        lines.append(f"the claimed {claim['parameter']} = {claim['value']!r} {verdict} {shown(p.lower, p.upper)}{word}")
    return lines


def _culprits(fit: Identification) -> list[str]:
    """The rows that contradict each other."""
    places = dict.fromkeys((r["channel"], r["time"], r["duration"]) for c in fit.falsifying for r in c["rows"])
    if not places:
        return []
    names = [f"{c} at {t:.6g} s" + (f" over {d:.4g} s" if d else "") for c, t, d in list(places)[:MOST_DIRECTIONS]]
    more = f" and {len(places) - MOST_DIRECTIONS} more (report.html)" if len(places) > MOST_DIRECTIONS else ""
    return [f"rows that contradict each other: {', '.join(names)}{more}"]
