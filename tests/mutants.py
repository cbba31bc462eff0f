"""Named faults, each put into a copy of the tree, and the tests that have to fail there: python -m tests.mutants [NAME ...].

A mutant is one edit of one line. It is killed when one of its tests fails, and survives when they pass, those of the gate and then those of the night;
tests that fail without any edit kill nothing, so each set of tests runs once on the plain copy. ``--rust`` adds those of the core, each of which is compiled. The run fails if one survives.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.mutant import Mutant
from tests.mutants_of_diagnosis import DIAGNOSIS
from tests.mutants_of_estimation import ESTIMATION
from tests.mutants_of_null import NULL
from tests.mutants_of_proofs import PROOFS
from tests.mutants_of_results import RESULTS
from tests.mutants_of_selection import SELECTION

ROOT = Path(__file__).parents[1]
# Seconds in which the tests of a mutant end; one that never ends is noticed as well.
PATIENCE = 900
# Tests of the gate, and those that run in make nightly alone: whole diagnoses, which the second look alone pays for.
GATE, NIGHT = "not nightly", "nightly"
# What pytest says where a file has no test of the kind.
NONE = 5
MUTANTS = (*RESULTS, *ESTIMATION, *DIAGNOSIS, *NULL, *SELECTION, *PROOFS)


def copied(folder: Path) -> Path:
    """The files of the tree, with changes, and the compiled module."""
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    for name in [*listed.stdout.splitlines(), *(str(p.relative_to(ROOT)) for p in ROOT.glob("python/ivsid/_core*.so"))]:
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    return folder


def failed(tree: Path, mutant: Mutant, kind: str) -> bool:
    """Whether one of the mutant's tests of a kind fails in a tree."""
    if mutant.rust:
        words = ["cargo", "test", "-q", "--profile", "gate", "--locked", "-p", "interval-core"]
        words += [w for t in mutant.tests for w in ("--test", t)]
        target = os.environ.get("CARGO_TARGET_DIR", str(ROOT / "target" / "mutants"))
        environment = {**os.environ, "CARGO_TARGET_DIR": target, "PROPTEST_RNG_SEED": "1"}
    else:
        there = [f"tests/python/{t}" for t in mutant.tests]
        words = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-m", kind, *there]
        paths = os.pathsep.join(str(tree / p) for p in ("python", "", "tests/python"))
        environment = {**os.environ, "PYTHONPATH": paths, "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(words, cwd=tree, env=environment, capture_output=True, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        return True
    if mutant.rust and b"could not compile" in done.stderr:
        raise SystemExit(f"{mutant.name} does not compile:\n{done.stderr.decode()[-2000:]}")
    if not mutant.rust and done.returncode not in (0, 1, 2, NONE):
        raise SystemExit(f"{mutant.name}: pytest ended with {done.returncode}\n{done.stdout.decode()[-2000:]}")
    return done.returncode not in ((0,) if mutant.rust else (0, NONE))


def survives(tree: Path, mutant: Mutant, kind: str) -> bool:
    """Whether the tests of a kind pass with the fault in the tree, which is left as it was."""
    path = tree / mutant.file
    text = path.read_text(encoding="utf-8")
    if text.count(mutant.old) != mutant.count:
        raise SystemExit(
            f"{mutant.name}: {mutant.file} has {text.count(mutant.old)} places of {mutant.old!r}, not {mutant.count}"
        )
    try:
        path.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
        return not failed(tree, mutant, kind)
    finally:
        path.write_text(text, encoding="utf-8")


def main() -> int:
    """Runs the mutants that are named, or all."""
    words = [w for w in sys.argv[1:] if w != "--rust"]
    known = {m.name: m for m in MUTANTS}
    if wrong := set(words) - known.keys():
        sys.stderr.write(f"no mutant {', '.join(sorted(wrong))}; there are {', '.join(known)}\n")
        return 2
    chosen = [known[w] for w in words] or [m for m in MUTANTS if not m.rust or "--rust" in sys.argv]
    alive = []
    with tempfile.TemporaryDirectory() as folder:
        tree = copied(Path(folder))
        sound: set[tuple[tuple[str, ...], str]] = set()
        for mutant in chosen:
            begin, left = time.monotonic(), True
            for kind in (GATE,) if mutant.rust else (GATE, NIGHT):
                if (mutant.tests, kind) not in sound and failed(tree, mutant, kind):
                    sys.stderr.write(f"{', '.join(mutant.tests)} ({kind}) fails without a fault\n")
                    return 2
                sound.add((mutant.tests, kind))
                if not (left := survives(tree, mutant, kind)):
                    break
            alive += [mutant.name] * left
            sys.stdout.write(f"{'SURVIVES' if left else 'killed'}: {mutant.name} ({time.monotonic() - begin:.0f} s)\n")
            sys.stdout.flush()
    sys.stdout.write(f"test result: {len(chosen) - len(alive)} passed, {len(alive)} failed\n")
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main())
