"""Parameter intervals as they narrow: the rows of a log one by one, in the bounded memory of a vehicle's computer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.effects import CHANNELS, Term, terms_of
from ivsid.errors import IvsidError, meant
from ivsid.identification.assumptions import assumptions, cause_notes, left_out
from ivsid.identification.blocks import linked, nonzero
from ivsid.identification.followed import Change, Following, Moment
from ivsid.identification.physics import subject_of, with_bounds
from ivsid.identification.result import Parameter
from ivsid.intervals import FloatArray, IntervalArray
from ivsid.linear.following import Follower
from ivsid.log import GivenLog, log_of
from ivsid.rows import ROW_KINDS, WINDOW, RegressionRows, build_rows, window_count
from ivsid.sensors.bounds import bound_log
from ivsid.setup import examined
from ivsid.vehicle import GivenVehicle, vehicle_of

# Most size of a parameter in its unit, with which a follower starts.
# Source: physics: masses, inertias and drags of a ship of 300,000 t stay below it
START: Final = 1e12
# Ends beyond this share of the start are shown as open: they are what the start leaves, and nothing of the rows.
# Source: definition: a start is far above any parameter
OPEN: Final = 1e-3
# Moments of a log that are kept where no interval of time is given.
# Source: definition: lines that a reader looks at
MOMENTS: Final = 20


@dataclass
class _Block:
    """Parameters that share rows, and how far their rows were taken."""

    columns: tuple[int, ...]
    rows: RegressionRows
    follower: Follower
    taken: int = 0
    refuted: bool = False

    def until(self, end: float, column: Callable[[int], str], kept: list[Change]) -> None:
        """Takes the rows that end up to a time; each proof is kept."""
        ends = self.rows.time + self.rows.duration
        stop = int(np.searchsorted(ends, end, side="right"))
        while self.taken < stop and not self.refuted:
            part = slice(self.taken, stop)
            count, proof = self.follower.take(ends[part], self.rows.matrix[part], self.rows.right[part])
            self.taken += count
            if proof is not None:
                parameter = None if proof.column is None else column(self.columns[proof.column])
                kept.append(Change(proof.time, proof.since, parameter, proof.rows))
                self.refuted = True


def follow(
    vehicle: GivenVehicle,
    log: GivenLog,
    *,
    form: str = "total",
    rows: str = "auto",
    window: float | Sequence[float] = WINDOW,
    physical: bool = False,
    start: float = START,
    drift: Mapping[str, float] | None = None,
    changes: float | None = None,
    every: float | None = None,
    watch: Callable[[Moment], None] = lambda _: None,
    progress: Callable[[str], None] = lambda _: None,
    examine: bool = True,
) -> Following:
    """Parameter intervals of the vehicle file's model after each row of a log, as a vehicle's computer has them.

    The intervals hold every parameter that the rows so far allow, at every moment, as those of ``identify`` do for all rows.

    Args:
        vehicle: as for ``identify``.
        log: as for ``identify``.
        form: as for ``identify``.
        rows: as for ``identify``; each row counts from its end on.
        window: length of integral rows [s], or several.
        physical: whether the bounds that every vessel keeps are rows, too, as for ``identify``.
        start: most size of every parameter in its unit, which is an assumption; ends above a thousandth of it are open.
        drift: most change of parameters by id, in their unit a second; the others are constant. Such rows hold at one instant, so ``rows``
            are ``pointwise``.
        changes: length [s] of windows that are compared: a proof that no constant parameters explain them together is a change, after which
            everything begins anew. By default there is one set over all rows.
        every: time between two moments that are kept and shown [s]; by default a twentieth of the log.
        watch: shown each moment as it comes.
        progress: told of each step.
        examine: whether the set-up is examined first.

    Raises:
        IvsidError: unusable input, in one sentence.
    """
    vehicle = vehicle_of(vehicle)
    log = log_of(log, vehicle.log)
    doubts = examined(vehicle, [log], progress) if examine else ()
    terms = terms_of(vehicle, form)
    rates = _rates(terms, drift or {}, changes, start)
    bounded = bound_log(log, vehicle, window_count(window))
    kind = "pointwise" if drift and rows == "auto" else rows
    made = build_rows(bounded, vehicle, terms, added_mass=form == "added", kind=kind, window=window)
    if drift and np.any(made.duration > 0):
        raise IvsidError(f"rows '{rows}' span windows in which parameters drift; use rows pointwise with drift")
    if physical:
        made = with_bounds(made, subject_of(bounded, vehicle, terms, form))
    step = (log.t[-1] - log.t[0]) / MOMENTS if every is None else every
    if not 0 < step < np.inf:
        raise IvsidError(f"moments every {step:g} s are not possible; give a positive number of seconds")
    blocks = _blocks(made, rates, start, changes)
    progress(f"following {made.time.size} rows")
    found: list[Change] = []
    moments: list[Moment] = []
    first, last = float(log.t[0]), float(log.t[-1])
    count = max(int(np.ceil((last - first) / step - 1e-9)), 1)
    for k in range(1, count + 1):
        end = last if k == count else first + k * step
        for block in blocks:
            while True:
                block.until(end, lambda j: terms[j].id, found)
                if not block.refuted or changes is None:
                    break
                block.refuted = False
        empty = any(b.refuted for b in blocks)
        moments.append(Moment(end, sum(b.taken for b in blocks), {} if empty else _parameters(terms, blocks, start)))
        watch(moments[-1])
        if empty:
            break
    parameters = moments[-1].parameters
    ends = [e for p in parameters.values() for e in (p.lower, p.upper)]
    status = "empty" if not parameters else "enclosed" if np.all(np.isfinite(ends)) else "unbounded"
    absent = left_out(vehicle, bounded)
    measured = ~np.isin(made.kind, [k for k, name in enumerate(ROW_KINDS) if name.startswith("physical.")])
    return Following(
        status=status,
        guaranteed=bounded.rule.guaranteed and not bounded.statistical and not absent,
        assumes=(*assumptions(made, bounded, vehicle), *_own_assumptions(start, drift or {}, changes)),
        parameters=parameters,
        moments=tuple(moments),
        changes=tuple(sorted(found, key=lambda c: c.time)),
        rows={name: int((measured & (made.channel == k)).sum()) for k, name in enumerate(CHANNELS)},
        notes=(*log.notes, *cause_notes(absent)),
        ignored=log.ignored,
        options={
            "form": form,
            "rows": kind,
            "window": window if isinstance(window, float | int) else list(window),
            "physical": physical,
            "start": start,
            "drift": dict(drift or {}),
            "changes": changes,
            "every": step,
        },
        vehicle=vehicle,
        log_name=log.name,
        log_sha256=log.sha256,
        setup=doubts,
    )


def _rates(terms: Sequence[Term], drift: Mapping[str, float], changes: float | None, start: float) -> FloatArray:
    """Most change of each parameter [1/s], shape (n,)."""
    ids = [t.id for t in terms]
    for id_, rate in drift.items():
        if id_ not in ids:
            raise IvsidError(f"drift of '{id_}' is no parameter of the model; {meant(id_, ids)}use {', '.join(ids)}")
        if not 0 <= rate < np.inf:
            raise IvsidError(f"drift of {id_} is {rate:g}; give its most change a second, a number from 0 up")
    if drift and changes is not None:
        raise IvsidError(
            "drift and changes were both given; parameters drift by stated rates, or are constant until a change"
        )
    if changes is not None and not 0 < changes < np.inf:
        raise IvsidError(f"windows of {changes:g} s cannot be compared; give a positive number of seconds")
    if not 0 < start <= 1e100:
        raise IvsidError(
            f"a start of {start:g} is not usable; give the most size of any parameter, above 0 and up to 1e100"
        )
    return np.array([float(drift.get(id_, 0.0)) for id_ in ids])


def _blocks(rows: RegressionRows, rates: FloatArray, start: float, changes: float | None) -> list[_Block]:
    """A follower for each set of parameters that share rows, with its rows in the order of their ends."""
    used = nonzero(rows)
    order = np.argsort(rows.time + rows.duration, kind="stable")
    none: NDArray[np.bool_] = ~np.any(used, axis=0)
    blocks = []
    for columns in linked(used):
        mine = np.any([used[j] for j in columns], axis=0)
        # The first block keeps the rows without any parameter: such a row can falsify the model.
        mine = mine | none if columns[0] == 0 else mine
        n = len(columns)
        follower = Follower(IntervalArray(np.full(n, -start), np.full(n, start)), rates[list(columns)], changes)
        blocks.append(_Block(columns, rows.take(order[mine[order]], columns), follower))
    return blocks


def _parameters(terms: Sequence[Term], blocks: Sequence[_Block], start: float) -> dict[str, Parameter]:
    """Intervals by id in the order of the model; an end near the start is open."""
    found: dict[int, tuple[float, float]] = {}
    for block in blocks:
        bounds = block.follower.bounds
        for j, low, high in zip(block.columns, bounds.lower, bounds.upper, strict=True):
            found[j] = (
                -np.inf if low < -OPEN * start else float(low) + 0.0,
                np.inf if high > OPEN * start else float(high) + 0.0,
            )
    return {t.id: Parameter(*found[j], t.unit, t.symbol) for j, t in enumerate(terms)}


def _own_assumptions(start: float, drift: Mapping[str, float], changes: float | None) -> list[str]:
    lines = [f"each parameter is at most {start:g} in size, in its unit"]
    lines += [f"{id_} changes by at most {rate:g} of its unit a second" for id_, rate in drift.items()]
    if changes is not None:
        lines.append("parameters are constant from one change to the next")
    elif not drift:
        lines.append("parameters are constant over the log")
    return lines
