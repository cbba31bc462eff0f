"""Holds what the diagnosis said against the truth, and counts."""

from __future__ import annotations

import math
from pathlib import Path

from tests.exam.catalogue import EFFECTS, JOINED
from tests.exam.criteria import hit, judged, passed, seen, spurious
from tests.exam.worth import worth


def inside(lower: float | None, x: float, upper: float | None) -> bool:
    """Whether a value lies in an interval; an end that is null is open."""
    return (lower is None or lower <= x) and (upper is None or x <= upper)


def grade(folder: Path, said: dict, truth: dict) -> dict:
    """One case."""
    truth = renamed(truth)
    row = {"seed": truth["seed"], "stratum": truth["stratum"], "truth": truth["truth"]}
    if "crash" in said:
        return row | said
    record = said["record"]
    findings = record["findings"]
    held = {}
    for f in findings:
        ways = [w for w in same(truth["truth"]) if set(f["parameters"]) & set(w)]
        scored = [
            {
                k: [inside(b["lower"], w[k], b["upper"]), w[k], b["lower"], b["upper"], bool(b["guaranteed"])]
                for k, b in f["parameters"].items()
                if k in w
            }
            for w in ways
        ]
        held |= max(scored, key=lambda s: sum(h[0] for h in s.values()), default={})
    z = truth["z"]
    known = z and all(i in EFFECTS for i in z) and truth["exact"] and "gain" in record
    sizes = truth["stratum"]["sizes"]
    return row | {
        "verdict": record["verdict"],
        "found": [f["effect"] for f in findings],
        "sets": [[f["effect"], *f["alternatives"]] for f in findings],
        "z": z,
        # What the product predicts for the same size: it need not agree, and is compared.
        "predicted": {i: said["visible"][i] * (s or 0) for i, s in sizes.items() if i in said.get("visible", {})},
        "held": held,
        "cpu": said.get("cpu", 0.0),
        "evidence": [f["evidence"] for f in findings],
        "sure": [
            [f.get("probability", 1.0), f.get("confidence", 1.0), f.get("like", {}).get("kind", "")] for f in findings
        ],
        "losses": record.get("gain", {}).get("losses", {}),
        "left": said.get("left", []),
        "adequacy": said.get("adequacy", []),
        "worth": worth(folder, record["gain"], truth) if known else {},
        "peers": said.get("peers", {}),
    }


def renamed(truth: dict) -> dict:
    """The answer by the names of today's catalogue: a cause that joined it after the case was drawn is a single effect."""
    stratum = truth["stratum"]
    joined = stratum["what"] == "outside" and set(truth["z"]) <= set(JOINED)
    stratum = stratum | {"what": "one" if joined else stratum["what"], "sizes": _named(stratum["sizes"])}
    return truth | {"truth": _named(truth["truth"]), "z": _named(truth["z"]), "stratum": stratum}


def _named(numbers: dict) -> dict:
    return {JOINED.get(k, k): q for k, q in numbers.items()}


def same(truth):
    """All ways to say the truth: a wave half a turn later in the opposite direction, or of the opposite current, is the same."""
    ways = []
    for half in range(-2, 5):
        for other in range(-2, 3) if "wave.force.direction" in truth else (half,):
            way = dict(truth)
            for id_ in ("wave.force", "current.oscillating"):
                if f"{id_}.phase" in way:
                    way[f"{id_}.phase"] += half * math.pi
            if "wave.force.direction" in way:
                way["wave.force.direction"] += other * math.pi
                if (half + other) % 2:
                    way["wave.force.amplitude"] *= -1
            if half % 2 and "current.oscillating.phase" in way:
                way["current.oscillating.north"] *= -1
                way["current.oscillating.east"] *= -1
            ways.append(way)
    return ways


def score(rows) -> str:
    """What is demanded beside what was reached, and every case that counts against it."""
    out = []
    done = [r for r in rows if "verdict" in r]
    if done:
        cpu = sorted(r["cpu"] for r in done)
        out.append(f"cases {len(done)} of {len(rows)}, cpu median {cpu[len(cpu) // 2]:.1f} s, largest {cpu[-1]:.0f} s")
    for j in judged(rows):
        bound = "at most" if j.criterion.most else "at least"
        out.append(
            f"{j.verdict:9s} {j.criterion.text}: {j.hits} of {j.cases}, {bound} {j.criterion.rate:g} "
            f"({j.low:.3f} to {j.high:.3f} by exact limits)"
        )
    out.append("the examination is " + ("passed" if passed(rows) else "failed"))
    visible = [id(r) for what in ("one", "two") for r in seen(rows, what)]
    for r in done:
        what = r["stratum"]["what"]
        lost = [k for k, h in r["held"].items() if not h[0]]
        bad = {
            "none": r["verdict"] != "adequate",
            "one": (id(r) in visible and not hit(r)) or spurious(r) > 0,
            "two": (id(r) in visible and not hit(r)) or spurious(r) > 0,
            "outside": r["found"] != ["unknown"]
            and not (r["verdict"] == "adequate" and max(r["z"].values(), default=0.0) < 8),
        }[what]
        if bad or lost:
            out.append("  " + line(r) + (f" outside their intervals: {lost}" if lost else ""))
    for r in [r for r in rows if "crash" in r][:3]:
        out.append(f"CRASH {r['seed']} {r['stratum']} {r['truth']}\n{r['crash'][-900:]}")
    out += [f"skipped {r['seed']}: {r['skipped']}" for r in rows if "skipped" in r]
    return "\n".join(out)


def line(r: dict) -> str:
    """A case in a line."""
    s = r["stratum"]
    words = " ".join(f"{i} z {z:.1f}" for i, z in r["z"].items()) or "nothing"
    where = f"{s['kind']} {s['style']} amb {s['ambient']} {s.get('family', '')} {s.get('share', 0):.2f}"
    return f"{r['seed']} {words} ({where}) -> {r['verdict']} {r['sets']}"
