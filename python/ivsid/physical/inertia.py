"""Inertia: a motion of any direction has kinetic energy, so that the inertia matrix with its added mass is positive definite.

The bound is linear in the parameters for each direction of motion. The direction that tells most is that of the least eigenvalue of the matrix in
the middle of a box: of a single point it decides, of a box it proves that no point is positive definite where it is violated.

Source: Fossen 2011, property 6.1 (M is symmetric and positive definite).
"""

from __future__ import annotations

from typing import Final

import numpy as np

from ivsid.intervals import IntervalArray
from ivsid.physical.bound import Box, Inequalities, Subject

KIND: Final = "physical.inertia"


def sentence(_subject: Subject) -> str:
    """The bound in words."""
    return "the inertia matrix with its added mass is positive definite"


def inequalities(subject: Subject, box: Box | None = None) -> tuple[Inequalities, ...]:
    """The energy of the motion that has the least of it, in the middle of a box; none without a finite box."""
    if box is None:
        return ()
    known, units = subject.inertia()
    middle = np.array([0.5 * (low + high) for low, high in (box[t.id] for t in subject.terms)])
    if not np.isfinite(middle).all() or not all(units[:, k, k].any() for k in range(3)):
        return ()
    matrix = known + np.tensordot(middle, units, axes=1)
    # A motion counts by its speed at the ends of the hull, so that turning is compared with moving.
    length = subject.vehicle.hull.length or 1.0
    scale = np.diag([1.0, 1.0, 1.0 / length])
    values, vectors = np.linalg.eigh(scale @ (0.5 * (matrix + matrix.T)) @ scale)
    q = scale @ vectors[:, 0]
    # The direction is as good as any, and its energy is enclosed: what is called a contradiction is none of rounding.
    along = IntervalArray(q)
    pairs = along.reshape(3, 1) * along.reshape(1, 3)
    still, each = subject.enclosed_inertia()
    row = (each * pairs).sum(axis=1).sum(axis=1)
    least = -(still * pairs).sum().upper
    channel = np.array([int(np.argmax(np.abs(vectors[:, 0])))], dtype=np.int64)

    def words(_row: int, _reached: float) -> str:
        return (
            f"the inertia matrix is not positive definite: its least eigenvalue is {values[0]:.4g} kg, so that a push "
            "along that direction moves the vessel the other way"
        )

    time = subject.time[:1] if subject.time.size else np.zeros(1)
    return (Inequalities(KIND, row.reshape(1, len(row)), np.array([least]), channel, time, words),)
