"""The feasible set beside other interval packages on the same rows: times, widths, and whether the truth is inside.

Peers are no dependencies: each runs in a process of its own (importing codac leaves the processor rounding upward) and is skipped with its
reason if it is missing, fails or takes longer than the limit. Times are the least of two runs within that process, its start left out.

Run: python benches/feasible_peers.py [--python PEERS_PYTHON] [--limit SECONDS]
PEERS_PYTHON is a Python that has intvalpy and codac; Octave with its interval package is found by its name.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

# The start of every peer is the box [-BOX, BOX].
BOX = 100.0
OCTAVE = """
pkg load interval
load("{path}");
A = infsup(lower, upper); b = infsup(low, high);
tic; x = gauss(A' * A, A' * b); first = toc; tic; x = gauss(A' * A, A' * b); spent = min(first, toc);
printf("{{\\"time\\": %.17g, \\"lower\\": [%.17g, %.17g, %.17g], \\"upper\\": [%.17g, %.17g, %.17g]}}\\n", spent, inf(x), sup(x));
"""


def least(work: Callable[[], Any], repeat: int = 2) -> tuple[float, Any]:
    """The least time of some runs, and the result."""
    times, result = [], None
    for _ in range(repeat):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return min(times), result


def codac_work(rows: dict[str, Any]) -> Callable[[], Any]:
    """CtcInverse of a x = b, contracted to its fixpoint."""
    import codac  # type: ignore[import-not-found]  # noqa: PLC0415 - the import itself changes the rounding mode

    def vector(low: Any, high: Any) -> list[Any]:
        return [codac.Interval(float(p), float(q)) for p, q in zip(low, high, strict=True)]

    x = codac.VectorVar(rows["lower"].shape[1])
    a = codac.IntervalMatrix([vector(p, q) for p, q in zip(rows["lower"], rows["upper"], strict=True)])
    right = codac.IntervalVector(vector(rows["low"], rows["high"]))
    contractor = codac.CtcFixpoint(codac.CtcInverse(codac.AnalyticFunction([x], a * x), right))

    def work() -> Any:
        box = codac.IntervalVector([codac.Interval(-BOX, BOX)] * rows["lower"].shape[1])
        contractor.contract(box)
        return [box[j].lb() for j in range(box.size())], [box[j].ub() for j in range(box.size())]

    return work


def intvalpy_work(method: str) -> Callable[[dict[str, Any]], Callable[[], Any]]:
    """A method of intvalpy for overdetermined systems."""

    def prepared(rows: dict[str, Any]) -> Callable[[], Any]:
        import intvalpy  # type: ignore[import-not-found]  # noqa: PLC0415 - a peer that may be missing

        matrix, right = intvalpy.Interval(rows["lower"], rows["upper"]), intvalpy.Interval(rows["low"], rows["high"])
        function = getattr(intvalpy, method)

        def work() -> Any:
            found = function(matrix, right)
            return [float(v.a) for v in found], [float(v.b) for v in found]

        return work

    return prepared


PEERS: dict[str, Callable[[dict[str, Any]], Callable[[], Any]]] = {
    "intvalpy, Rohn": intvalpy_work("Rohn"),
    "intvalpy, PSS": intvalpy_work("PSS"),
    "codac, CtcInverse to its fixpoint": codac_work,
}


def run_peer(name: str, path: str) -> None:
    """The body of a peer's process."""
    spent, (lower, upper) = least(PEERS[name](dict(np.load(path))))
    print(json.dumps({"time": spent, "lower": lower, "upper": upper}))


def reason(text: str) -> str:
    """The last line of an error, shortened."""
    lines = [line.strip() for line in text.splitlines() if line.strip() and "preparing to exit" not in line]
    return lines[-1][:100] if lines else "no word of why"


def outcome(command: list[str], limit: float) -> dict[str, Any] | str:
    """The result of a peer's process, or the reason for none."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        return f"not done within {limit:g} s"
    if done.returncode:
        return f"skipped: {reason(done.stderr)}"
    try:
        found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1].replace("Inf", "Infinity"))
    except (IndexError, ValueError):
        return f"skipped: {reason(done.stdout)}"
    return found


def octave(rows: dict[str, Any], folder: Path, limit: float) -> dict[str, Any] | str:
    """Octave's interval package, whose solvers take square systems (``mldivide`` of its version 3.2.1 fails on these): the normal equations of eq. 14."""
    program = shutil.which("octave-cli") or shutil.which("octave")
    if program is None:
        return "skipped: octave is not installed"
    from scipy.io import savemat  # noqa: PLC0415 - a peer's Python need not have it

    path = folder / "rows.mat"
    savemat(path, {**rows, "low": rows["low"][:, None], "high": rows["high"][:, None]})
    return outcome([program, "--quiet", "--norc", "--eval", OCTAVE.format(path=path)], limit)


def shown(name: str, found: dict[str, Any] | str, ours: float, truth: Any) -> str:
    """One line of the table."""
    if isinstance(found, str):
        return f"  {name:36} {found}"
    lower, upper = np.array(found["lower"], dtype=float), np.array(found["upper"], dtype=float)
    widths = ", ".join(f"{w:.4g}" for w in upper - lower)
    inside = bool(((lower <= truth) & (truth <= upper)).all())
    return f"  {name:36} {found['time'] * 1e3:10.4g} ms, {found['time'] / ours:8.3g} x, widths {widths}, truth inside: {inside}"


def main() -> None:
    """Prints the table."""
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--python", default=sys.executable)
    arguments.add_argument("--limit", type=float, default=60.0)
    chosen = arguments.parse_args()
    from feasible import TRUTH, bounds, highs, ours, surge  # noqa: PLC0415 - a peer's Python has no ivsid

    for m in (30, 300, 3000):
        lower, upper, low, high = rows = surge(m)
        named = {"lower": lower, "upper": upper, "low": low, "high": high}
        spent, found = least(lambda: ours(rows), 15)  # noqa: B023 - called at once
        ends = bounds(found)
        print(f"{m} rows x 3:")
        print(
            shown(
                "ivsid, all orthants, proved", {"time": spent, "lower": ends[:, 0], "upper": ends[:, 1]}, spent, TRUTH
            )
        )
        taken, ends = least(lambda: highs(rows))  # noqa: B023 - called at once
        print(
            shown(
                "SciPy HiGHS, six programs, not proved",
                {"time": taken, "lower": ends[:, 0], "upper": ends[:, 1]},
                spent,
                TRUTH,
            )
        )
        with tempfile.TemporaryDirectory() as place:
            path = Path(place) / "rows.npz"
            np.savez(path, lower=lower, upper=upper, low=low, high=high)
            for name in PEERS:
                command = [chosen.python, __file__, "--peer", name, str(path)]
                print(shown(name, outcome(command, chosen.limit), spent, TRUTH), flush=True)
            print(
                shown("Octave interval, gauss(A'A, A'b)", octave(named, Path(place), chosen.limit), spent, TRUTH),
                flush=True,
            )


if __name__ == "__main__":
    if "--peer" in sys.argv:
        run_peer(sys.argv[-2], sys.argv[-1])
    else:
        main()
