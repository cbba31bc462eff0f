"""Holds what the diagnosis said against the truth, and counts."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from tests.exam.worth import worth

from ivsid.effects import EFFECTS


def grade(folder: Path, said: dict, truth: dict) -> dict:
    """One case."""
    row = {"seed": int(folder.name), "stratum": truth["stratum"], "truth": truth["truth"]}
    if "crash" in said:
        return row | said
    record = said["record"]
    findings = record["findings"]
    sizes = dict(truth["stratum"]["sizes"])
    held = {}
    for f in findings:
        ways = [w for w in same(truth["truth"]) if set(f["parameters"]) & set(w)]
        scored = [
            {
                k: [bool(b["lower"] <= w[k] <= b["upper"]), w[k], b["lower"], b["upper"], bool(b["guaranteed"])]
                for k, b in f["parameters"].items()
                if k in w
            }
            for w in ways
        ]
        held |= max(scored, key=lambda s: sum(h[0] for h in s.values()), default={})
    z = {i: shown(said, i, s, truth["truth"]) for i, s in sizes.items()}
    known = sizes and all(i in EFFECTS for i in sizes)
    return row | {
        "verdict": record["verdict"],
        "found": [f["effect"] for f in findings],
        "sets": [[f["effect"], *f["alternatives"]] for f in findings],
        "z": z,
        "held": held,
        "cpu": said["cpu"],
        "evidence": [f["evidence"] for f in findings],
        "left": said["left"],
        "adequacy": said["adequacy"],
        "worth": worth(folder, record["gain"], truth) if known else {},
        "peers": said["peers"],
    }


def shown(said: dict, id_: str, size: float, truth: dict[str, float]) -> float:
    """The z that the log predicts for what was hidden; negative where it has none for such an effect."""
    if id_ in said["levels"]:
        values, z = zip(*said["levels"][id_], strict=True)
        return float(np.interp(truth[EFFECTS[id_].parts[0]], values, z))
    return said["visible"].get(id_, -1) * size


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


def hit(row):
    """Whether each hidden effect is named, or in a set."""
    return all(any(i in s for s in row["sets"]) for i in row["z"])


def score(rows):
    out = []
    crashes = [r for r in rows if "crash" in r]
    skipped = [r for r in rows if "skipped" in r]
    rows = [r for r in rows if "verdict" in r]
    none = [r for r in rows if r["stratum"]["what"] == "none"]
    bad = [r for r in none if r["verdict"] != "adequate"]
    out.append(
        f"cases {len(rows)}, crashes {len(crashes)}, skipped {len(skipped)}, cpu median {sorted(r['cpu'] for r in rows)[len(rows) // 2]:.1f} s"
        if rows
        else "no rows"
    )
    out.append(
        f"nulls {len(none)}: not adequate {len(bad)} {[(r['seed'], r['found'], r['stratum']['style'], r['stratum']['ambient']) for r in bad]}"
    )
    singles = [r for r in rows if r["stratum"]["what"] == "one"]
    visible = [r for r in singles if max(r["z"].values()) >= 8 or max(r["z"].values()) < 0]
    named = [r for r in visible if hit(r)]
    out.append(f"singles {len(singles)}, z >= 8: {len(visible)}, named or in set {len(named)}")
    for r in singles:
        i = next(iter(r["z"]))
        mark = (
            "ok "
            if hit(r)
            else ("-- " if r["verdict"] == "adequate" else ("?? " if "unknown" in r["found"] else "XX "))
        )
        extra = [f for f, s in zip(r["found"], r["sets"], strict=True) if i not in s]
        if (mark != "ok " and r in visible) or extra or any(not h[0] for h in r["held"].values()):
            out.append(
                f"  {mark}{r['seed']} {i} z {r['z'][i]:.1f} {r['stratum']['style']} {r['stratum']['kind']} amb {r['stratum']['ambient']} -> {r['sets']} ad {[round(r['adequacy'][1][k], 4) for k in (0, 1, 2, 3)]} of {r['adequacy'][0][0]:.0f} {[round(e.get('z', 0), 1) for e in r['evidence']]} held {[(k, h) for k, h in r['held'].items() if not h[0]]}"
            )
    held = [h for r in rows for h in r["held"].values()]
    out.append(f"intervals {len(held)}, hold {sum(h[0] for h in held)}")
    two = [r for r in rows if r["stratum"]["what"] == "two"]
    out.append(
        f"pairs {len(two)}: both {sum(hit(r) for r in two)}, extra {sum(len([f for f, s in zip(r['found'], r['sets'], strict=True) if not set(s) & set(r['z'])]) for r in two)}"
    )
    for r in two:
        if not hit(r):
            out.append(f"  {r['seed']} {r['z']} -> {r['sets']}")
    outside = [r for r in rows if r["stratum"]["what"] == "outside"]
    ok = [r for r in outside if "unknown" in r["found"] or r["verdict"] == "adequate"]
    out.append(
        f"outside {len(outside)}: unknown or adequate {len(ok)} {[(r['truth'], r['found']) for r in outside if r not in ok]}"
    )
    shown = (*visible, *(q for q in two if min(q["z"].values()) >= 8))
    for label, lines in (("turning", False), ("straight", True)):
        here = [r["worth"] for r in shown if (r["stratum"]["style"] == "line") == lines and r["worth"]]
        every = sorted(x for w in here for x in w.values())
        if every:
            out.append(
                f"gain over the true model's, z >= 8, {label} TRAIN: median {every[len(every) // 2]:.3f}, tenth {every[len(every) // 10]:.3f} "
                f"of {len(every)} channels in {len(here)} cases"
            )
    for name in rows[0]["peers"] if rows else ():
        alarms = sum(bool(r["peers"][name]) for r in none)
        first = sum(r["peers"][name][:1] == list(r["z"]) for r in visible)
        among = sum(set(r["z"]) <= set(r["peers"][name]) for r in visible)
        more = sum(len(set(r["peers"][name]) - set(r["z"])) for r in visible)
        out.append(
            f"{name}: alarms {alarms} of {len(none)} nulls; truth first {first}, among its names {among} of {len(visible)}, other names {more}; "
            f"outside: no name {sum(not r['peers'][name] for r in outside)} of {len(outside)}"
        )
    for r in crashes[:3]:
        out.append(f"CRASH {r['seed']} {r['stratum']} {r['truth']}\n{r['crash'][-900:]}")
    return "\n".join(out)
