"""Tubes proved once more, part by part, by the checker, which shares no code with the engine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby, product

from ivsid.identification import Identification
from ivsid.intervals import IntervalArray
from ivsid.tubes.equations import Equations
from ivsid.tubes.horizons import Window, of_piece
from ivsid.tubes.inputs import Course
from ivsid.verification.claims import part_of, start_box
from ivsid.verification.tubes import TubeChecker


@dataclass(frozen=True)
class Checked:
    """What the checker proved of the parts of all steps.

    Attributes:
        parts: number of parts.
        proved: number of those that are proved.
        faults: the first claim that is not proved of each other part, with the time of its step [s].
    """

    parts: int
    proved: int
    faults: tuple[tuple[float, str], ...]


def checked(
    fit: Identification,
    equations: Equations,
    course: Course,
    windows: tuple[Window, ...],
    given: IntervalArray | None,
    *,
    parts: int,
    progress: Callable[[str], None],
) -> Checked:
    """Follows the windows again with a certificate of each part, and proves each in exact ranges.

    Args:
        fit: whose parameters move.
        equations: of the fit.
        course: of the log.
        windows: of a horizon.
        given: zeros where surge of a straight run alone is followed; None where all components are free.
        parts: equal parts of each step.
        progress: told of each window.
    """
    free = (True, given is None, given is None)
    count, faults = 0, []
    for number, (piece, w) in enumerate(product(equations.pieces, windows), start=1):
        progress(f"proving tube {number} of {len(equations.pieces) * len(windows)} once more")
        checker = TubeChecker(fit.vehicle, fit.options["form"], piece.points, free)
        followed = of_piece(equations, piece, course, w.first, w.proved, given, parts=parts, certify=True)
        begun = followed.bounds[0]
        checker.begin(start_box(begun.lower[:3].tolist(), begun.upper[:3].tolist()))
        low, high = followed.parts.lower.tolist(), followed.parts.upper.tolist()
        rows = [list(zip(a, b, strict=True)) for a, b in zip(low, high, strict=True)]
        for step, claims in groupby(zip(followed.steps, rows, strict=True), key=lambda claim: claim[0][0]):
            k = w.first + step
            force = list(zip(course.force.lower[k].tolist(), course.force.upper[k].tolist(), strict=True))
            h = (float(course.h.lower[k]), float(course.h.upper[k]))
            parts_of_step = [(cell, part_of(row, force, h, share)) for (_, cell, share), row in claims]
            for fault in checker.faults(parts_of_step):
                count += 1
                if fault is not None:
                    faults.append((float(course.log.t[k]), fault))
    return Checked(count, count - len(faults), tuple(faults))
