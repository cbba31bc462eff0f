"""The examination as the table of the documentation."""

from __future__ import annotations

import statistics

from tests.exam.grade import hit


def table(rows, first: int, count: int) -> str:
    """Markdown: the acceptance table, the results of each stratum, and the peers on the same cases."""
    crashes = sum("crash" in r for r in rows)
    done = [r for r in rows if "verdict" in r]
    of = {w: [r for r in done if r["stratum"]["what"] == w] for w in ("none", "one", "two", "outside")}
    seen = [r for r in of["one"] if max(r["z"].values()) >= 8]
    pairs = [r for r in of["two"] if min(r["z"].values()) >= 8]
    nulls = of["none"]
    alarms = [r for r in nulls if r["verdict"] != "adequate"]
    named = [r for r in of["one"] if r["found"] and r["found"] != ["unknown"]]
    wrong = [r for r in named if not hit(r) and len(r["found"]) == 1]
    beyond = [r for r in of["outside"] if "unknown" in r["found"] or r["verdict"] == "adequate"]
    spurious = sum(not set(s) & {*r["z"], "unknown"} for r in of["two"] for s in r["sets"])
    more = sum(not set(s) & {*r["z"], "unknown"} for r in seen for s in r["sets"])
    held = [h for r in done for h in r["held"].values()]
    sure = [h for h in held if h[4]]
    gains = sorted(x for r in (*seen, *pairs) if r["stratum"]["style"] != "line" for x in r["worth"].values())
    out = [
        "# The examination",
        "",
        f"`make exam SEED={first} EXAM={count}`: {len(done)} cases, {crashes} crashes, {len(rows) - len(done) - crashes} that could not be drawn. Every case is a folder of files whose names say "
        "nothing; the examined process is not given the truth. z is the log's own prediction for the hidden size.",
        "",
        "| cases | required | reached |",
        "|---|---|---|",
        f"| nulls: verdict other than `adequate` | 1 % | {share(len(alarms), len(nulls))} |",
        f"| single effects with z >= 8: named, or in a set | 95 % | {share(sum(map(hit, seen)), len(seen))} |",
        f"| spurious names beside them, a case | | {more / max(len(seen), 1):.2f} |",
        f"| wrong single name, any size | 1 % of names | {share(len(wrong), len(named))} |",
        f"| outside the catalogue: `unknown` or `adequate` | 90 % | {share(len(beyond), len(of['outside']))} |",
        f"| pairs, both z >= 8: both | 80 % | {share(sum(map(hit, pairs)), len(pairs))} |",
        f"| spurious names in pairs, a case | 0.1 | {spurious / max(len(of['two']), 1):.2f} of {len(of['two'])} |",
        f"| intervals hold | 99 % | {share(sum(h[0] for h in held), len(held))} |",
        f"| guaranteed intervals hold | 100 % | {share(sum(h[0] for h in sure), len(sure))} |",
    ]
    if gains:
        above = sum(x >= 0.9 for x in gains)
        out.append(
            f"| gain on TEST over the true model's (turning TRAIN, z >= 8) | median 0.95, 0.90 in 90 % | median {statistics.median(gains):.3f}, 0.90 in {share(above, len(gains))} |"
        )
    out.append(f"| processor time, median and largest | 3 s | {times(done)} |")
    out += ["", "| stratum | nulls not adequate | singles with z >= 8 named or in a set |", "|---|---|---|"]
    for key in ("kind", "style", "ambient", "rate", "duration"):
        for value in sorted({r["stratum"][key] for r in done}, key=str):
            a = [r for r in nulls if r["stratum"][key] == value]
            b = [r for r in seen if r["stratum"][key] == value]
            bad = sum(r["verdict"] != "adequate" for r in a)
            out.append(f"| {key} {value} | {bad} of {len(a)} | {sum(map(hit, b))} of {len(b)} |")
    effects = sorted({i for r in seen for i in r["z"]})
    out += ["", "| effect, z >= 8 | named or in a set |", "|---|---|"]
    for id_ in effects:
        own = [r for r in seen if id_ in r["z"]]
        out.append(f"| {id_} | {sum(map(hit, own))} of {len(own)} |")
    out += [
        "",
        "| the same cases | false alarms on nulls | truth first | among its names | other names a case | no name outside the catalogue |",
        "|---|---|---|---|---|---|",
    ]
    mine = [(r["found"], {i for s in r["sets"] for i in s}) for r in seen]
    first_right = sum(f[:1] == list(r["z"]) for (f, _), r in zip(mine, seen, strict=True))
    out.append(
        f"| ivsid | {share(len(alarms), len(nulls))} | {share(first_right, len(seen))} | {share(sum(map(hit, seen)), len(seen))} | {more / max(len(seen), 1):.2f} | {share(len(beyond), len(of['outside']))} |"
    )
    for name in done[0]["peers"] if done else ():
        others = sum(len(set(r["peers"][name]) - set(r["z"])) for r in seen) / max(len(seen), 1)
        out.append(
            f"| {name} | {share(sum(bool(r['peers'][name]) for r in nulls), len(nulls))} | {share(sum(r['peers'][name][:1] == list(r['z']) for r in seen), len(seen))} "
            f"| {share(sum(set(r['z']) <= set(r['peers'][name]) for r in seen), len(seen))} | {others:.2f} | {share(sum(not r['peers'][name] for r in of['outside']), len(of['outside']))} |"
        )
    out += [
        "",
        "`sparse` is sequentially thresholded least squares, `stepwise` forward selection by the Bayesian information criterion, `bootstrap` forward selection by a block bootstrap (tests/exam/peers.py); they see the same "
        "logs and the catalogue's columns, but no sensor effects.",
    ]
    return "\n".join(out) + "\n"


def share(a: int, n: int) -> str:
    """``a of n (p %)``."""
    return f"{a} of {n}" + (f" ({100 * a / n:.1f} %)" if n else "")


def times(rows) -> str:
    """Of the diagnoses."""
    cpu = sorted(r["cpu"] for r in rows)
    return f"{cpu[len(cpu) // 2]:.1f} s, {cpu[-1]:.0f} s" if cpu else "none"
