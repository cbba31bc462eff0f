"""A figure of the sweep's throughput against N, n and threads, from the last `cargo bench --bench inverse`.

Run: cargo bench --bench inverse -- sweep; python benches/throughput.py docs/throughput.png [target/criterion]
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot


def read(root: Path) -> dict[tuple[int, int], list[tuple[int, float]]]:
    """Inverses a second by (order, threads), against the number of partitions."""
    found: dict[tuple[int, int], list[tuple[int, float]]] = {}
    for folder in root.glob("sweep_n=*"):
        match = re.fullmatch(r"sweep_n=(\d+)_threads=(\d+)", folder.name)
        if match is None:
            continue
        for part in folder.iterdir():
            estimates = part / "new" / "estimates.json"
            if estimates.is_file():
                seconds = json.loads(estimates.read_text())["median"]["point_estimate"] * 1e-9
                key = (int(match[1]), int(match[2]))
                found.setdefault(key, []).append((int(part.name), 2 * int(part.name) / seconds))
    return {key: sorted(points) for key, points in sorted(found.items())}


def draw(series: dict[tuple[int, int], list[tuple[int, float]]], target: Path) -> None:
    """One line an order; dashed for one thread."""
    figure, axes = pyplot.subplots(figsize=(7.5, 4.8), layout="constrained")
    orders = sorted({n for n, _ in series})
    colours = dict(
        zip(orders, pyplot.get_cmap("viridis")([i / max(len(orders) - 1, 1) for i in range(len(orders))]), strict=True)
    )
    for (n, threads), points in series.items():
        label = f"n = {n}" if threads == 1 else None
        x, y = zip(*points, strict=True)
        axes.loglog(x, y, color=colours[n], linestyle="--" if threads == 1 else "-", marker=".", label=label)
    axes.set_xlabel("partitions N")
    axes.set_ylabel("inverses a second (dashed: one thread, solid: two)")
    axes.grid(visible=True, which="major", alpha=0.3)
    axes.legend(ncols=2, fontsize="small")
    figure.savefig(target, dpi=130)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: python benches/throughput.py FIGURE.png [target/criterion]")
    measured = read(Path(sys.argv[2] if len(sys.argv) > 2 else "target/criterion"))
    if not measured:
        sys.exit("no measurement was found: run cargo bench --bench inverse -- sweep first")
    draw(measured, Path(sys.argv[1]))
