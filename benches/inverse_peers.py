"""Inverses beside their alternatives, in one run: times as ratios, widths over the exact hull.

Run: python benches/inverse_peers.py; peers that are installed are measured (numpy always, numba, python-flint, codac).
"""

from __future__ import annotations

import os
import subprocess
import sys
import timeit
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ivsid import IntervalArray, linalg

try:
    from flint import arb, arb_mat
except ImportError:
    arb = arb_mat = None
try:
    import numba
except ImportError:
    numba = None


THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "RAYON_NUM_THREADS")


def best(run: Callable[[], Any], repeat: int = 7) -> float:
    """Least time of one call."""
    number = max(1, int(0.02 / max(timeit.timeit(run, number=1), 1e-9)))
    return min(timeit.repeat(run, number=number, repeat=repeat)) / number


def bounds(n: int, radius: float, k: int = 0) -> tuple[Any, Any]:
    """``n I + U(-1, 1)`` with relative radii (family dd)."""
    rng = np.random.default_rng(7)
    centre = rng.uniform(-1, 1, (k, n, n) if k else (n, n)) + n * np.eye(n)
    return centre - radius * np.abs(centre), centre + radius * np.abs(centre)


def dominant(n: int, radius: float, k: int = 0) -> IntervalArray:
    """The same as an array of intervals."""
    return IntervalArray(*bounds(n, radius, k))


def codac(n: int, radius: float) -> float | None:
    """Seconds of codac's enclosure, in a process of its own: it leaves the processor rounding upward. None without it."""
    program = f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); import inverse_peers; inverse_peers.run_codac({n}, {radius})"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    return float(done.stdout) if done.returncode == 0 else None


def run_codac(n: int, radius: float) -> None:
    """Prints the time."""
    import codac  # noqa: PLC0415 - the import itself changes the rounding mode

    lower, upper = bounds(n, radius)
    rows = [
        [codac.Interval(x, y) for x, y in zip(p, q, strict=True)]
        for p, q in zip(lower.tolist(), upper.tolist(), strict=True)
    ]
    print(best(partial(codac.inverse_enclosure, codac.IntervalMatrix(rows)), 1))


def numpy_sweep(a: IntervalArray, partitions: int) -> tuple[Any, Any]:
    """Eq. 11 with batched inverses, chunk by chunk."""
    step = (a.upper - a.lower) / 2 / partitions
    least, most = np.full(a.shape, np.inf), np.full(a.shape, -np.inf)
    for start in range(0, partitions, 8192):
        k = np.arange(start, min(start + 8192, partitions))[:, None, None]
        least = np.minimum(least, np.linalg.inv(a.lower + k * step).min(axis=0))
        most = np.maximum(most, np.linalg.inv(a.upper - k * step).max(axis=0))
    return least, most


def numba_sweep() -> Callable[..., Any] | None:
    """The closed form for n = 3, compiled; None without numba."""
    if numba is None:
        return None

    @numba.njit(fastmath=True)
    def run(start, step, partitions, sign, least):
        found = np.full(9, np.inf if least else -np.inf)
        for k in range(partitions):
            m = start + sign * k * step
            a, b, c, d, e, f, g, h, i = m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]
            p, q, r = e * i - f * h, f * g - d * i, d * h - e * g
            s = 1.0 / (a * p + b * q + c * r)
            x = (p * s, (c * h - b * i) * s, (b * f - c * e) * s, q * s, (a * i - c * g) * s, (c * d - a * f) * s)
            y = (r * s, (b * g - a * h) * s, (a * e - b * d) * s)
            for t in range(6):
                found[t] = min(found[t], x[t]) if least else max(found[t], x[t])
            for t in range(3):
                found[6 + t] = min(found[6 + t], y[t]) if least else max(found[6 + t], y[t])
        return found

    return run


