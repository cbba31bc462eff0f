"""What changed between the logs of a vehicle, by dates: periods without a contradiction, and the least sets of logs that contradict each other.

Each statement is a proof that no parameter is consistent with all rows of a few logs. If the sensor bounds, the thrust accuracy and the
model structure hold in those logs, a parameter has changed between them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np

from ivsid.fleets.consistency import Ask, Decision, Model, Subset, decide
from ivsid.fleets.log_rows import LogRows, empty, joined
from ivsid.intervals import FloatArray

# Pairs of logs that are tried on all of their rows, beside those whose intervals are disjoint.
# Source: resource: about a minute on two processors
MOST_PAIRS: Final = 2000
# Pairs whose intervals are compared; those of the first periods come first.
# Source: resource: seconds, and memory of the pairs that are found
COMPARED: Final = 1_000_000
# Pairs that are tried at once.
# Source: resource: memory of their working sets
AT_ONCE: Final = 250


@dataclass(frozen=True)
class Change:
    """A least set of logs that contradict each other: without any one of them no contradiction is left that the search could find.

    Attributes:
        logs: numbers of the logs, by date.
        decision: the proof.
        irreducible: whether a consistent point was found without each of the logs.
        changed: parameters whose intervals of single logs are disjoint: each of them has changed, whatever else has.
        between: for each of these, the two logs with disjoint intervals.
        alone: parameters that could explain the contradiction alone; if a single parameter has changed, it is one of these.
        excluded: for each other parameter, the proof that the logs contradict each other even if it has a value of its own in each.
        undecided: parameters for which neither was found.
    """

    logs: tuple[int, ...]
    decision: Decision
    irreducible: bool
    changed: tuple[int, ...]
    between: dict[int, tuple[int, int]]
    alone: tuple[int, ...]
    excluded: dict[int, Decision]
    undecided: tuple[int, ...]


@dataclass(frozen=True)
class Drift:
    """Periods of a vehicle's logs, and what contradicts what.

    Attributes:
        periods: numbers of the logs of each period, by date; no contradiction was found within one. Fewer periods are impossible, as far as
            each was extended until a contradiction was proved.
        changes: one for each boundary between two periods.
        pairs: pairs of logs that contradict each other, with the parameters whose intervals are disjoint.
        tried: number of pairs that were tried on all of their rows.
        untried: number of pairs that were not, and whose intervals are not known to be disjoint.
    """

    periods: tuple[tuple[int, ...], ...]
    changes: tuple[Change, ...]
    pairs: dict[tuple[int, int], tuple[int, ...]]
    tried: int
    untried: int


@dataclass(frozen=True)
class Logs:
    """What is known of the logs before they are held against each other.

    Attributes:
        order: their numbers, by date.
        names: by number.
        lower: bounds of single logs, shape (logs, n); infinite where there is none.
        upper: the same from above.
        rows: the rows that prove the bounds of a log.
    """

    order: tuple[int, ...]
    names: tuple[str, ...]
    lower: FloatArray
    upper: FloatArray
    rows: Callable[[int], LogRows]

    def start(self, logs: Sequence[int]) -> LogRows:
        """The rows that prove the tightest end of each parameter that one of the logs has."""
        chosen = sorted({int(k) for k in self.tightest(logs)})
        parts = [self.rows(k) for k in chosen]
        return joined(parts) if parts else empty(self.lower.shape[1])

    def tightest(self, logs: Sequence[int]) -> list[int]:
        """The log with the tightest end, for each end that a log bounds."""
        given = np.array(logs)
        ends = (
            (self.lower[given], np.argmax(self.lower[given], axis=0)),
            (-self.upper[given], np.argmin(self.upper[given], axis=0)),
        )
        return [int(given[k]) for values, best in ends for j, k in enumerate(best) if np.isfinite(values[k, j])]

    def subset(self, logs: Sequence[int], free: int | None = None) -> Subset:
        """Logs that are to hold together."""
        if free is not None:
            return Subset(tuple(logs), joined([self.rows(k) for k in logs]), free)
        return Subset(tuple(logs), self.start(logs))


def drift(logs: Logs, model: Model, ask: Ask, progress: Callable[[str], None], most: int = MOST_PAIRS) -> Drift:
    """What changed between the logs.

    Args:
        logs: with their order; each is consistent in itself.
        model: parameters and their blocks.
        ask: tries points on the rows of the logs.
        progress: told of each step.
        most: pairs that are tried on all of their rows.
    """

    def judge(sets: Sequence[Sequence[int]]) -> list[Decision]:
        return decide([logs.subset(s) for s in sets], model, logs.names, ask)

    periods, broken = [], []
    rest = list(logs.order)
    while rest:
        progress(f"periods: {len(logs.order) - len(rest)} of {len(logs.order)} logs")
        size, proof = _longest(rest, judge)
        periods.append(tuple(rest[:size]))
        if proof is not None:
            broken.append(proof)
        rest = rest[size:]
    changes = []
    for k, proof in enumerate(broken):
        progress(f"least sets of logs {k} of {len(broken)}")
        changes.append(_change(proof, logs, model, ask, judge))
    pairs, tried, untried = _pairs(periods, logs, judge, progress, most)
    return Drift(tuple(periods), tuple(changes), pairs, tried, untried)


def _longest(
    rest: Sequence[int], judge: Callable[[Sequence[Sequence[int]]], list[Decision]]
) -> tuple[int, Decision | None]:
    """The number of first logs that hold together, and the proof that one more contradicts them."""
    (whole,) = judge([rest])
    if whole.consistent is not False:
        return len(rest), None
    low, high, proof = 1, len(rest), whole
    while high - low > 1:
        middle = (low + high) // 2
        (found,) = judge([rest[:middle]])
        if found.consistent is False:
            high, proof = middle, found
        else:
            low = middle
    return low, proof


def _change(
    proof: Decision, logs: Logs, model: Model, ask: Ask, judge: Callable[[Sequence[Sequence[int]]], list[Decision]]
) -> Change:
    """The least set of logs behind a contradiction, and the parameters that may have changed."""
    place = {k: i for i, k in enumerate(logs.order)}
    kept = sorted(proof.solved.logs, key=place.__getitem__)
    irreducible = False
    while not irreducible:
        tries = judge([[x for x in kept if x != k] for k in kept]) if len(kept) > 1 else []
        smaller = next((d for d in tries if d.consistent is False), None)
        if smaller is None:
            irreducible = all(d.consistent for d in tries)
            break
        proof = smaller
        kept = sorted(smaller.solved.logs, key=place.__getitem__)
    between = {}
    for j in range(len(model.terms)):
        lower, upper = logs.lower[kept, j], logs.upper[kept, j]
        a, b = int(np.argmax(lower)), int(np.argmin(upper))
        if lower[a] > upper[b]:
            between[j] = tuple(sorted((kept[a], kept[b]), key=place.__getitem__))
    single = decide([logs.subset(kept, free=j) for j in range(len(model.terms))], model, logs.names, ask)
    return Change(
        tuple(kept),
        proof,
        irreducible,
        tuple(between),
        between,  # type: ignore[arg-type]
        tuple(j for j, d in enumerate(single) if d.consistent),
        {j: d for j, d in enumerate(single) if d.consistent is False},
        tuple(j for j, d in enumerate(single) if d.consistent is None),
    )


def _pairs(
    periods: Sequence[Sequence[int]],
    logs: Logs,
    judge: Callable[[Sequence[Sequence[int]]], list[Decision]],
    progress: Callable[[str], None],
    most: int,
) -> tuple[dict[tuple[int, int], tuple[int, ...]], int, int]:
    """The pairs that contradict each other; two logs of one period do not."""
    found: dict[tuple[int, int], tuple[int, ...]] = {}
    open_: list[tuple[int, int]] = []
    compared = whole = 0
    for first, second in combinations(periods, 2):
        later = np.array(second)
        whole += len(first) * later.size
        for a in first:
            if compared >= COMPARED:
                break
            compared += later.size
            apart = (logs.lower[a] > logs.upper[later]) | (logs.lower[later] > logs.upper[a])
            for b, each in zip(later.tolist(), apart, strict=True):
                if each.any():
                    found[a, b] = tuple(np.flatnonzero(each).tolist())
                else:
                    open_.append((a, b))
    tried = open_[:most]
    for k in range(0, len(tried), AT_ONCE):
        progress(f"pairs of logs {k} of {len(tried)}")
        for d in judge(tried[k : k + AT_ONCE]):
            if d.consistent is False:
                a, b = d.subset.logs
                found[a, b] = ()
    return dict(sorted(found.items())), len(tried), len(open_) - len(tried) + whole - compared
