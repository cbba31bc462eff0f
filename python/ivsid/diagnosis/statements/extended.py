"""Extended model as a vehicle file."""

from __future__ import annotations

from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import CATALOGUE, PAPER_TERMS, WITH_HEADING, own_ids
from ivsid.vehicle import Vehicle, parse_vehicle


def extended_text(vehicle: Vehicle, h: Hypothesis) -> str:
    """Text of a vehicle file with the model of a hypothesis; numbers that a file cannot state stand in comments.

    Args:
        vehicle: of the file that is extended.
        h: the hypothesis.
    """
    lines: list[str] = []
    given = {g.effect.id: g for g in h.given}
    keys = {k.name: k(g.values[0]) for g in given.values() if (k := g.effect.key) and g.thruster is None}
    inside = ""
    for line in vehicle.text.splitlines():
        head = line.strip()
        if head.startswith("["):
            inside = head.split("#")[0].replace(" ", "").strip()
        if inside == "[model]" or inside.startswith("[model."):
            continue
        if inside == "[[thrusters]]" and any(head.startswith(k) and "=" in head for k in keys):
            continue
        lines.append(line)
        if head.startswith("[") and inside == "[[thrusters]]":
            lines += [f"{k} = {v!r}" for k, v in keys.items()]
    ids, unstated = stated(h)
    shared = any(t in PAPER_TERMS[:2] for t in h.terms)
    lines.append("")
    lines.append("[model]  # as the diagnosis extended it")
    if shared and set(ids) <= {t.id for t in PAPER_TERMS}:
        lines.append('terms = "paper"')
    else:
        lines.append("terms = [" + ", ".join(f'"{i}"' for i in ids) + "]")
    # The extended model does not repeat a claim that the log contradicts.
    claimed = {k: v for k, v in vehicle.model.values.items() if k not in h.freed}
    if claimed:
        pairs = ", ".join(f'"{k}" = {v!r}' for k, v in claimed.items())
        lines.append(f"values = {{ {pairs} }}")
    for id_ in (i for i in ids if i in own_ids()):
        lines.append(f"# {id_} is an effect of your own: read this file with ivsid --own-effects FILE")
    lines += [f"# fitted: {t.id} = {float(h.values[t.id]):.6g} {t.unit}" for t in h.terms if t.id not in unstated]
    unstated |= {n: value for g in given.values() if g.effect.key is None for n, value in g.named.items()}
    if unstated:
        lines.append("# found, and not part of a vehicle file:")
        lines += [f"#   {name} = {value:.6g}" for name, value in unstated.items()]
    text = "\n".join(lines) + "\n"
    parse_vehicle(text, "model.toml")
    return text


def stated(h: Hypothesis) -> tuple[list[str], dict[str, float]]:
    """Ids by which ``model.terms`` states the terms of a hypothesis, in their order, and the numbers of terms that it cannot state."""
    several = {t.id: id_ for id_, terms in WITH_HEADING.items() for t in terms if set(terms) <= set(h.terms)}
    shared = set(PAPER_TERMS) & set(h.terms)
    ids = [several.get(t.id, t.id) for t in h.terms if t.id in several or t.id in CATALOGUE]
    rest = {
        t.id: float(h.values[t.id])
        for t in h.terms
        if t.id not in several and t.id not in CATALOGUE and t not in shared
    }
    return list(dict.fromkeys(ids)), rest