def both_sets(compiled: Callable[..., Any], a: IntervalArray, step: Any, partitions: int) -> None:
    """Eq. 11 in the compiled closed form."""
    compiled(a.lower.ravel(), step, partitions, 1.0, True)
    compiled(a.upper.ravel(), step, partitions, -1.0, False)


def sweeps() -> None:
    """The sweep: inverses a second on one core."""
    compiled = numba_sweep()
    for n, partitions in ((3, 1_000_000), (6, 100_000), (12, 20_000), (50, 1000)):
        a = dominant(n, 0.01)
        ours = best(partial(linalg.inverse, a, "published", partitions))
        batched = best(partial(numpy_sweep, a, min(partitions, 100_000)), 3) * partitions / min(partitions, 100_000)
        line = f"sweep n={n:3} N={partitions:8}: {2 * partitions / ours * 1e-6:8.3f} M/s, {batched / ours:6.1f} x numpy batched"
        if compiled is not None and n == 3:
            step = ((a.upper - a.lower) / 2 / partitions).ravel()

            run = partial(both_sets, compiled, a, step, partitions)
            run()
            line += f", {best(run) / ours:.1f} x numba closed form"
        print(line)


def balls(lower: Any, upper: Any) -> Any:
    """The matrix for python-flint."""
    rows = [
        [arb(float((a + b) / 2), float((b - a) / 2 * (1 + 1e-15))) for a, b in zip(p, q, strict=True)]
        for p, q in zip(lower, upper, strict=True)
    ]
    return arb_mat(rows)


def invert_all(matrices: list[Any]) -> list[Any]:
    """One after the other."""
    return [m.inv() for m in matrices]


def hulls() -> None:
    """Exact hulls of a batch of order 3."""
    for radius in (0.001, 0.01):
        batch = dominant(3, radius, 10_000)
        ours = best(partial(linalg.inverse, batch)) / 10_000
        line = f"hull n=3, radius {radius}: {ours * 1e9:.0f} ns a matrix, all proved: {linalg.inverse(batch).guaranteed.all()}"
        if arb is not None:
            matrices = [balls(batch.lower[k], batch.upper[k]) for k in range(300)]
            peer = best(partial(invert_all, matrices)) / 300
            line += f"; python-flint inv {peer * 1e9:.0f} ns ({peer / ours:.1f} x)"
        print(line)
    for n in (8, 10):
        a = dominant(n, 0.1)
        print(f"hull n={n}: {best(partial(linalg.inverse, a), 3) * 1e3:.1f} ms, {linalg.inverse(a).status}")


def enclosures() -> None:
    """Enclosures at larger orders: time, and the width beside that of the exact hull if signs are fixed, else of its inner bound."""
    for n in (50, 100, 200):
        for radius in (1e-6, 0.01):
            a = dominant(n, radius)
            ours = best(partial(linalg.inverse, a, "hansen-bliek-rohn"), 3)
            value = linalg.inverse(a, "hansen-bliek-rohn").value
            # First order: the exact hull's width but for the square of the radii.
            p = np.linalg.inv(a.midpoint)
            first = 2 * np.abs(p) @ ((a.upper - a.lower) / 2) @ np.abs(p)
            line = f"enclosure n={n}, radius {radius:g}: {ours * 1e3:.2f} ms, width {np.max((value.upper - value.lower) / first):.3f} of first order"
            if arb is not None:
                matrix = balls(a.lower, a.upper)
                peer = best(matrix.inv, 1)
                line += f"; python-flint {peer / ours:.1f} x"
            spent = codac(n, radius) if n <= 100 else None
            if spent is not None:
                line += f"; codac {spent / ours:.1f} x"
            print(line)


if __name__ == "__main__":
    if any(os.environ.get(name) != "1" for name in THREADS):
        # One core for everybody; the libraries read this when they load.
        os.environ.update(dict.fromkeys(THREADS, "1"))
        os.execv(sys.executable, [sys.executable, *sys.argv])
    sweeps()
    hulls()
    enclosures()
