"""The examination as the table of the documentation."""

from __future__ import annotations

import statistics

from tests.exam.criteria import hit, judged, of, seen, spurious
from tests.exam.reliability import lines


def table(rows, first: int, count: int) -> str:
    """Markdown: the acceptance table, the results of each stratum, and the peers on the same cases."""
    crashes = sum("crash" in r for r in rows)
    done = [r for r in rows if "verdict" in r]
    nulls, outside = of(done, "none"), of(done, "outside")
    singles, pairs = seen(done, "one"), seen(done, "two")
    alarms = [r for r in nulls if r["verdict"] != "adequate"]
    beyond = [r for r in outside if "unknown" in r["found"] or r["verdict"] == "adequate"]
    gains = sorted(x for r in (*singles, *pairs) if r["stratum"]["style"] != "line" for x in r["worth"].values())
    out = [
        "# The examination",
        "",
        f"`make exam SEED={first} EXAM={count}`: {len(done)} cases, {crashes} crashes, {len(rows) - len(done) - crashes} that could not be drawn. Every case is a folder with a random name; the "
        "examined process is not given the truth. Logs are written by the examiner's own simulator (tests/exam/simulator.py), with thrust errors of seven families at any share of their accuracy, and where nothing is hidden with four kinds of sea (tests/exam/seas.py) and with three kinds of sensors (tests/exam/sensor_errors.py). z is "
        "how far an effect stands out by the examiner's own reckoning (tests/exam/shown.py). A rate fails if the counts contradict it at 95 %, and is shown if they exclude its opposite (exact limits, "
        "tests/exam/criteria.py).",
        "",
        "| cases | required | reached | limits at 95 % | |",
        "|---|---|---|---|---|",
    ]
    for j in judged(rows):
        c = j.criterion
        reached = f"{j.hits / max(j.cases, 1):.2f} of {j.cases}" if c.events else share(j.hits, j.cases)
        wanted = f"{'at most' if c.most else 'at least'} {f'{c.rate:g}' if c.events else f'{100 * c.rate:g} %'}"
        limits = f"{j.low:.2f} to {j.high:.2f}" if c.events else f"{100 * j.low:.1f} to {100 * j.high:.1f} %"
        out.append(f"| {c.text} | {wanted} | {reached} | {limits} | {j.verdict} |")
    if gains:
        above = sum(x >= 0.9 for x in gains)
        out.append(
            f"| gain on TEST over the true model's (turning TRAIN, z >= 8) | median 0.95, 0.90 in 90 % | median {statistics.median(gains):.3f}, 0.90 in {share(above, len(gains))} | | |"
        )
    out.append(f"| processor time, median and largest | 3 s | {times(done)} | | |")
    out += ["", *lines(done), "", "![Share of right findings against the probability that was said](reliability.svg)"]
    out += ["", "| stratum | nulls not adequate | singles with z >= 8 named or in a set |", "|---|---|---|"]
    for key in ("kind", "style", "ambient", "rate", "duration", "family", "sea", "sensors"):
        for value in sorted({r["stratum"][key] for r in done}, key=str):
            a = [r for r in nulls if r["stratum"][key] == value]
            b = [r for r in singles if r["stratum"][key] == value]
            bad = sum(r["verdict"] != "adequate" for r in a)
            out.append(f"| {key} {value} | {bad} of {len(a)} | {sum(map(hit, b))} of {len(b)} |")
    effects = sorted({i for r in singles for i in r["z"]})
    out += ["", "| effect, z >= 8 | named or in a set |", "|---|---|"]
    for id_ in effects:
        own = [r for r in singles if id_ in r["z"]]
        out.append(f"| {id_} | {sum(map(hit, own))} of {len(own)} |")
    out += [
        "",
        "| the same cases | false alarms on nulls | truth first | among its names | other names a case | no name outside the catalogue |",
        "|---|---|---|---|---|---|",
    ]
    every = max(len(singles), 1)
    first_right = sum(r["found"][:1] == list(r["z"]) for r in singles)
    more = sum(map(spurious, singles)) / every
    out.append(
        f"| ivsid | {share(len(alarms), len(nulls))} | {share(first_right, len(singles))} | {share(sum(map(hit, singles)), len(singles))} | {more:.2f} | {share(len(beyond), len(outside))} |"
    )
    for name in done[0]["peers"] if done else ():
        others = sum(len(set(r["peers"][name]) - set(r["z"])) for r in singles) / every
        out.append(
            f"| {name} | {share(sum(bool(r['peers'][name]) for r in nulls), len(nulls))} | {share(sum(r['peers'][name][:1] == list(r['z']) for r in singles), len(singles))} "
            f"| {share(sum(set(r['z']) <= set(r['peers'][name]) for r in singles), len(singles))} | {others:.2f} | {share(sum(not r['peers'][name] for r in outside), len(outside))} |"
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
