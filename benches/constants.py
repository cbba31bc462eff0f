"""How much each number matters: ``python benches/constants.py OUT.md [NAME ...]`` (``make constants``).

Every constant whose source is this measurement is halved and doubled in turn, in a process of its own. For one of ivsid.diagnosis and ivsid.effects a fixed set
of short simulated logs is diagnosed again: two with nothing hidden, some with one cause each, one with a drag that is no cause of the
catalogue. A number that those do not read has a case of ``constants_rare.py``. For one of another chapter the tasks of
``constants_tasks.py`` run again. The table counts the verdicts that change, names the
cases, and gives the largest relative change of the ends of intervals. A number whose halving and doubling change nothing is one that the
results do not hang on; one that changes verdicts on one side stands as far from that side as the table says. A number that no case reads is
said to be so: it waits for a case. With names, only those constants are measured, and the others keep their lines.
"""

from __future__ import annotations

import ast
import importlib.machinery
import json
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "docs"), str(ROOT / "tests" / "python"), str(ROOT / "benches")]
CASES: dict[str, dict[str, float]] = {
    "nothing": {},
    "nothing, other seed": {},
    "surge drag": {"drag.surge.linear": 6.0},
    "delay": {"thruster.delay": 0.3},
    "current": {"current.steady.north": 0.08, "current.steady.east": 0.05},
    "dead band": {"thruster.deadband": 12.0},
    "gyro scale": {"sensor.yaw_rate.scale": 0.06},
    "waves": {
        "wave.force.amplitude": 3.0,
        "wave.force.period": 5.0,
        "wave.force.phase": 1.0,
        "wave.force.direction": 0.4,
    },
}
FACTORS = (0.5, 2.0)
# Files whose constants the diagnosed logs judge: effects declare the values that a diagnosis tries.
DIAGNOSIS = ("diagnosis/", "effects/")
UNREAD = "not read by the cases"
HEAD = """# Numbers, halved and doubled

`make constants` writes this page: each number is halved and doubled. For a number of the diagnosis {cases} short logs are diagnosed again
({names}).
A number that those do not read has a case of its own ({rare}).
For a number of another chapter {tasks} short tasks run again ({others}).
A cell counts the verdicts and names that change, names the cases, and gives the largest relative change of an end of an interval where none
does. A number that no case reads has no measurement here, and needs a case in `benches/constants_rare.py`.

| constant | value | halved | doubled |
|---|---|---|---|
"""


def scaled(value: Any, factor: float) -> Any:
    """A constant with all its numbers multiplied; whole numbers stay whole and at least 1."""
    if isinstance(value, tuple):
        return tuple(scaled(v, factor) for v in value)
    return max(1, round(value * factor)) if isinstance(value, int) else value * factor


def patch(file: str, name: str, factor: float) -> None:
    """Lets one module of the package bind one constant to a multiple, before anything else reads it."""
    original = importlib.machinery.SourceFileLoader.source_to_code

    def compiled(self: Any, data: Any, path: Any, **rest: Any) -> Any:
        if str(path).endswith(f"ivsid/{file}") and not isinstance(data, ast.AST):
            tree = ast.parse(data)
            for node in tree.body:
                target = (
                    node.target
                    if isinstance(node, ast.AnnAssign)
                    else node.targets[0]
                    if isinstance(node, ast.Assign)
                    else None
                )
                if isinstance(target, ast.Name) and target.id == name:
                    call = f"__import__('constants_scaling').scaled(0, {factor!r})"
                    replaced = ast.parse(call, mode="eval").body
                    assert isinstance(replaced, ast.Call)
                    replaced.args[0] = node.value  # type: ignore[union-attr, assignment]
                    node.value = replaced  # type: ignore[union-attr]
            data = ast.fix_missing_locations(tree)
        return original(self, data, path, **rest)

    importlib.machinery.SourceFileLoader.source_to_code = compiled  # type: ignore[method-assign, assignment]
    sys.modules["constants_scaling"] = sys.modules[__name__]


def outcomes(file: str, name: str) -> dict[str, Any]:
    """The cases that a constant is judged by."""
    from constants_rare import rare, served  # noqa: PLC0415 - after the patch
    from constants_tasks import worked  # noqa: PLC0415 - likewise

    if file == "rare" or f"{file} {name}" in served():
        return rare(f"{file} {name}")
    return diagnosed() if file.startswith(DIAGNOSIS) else worked()


def diagnosed() -> dict[str, Any]:
    """Verdict, names and intervals of every case."""
    from diagnosis_logs import logs_of, vehicle_of  # noqa: PLC0415 - after the patch
    from ivsid import IvsidError, diagnose  # noqa: PLC0415 - likewise

    vehicle, found = vehicle_of(), {}
    for k, (case, effects) in enumerate(CASES.items()):
        train, test = logs_of(vehicle, effects, duration=150.0, seed=301 + 10 * k)
        try:
            result = diagnose(vehicle, train, test, null_logs=0)
        except IvsidError as refusal:
            found[case] = {"verdict": f"refused: {refusal}", "names": [], "ends": []}
            continue
        found[case] = {
            "verdict": result.verdict,
            "names": sorted(f.effect for f in result.findings),
            "ends": [x for f in result.findings for b in f.parameters.values() for x in (b.lower, b.upper)],
        }
    return found


