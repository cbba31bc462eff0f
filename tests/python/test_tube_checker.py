"""Certificates of tubes: every step is proved in rationals, and no claim that is too narrow passes."""

from copy import deepcopy
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from ivsid import IvsidError
from ivsid.log import Log
from ivsid.tubes import tube
from ivsid.tubes.equations import equations_of
from ivsid.tubes.horizons import of_piece, start_of, window
from ivsid.tubes.inputs import course_of
from ivsid.tubes.parameters import pieces_of
from ivsid.verification.claims import part_of, start_box
from ivsid.verification.covered import covers
from ivsid.verification.rational import Range
from ivsid.verification.tubes import TubeChecker
from tube_runs import SWAN, course_of_log, escapes, examined, fit_of, log_of, twin_of, wide  # noqa: F401 - fixtures


@pytest.mark.parametrize("channels", ["all", "straight"])
def test_the_checker_proves_every_step(fit, test_log, channels):
    """In exact arithmetic, from the second definitions of the terms."""
    log = Log("part.csv", test_log.sha256, test_log.t[:60], {n: x[300:360] for n, x in test_log.columns.items()})
    made = tube(fit, log, channels=channels, windows=[], inner=False, check=True)
    assert made.checked.parts == made.checked.proved == 59 and not made.checked.faults


FORGED = {
    "upper": (8, 1, -1e-4),
    "lower": (6, 0, 1e-4),
    "sway": (7, 1, -1e-4),
    "rates": (3, 1, -1e-3),
    "turn": (5, 0, 1e-3),
    "start": (2, 1, 1e-3),
}


@pytest.mark.parametrize("case", FORGED)
def test_the_checker_refuses_a_claim_that_is_too_narrow(fit, course, case):
    column, end, shift = FORGED[case]
    equations = equations_of(fit)
    steps = slice(310, 311)
    followed = equations.model.follow(start_of(course, 310, None), course.h[steps], course.force[steps], certify=True)
    row = [list(e) for e in zip(followed.parts.lower[0].tolist(), followed.parts.upper[0].tolist(), strict=True)]
    force = list(zip(course.force.lower[310].tolist(), course.force.upper[310].tolist(), strict=True))
    h = (float(course.h.lower[310]), float(course.h.upper[310]))
    points = equations.pieces[0].points
    assert TubeChecker(fit.vehicle, "total", points).fault(part_of(row, force, h, 1)) is None
    row[column][end] += shift
    assert TubeChecker(fit.vehicle, "total", points).fault(part_of(row, force, h, 1)) is not None


def certified(fit, course, first, count, start):
    """A checker, and the parts of a tube."""
    equations = equations_of(fit)
    steps = slice(first, first + count)
    found = equations.model.follow(start, course.h[steps], course.force[steps], certify=True)
    rows = [
        [list(e) for e in zip(a, b, strict=True)]
        for a, b in zip(found.parts.lower.tolist(), found.parts.upper.tolist(), strict=True)
    ]
    parts = []
    for row, (step, _, share) in zip(rows, found.steps, strict=True):
        k = first + step
        force = list(zip(course.force.lower[k].tolist(), course.force.upper[k].tolist(), strict=True))
        parts.append((row, force, (float(course.h.lower[k]), float(course.h.upper[k])), share))
    return TubeChecker(fit.vehicle, "total", equations.pieces[0].points), parts


def test_the_checker_integrates_the_turn(fit, course):
    """After a second the yaw rate is narrower than its accelerations alone allow, and no narrower than its row since the start."""
    checker, parts = certified(fit, course, 310, 40, start_of(course, 310, None))
    assert all(checker.fault(part_of(*p)) is None for p in parts[:-1])
    row, *rest = parts[-1]
    forgotten = TubeChecker(fit.vehicle, "total", equations_of(fit).pieces[0].points)
    assert "of r" in forgotten.fault(part_of(row, *rest))
    row[8][1] -= 1e-3
    assert "upper end of r" in checker.fault(part_of(row, *rest))


def test_the_checker_bounds_the_momentum(fit, course):
    """A turn of any rate leaves the momentum alone: without that bound, ends and accelerations are not proved."""
    checker, parts = certified(fit, course, 310, 50, wide(course, 310))
    assert all(checker.fault(part_of(*p)) is None for p in parts)
    row, *rest = parts[-1]
    forgotten = TubeChecker(fit.vehicle, "total", equations_of(fit).pieces[0].points)
    assert forgotten.fault(part_of(row, *rest)) is not None
    row[6][1] -= 1e-3
    assert checker.fault(part_of(row, *rest)) is not None


