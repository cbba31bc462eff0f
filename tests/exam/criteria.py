"""Pass or fail: each demanded rate beside the counts, by exact binomial limits (Clopper and Pearson 1934).

A rate fails if the counts contradict it at 95 %, that is if the demanded rate lies beyond the one-sided limit. It is shown if the
other limit lies on its right side, too. Between the two there are too few cases: it passes and is said to be not shown.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from scipy.stats import beta, chi2

# Standard deviations from which an effect has to be named, and the largest set that counts as naming it.
VISIBLE = 8.0
LARGEST_SET = 5
SURE = 0.95
Rows = Sequence[dict]


@dataclass(frozen=True)
class Criterion:
    """A demanded rate.

    Attributes:
        text: what is counted.
        rate: demanded.
        most: whether the rate is the largest that is allowed; else the smallest.
        count: from the rows of all cases to hits and cases.
        events: whether a case may have several hits, so that their number is Poisson's (limits of Garwood 1936).
    """

    text: str
    rate: float
    most: bool
    count: Callable[[Rows], tuple[int, float]]
    events: bool = False

    def judge(self, rows: Rows) -> Judged:
        k, n = self.count(rows)
        low, high = poisson(k, n) if self.events else clopper_pearson(k, n)
        against, safe = (low > self.rate, high <= self.rate) if self.most else (high < self.rate, low >= self.rate)
        return Judged(self, k, n, low, high, "fails" if against else "shown" if safe else "not shown")


@dataclass(frozen=True)
class Judged:
    """A criterion with its counts, its limits, and ``fails``, ``shown`` or ``not shown``."""

    criterion: Criterion
    hits: int
    cases: float
    low: float
    high: float
    verdict: str

    @property
    def passes(self) -> bool:
        return self.verdict != "fails"


def clopper_pearson(k: int, n: int) -> tuple[float, float]:
    """One-sided limits of a rate after k of n, each at 95 %."""
    low = float(beta.ppf(1 - SURE, k, n - k + 1)) if k else 0.0
    return low, float(beta.ppf(SURE, k + 1, n - k)) if k < n else 1.0


def poisson(k: int, n: float) -> tuple[float, float]:
    """One-sided limits of a number a case after k in n cases, each at 95 %."""
    if not n:
        return 0.0, float("inf")
    return (float(chi2.ppf(1 - SURE, 2 * k)) / 2 / n if k else 0.0), float(chi2.ppf(SURE, 2 * k + 2)) / 2 / n


def of(rows: Rows, what: str) -> list[dict]:
    """Cases of one kind that were examined."""
    return [r for r in rows if "verdict" in r and r["stratum"]["what"] == what]


def seen(rows: Rows, what: str) -> list[dict]:
    """Those whose every effect is visible."""
    return [r for r in of(rows, what) if min(r["z"].values()) >= VISIBLE]


def hit(row: dict) -> bool:
    """Whether each hidden effect is named, or in a set that is small."""
    return all(any(i in s and len(s) <= LARGEST_SET for s in row["sets"]) for i in row["z"])


def wrong(row: dict) -> bool:
    """Whether a single name is given, and is not the truth."""
    return len(row["found"]) == 1 and row["found"] != ["unknown"] and not hit(row)


def spurious(row: dict) -> int:
    """Names that are none of the hidden ones."""
    return sum(not set(s) & {*row["z"], "unknown"} for s in row["sets"])


def names(row: dict) -> int:
    return sum(f != "unknown" for f in row["found"])


def mistaken(rows: Rows) -> tuple[int, float]:
    """Findings that are wrong, and how many of them their probabilities let expect."""
    said = [(s, p[0], r) for r in rows if "verdict" in r for s, p in zip(r["sets"], r["sure"], strict=True)]
    wrongs = sum(not (r["truth"] if s == ["unknown"] else set(s) & set(r["z"])) for s, _, r in said)
    return wrongs, round(sum(1.0 - p for _, p, _ in said), 1)


def counted(rows: Rows, condition: Callable[[dict], bool]) -> tuple[int, int]:
    return sum(map(condition, rows)), len(rows)


def held(rows: Rows, *, guaranteed: bool) -> tuple[int, int]:
    bounds = [h for r in rows if "verdict" in r for h in r["held"].values() if h[4] or not guaranteed]
    return sum(h[0] for h in bounds), len(bounds)


CRITERIA = (
    Criterion(
        "null logs with a verdict other than `adequate`",
        0.01,
        True,
        lambda rows: counted(of(rows, "none"), lambda r: r["verdict"] != "adequate"),
    ),
    Criterion(
        "single effects, z >= 8: named, or in a set of at most 5",
        0.97,
        False,
        lambda rows: counted(seen(rows, "one"), hit),
    ),
    Criterion(
        "a wrong single name, of single effects that are named",
        0.01,
        True,
        lambda rows: counted([r for r in of(rows, "one") if names(r)], wrong),
    ),
    Criterion(
        "outside the catalogue: `unknown`, or `adequate` below z = 8",
        0.95,
        False,
        lambda rows: counted(
            of(rows, "outside"),
            lambda r: "unknown" in r["found"] or (r["verdict"] == "adequate" and max(r["z"].values()) < VISIBLE),
        ),
    ),
    Criterion(
        "outside the catalogue: no name", 0.9, False, lambda rows: counted(of(rows, "outside"), lambda r: not names(r))
    ),
    Criterion("pairs, both z >= 8: both named", 0.9, False, lambda rows: counted(seen(rows, "two"), hit)),
    Criterion(
        "spurious names in pairs, a case",
        0.05,
        True,
        lambda rows: (sum(map(spurious, of(rows, "two"))), len(of(rows, "two"))),
        events=True,
    ),
    Criterion("intervals that hold", 0.99, False, lambda rows: held(rows, guaranteed=False)),
    Criterion("guaranteed intervals that hold", 1.0, False, lambda rows: held(rows, guaranteed=True)),
    Criterion(
        "findings that are wrong, over those that their probabilities let expect", 1.0, True, mistaken, events=True
    ),
    Criterion(
        "cases that end without a verdict",
        0.0,
        True,
        lambda rows: counted([r for r in rows if "skipped" not in r], lambda r: "verdict" not in r),
    ),
)


def judged(rows: Rows) -> list[Judged]:
    """Every criterion."""
    return [c.judge(rows) for c in CRITERIA]


def passed(rows: Rows) -> bool:
    """Whether no demanded rate is contradicted."""
    return all(j.passes for j in judged(rows))
