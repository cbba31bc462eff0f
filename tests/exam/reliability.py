"""Whether probabilities that were said are kept: python -m tests.exam.reliability ROWS.json... prints the counts by kind of finding.

The product's table of counts (statements/probability.py) is made by this command from one examination, and held against the next.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from tests.exam.criteria import clopper_pearson

# Edges of the groups of said probabilities.
EDGES = (0.0, 0.5, 0.7, 0.85, 0.95, 0.98, 1.0)


@dataclass(frozen=True)
class Said:
    """A probability that was said, and whether it came true."""

    kind: str
    probability: float
    right: bool


def sets(rows: Sequence[dict]) -> Iterator[Said]:
    """Of each finding: that its set holds a hidden effect, or of an ``unknown``, that anything is hidden."""
    for r in rows:
        for s, (p, _, kind) in zip(r.get("sets", ()), r.get("sure", ()), strict=True):
            yield Said(kind, p, bool(r["truth"]) if s == ["unknown"] else bool(set(s) & set(r["z"])))


def firsts(rows: Sequence[dict]) -> Iterator[Said]:
    """Of each named finding: that its first name is hidden."""
    for r in rows:
        for s, (p, weight, kind) in zip(r.get("sets", ()), r.get("sure", ()), strict=True):
            if s[0] != "unknown":
                yield Said(kind, p * weight, s[0] in r["z"])


def curve(said: Sequence[Said]) -> list[tuple[int, float, float, float, float]]:
    """Of each group of probabilities that has findings: their number, what they said in the mean, what came true, and its exact limits."""
    out = []
    for low, high in pairwise(EDGES):
        group = [q for q in said if low < q.probability <= high]
        if group:
            k, n = sum(q.right for q in group), len(group)
            out.append((n, sum(q.probability for q in group) / n, k / n, *clopper_pearson(k, n)))
    return out


def lines(rows: Sequence[dict]) -> list[str]:
    """Both curves as a table of the documentation."""
    out = [
        "| said of | findings | probability said, mean | came true | limits at 95 % |",
        "|---|---|---|---|---|",
    ]
    for what, said in (("the set", list(sets(rows))), ("the first name", list(firsts(rows)))):
        out += [
            f"| {what} | {n} | {p:.3f} | {true:.3f} | {low:.3f} to {high:.3f} |"
            for n, p, true, low, high in curve(said)
        ]
    return out


def drawing(rows: Sequence[dict], path: Path) -> None:
    """The curves as a figure; the same rows give the same bytes."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.6, 4.2), layout="constrained")
    axes = figure.subplots()
    axes.plot([0, 1], [0, 1], color="0.7", linewidth=1)
    for what, marker, said in (("set", "o", list(sets(rows))), ("first name", "s", list(firsts(rows)))):
        made = curve(said)
        if made:
            _, p, true, low, high = zip(*made, strict=True)
            reach = [[t - b for t, b in zip(true, low, strict=True)], [a - t for t, a in zip(true, high, strict=True)]]
            axes.errorbar(p, true, reach, fmt=marker, capsize=3, label=what)
    axes.set(xlabel="probability that was said", ylabel="share that was right", xlim=(0, 1.02), ylim=(0, 1.02))
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower right")
    with rc_context({"svg.hashsalt": "reliability"}):
        figure.savefig(path, metadata={"Date": None})


def main() -> int:
    rows = [r for path in sys.argv[1:] for r in json.loads(Path(path).read_text()) if "verdict" in r]
    counts: dict[str, list[int]] = {}
    for q in sets(rows):
        n = counts.setdefault(q.kind, [0, 0])
        n[0] += q.right
        n[1] += 1
    for kind, (right, of) in sorted(counts.items()):
        sys.stdout.write(f"{kind}: {right} of {of}\n")
    sys.stdout.write("\n".join(lines(rows)) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
