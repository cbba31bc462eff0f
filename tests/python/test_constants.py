"""Every number that the package decides by has a reason and a source, and the page of the docs says the same."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs"))

from constants import PAGE, constants, page  # noqa: E402 - docs/constants.py stands beside the page that it makes


@pytest.fixture(scope="module")
def shipped():
    return constants()


def test_every_constant_has_a_reason(shipped):
    found = shipped
    assert len(found) > 200
    lacking = [f"{c.file}:{c.line} {c.name}" for c in found if not c.reason or not c.source]
    assert not lacking, lacking


def test_no_constant_waits_for_its_measurement(shipped):
    assert not [f"{c.file} {c.name}" for c in shipped if c.source == "none"]


def test_commands_that_repeat_a_measurement_exist(shipped):
    targets = set(re.findall(r"^([a-z][\w-]*):", (ROOT / "Makefile").read_text(), re.M))
    named = {(c.name, t) for c in shipped for t in re.findall(r"measured: make ([a-z][\w-]*)", c.source)}
    assert named
    assert not {(name, t) for name, t in named if t not in targets}


def test_measured_constants_stand_in_the_table_of_measurements(shipped):
    measured = (ROOT / "docs" / "constants_measured.md").read_text()
    wanted = [c for c in shipped if c.source.startswith("measured: make constants")]
    rows = [f"| `{c.file} {c.name}` | `{c.value}` | " for c in wanted]
    lacking = [row for row in rows if row not in measured or f"{row}not read" in measured]
    assert wanted and not lacking, lacking


def test_the_page_is_made_from_the_comments(shipped):
    assert PAGE.read_text() == page(shipped)


def test_a_number_without_a_source_is_seen(tmp_path):
    (tmp_path / "one.py").write_text(
        "# A reason.\n# Source: definition.\nA = 1.0\nB = (2, 3.5)\n\n\nC: Final = 4\n# Reason alone.\nD = {'x': 1e3}\nE = 'text'\n"
        "# Made.\n# Source: theorem.\nF = tuple(np.geomspace(0.2, 2.5, 16).tolist())\nG = ((0, True), (1, False))\nH = (True, False)\n"
    )
    found = {c.name: (c.value, c.reason, c.source) for c in constants(tmp_path)}
    assert found == {
        "A": ("1.0", "A reason.", "definition."),
        "B": ("(2, 3.5)", "A reason.", "definition."),
        "C": ("4", "", ""),
        "D": ("{'x': 1e3}", "Reason alone.", ""),
        "F": ("tuple(np.geomspace(0.2, 2.5, 16).tolist())", "Made.", "theorem."),
        "G": ("((0, True), (1, False))", "Made.", "theorem."),
    }
