"""The feasible set beside its alternatives: HiGHS, a constraint generation in NumPy, intvalpy and codac if they are importable.

Times are the least of several runs in one process, ratios are of the same run. codac leaves the processor rounding upward when it is
imported, so it has a process of its own; a folder of peers may be given in PYTHONPATH.

Run: python benches/feasible.py [--large]     (--large adds 1e7 rows: 700 MB)
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from ivsid import IntervalArray, regression

Array = NDArray[np.float64]
Rows = tuple[Array, Array, Array, Array]
TRUTH = np.array([25.8, 0.7225, 1.3274])


def surge(m: int, seed: int = 1) -> Rows:
    """A surge model of three parameters, m u' + d1 u + d2 u|u| = X: velocities within 4 mm/s, accelerations 20 mm/s2, thrust 0.1 N."""
    rng = np.random.default_rng(seed)
    u, rate = rng.uniform(-1, 1, m), rng.uniform(-0.3, 0.3, m)
    force = TRUTH[0] * rate + TRUTH[1] * u + TRUTH[2] * u * np.abs(u) + 0.099 * rng.uniform(-1, 1, m)
    radius = (0.02, 0.004)
    rate += 0.99 * radius[0] * rng.uniform(-1, 1, m)
    u += 0.99 * radius[1] * rng.uniform(-1, 1, m)
    low, high = u - radius[1], u + radius[1]
    lower = np.stack([rate - radius[0], low, low * np.abs(low)], 1)
    upper = np.stack([rate + radius[0], high, high * np.abs(high)], 1)
    # A few rounding errors of slack keep the truth inside under any order of these operations.
    return lower - 1e-15, upper + 1e-15, force - 0.1, force + 0.1


def many(m: int, n: int, seed: int = 2) -> Rows:
    """Rows with n parameters of either sign."""
    rng = np.random.default_rng(seed)
    truth = rng.uniform(5, 50, n) * rng.choice([-1, 1], n)
    exact = rng.uniform(-1, 1, (m, n))
    value = exact @ truth + rng.uniform(-1, 1, m)
    exact += 0.01 * rng.uniform(-1, 1, (m, n))
    return exact - 0.01, exact + 0.01, value - 1, value + 1


def least(work: Callable[[], Any], repeat: int) -> tuple[float, Any]:
    """The least time of some runs, and the result."""
    times, result = [], None
    for _ in range(repeat):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return min(times), result


def highs(rows: Rows) -> Array:
    """Six programs of the positive orthant through SciPy: neither proved, nor the other seven orthants."""
    lower, upper, low, high = rows
    n = lower.shape[1]
    matrix, right = np.concatenate([lower, -upper]), np.concatenate([high, -low])
    ends = [
        sign * linprog(sign * np.eye(n)[j], A_ub=matrix, b_ub=right, bounds=(0, None), method="highs").fun
        for j in range(n)
        for sign in (1.0, -1.0)
    ]
    return np.reshape(ends, (n, 2))


def numpy_generation(rows: Rows) -> Array:
    """The same programs by constraint generation: HiGHS on few rows, whole arrays scanned by NumPy. Not proved."""
    lower, upper, low, high = rows
    m, n = lower.shape
    ends = np.empty((n, 2))
    working = np.unique(np.linspace(0, m - 1, 100).astype(int))
    for j in range(n):
        for k, sign in enumerate((1.0, -1.0)):
            for _ in range(200):
                matrix = np.concatenate([lower[working], -upper[working]])
                right = np.concatenate([high[working], -low[working]])
                found = linprog(sign * np.eye(n)[j], A_ub=matrix, b_ub=right, bounds=(0, None), method="highs")
                above, below = lower @ found.x - high, low - upper @ found.x
                worst = {int(above.argmax()), int(below.argmax())}
                if max(above.max(), below.max()) < 1e-9:
                    break
                working = np.union1d(working, list(worst))
            ends[j, k] = sign * found.fun
    return ends


def ours(rows: Rows, signs: list[int] | None = None) -> Any:
    """The proved set."""
    lower, upper, low, high = rows
    return regression.feasible_set(IntervalArray(lower, upper), IntervalArray(low, high), signs=signs)


def widths(ends: Array) -> str:
    """Widths of the parameters."""
    return ", ".join(f"{w:.4g}" for w in ends[:, 1] - ends[:, 0])


def bounds(found: Any) -> Array:
    """Ends, shape (n, 2)."""
    return np.stack([found.value.lower, found.value.upper], 1)


