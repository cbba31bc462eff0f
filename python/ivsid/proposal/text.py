"""The proposed vehicle file as commented TOML."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from typing import Final

from ivsid.proposal.blanks import Answers, Demand
from ivsid.proposal.found import si_unit
from ivsid.proposal.noise import SIGMAS
from ivsid.proposal.propose import Proposal
from ivsid.proposal.thrusters import ANGLES, word
from ivsid.sensors.noise import DEFAULT_CONFIDENCE
from ivsid.vehicle.reading import TODO

MARK: Final = f'"{TODO}"'
# Column in which comments begin.
# Source: definition
WIDTH: Final = 48

# Absolute part of the guessed accuracy of a thrust curve, as a share of the bollard pull.
# Source: definition: a guess that the proposed file calls one
LOOSE: Final = 0.02
# Terms of the proposed model, by row of the file.
TERMS: Final = (
    ("mass.surge", "mass.sway", "inertia.yaw", "added_mass.munk"),
    ("drag.surge.linear", "drag.surge.quadratic", "drag.sway.linear", "drag.sway.quadratic"),
    ("drag.yaw.linear", "drag.yaw.quadratic"),
)


def vehicle_file(proposal: Proposal, answers: Answers, name: str) -> str:
    """The text of the file; keys that nobody could answer hold the mark ``TODO``, which every command refuses.

    Args:
        proposal: what the logs say.
        answers: what the user says.
        name: of the vehicle.
    """
    lines = [*_head(proposal, answers), f"name = {_quoted(name)}", "", *_hull(answers)]
    for demand in proposal.demands:
        lines += ["", *_thruster(demand, answers, proposal)]
    lines += ["", *_sensors(proposal), "", *_model(), "", *_log(proposal)]
    return "\n".join(lines) + "\n"


def _head(proposal: Proposal, answers: Answers) -> Iterator[str]:
    log = proposal.logs[0]
    yield f"# Proposed by `ivsid init` from {', '.join(x.name for x in proposal.logs)}: {log.t.size} rows, {log.t[-1] - log.t[0]:.4g} s, names: {proposal.columns.program.name}."
    yield '# Every number with "a guess" beside it is one: replace it by what you know.'
    if blanks := proposal.blanks(answers):
        yield f"# To fill in ({TODO}): {', '.join(blanks)}."
    if proposal.questions:
        yield "# Questions that the log leaves open:"
        yield from (f"#  - {q}" for q in proposal.questions)
    if proposal.assumed:
        yield "# Assumed where the logs show no bound:"
        yield from (f"#  - {a}" for a in proposal.assumed)


def _hull(answers: Answers) -> Iterator[str]:
    yield "[hull]"
    yield _line("mass", MARK if answers.mass is None else _number(answers.mass), "kg, with all that is on board")
    yield "# length = 2.0                                  # m; likewise beam, draught; centre_of_gravity = [x, y] from the body origin"


def _thruster(demand: Demand, answers: Answers, proposal: Proposal) -> Iterator[str]:
    yield "[[thrusters]]"
    yield _line(
        "name",
        _quoted(demand.name),
        f"demand {demand.column}, {_number(demand.lowest)} to {_number(demand.highest)} in the logs",
    )
    place = answers.positions.get(demand.name)
    side = next((s for s in ("port", "starboard") if word(demand.name, s)), None)
    hint = {"port": ", y is negative to port", "starboard": ", y is positive to starboard", None: ""}[side]
    yield _line(
        "position",
        MARK if place is None else f"[{_number(place[0])}, {_number(place[1])}]",
        f"[x forward, y to starboard] m from the body origin{hint}",
    )
    if f"azimuth_{demand.name}" in proposal.angles:
        yield _line("steering", _quoted("azimuth"), f"its direction is the column azimuth_{demand.name} of the log")
    else:
        yield _line("azimuth", "0.0", "rad, direction of the thrust; 1.571 pushes to starboard")
    if f"rudder_{demand.name}" in proposal.angles:
        yield _line(
            "rudder",
            MARK,
            "{ area = m^2, aspect_ratio = span^2 / area, position = m ahead of the origin, propeller_diameter = m, where it stands in the slipstream }",
        )
    thrust = answers.thrusts.get(demand.name)
    if thrust is None:
        yield _line(
            "quadratic",
            MARK,
            f"{{ forward = k }}: T = k n|n| [N], k = T / {_number(demand.span)}^2 with the bollard pull T at {_number(demand.neutral + demand.span)};",
        )
        yield f"{'':<{WIDTH}}# or in its place table = {{ demand = [...], thrust = [...] }}: `ivsid thrust` makes it from a bollard-pull table"
    else:
        yield _line(
            "quadratic",
            f"{{ forward = {_number(thrust / demand.span**2)} }}",
            f"{_number(thrust)} N at {_number(demand.neutral + demand.span)}; add reverse if it pulls less astern",
        )
    yield _line("neutral", _number(demand.neutral), demand.reason)
    ends = f"[{_number(-demand.end)}, {_number(demand.end)}]"
    reason = (
        "ends of its unit" if demand.neutral or demand.end == 1.0 else "a guess: half more than the largest of the logs"
    )
    yield _line("demand_range", ends, f"{reason}; a log beyond it is refused; leave it out beside a table")
    absolute = "" if thrust is None else f"absolute = {_number(LOOSE * thrust)}, "
    yield _line("accuracy", f"{{ {absolute}relative = 0.2 }}", "a guess: the bound on the error of that curve")


def _sensors(proposal: Proposal) -> Iterator[str]:
    yield "[sensors]"
    # Bounds that are guesses hold with no stated probability: under ``sigmas`` no command calls a result guaranteed.
    yield _line(
        "sigmas", _number(SIGMAS), "under sigmas nothing is called guaranteed, as long as this file holds guesses;"
    )
    yield f"{'':<{WIDTH}}# once you know all bounds, thrust accuracy too, write in its place: confidence = {DEFAULT_CONFIDENCE:g}"
    for section, numbers in proposal.sensors.items():
        yield f"[sensors.{section}]"
        for n in numbers:
            yield _line(n.key, _number(n.value), n.reason)
        if section == "acceleration" and proposal.gravity:
            yield _line("gravity", "true", "the readings hold gravity, which roll and pitch take out")


def _model() -> Iterator[str]:
    """The terms of a usual hull, without those that need its length."""
    yield "[model]"
    yield "# Of a usual hull, both drags of surge, sway and yaw, and the moment of the added masses. With hull.length in this file,"
    yield '# "drag.cross_flow" may stand in place of "drag.sway.quadratic" and "drag.yaw.quadratic". Leave out terms that your vessel has not.'
    yield "terms = ["
    yield from (f"    {', '.join(map(_quoted, row))}," for row in TERMS)
    yield "]"


def _log(proposal: Proposal) -> Iterator[str]:
    mapped, log = proposal.mapped, proposal.logs[0]
    yield "[log]"
    yield _line(
        "frame",
        _quoted(mapped.frame),
        "frd: forward, starboard, down, north and east; flu: forward, port, up, east and north",
    )
    if mapped.time:
        yield _line(
            "time",
            _table(mapped.time),
            f"{log.t.size} rows in {log.t[-1] - log.t[0]:.6g} s: {1 / log.period:.4g} Hz as a rule",
        )
    if mapped.rates:
        yield _line(
            "rates",
            _table(mapped.rates),
            "unit per second, a guess: half more than the fastest change seen; each channel has its own clock",
        )
    yield "[log.columns]"
    for name, f in proposal.channels.items():
        quality = log.quality.get(name)
        seen = (
            ""
            if quality is None
            else f"{_number(quality.lower)} to {_number(quality.upper)} {f.unread or si_unit(name)}, {quality.rate:.4g} Hz"
        )
        others = f"; also {', '.join(f.others[:3])}" if f.others else ""
        open_ = f"scale: how many {si_unit(name)} is one {f.unread}; " if f.unread else ""
        yield _line(name, _value(_given(proposal, name)), f"{open_}{seen}{others}")
    for name in mapped.columns:
        if name not in proposal.channels:
            yield _line(
                name,
                _value(_given(proposal, name)),
                "" if name.startswith(("demand_", *ANGLES)) else "one of several columns of this name",
            )
    notes = [n for n in log.notes if not n.endswith("as its header says") and "that their headers say" not in n]
    yield from (f"# note: {n}" for n in notes)
    if proposal.columns.unknown:
        most = 12
        more = len(proposal.columns.unknown) - most
        yield f"# Columns that are not used: {', '.join(proposal.columns.unknown[:most])}{f' and {more} more' if more > 0 else ''}"


def _given(proposal: Proposal, name: str) -> str | Mapping[str, object]:
    """The keys of a column; a scale that nobody knows is marked."""
    given = proposal.mapped.columns.get(name, name)
    return {**given, "scale": TODO} if name in proposal.unread and not isinstance(given, str) else given


def _line(key: str, value: str, comment: str) -> str:
    given = f"{key} = {value}"
    return f"{given:<{WIDTH - 1}} # {comment}" if comment else given


def _value(given: str | Mapping[str, object]) -> str:
    return _quoted(given) if isinstance(given, str) else _table(given)


def _table(given: Mapping[str, object]) -> str:
    inside = ", ".join(f"{k} = {_table(v) if isinstance(v, Mapping) else _scalar(v)}" for k, v in given.items())
    return f"{{ {inside} }}"


def _scalar(value: object) -> str:
    return repr(float(value)) if isinstance(value, (int, float)) else _quoted(str(value))


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _number(value: float) -> str:
    """Four digits, with a point: a TOML float."""
    shown = f"{value:.4g}"
    return shown if any(c in shown for c in ".en") or not math.isfinite(value) else f"{shown}.0"
