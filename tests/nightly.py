"""Runs what the gate leaves out, with fresh seeds, and writes docs/nightly.md: python -m tests.nightly [PART ...].

The page is written once, after the last part; a run that is stopped leaves the page as it was. Parts that are not named
keep their rows, with the date and the commit of their own run. SEED repeats the draws of an earlier run.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "nightly.md"
BIN = Path(sys.executable).parent
HEAD = """# The nightly run

`make nightly` runs every test that the gate leaves out, and the gate's property tests with fresh seeds; the gate draws
fixed ones. `make nightly PARTS="fuzz draws"` runs some of its parts, `SEED=... make nightly` repeats its draws. A test leaves
the gate when it is slow and a quicker test of the same mechanism stays; `pytest -m nightly` lists them. A test that is marked
`sampled` takes evenly spaced cases of one mechanism in the gate, and all of them here. The table is written by
`tests/nightly.py`, each row with the date and the commit of its run.

| part | command | cases | result | time [s] | date | commit |
|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Part:
    """A command of the nightly run; ``{seed}`` stands for the drawn seed, in its words and in its environment."""

    name: str
    command: str
    variables: str = ""

    def shown(self, seed: object) -> str:
        """The command as one types it."""
        return f"{self.variables} {self.command}".strip().format(seed=seed)


PARTS = (
    # The examination, whole diagnoses, real vessels, long sails and twins.
    Part(
        "tests",
        'pytest -n auto --dist worksteal -m "nightly or sampled or same_rows" --hypothesis-seed={seed}',
        "IVSID_SEED={seed}",
    ),
    # Python's property tests, which the gate draws from fixed seeds.
    Part("draws", 'pytest -n auto -m "hypothesis and not nightly" --hypothesis-seed={seed}', "IVSID_SEED={seed}"),
    Part("oracle", "pytest -n auto tests/python/test_oracle.py", "IVSID_CASES=1e6"),
    Part("recommended", "pytest -n auto tests/python/test_recommended.py", "IVSID_CASES=1e5"),
    Part("reverses", "pytest -n auto tests/python/test_reverses.py", "IVSID_CASES=1e4"),
    Part(
        "rust",
        "cargo test --profile gate --locked --workspace --exclude benches -- --include-ignored",
        "PROPTEST_RNG_SEED={seed}",
    ),
    Part(
        "fuzz",
        "cargo test --profile gate --locked --workspace --exclude benches --test fuzz_text",
        "IVSID_FUZZ_SECONDS=120",
    ),
    # Mutated files through every reader, and named faults that tests have to see.
    Part("files", "python -m tests.fuzz_files 10000 {seed}"),
    Part("mutants", "python -m tests.mutants --rust"),
    # Wheel, source distribution and crate, and the tutorial with the wheel away from the tree; a wheel of the source there.
    Part("packages", "make wheel try-wheel && make try-wheel SOURCE=1"),
    # Lints of the benchmarks, and the documentation of the crates and of the package, and the release workflow.
    Part("lints", "make clippy site workflows"),
)


def counted(text: str) -> tuple[str, str]:
    """Cases and result, of what pytest or Cargo said; empty for a part without tests."""
    numbers = {
        word: sum(int(n) for n in re.findall(rf"(\d+) {word}", "\n".join(closing(text))))
        for word in ("passed", "failed", "errors?", "skipped", "ignored")
    }
    bad = numbers["failed"] + numbers["errors?"]
    cases = numbers["passed"] + bad
    left = numbers["skipped"] + numbers["ignored"]
    if not cases:
        return "", ""
    return f"{cases}" + (f" ({left} skipped)" if left else ""), f"{numbers['passed']} passed, {bad} failed"


def closing(text: str) -> list[str]:
    """The lines that sum up: one of pytest, one of each binary of Cargo."""
    return re.findall(r"^test result: .*$|^=+ .* in [0-9.]+s.*=+$", text, re.MULTILINE)


def run(part: Part, seed: int) -> tuple[str, bool]:
    """The part's row, and whether it passed."""
    given = dict(pair.split("=", 1) for pair in part.variables.format(seed=seed).split())
    # With the interpreter's own folder first, "pytest" is that of this environment.
    environment = {**os.environ, **given, "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}"}
    sys.stdout.write(f"{part.name}: {part.shown(seed)}\n")
    sys.stdout.flush()
    begin, date = time.monotonic(), datetime.now(UTC).date().isoformat()
    printed = []
    with subprocess.Popen(
        part.command.format(seed=seed),
        shell=True,
        cwd=ROOT,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as process:
        # Lines are shown as they come: a part takes up to an hour, and one that is stopped leaves what it found.
        for line in process.stdout or ():
            printed.append(line)
            sys.stdout.write(line)
            sys.stdout.flush()
    spent = time.monotonic() - begin
    cases, result = counted("".join(printed))
    passed = process.returncode == 0
    if not passed:
        result = f"**{result or 'failed'}, code {process.returncode}**"
    result = result or "passed"
    sys.stdout.write(f"{part.name}: {result}, {spent:.0f} s\n")
    sys.stdout.flush()
    row = f"| {part.name} | `{part.shown(seed)}` | {cases} | {result} | {spent:.0f} | {date} | {commit()} |"
    return row, passed


def commit() -> str:
    """The commit that is checked out, and whether files differ from it."""

    def git(*words: str) -> str:
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()

    changed = git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs/nightly.md")
    return git("rev-parse", "--short=10", "HEAD") + (", with changes" if changed else "")


def kept(page: Path) -> dict[str, str]:
    """The rows that stand in the page, by part."""
    text = page.read_text(encoding="utf-8") if page.exists() else ""
    rows = (line for line in text.splitlines() if re.match(r"\| \w+ \| `", line))
    return {row.split(" ", 2)[1]: row for row in rows if "| not run |" not in row}


def write(page: Path, rows: dict[str, str]) -> None:
    """The page, whole or not at all; a part that never ran is said to be one."""
    never = [f"| {p.name} | `{p.shown('SEED')}` | | not run | | | |" for p in PARTS if p.name not in rows]
    text = HEAD + "\n".join([*(rows[p.name] for p in PARTS if p.name in rows), *never]) + "\n"
    new = page.with_suffix(".new")
    new.write_text(text, encoding="utf-8")
    new.replace(page)


def main() -> int:
    """Runs the parts that are named, or all of them."""
    wanted = sys.argv[1:] or [p.name for p in PARTS]
    unknown = set(wanted) - {p.name for p in PARTS}
    if unknown:
        sys.stderr.write(f"no part {', '.join(sorted(unknown))}; there are {', '.join(p.name for p in PARTS)}\n")
        return 2
    seed = int(os.environ.get("SEED", time.time_ns() % 10_000_000))
    sys.stdout.write(f"seed {seed}\n")
    found = {p.name: run(p, seed) for p in PARTS if p.name in wanted}
    write(PAGE, {**kept(PAGE), **{name: row for name, (row, _) in found.items()}})
    return 0 if all(passed for _, passed in found.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
