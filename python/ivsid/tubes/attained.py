"""The inner bound: what single members attain, in plain floats. It shows how much of a tube is real, and proves nothing.

Members are vertices of the polytope of parameters. Their errors are bang-bang: held at one end, switched once, or switched where the adjoint of a target
changes its sign (Pontryagin and others 1962), with the start at the end that pushes the same way. The adjoint is taken about every pattern
of held errors: it knows the first order alone, and surge feels a turn by its square.
"""

from __future__ import annotations

from itertools import product
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import IntervalArray
from ivsid.tubes.equations import Equations
from ivsid.tubes.horizons import Window, start_of
from ivsid.tubes.inputs import Course

Array: TypeAlias = NDArray[np.float64]
# Moments of a window at which the members' velocities are pushed outward.
# Source: resource: each costs two adjoint runs a component and side
TARGETS: Final = 3
# Longest window that is pushed towards targets [steps]; longer ones have held errors alone.
# Source: resource: an adjoint run costs ten times the run itself
LONGEST: Final = 1200
# Most patterns of held errors; beyond it all stand at one end together.
# Source: resource: each costs a run for each member
MOST_PATTERNS: Final = 16
# Moments of a window at which held errors switch once are its multiples of 1 / SWITCHES.
# Source: resource: each costs a run for each member, pattern and end; a vehicle that was turned for a while and is then pushed has its extreme surge
SWITCHES: Final = 20
# Most patterns to each of which each other may switch; beyond it all switch to one end together.
# Source: resource: the runs grow with its square
FEW_PATTERNS: Final = 4


def attained(
    equations: Equations, course: Course, window: Window, given: IntervalArray | None = None
) -> tuple[Array, Array]:
    """Least and largest u, v, r, psi, x, y of the members at the rows of a window, shape (rows, 6) each."""
    steps = slice(window.first, window.proved)
    count = window.proved - window.first
    start = start_of(course, window.first, given)
    box = list(zip(start.lower.tolist(), start.upper.tolist(), strict=True))
    errors = [e[steps] for e in course.errors]
    middle = None if given is None else given[steps].midpoint
    patterns = list(product((-1.0, 1.0), repeat=len(errors)))
    if len(patterns) > MOST_PATTERNS:
        patterns = [(s,) * len(errors) for s in (-1.0, 1.0)]
    followed = 1 if given is not None else 3
    towards = [
        (target, [side if j == i else 0.0 for j in range(6)])
        for target in sorted({round(count * (k + 1) / TARGETS) for k in range(TARGETS)})
        for i in range(followed)
        for side in (-1.0, 1.0)
    ]
    towards = towards if given is None and count <= LONGEST else []
    lower, upper = np.full((count + 1, 6), np.inf), np.full((count + 1, 6), -np.inf)
    ends = patterns if len(patterns) <= FEW_PATTERNS else [(s,) * len(errors) for s in (-1.0, 1.0)]
    moments = sorted({round(count * k / SWITCHES) for k in range(1, SWITCHES)})
    for theta in equations.members:
        for pattern in patterns:
            switched = [(k, end) for k in moments for end in ends if end != pattern] if given is None else []
            for side in (-1.0, 1.0):
                runs = equations.model.members(
                    theta,
                    box,
                    course.h.midpoint[steps],
                    course.centre[steps],
                    errors,
                    middle,
                    (pattern, [side] * 6),
                    switched,
                    towards if side < 0 else [],
                )
                for run in runs:
                    lower[: len(run)] = np.minimum(lower[: len(run)], run)
                    upper[: len(run)] = np.maximum(upper[: len(run)], run)
    return lower, upper
