"""The parameters that are consistent with all rows of some logs, by constraint generation: few rows are solved, all others are tried.

Only points go to the logs, and only the rows that these points violate come back. Every bound and every contradiction is proved by the
rows that came back; that no row is violated any more says how tight the bounds are, and is no part of a proof.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np

from ivsid.effects import Term
from ivsid.fleets.log_rows import LogRows, distinct, joined
from ivsid.fleets.scan import Question, Violated
from ivsid.fleets.working_set import RESIDUAL, Solved, solve, vertices
from ivsid.intervals import FloatArray

# Passes over all logs; each adds rows, and nine in ten searches end within ten.
# Source: resource: bounds a search that rounding keeps from its end
PASSES: Final = 60

Ask: TypeAlias = Callable[[Sequence[Question]], list[Violated]]
Blocks: TypeAlias = Sequence[tuple[int, ...]]


@dataclass(frozen=True)
class Model:
    """The parameters of all logs.

    Attributes:
        terms: one for each column.
        blocks: columns that share rows in some log.
    """

    terms: tuple[Term, ...]
    blocks: tuple[tuple[int, ...], ...]

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of the parameters."""
        return tuple(t.id for t in self.terms)

    def apart(self, column: int, logs: Sequence[int], names: Sequence[str]) -> Model:
        """The model in which one parameter has a value of its own in each of some logs.

        The first log keeps the column; the others get columns of their own behind the rest.
        """
        term, n = self.terms[column], len(self.terms)
        more = tuple(replace(term, id=f"{term.id} @ {name}") for name in names[1:])
        extra = tuple(range(n, n + len(logs) - 1))
        first = replace(term, id=f"{term.id} @ {names[0]}")
        terms = (*self.terms[:column], first, *self.terms[column + 1 :], *more)
        return Model(terms, tuple((*b, *extra) if column in b else b for b in self.blocks))


@dataclass(frozen=True)
class Subset:
    """Logs whose rows are to hold together.

    Attributes:
        logs: their numbers.
        start: some of their rows, to begin with.
        free: a parameter that has a value of its own in each log; None if all are shared.
    """

    logs: tuple[int, ...]
    start: LogRows
    free: int | None = None


@dataclass(frozen=True)
class Decision:
    """Whether some parameter is consistent with all rows of some logs.

    Attributes:
        subset: the logs.
        solved: the working set at the end, with the proof of a contradiction.
        consistent: False where a contradiction is proved, True where a point was found that violates no row, None where neither was.
        model: the parameters, those that are apart included.
    """

    subset: Subset
    solved: Solved
    consistent: bool | None
    model: Model


@dataclass(frozen=True)
class Pooled:
    """The proved hull of the parameters that are consistent with all rows of all logs.

    Attributes:
        solved: bounds, status and certificates.
        rows: the working set that proves them.
        passes: over the logs.
        complete: whether no row of any log was violated at the end; the bounds hold in any case, and may be wider if not.
    """

    solved: Solved
    rows: LogRows
    passes: int
    complete: bool


def pooled(start: LogRows, model: Model, ask: Ask, logs: frozenset[int] | None = None) -> Pooled:
    """The hull of the parameters that are consistent with all rows of some logs.

    Args:
        start: some rows of the logs, to begin with.
        model: parameters and their blocks.
        ask: tries points on the rows of the logs.
        logs: numbers of the logs; None for all.
    """
    rows = start
    for passes in range(PASSES):
        questions, all_ends = [], True
        for k, block in enumerate(model.blocks):
            points, whole = vertices(rows, block, first=k == 0)
            all_ends &= whole
            if len(points):
                questions.append(Question(points, logs, (tuple(block), k == 0)))
        if not all_ends:
            solved = solve(rows, model.terms, model.blocks)
            if solved.empty or not questions:
                return Pooled(solved, rows, passes, solved.empty)
        answers = [a for a in ask(questions) if a.rows.count]
        new = [a.rows for a in answers]
        grown = distinct(joined([rows, *new])) if new else rows
        if grown.count == rows.count:
            # A vertex misses rows of its own basis by rounding, and violates no other.
            kept = all(float(a.amount.max()) <= RESIDUAL for a in answers)
            return Pooled(solve(rows, model.terms, model.blocks), rows, passes + 1, all_ends and kept)
        rows = grown
    return Pooled(solve(rows, model.terms, model.blocks), rows, PASSES, False)


def decide(subsets: Sequence[Subset], model: Model, names: Sequence[str], ask: Ask) -> list[Decision]:
    """For each subset, a proved contradiction or a point that violates no row; all subsets advance together.

    Args:
        subsets: each with at least one log.
        model: parameters and their blocks.
        names: of the logs, by number.
        ask: tries points on the rows of the logs.
    """
    models = [model if s.free is None else model.apart(s.free, s.logs, [names[k] for k in s.logs]) for s in subsets]
    rows = [_spread(s, s.start, len(model.terms)) for s in subsets]
    done: dict[int, Decision] = {}
    for _ in range(PASSES):
        open_, questions = [], []
        for k, subset in enumerate(subsets):
            if k in done:
                continue
            solved = solve(rows[k], models[k].terms, models[k].blocks)
            if solved.empty:
                done[k] = Decision(subset, solved, False, models[k])
            elif solved.status == "not_applicable":
                done[k] = Decision(subset, solved, None, models[k])
            else:
                open_.append((k, solved))
                questions.append(Question(_points(subset, solved.centre, len(model.terms)), frozenset(subset.logs)))
        if not open_:
            break
        for (k, solved), answer in zip(open_, ask(questions), strict=True):
            new = _spread(subsets[k], answer.rows, len(model.terms))
            grown = distinct(joined([rows[k], new])) if new.count else rows[k]
            if grown.count == rows[k].count:
                done[k] = Decision(subsets[k], solved, True if not new.count else None, models[k])
            rows[k] = grown
    for k, subset in enumerate(subsets):
        if k not in done:
            done[k] = Decision(subset, solve(rows[k], models[k].terms, models[k].blocks), None, models[k])
    return [done[k] for k in range(len(subsets))]


def _spread(subset: Subset, rows: LogRows, columns: int) -> LogRows:
    """The rows with a column for each log in place of that of the free parameter."""
    if subset.free is None:
        return rows
    more = len(subset.logs) - 1
    lower, upper = (np.hstack([a[:, :columns], np.zeros((rows.count, more))]) for a in (rows.lower, rows.upper))
    for k, log in enumerate(subset.logs[1:]):
        mine = rows.log == log
        for whole in (lower, upper):
            whole[mine, columns + k] = whole[mine, subset.free]
            whole[mine, subset.free] = 0.0
    return replace(rows, lower=lower, upper=upper)


def _points(subset: Subset, centre: FloatArray, columns: int) -> FloatArray | dict[int, FloatArray]:
    """The point that each log is asked for, shape (1, n)."""
    if subset.free is None:
        return centre[None, :]
    points = {}
    for k, log in enumerate(subset.logs):
        own = centre[:columns].copy()
        own[subset.free] = centre[subset.free if k == 0 else columns + k - 1]
        points[log] = own[None, :]
    return points