def variant(file: str, name: str, factor: float) -> dict[str, Any]:
    """All cases in a process of its own with one constant changed."""
    with tempfile.TemporaryDirectory() as empty:
        alone = {
            "OPENBLAS_NUM_THREADS": "1",
            "OMP_NUM_THREADS": "1",
            "PYTHONPYCACHEPREFIX": empty,
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        line = [sys.executable, __file__, "--child", file, name, repr(factor)]
        done = subprocess.run(line, capture_output=True, text=True, env={**os.environ, **alone}, check=False)
    if done.returncode:
        return {"failed": done.stderr.strip().splitlines()[-1][:80] if done.stderr else "stopped"}
    made: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return made


def difference(plain: dict[str, Any], other: dict[str, Any]) -> str:
    """A cell of the table."""
    if "failed" in other:
        return f"fails: {other['failed']}"
    changed, largest = [], 0.0
    plain = {case: plain[case] for case in other}
    for case, a in plain.items():
        b = other[case]
        if (a["verdict"], a["names"]) != (b["verdict"], b["names"]):
            changed.append(f"{case}: {', '.join(b['names']) or b['verdict']}")
        elif a["ends"]:
            pairs = zip(a["ends"], b["ends"], strict=False)
            largest = max([largest, *(abs(x - y) / max(abs(x), 1e-9) for x, y in pairs if None not in (x, y))])
    if changed:
        return f"{len(changed)} of {len(plain)} ({'; '.join(changed)})"
    return "0" if largest == 0 else f"0; ends move by {largest:.1g}"


def reached_by(kind: str) -> set[str]:
    """The constants, as ``file NAME``, that the cases of a kind read."""
    line = [sys.executable, __file__, "--reached", kind]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


def _kind(file: str, name: str) -> str:
    """A file without constants that is judged by the same cases."""
    from constants_rare import served  # noqa: PLC0415 - beside this file

    return "rare" if f"{file} {name}" in served() else "diagnosis/none" if file.startswith(DIAGNOSIS) else "none"


def head() -> str:
    """The words above the table."""
    from constants_rare import RARE  # noqa: PLC0415 - beside this file
    from constants_tasks import TASKS  # noqa: PLC0415 - likewise

    names, rare, others = ("; ".join(cases) for cases in (CASES, RARE, TASKS))
    return HEAD.format(cases=len(CASES), names=names, rare=rare, tasks=len(TASKS), others=others)


def main(out: Path, wanted: list[str]) -> None:
    """Measures and writes the page after each constant, so that a long run may be stopped."""
    from constants import constants  # noqa: PLC0415 - docs/constants.py, on the path above

    ours = [c for c in constants() if c.source == "none" or "make constants" in c.source]
    kept = out.read_text().splitlines() if out.exists() else []
    rows = {row.split("`")[1]: row for row in kept if row.startswith("| `")}
    todo = [c for c in ours if (c.name in wanted if wanted else f"{c.file} {c.name}" not in rows)]
    plain = {kind: variant(kind, "NONE", 1.0) for kind in {_kind(c.file, c.name) for c in todo}}
    for failed in (p["failed"] for p in plain.values() if "failed" in p):
        sys.exit(f"the cases do not run: {failed}")
    with ThreadPoolExecutor(int(os.environ.get("JOBS", "2"))) as pool:
        read = {kind: reached_by(kind) for kind in plain}
        work = [
            [
                pool.submit(variant, c.file, c.name, f)
                for f in FACTORS
                if f"{c.file} {c.name}" in read[_kind(c.file, c.name)]
            ]
            for c in todo
        ]
        for c, varied in zip(todo, work, strict=True):
            cells = [difference(plain[_kind(c.file, c.name)], x.result()) for x in varied] or [UNREAD, UNREAD]
            rows[f"{c.file} {c.name}"] = f"| `{c.file} {c.name}` | `{c.value}` | {cells[0]} | {cells[1]} |"
            known = {f"{q.file} {q.name}" for q in ours}
            table = "\n".join(row for key, row in sorted(rows.items()) if key in known)
            out.write_text(head() + table + "\n")
            print(rows[f"{c.file} {c.name}"], flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        patch(sys.argv[2], sys.argv[3], float(sys.argv[4]))
        print(json.dumps(outcomes(sys.argv[2], sys.argv[3])))
    elif sys.argv[1:2] == ["--reached"]:
        from constants_rare import served
        from constants_reached import executed, reached

        package = Path(__import__("ivsid").__file__).parent
        # Lines of the files of the rare numbers alone: a trace of all lines takes ten times as long.
        only = frozenset(c.split()[0] for c in served()) if sys.argv[2] == "rare" else None
        print(json.dumps(sorted(reached(package, executed(package, lambda: outcomes(sys.argv[2], "NONE"), only)))))
    elif len(sys.argv) > 1:
        main(Path(sys.argv[1]), sys.argv[2:])
    else:
        sys.exit("use: constants.py OUT.md [NAME ...]")
