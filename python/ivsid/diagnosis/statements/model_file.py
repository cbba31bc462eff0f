"""Reasons for which an extended model is not handed out as a vehicle file: it is none, it is no vessel's, or it is not better on the other log."""

from __future__ import annotations

import numpy as np

from ivsid.diagnosis.plant.physics import Hypothesis, changed, water
from ivsid.diagnosis.plant.points import Points
from ivsid.diagnosis.statements.carried import BESIDE_STRUCTURE, Carried
from ivsid.diagnosis.statements.comparison import Gain
from ivsid.intervals import IntervalArray
from ivsid.physical import Fault, Subject, faults
from ivsid.vehicle import Vehicle


def against(vehicle: Vehicle, h: Hypothesis, seen: Points, gain: Gain) -> tuple[str, ...]:
    """Sentences on why there is no model file; none where there is one.

    Args:
        vehicle: of the file.
        h: the extended model.
        seen: states of the first log.
        gain: of the extended model on the other log.
    """
    if not gain.extended:
        return ("the model was not extended: no cause was found that stands",)
    found = [f.sentence for f in unphysical(vehicle, h, seen)]
    if gain.diverges[1] is not None:
        found.append(f"its simulation of {gain.log} diverges from t = {gain.diverges[1]:.6g} s")
    # Small losses beside a gain are said, and leave the choice to the reader.
    # What the page calls better, by ranks over all quantities or by a quantity's own interval.
    better = bool(gain.gains) or any(low > 1.0 for low, _ in gain.factors.values())
    worse = [k for k, growth in Carried(gain, complete=True).growth.items() if growth > BESIDE_STRUCTURE]
    if worse or (gain.losses and not better):
        found.append(f"on {gain.log} it is worse in {', '.join(worse or gain.losses)}, by more than chance")
    if grown := [k for k in gain.grown if k not in worse]:
        # Windows that differ leave wide intervals: what grows all the same needs another log before it is handed out.
        found.append(f"on {gain.log} its error in {', '.join(grown)} grows by a quarter or more")
    if not better and gain.diverges == (None, None):
        found.append(f"on {gain.log} it is better in nothing by more than chance")
    return tuple(found)


def unphysical(vehicle: Vehicle, h: Hypothesis, seen: Points) -> tuple[Fault, ...]:
    """Bounds of every vessel that a model does not keep, before or after what changes in it."""
    u, v, r = seen.nu
    u_c, v_c, _, _ = water(h, seen)
    velocities = [np.atleast_1d(x) for x in (u - u_c, v - v_c, r)]
    usable = np.isfinite(velocities).all(axis=0)
    kept = [IntervalArray(x[usable]) for x in velocities]
    time = np.broadcast_to(seen.t, usable.shape)[usable]
    subject = Subject(vehicle, h.terms, (kept[0], kept[1], kept[2]), time)
    found: dict[tuple[str, tuple[str, ...]], Fault] = {}
    # Masses and drags that an effect changes in time are those of its ends.
    for end in (0, -1) if time.size else ():
        values = changed(h, time[[end]])
        box = {t.id: (float(np.ravel(values[t.id])[-1]),) * 2 for t in h.terms}
        for f in faults(subject, box):
            found.setdefault((f.bound, f.parameters), f)
    return tuple(found.values())
