"""Physical bounds of an identification: rows of the regression under a stated assumption, and notes on sets that contradict them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ivsid.effects import Term
from ivsid.identification.result import Parameter
from ivsid.intervals import IntervalArray
from ivsid.physical import Fault, Inequalities, Subject, faults, regression_bounds
from ivsid.rows import ROW_KINDS, RegressionRows
from ivsid.sensors.bounds import BoundedLog
from ivsid.vehicle import Vehicle

# What a result with physical rows says of its inflation.
INFLATION = "the inflation is that of the measured rows: the physical bounds have no radius that could grow"


def subject_of(bounded: BoundedLog, vehicle: Vehicle, terms: Sequence[Term], form: str) -> Subject:
    """The model with the velocities of a log.

    Args:
        bounded: the log in intervals.
        vehicle: with its hull.
        terms: of the model.
        form: ``total`` or ``added``.
    """
    u, v, r = (bounded.channels[name] for name in ("u", "v", "r"))
    known = vehicle.hull.mass if form == "added" else 0.0
    return Subject(vehicle, tuple(terms), (u, v, r), bounded.log.t, known)


def with_bounds(rows: RegressionRows, subject: Subject) -> RegressionRows:
    """The rows with those of the physical bounds, one-sided and without a duration, after all others.

    Args:
        rows: of the model, whose first columns are its terms.
        subject: the model with its velocities.
    """
    bounds, sentences = regression_bounds(subject)
    parts = [rows, *(_rows(rows, b) for b in bounds if b.least.size)]
    named = {k: np.concatenate([getattr(p, k) for p in parts]) for k in ("channel", "time", "duration", "kind")}
    return RegressionRows(
        rows.terms,
        IntervalArray.concatenate([p.matrix for p in parts]),
        IntervalArray.concatenate([p.right for p in parts]),
        **named,
        assumes=(*rows.assumes, *sentences),
    )


def _rows(rows: RegressionRows, bound: Inequalities) -> RegressionRows:
    """One bound as rows; the unknowns after the terms do not stand in it."""
    m, n = bound.least.size, len(rows.terms)
    lower, upper = np.zeros((m, n)), np.zeros((m, n))
    k = bound.matrix.shape[1]
    lower[:, :k], upper[:, :k] = bound.matrix.lower, bound.matrix.upper
    right = IntervalArray(bound.least, np.full(m, np.inf))
    kind = np.full(m, ROW_KINDS.index(bound.kind), dtype=np.int64)
    return replace(
        rows,
        matrix=IntervalArray(lower, upper),
        right=right,
        channel=bound.channel,
        time=bound.time,
        duration=np.zeros(m),
        kind=kind,
    )


def contradicted(subject: Subject, parameters: Mapping[str, Parameter]) -> tuple[Fault, ...]:
    """Physical bounds that no parameter of a set keeps; none of a set without intervals, or with reversed ones.

    Args:
        subject: the model with its velocities.
        parameters: intervals by id.
    """
    ids = [t.id for t in subject.terms]
    if set(ids) - set(parameters) or any(parameters[i].lower > parameters[i].upper for i in ids):
        return ()
    return faults(subject, {i: (parameters[i].lower, parameters[i].upper) for i in ids})


def of_no_vessel(subject: Subject, estimate: Mapping[str, float]) -> tuple[str, ...]:
    """A note on the parameter of least inflation of an empty set that no vessel can have; none where one can.

    Args:
        subject: the model with its velocities.
        estimate: the point by id; without a number of each term it says nothing.
    """
    ids = [t.id for t in subject.terms]
    if set(ids) - set(estimate):
        return ()
    found = faults(subject, {i: (estimate[i], estimate[i]) for i in ids})
    if not found:
        return ()
    return (
        f"no vessel has the parameter of least inflation ({found[0].sentence}): it shows how wrong the model is, and is no estimate of the vessel",
    )
