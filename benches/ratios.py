"""Ratios of the last `cargo bench --bench interval`, and of Python beside it.

Run: cargo bench --bench interval; python benches/ratios.py [target/criterion]
"""

from __future__ import annotations

import json
import sys
import timeit
from pathlib import Path

import numpy as np

from ivsid import Interval, IntervalArray

try:
    from flint import arb, arb_mat
except ImportError:
    arb = arb_mat = None


def seconds(folder: Path) -> float:
    """Median time of a measurement of criterion."""
    return float(json.loads((folder / "new" / "estimates.json").read_text())["median"]["point_estimate"]) * 1e-9


def best(statement: object, repeat: int = 15) -> float:
    """Least time of one run."""
    timer = timeit.Timer(statement)  # type: ignore[arg-type]
    number = max(1, int(0.02 / max(timer.timeit(1), 1e-9)))
    return min(timer.repeat(repeat, number)) / number


def criterion(root: Path) -> None:
    """Each back end beside the unrounded loop."""
    for group in sorted(root.glob("*-*")):
        rows = {p.name: seconds(p) for p in group.iterdir() if (p / "new").is_dir()}
        for backend in ("portable", "avx2", "avx512"):
            if backend in rows and f"plain-{backend}" in rows:
                ratio = rows[f"plain-{backend}"] / rows[backend]
                print(f"{group.name:14} {backend:9} {ratio:5.2f} of the unrounded loop with the same features")


def python(root: Path) -> None:
    """Python beside Rust and python-flint."""
    rng = np.random.default_rng(1)
    n = 1_000_000
    centre, radius = rng.uniform(-4, 4, (2, n)), rng.uniform(0, 0.5, (2, n))
    a, b = (IntervalArray(c - r, c + r) for c, r in zip(centre, radius, strict=True))
    rust = min((seconds(p) for p in root.glob("mul-memory/*") if p.name in ("avx2", "avx512", "portable")), default=0.0)
    spent = best(lambda: a * b)
    print(
        f"IntervalArray product of 1e6: {n / spent * 1e-6:.0f} M/s, {rust / spent:.2f} of the Rust figure on one core"
    )
    x, y = Interval(1.0, 2.0), Interval(0.1, 0.2)
    ours = best(lambda: x * y + x)
    matrix = IntervalArray(a.lower[:10_000].reshape(100, 100), a.upper[:10_000].reshape(100, 100))
    product = best(lambda: matrix @ matrix)
    print(f"scalar x * y + x: {ours * 1e9:.0f} ns; product of 100 by 100 matrices: {product * 1e3:.3f} ms")
    if arb is None:
        print("python-flint is not installed: no peer for these two")
        return
    p, q = arb(1.5, 0.5), arb(0.15, 0.05)
    peer = best(lambda: p * q + p)
    balls = arb_mat(
        [
            [arb(float(m), float(r)) for m, r in zip(*rows, strict=True)]
            for rows in zip(matrix.midpoint, matrix.radius, strict=True)
        ]
    )
    peer_product = best(lambda: balls * balls)
    print(
        f"python-flint: {peer * 1e9:.0f} ns ({peer / ours:.2f} x), {peer_product * 1e3:.2f} ms ({peer_product / product:.1f} x)"
    )


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "target/criterion")
    if not folder.is_dir():
        sys.exit(f"{folder} does not exist: run cargo bench --bench interval first")
    criterion(folder)
    python(folder)