def test_the_checker_proves_cells_of_the_yaw_rate(fit, test_log, course):
    """Each part, and that the cells that are cut anew hold all states of the step before."""
    log = Log("part.csv", test_log.sha256, test_log.t[:14], {n: x[310:324] for n, x in test_log.columns.items()})
    made = tube(fit, log, windows=[], inner=False, yaw_cells=3, check=True)
    assert made.yaw_cells == 3 and made.checked.parts == made.checked.proved >= 26
    equations = replace(equations_of(fit), yaw_cells=3)
    piece, start = equations.pieces[0], start_of(course, 310, None)
    found = of_piece(equations, piece, course, 310, 321, None, parts=1, certify=True)
    claims = {}
    for (step, cell, share), low, high in zip(found.steps, found.parts.lower, found.parts.upper, strict=True):
        k = 310 + step
        force = list(zip(course.force.lower[k].tolist(), course.force.upper[k].tolist(), strict=True))
        h = (float(course.h.lower[k]), float(course.h.upper[k]))
        part = part_of(list(zip(low.tolist(), high.tolist(), strict=True)), force, h, share)
        claims.setdefault(step, []).append((cell, part))

    def fault(last, change):
        """What the checker says first of a step whose claims are changed, after those before it."""
        checker = TubeChecker(fit.vehicle, "total", piece.points)
        checker.begin(start_box(start.lower[:3].tolist(), start.upper[:3].tolist()))
        assert not any(f for step in range(last) for f in checker.faults(claims[step]))
        return checker.faults(change(claims[last]))[0]

    assert len(claims[0]) > 1 and len(claims[10]) > 2
    assert all("leave states" in fault(0, change) for change in (lambda c: c[1:], lambda c: c[:-1]))
    assert "leave states" in fault(10, lambda c: [c[0], *c[2:]])


def box(*ends):
    return tuple(Range(Fraction(a), Fraction(b)) for a, b in ends)


def test_a_cover_has_no_gap():
    whole = box((0, 1), (-1, 1), (0, 3))
    cells = [box((0, 1), (-1, 1), (a, a + 1)) for a in range(3)]
    assert covers(cells, whole) and covers(cells[::-1], whole) and covers(cells, box((0, 1), (0, 0), (1, 1)))
    assert not covers([], whole) and not covers([], box((0, 1), (0, 1), (2, 2)))
    for k in range(3):
        assert not covers(cells[:k] + cells[k + 1 :], whole)
        # A cell that lacks some of sway where the yaw rates meet, though another holds the same yaw rate.
        assert not covers([*cells, box((0, 1), (-1, Fraction(1, 2)), (k, k + 1))], whole)
    beyond = box((5, 6), (5, 6), (4, 5))
    assert covers([*cells, beyond], whole) and not covers(cells, box((0, 1), (0, 1), (2, Fraction(7, 2))))


def test_pieces_cover_the_parameters(fit, test_log):
    """The hull of the pieces' tubes holds all trajectories, is no wider than the tube of all parameters, and is proved again."""
    rng = np.random.default_rng(3)
    course = course_of(SWAN, test_log)
    whole, states = examined(rng, fit, course, 310, 60, 40)
    cut = equations_of(fit, cells=2)
    assert len(cut.pieces) == 8
    bounds = window(cut, course, 310, 370, None)
    assert escapes(bounds, states) == 0
    assert np.all(whole.lower <= bounds.lower) and np.all(bounds.upper <= whole.upper)
    assert np.all(bounds.upper[60, :3] - bounds.lower[60, :3] < whole.upper[60, :3] - whole.lower[60, :3])
    # A piece alone is left.
    alone = window(replace(cut, pieces=cut.pieces[:1]), course, 310, 370, None)
    assert escapes(alone, states) > 0
    log = Log("part.csv", test_log.sha256, test_log.t[:8], {n: x[300:308] for n, x in test_log.columns.items()})
    again = tube(fit, log, channels="straight", windows=[], inner=False, cells=2, check=True)
    assert again.pieces == 4 and again.checked.proved == again.checked.parts == 28


@pytest.mark.parametrize(("key", "value"), [("lower", ["x"]), ("right", None), ("upper", [3, 4])])
def test_a_damaged_certificate_is_a_sentence(fit, key, value):
    """An edited result is read by whoever validates: a corner of its sets that is no number ends in a sentence."""
    edited = deepcopy(fit.certificates)
    for c in edited:
        for row in c.get("rows", ()):
            row[key] = value * len(row["lower"]) if value == ["x"] else value
    with pytest.raises(IvsidError, match="a certificate of the fit cannot be read"):
        pieces_of(replace(fit, certificates=edited), list(fit.parameters), 1)
