"""A rule: what it measures of a cause, the limit it holds that against, why, and what it says of a cause that it refuses."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

C = TypeVar("C")


@dataclass(frozen=True)
class Refusal:
    """A cause that a rule refused.

    Attributes:
        rule: name of the rule.
        value: of its statistic.
        limit: that the statistic did not keep.
        sentence: with both numbers.
        beside: causes that stood in the model when the rule was asked.
    """

    rule: str
    value: float
    limit: float
    sentence: str
    beside: tuple[str, ...] = ()


@dataclass(frozen=True)
class Rule(Generic[C]):
    """One rule on cases of a kind.

    Attributes:
        name: in results and in the table of the documentation.
        statistic: what is measured, in words.
        bound: the limit in words, with its number where it is one number.
        why: the reason for the rule.
        measured: the source of the limit, or the command that measures it.
        value: the statistic of a case.
        limit: its limit.
        said: what is said of a refused case, with ``{value}``, ``{limit}`` and the attributes of ``{case}``.
        asked: of which cases the rule is asked; of all by default.
        least: whether the statistic has to reach the limit; else it must not exceed it.
    """

    name: str
    statistic: str
    bound: str
    why: str
    measured: str
    value: Callable[[C], float]
    limit: Callable[[C], float]
    said: str
    asked: Callable[[C], bool] = lambda _: True
    least: bool = True

    def refuses(self, case: C, beside: Iterable[str] = ()) -> Refusal | None:
        """The refusal of a case, or None where the rule is kept or not asked.

        Args:
            case: a cause with all that the rule asks of it.
            beside: causes that stand in the model.
        """
        if not self.asked(case):
            return None
        value, limit = self.value(case), self.limit(case)
        # A comparison with "not a number" is false, so that a statistic that does not exist refuses.
        if (value >= limit) if self.least else (value <= limit):
            return None
        return Refusal(self.name, value, limit, self.said.format(value=value, limit=limit, case=case), tuple(beside))


def first_refusal(rules: Iterable[Rule[C]], case: C, beside: Iterable[str] = ()) -> Refusal | None:
    """The refusal by the first rule that a case does not keep, or None if it keeps all."""
    return next((r for r in (rule.refuses(case, beside) for rule in rules) if r is not None), None)