def peer(name: str, m: int) -> str:
    """A peer's time and widths, from a process of its own."""
    found = subprocess.run(
        [sys.executable, __file__, "--peer", name, str(m)], capture_output=True, text=True, check=False
    )
    return found.stdout.strip() if found.returncode == 0 else "not installed, or it failed"


def run_peer(name: str, m: int) -> None:
    """The body of that process."""
    rows = surge(m)
    lower, upper, low, high = rows
    if name == "codac":
        import codac  # type: ignore[import-not-found]  # noqa: PLC0415 - the import itself changes the rounding mode

        def intervals(lows: Array, highs: Array) -> list[Any]:
            return [codac.Interval(float(p), float(q)) for p, q in zip(lows, highs, strict=True)]

        x = codac.VectorVar(3)
        a = codac.IntervalMatrix([intervals(p, q) for p, q in zip(lower, upper, strict=True)])
        inverse = codac.CtcInverse(codac.AnalyticFunction([x], a * x), codac.IntervalVector(intervals(low, high)))
        contractor = codac.CtcFixpoint(inverse)

        def work() -> Array:
            box = codac.IntervalVector([codac.Interval(-100, 100)] * 3)
            contractor.contract(box)
            return np.array([[box[j].lb(), box[j].ub()] for j in range(3)])

    else:
        import intvalpy  # type: ignore[import-not-found]  # noqa: PLC0415 - a peer that may be missing

        matrix, right = intvalpy.Interval(lower, upper), intvalpy.Interval(low, high)

        def work() -> Array:
            found = intvalpy.linear.Rohn(matrix, right)
            return np.array([[float(v.a), float(v.b)] for v in found])

    spent, ends = least(work, 2)
    print(f"{spent * 1e3:.3g} ms, widths {widths(ends)}")


def compare(m: int) -> None:
    """HiGHS, NumPy and the proved set on the same rows."""
    rows = surge(m)
    spent, found = least(lambda: ours(rows), 15 if m < 1e6 else 4)
    signed, _ = least(lambda: ours(rows, [1, 1, 1]), 15 if m < 1e6 else 4)
    held = found.status == "enclosed" and bool(found.value.contains(TRUTH).all())
    print(f"\n{m} x 3: all orthants {spent * 1e3:.3g} ms, signs stated {signed * 1e3:.3g} ms, truth inside: {held}")
    print(f"  widths {widths(bounds(found))}, inflation {found.inflation:.4f}")
    if m <= 30_000:
        peer_time, ends = least(lambda: highs(rows), 3 if m < 30_000 else 1)
        off = np.abs(ends - bounds(found)).max() / np.abs(ends).max()
        print(
            f"  six HiGHS programs {peer_time * 1e3:.4g} ms: {peer_time / spent:.0f} x as long; ends differ by {off:.1e}"
        )
    if m >= 30_000:
        peer_time, ends = least(lambda: numpy_generation(rows), 1)
        print(
            f"  NumPy constraint generation {peer_time * 1e3:.4g} ms: {peer_time / spent:.0f} x as long, widths {widths(ends)}"
        )
    if m <= 3000:
        print(f"  codac, CtcInverse to its fixpoint: {peer('codac', m)}")
        print(f"  intvalpy, Rohn: {peer('intvalpy', m)}")


def peak() -> float:
    """The largest resident size so far [bytes]."""
    line = next(x for x in Path("/proc/self/status").read_text().splitlines() if x.startswith("VmHWM"))
    return float(line.split()[1]) * 1024


def main() -> None:
    """Prints every comparison."""
    for m in (300, 3000, 30_000, 1_000_000):
        compare(m)
    for m, n in ((12_000, 9), (1_000_000, 12)):
        rows = many(m, n)
        spent, found = least(lambda r=rows: ours(r), 2)  # type: ignore[misc]
        print(f"\n{m} x {n}: {spent:.3g} s, {found.status}, orthants looked at {len(found.certificate)} of {2**n}")
    if "--large" in sys.argv:
        rows = surge(10_000_000)
        data = sum(a.nbytes for a in rows)
        Path("/proc/self/clear_refs").write_text("5")  # the peak starts anew (Linux)
        before = peak()
        spent, found = least(lambda: ours(rows), 2)
        grown = peak() - before
        print(
            f"\n1e7 x 3: {spent:.3g} s, {found.status}; memory beside {data / 1e6:.0f} MB of data at most {grown / 1e6:.0f} MB"
        )


if __name__ == "__main__":
    if "--peer" in sys.argv:
        run_peer(sys.argv[-2], int(sys.argv[-1]))
    else:
        main()
