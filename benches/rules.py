"""How often does each rule of the diagnosis decide? Rows for docs/rules_measured.md.

python benches/rules.py [CASES] [SEED]

A rule decides where it refuses and every other rule of its stage would not. Cases are those of the examination, with a known cause, so
that what a rule keeps out is told apart: causes that are not there, and those that are. Null logs are off, for time.
"""

from __future__ import annotations

import os
import sys
from collections import defaultdict

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.exam.cases import case
from tests.exam.seal import answer, seal

from ivsid.diagnosis import diagnose
from ivsid.diagnosis.null import family_wise, rule
from ivsid.diagnosis.null.rule import Rule
from ivsid.diagnosis.null.screening import SCREENING
from ivsid.diagnosis.selection import review, select, verdict
from ivsid.diagnosis.selection.rules import FULL_FITS, LATE
from ivsid.diagnosis.selection.verdict import VERDICT
from ivsid.diagnosis.statements import carried, findings
from ivsid.diagnosis.statements.carried import CARRIES, STAYS
from ivsid.diagnosis.statements.rules import HELD, UNNAMED
from ivsid.errors import IvsidError
from ivsid.log import read_log
from ivsid.vehicle import read_vehicle

DEFAULTS = ("100", "70000")
ALL = (*SCREENING, *LATE, *FULL_FITS, *VERDICT, *HELD, UNNAMED, STAYS, CARRIES)
# By name of the rule: refusals, those that no other rule of the stage shares, and such of a cause that is hidden.
counts: dict[str, list[int]] = defaultdict(lambda: [0, 0, 0])
hidden: set[str] = set()
asking = Rule.refuses


def identity(one: object) -> str:
    """The id of the cause that a rule is asked of; empty where it is asked of a model."""
    for path in (("s", "id"), ("rival", "id"), ("effect", "id")):
        found: object = one
        for name in path:
            found = getattr(found, name, None)
        if isinstance(found, str):
            return found
    return ""


def noted(name: str, one: object, alone: bool) -> None:
    """Counts a refusal."""
    counts[name][0] += 1
    counts[name][1] += alone
    counts[name][2] += alone and identity(one) in hidden


def shared(first: Rule, rules, one) -> bool:
    """Whether another rule of the stage refuses, too."""
    for other in rules:
        if other is not first:
            try:
                if asking(other, one) is not None:
                    return True
            except (ArithmeticError, ValueError, IndexError, np.linalg.LinAlgError):
                # A statistic that asks for what the first rule excludes.
                return True
    return False


def first_refusal(rules, one, beside=()):
    """As that of the package, with the count."""
    for r in rules:
        said = asking(r, one, beside)
        if said is not None:
            noted(r.name, one, not shared(r, rules, one))
            return said
    return None


def refuses(self, one, beside=()):
    """A rule that is asked by itself decides wherever it refuses."""
    said = asking(self, one, beside)
    if said is not None:
        noted(self.name, one, True)
    return said


def main() -> None:
    """Prints the table."""
    count, seed = map(int, (*sys.argv[1:], *DEFAULTS[len(sys.argv) - 1 :]))
    for module in (carried, family_wise, findings, review, select, verdict):
        module.first_refusal = first_refusal
    rule.Rule.refuses = refuses
    done = 0
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        for k in range(seed, seed + count):
            try:
                folder = seal(case(k, duration=300.0), Path(one), Path(other))
            except ValueError:
                continue
            hidden.clear()
            hidden.update(answer(folder, Path(other))["z"])
            vehicle = read_vehicle(folder / "vehicle.toml")
            try:
                diagnose(vehicle, *(read_log(folder / f"{j}.csv", vehicle.log) for j in (1, 2)), null_logs=0)
            except IvsidError:
                continue
            done += 1
    print(f"{done} cases of the examination from seed {seed}, 300 s each.\n")
    print("| rule | refusals | of these it alone | of a hidden cause |\n|---|---|---|---|")
    for r in ALL:
        print("| " + " | ".join([r.name, *map(str, counts[r.name])]) + " |")


if __name__ == "__main__":
    main()
