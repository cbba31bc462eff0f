"""Work on several hypotheses side by side: in a second process where one can be forked, else in threads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.effects import EFFECTS
from ivsid.effects.terms import Term
from ivsid.intervals.apart import forks
from ivsid.intervals.turns import in_turns
from ivsid.memory.pieces import processors

_P = ParamSpec("_P")
_T = TypeVar("_T")


def side_by_side(tasks: Sequence[Callable[[], _T]], models: Callable[[], Iterable[Hypothesis]] = tuple) -> list[_T]:
    """Results of the tasks, in their order.

    The tasks share no state, so results depend neither on processes nor on threads. The floating-point settings of NumPy hold in each.

    Args:
        tasks: fits of hypotheses.
        models: gives those from which they start: their terms and effects have functions, which no process sends, and the results keep them.

    Raises:
        Exception: that of the first task that fails.
    """
    threads = min(len(tasks), processors())
    if threads < 2:
        return [task() for task in tasks]
    if forks():
        return in_turns(tasks, _common(tuple(models())))
    with ThreadPoolExecutor(threads) as pool:
        waiting = [pool.submit(copy_context().run, task) for task in tasks]
        return [w.result() for w in waiting]


def _common(models: Sequence[Hypothesis]) -> list[object]:
    """Effects and terms of the catalogue and of hypotheses, once each."""
    terms: list[Term] = [t for e in EFFECTS.values() for t in e.terms]
    for h in models:
        terms += h.terms
    effects = [*EFFECTS.values(), *(g.effect for h in models for g in h.given)]
    return list({id(one): one for one in (*terms, *effects)}.values())


def one_blas_thread(function: Callable[_P, _T]) -> Callable[_P, _T]:
    """The function with one thread of BLAS.

    Its matrices are small, and its own threads and processes use the cores: threads of BLAS beside them wait for each other most of the time.
    """

    @wraps(function)
    def alone(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return alone
