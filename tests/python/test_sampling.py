"""Tests that take a share of their cases in the gate carry a mark that the nightly run selects."""

import ast
from pathlib import Path

import pytest

from sampling import NIGHTLY, spaced

HERE = Path(__file__).parent


def marks(nodes) -> set[str]:
    """Names of the marks in decorators or in ``pytestmark``."""
    return {n.attr for node in nodes for n in ast.walk(node) if isinstance(n, ast.Attribute)}


def taken_from_sampling(body) -> set[str]:
    """Names that a file takes from ``sampling``: the package has a ``spaced`` of its own."""
    return {
        a.asname or a.name for n in body if isinstance(n, ast.ImportFrom) and n.module == "sampling" for a in n.names
    }


def shares(node, names) -> bool:
    """Whether a function takes spaced cases, or asks whether it is night, by these names."""
    return any(isinstance(n, ast.Name) and n.id in names for n in ast.walk(node))


def test_tests_that_take_a_share_of_their_cases_run_at_night():
    examined = set()
    for path in sorted(HERE.glob("test_*.py")):
        body = ast.parse(path.read_text()).body
        names = taken_from_sampling(body)
        own = marks(n for n in body if isinstance(n, ast.Assign) and ast.unparse(n.targets[0]) == "pytestmark")
        for test in (
            n for n in body if isinstance(n, ast.FunctionDef) and n.name.startswith("test_") and shares(n, names)
        ):
            name = f"{path.name}::{test.name}"
            examined.add(name)
            assert (own | marks(test.decorator_list)) & {"sampled", "same_rows", "nightly"}, name
    assert len(examined) > 20


def test_the_nightly_run_selects_these_marks():
    assert '-m "nightly or sampled or same_rows"' in (HERE.parent / "nightly.py").read_text()


@pytest.mark.sampled
def test_spaced_cases_hold_the_first_and_the_last():
    taken = spaced(range(10), 3)
    assert list(taken) == (list(range(10)) if NIGHTLY else [0, 4, 9])
    assert list(spaced("ab", 3)) == ["a", "b"]
