"""Runs cases of the examination side by side and scores them: python -m tests.exam.run FIRST COUNT [key=value ...]."""

from __future__ import annotations

import json
import math
import os
import sys
import time
import traceback
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def one(job):
    seed, options = job
    from tests.exam.draw import case
    from tests.exam.peers import PEERS, regression
    from tests.exam.worth import worth

    from ivsid.diagnosis.diagnose import diagnose
    from ivsid.effects import EFFECTS
    from ivsid.log import Log

    try:
        c = case(seed, **options)
    except Exception as error:
        return {"seed": seed, "skipped": str(error)}
    train = Log("1.csv", "0" * 64, c.train.t, c.train.columns)
    test = Log("2.csv", "0" * 64, c.test.t, c.test.columns)
    start = time.process_time()
    try:
        d = diagnose(c.vehicle, train, test)
    except Exception:
        return {"seed": seed, "crash": traceback.format_exc(), "stratum": c.stratum, "truth": c.truth}
    spent = time.process_time() - start
    others = regression(c)
    known = all(i in EFFECTS for i, _ in c.stratum["sizes"])
    found = [f.effect for f in d.findings]
    sets = [[f.effect, *f.alternatives] for f in d.findings]
    z = {i: v.z for i, v in d.visible.items()}
    sizes = dict(c.stratum["sizes"])
    held = {}
    for f in d.findings:
        ways = [w for w in same(c.truth) if set(f.parameters) & set(w)]
        scored = [
            {k: [bool(b.lower <= w[k] <= b.upper), w[k], b.lower, b.upper] for k, b in f.parameters.items() if k in w}
            for w in ways
        ]
        held |= max(scored, key=lambda s: sum(h[0] for h in s.values()), default={})
    return {
        "seed": seed,
        "stratum": c.stratum,
        "truth": c.truth,
        "verdict": d.verdict,
        "found": found,
        "sets": sets,
        "z": {i: z.get(i, -1) * s for i, s in sizes.items()},
        "held": held,
        "cpu": spent,
        "evidence": [f.evidence for f in d.findings],
        "tested": {i: (i in z and z[i] >= 8) for i in sizes},
        "left": [(s.id, round(s.gain, 1)) for s in d.selection.leftover[:4]],
        "adequacy": [(a.gain, a.freedom, a.chance, a.chance_of_one, a.strongest[:2]) for a in d.adequacy],
        "gain": d.gain.simulation_rms,
        "worth": worth(c, d) if known else {},
        "peers": {name: peer(others) for name, peer in PEERS.items()},
    }


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
    hit = lambda r: all(any(i in s for s in r["sets"]) for i in r["z"])  # noqa: E731
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
    worths = sorted(min(r["worth"].values()) for r in (*visible, *(q for q in two if min(q["z"].values()) >= 8)))
    every = sorted(x for r in (*visible, *(q for q in two if min(q["z"].values()) >= 8)) for x in r["worth"].values())
    if every:
        out.append(
            f"gain over the true model's, z >= 8: median {every[len(every) // 2]:.3f}, tenth {every[len(every) // 10]:.3f} of {len(every)} channels; "
            f"worst channel: median {worths[len(worths) // 2]:.3f}, tenth {worths[len(worths) // 10]:.3f} of {len(worths)} cases"
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


def main():
    first, count = int(sys.argv[1]), int(sys.argv[2])
    options = {}
    path = None
    workers = 2
    for a in sys.argv[3:]:
        k, v = a.split("=", 1)
        if k == "out":
            path = v
        elif k == "workers":
            workers = int(v)
        else:
            options[k] = float(v) if k in ("size", "ambient", "duration") else v
    rows = []
    with ProcessPoolExecutor(workers) as pool:
        for row in pool.map(one, [(first + k, options) for k in range(count)]):
            rows.append(row)
            if path:
                # After each case: a run that is stopped leaves what it has.
                Path(path).write_text(json.dumps(rows, default=float))
    sys.stdout.write(score(rows) + "\n")


if __name__ == "__main__":
    main()
