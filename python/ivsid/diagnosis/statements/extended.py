"""Extended model as a vehicle file: every number in a key that ``simulate``, ``diagnose``, ``identify`` and ``validate`` read."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping

from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import CATALOGUE, PAPER_TERMS, WITH_HEADING, Given, own_ids
from ivsid.errors import IvsidError
from ivsid.vehicle import Vehicle, parse_vehicle

Ends = tuple[float, float]


def extended_text(vehicle: Vehicle, h: Hypothesis, ends: Mapping[str, Ends] | None = None) -> str:
    """Text of a vehicle file with the model of a hypothesis.

    A cause that a key of a thruster states stands there, every other number under ``[model.fitted]``.

    Args:
        vehicle: of the file that is extended.
        h: the hypothesis.
        ends: of the intervals, by parameter.
    """
    body = _without_model(vehicle.text)
    numbers = {t.id: float(h.values[t.id]) for t in h.terms}
    in_keys: list[str] = []
    # A number for one thruster replaces that for all.
    for g in sorted(h.given, key=lambda g: g.thruster or ""):
        keyed = _with_key(body, g)
        if keyed is None:
            numbers |= {n: float(v) for n, v in g.named.items()}
        else:
            body = keyed
            in_keys += g.named
    ids, _ = stated(h)
    lines = ["", "[model]  # as the diagnosis extended it"]
    if _is_paper(h):
        lines.append('terms = "paper"')
    else:
        lines.append("terms = [" + ", ".join(f'"{i}"' for i in ids) + "]")
    # The extended model does not repeat a claim that the log contradicts.
    claimed = {k: v for k, v in vehicle.model.values.items() if k not in h.freed}
    if claimed:
        pairs = ", ".join(f'"{k}" = {v!r}' for k, v in claimed.items())
        lines.append(f"values = {{ {pairs} }}")
    own = {i for n in (*numbers, *in_keys) for i in own_ids() if n == i or n.startswith(f"{i}.")}
    lines += [f"# {i} is an effect of your own: read this file with ivsid --own-effects FILE" for i in sorted(own)]
    lines += ["[model.fitted]", *(_entry(n, v, (ends or {}).get(n)) for n, v in numbers.items())]
    lines += [_entry(n, None, ends[n]) for n in in_keys if ends and n in ends]
    text = body + "\n".join(lines) + "\n"
    parse_vehicle(text, "model.toml")
    return text


def stated(h: Hypothesis) -> tuple[list[str], dict[str, float]]:
    """Ids by which ``model.terms`` states the terms of a hypothesis, in their order, and the numbers of terms that it cannot state."""
    if _is_paper(h):
        ids = [t.id for t in PAPER_TERMS]
        return ids, {t.id: float(h.values[t.id]) for t in h.terms if t.id not in ids}
    several = {t.id: id_ for id_, terms in WITH_HEADING.items() for t in terms if set(terms) <= set(h.terms)}
    ids = [several.get(t.id, t.id) for t in h.terms if t.id in several or t.id in CATALOGUE]
    rest = {t.id: float(h.values[t.id]) for t in h.terms if t.id not in several and t.id not in CATALOGUE}
    return list(dict.fromkeys(ids)), rest


def _is_paper(h: Hypothesis) -> bool:
    """Whether surge and sway share a column, which only the paper's model does."""
    return any(t in PAPER_TERMS[:2] for t in h.terms)


def _without_model(text: str) -> str:
    """The text without its section [model]."""
    lines: list[str] = []
    inside = ""
    for line in text.splitlines():
        inside = _header(line) or inside
        if inside != "[model]" and not inside.startswith("[model."):
            lines.append(line)
    return "\n".join(lines).rstrip() + "\n"


def _header(line: str) -> str:
    """The header of a section that a line opens, without blanks, or nothing."""
    head = line.strip()
    return head.split("#")[0].replace(" ", "").strip() if head.startswith("[") else ""


def _with_key(text: str, g: Given) -> str | None:
    """The text with the key of each thruster that states an effect, or None where no key can state it."""
    key = g.effect.key
    if key is None:
        return None
    value = key(float(g.values[0]))
    old = re.compile(rf"""\s*["']?{key.name}["']?\s*=""")
    names = [t.get("name") for t in tomllib.loads(text).get("thrusters", [])]
    lines: list[str] = []
    inside, at = "", -1
    for line in text.splitlines():
        opened = _header(line)
        inside = opened or inside
        at += opened == "[[thrusters]]"
        meant = inside == "[[thrusters]]" and g.thruster in (None, names[at])
        if meant and old.match(line):
            continue
        lines.append(line)
        if meant and opened:
            lines.append(f"{key.name} = {value!r}")
    made = "\n".join(lines) + "\n"
    try:
        thrusters = parse_vehicle(made, "model.toml").thrusters
    except IvsidError:
        return None
    found = [getattr(t, key.name) for t in thrusters if g.thruster in (None, t.name)]
    return made if found and all(x == value for x in found) else None


def _entry(name: str, value: float | None, ends: Ends | None) -> str:
    """A line of ``[model.fitted]``; an end without a bound is left out, and so is an interval that does not hold the value."""
    parts = {} if value is None else {"value": value}
    if ends is not None and (value is None or ends[0] <= value <= ends[1]):
        parts |= {k: float(e) for k, e in zip(("lower", "upper"), ends, strict=True) if math.isfinite(e)}
    return f'"{name}" = {{ {", ".join(f"{k} = {v!r}" for k, v in parts.items())} }}'
