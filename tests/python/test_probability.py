"""Probabilities of findings: their kinds, their numbers, and what an examination says of them."""

import pytest
from tests.exam.reliability import curve, drawing, firsts, sets

from ivsid.diagnosis.statements.probability import CLEAR, COUNTS, Alike, alike


def test_a_finding_is_like_those_of_its_company_and_size():
    assert alike("drag.lift.yaw", CLEAR, ()) == "alone, clear"
    assert alike("drag.lift.yaw", CLEAR - 0.1, ()) == "alone, faint"
    assert alike("drag.lift.yaw", 50.0, ("payload.step",)) == "several, clear"
    assert alike("drag.lift.yaw", 50.0, ("payload.step", "unknown")) == "beside unknown"
    assert alike("unknown", 50.0, ("payload.step",)) == "unknown"
    assert {alike(e, z, o) for e in ("a", "unknown") for z in (5.0, 50.0) for o in ((), ("b",), ("unknown",))} == set(
        COUNTS
    )


@pytest.mark.parametrize(("right", "of"), [(0, 0), (5, 5), (300, 300), (3, 7)])
def test_no_share_is_certain_and_many_cases_approach_theirs(right, of):
    p = Alike("", right, of).probability
    assert 0.0 < p < 1.0 and abs(p - (right / of if of else 0.5)) <= 0.5 / (of + 1) + 1e-12


# Ninety of a hundred sets are right, and so are half of the first names.
ROWS = [
    {
        "truth": {"a": 1.0},
        "z": {"a": 9.0},
        "sets": [["a" if k % 2 else "b", "a"] if k % 10 else ["c", "d"]],
        "sure": [[0.9, 0.5, "x"]],
    }
    for k in range(100)
]


def test_an_examination_tells_who_says_too_much():
    ((n, said, true, low, high),) = curve(list(sets(ROWS)))
    assert (n, said, true) == (100, pytest.approx(0.9), 0.9) and low < 0.9 < high
    ((_, said, true, low, high),) = curve(list(firsts(ROWS)))
    assert said == pytest.approx(0.45) and true == 0.5 and low < 0.45 < high
    # Who says 0.99 of the same is told so.
    ((*_, high),) = curve(list(sets([{**r, "sure": [[0.99, 0.5, "x"]]} for r in ROWS])))
    assert high < 0.99
    # An unknown is right where anything is hidden, and wrong where nothing is.
    unknown = {"z": {}, "sets": [["unknown"]], "sure": [[0.9, 1.0, "y"]]}
    assert [q.right for q in sets([{**unknown, "truth": {"x.side": 1.0}}, {**unknown, "truth": {}}])] == [True, False]


@pytest.mark.figures
def test_the_same_examination_draws_the_same_bytes(tmp_path):
    drawings = [tmp_path / f"{k}.svg" for k in range(2)]
    for path in drawings:
        drawing(ROWS, path)
    assert drawings[0].read_bytes() == drawings[1].read_bytes()


@pytest.mark.figures
def test_an_examination_without_findings_draws_no_legend(tmp_path):
    """Nulls that are all adequate ended in a warning of Matplotlib."""
    drawing([{"verdict": "adequate", "truth": {}, "z": {}}], tmp_path / "none.svg")
    assert b"legend" not in (tmp_path / "none.svg").read_bytes() != b""
