"""The last Rust benchmarks beside a saved baseline: a table of medians, the largest changes first.

Run: make bench-save, change something, make bench-compare. A change counts where it exceeds the intervals of both medians.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import NamedTuple


class Median(NamedTuple):
    """Nanoseconds of a measurement: the estimate and its confidence interval (95 %, criterion's bootstrap)."""

    estimate: float
    lower: float
    upper: float


class Change(NamedTuple):
    """A benchmark before and after."""

    name: str
    before: Median
    after: Median

    @property
    def ratio(self) -> float:
        """Time after over time before."""
        return self.after.estimate / self.before.estimate

    @property
    def verdict(self) -> str:
        """``faster`` or ``slower`` where the two intervals do not meet, else empty."""
        if self.after.upper < self.before.lower:
            return "faster"
        return "slower" if self.after.lower > self.before.upper else ""


def median(folder: Path) -> Median:
    """The median of a measurement of criterion."""
    found = json.loads((folder / "estimates.json").read_text())["median"]
    interval = found["confidence_interval"]
    return Median(found["point_estimate"], interval["lower_bound"], interval["upper_bound"])


def changes(root: Path, baseline: str) -> list[Change]:
    """Every benchmark that has both measurements, the largest change first."""
    pairs = [(f.parent.parent, f.parent) for f in root.rglob(f"{baseline}/estimates.json")]
    found = [
        Change(str(place.relative_to(root)), median(before), median(place / "new"))
        for place, before in pairs
        if (place / "new" / "estimates.json").is_file()
    ]
    return sorted(found, key=lambda change: max(change.ratio, 1 / change.ratio), reverse=True)


def main(baseline: str, root: Path) -> None:
    """Prints the table."""
    found = changes(root, baseline)
    if not found:
        sys.exit(f"no benchmark in {root} has a baseline {baseline}: run make bench-save first")
    for change in found:
        times = f"{change.before.estimate:14.1f} ns {change.after.estimate:14.1f} ns"
        print(f"{change.name:50} {times} {change.ratio:7.3f} {change.verdict}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "before", Path(os.environ.get("CRITERION_HOME", "target/criterion")))
