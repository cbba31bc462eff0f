"""Rules of the full fits: what a cause has to keep after the screening to be found, in the order in which they are asked.

Source: docs/theory.md, "Diagnosis"; the table docs/rules.md is made of these objects.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.round import Round
from ivsid.diagnosis.null.rule import Refusal, Rule
from ivsid.diagnosis.selection.force_rules import FORCES
from ivsid.diagnosis.selection.rivals import FINALISTS, MARGIN, Rival
from ivsid.effects import EFFECTS

# From this number of causes on, another one is added only where it explains enough of the rest.
# Source: measured: make constants
USUAL: Final = 4
# Share of the unexplained chi-squared in its channels that such a cause has to explain.
# Source: measured: make constants
WORTH: Final = 0.5
# Causes at most.
# Source: resource: a review takes a survey for each cause
MOST: Final = 6


@dataclass(frozen=True)
class Late:
    """A cause that passes where several were found already.

    Attributes:
        s: the cause.
        found: number of the causes that were found.
        left: unexplained chi-squared in its channels.
    """

    s: Scored
    found: int
    left: float


@dataclass(frozen=True)
class Place:
    """The rank of a cause that passes among all that do.

    Attributes:
        best: id of the cause with the largest merit.
        rank: place of the cause by merit, from 1.
    """

    best: str
    rank: int


@dataclass(frozen=True)
class Tried:
    """A cause that was fitted in full in the place of another.

    Attributes:
        rival: the cause.
        best: the one that fits best.
        free: lead of the best beside any thrust curve, by the merits of the scores; infinite where the scores do not say.
    """

    rival: Rival
    best: Rival
    free: float = float("inf")

    @property
    def explained(self) -> float:
        """Fall of chi-squared of the cause; none where its fit is worse than without it."""
        return max(self.rival.fall, 0.0)


@dataclass(frozen=True)
class Full:
    """A cause with its full fit.

    Attributes:
        fall: fall of chi-squared in the full fit.
        chance: of that fall; beside the worst declared errors inside their bounds in proportion to the limit there.
        level: threshold of the chance.
    """

    fall: float
    chance: float
    level: float

    @property
    def explained(self) -> float:
        """Fall of chi-squared, or none where other masses and drags are pushed aside for it."""
        return max(self.fall, 0.0)


# Share of the best cause's fall of chi-squared up to which the errors of the equations decide between two causes.
# Source: measured: the examination; a delay of 12.5 ms under readings averaged over 0.1 s was behind a lag of 12 ms by 0.23 %
INEXACT: Final = 5e-3


MOST_RULE: Final = Rule[Late](
    "most",
    "causes that were found already",
    f"below {MOST}",
    "So many causes at once are a model of another vehicle.",
    "resource: a review takes a survey for each cause",
    lambda c: c.found,
    lambda _: MOST - 1,
    "it comes after {value:g} others, and beyond {limit:g} no further cause is looked for",
    least=False,
)
WORTH_RULE: Final = Rule[Late](
    "worth",
    f"share of the unexplained chi² in its channels, where {USUAL} causes or more were found",
    f"at least {WORTH:g}",
    "Beside many causes a further small one fits what an unknown cause leaves.",
    "make constants",
    lambda c: c.s.fall / c.left if c.left > 0 else float("inf"),
    lambda _: WORTH,
    "beside so many causes it explains {value:.0%} of what is left in its channels, and {limit:.0%} count",
    lambda c: c.found >= USUAL,
)
FINALIST: Final = Rule[Place](
    "finalist",
    "rank by merit among the causes that pass",
    f"at most {FINALISTS}",
    "The time of a round grows with its full fits.",
    "resource: the time of a round grows with its full fits",
    lambda c: c.rank,
    lambda _: FINALISTS,
    "by its score it has the rank {value:g} beside {case.best}, and {limit:g} are fitted in full",
    least=False,
)
NUMBERS: Final = Rule[bool](
    "possible numbers",
    "whether the fitted numbers are ones that the cause can have (1 or 0)",
    "1",
    "A drag that drives, a delay of zero, a tide longer than several logs, a swell inside the declared ambient force and a hump of which no flank was sailed stand for another cause.",
    "definition",
    float,
    lambda _: 1.0,
    "fitted in full it has numbers that it cannot have",
)
RIVAL: Final = Rule[Tried](
    "rival",
    "merit behind the best cause, both fitted in full, or by their scores beside any thrust curve where that is less",
    f"at most {MARGIN:g}, or {INEXACT:.1%} of the best cause's fall of chi² where that is more and no outline bends to it",
    "Beyond three standard deviations the log tells the two apart, unless they differ by no more than the errors of the equations, whose steps are "
    "finite, or a thrust curve inside its accuracy makes the difference.",
    "definition: 0.3 % of normal errors lie beyond",
    lambda c: min(c.best.merit - c.rival.merit, c.free),
    lambda c: MARGIN if EFFECTS[c.rival.id].form.rough else max(MARGIN, INEXACT * c.best.fall),
    "fitted in full in the place of {case.best.id} it explains {case.explained:.0f} in chi² against {case.best.fall:.0f}; "
    "within {limit:.0f} it would be a rival",
    least=False,
)
FULL: Final = Rule[Full](
    "full fit",
    "chance of the fall of chi² in a full fit; beside the worst declared errors in proportion to the limit there",
    "at most the calibrated threshold of this log",
    "What the model explains by itself once it is fitted to the end, or beside other causes, needs no cause.",
    "make null-logs",
    lambda c: c.chance,
    lambda c: c.level,
    "fitted in full its fall of chi² of {case.explained:.1f} has probability {value:.1g}, and {limit:.1g} is the limit",
    least=False,
)
SETTLED: Final = Rule[bool](
    "settled",
    "whether a further round leads to a new set of causes (1 or 0)",
    "1",
    "Two sets of causes that take turns would never end.",
    "definition",
    float,
    lambda _: 1.0,
    "a further round leads back to causes that stood in the model before",
)
OWN: Final = Rule[bool](
    "own signature",
    "whether the cause has a signature of its own beside what was found (1 or 0)",
    "1",
    "A cause that the model holds in another form cannot be told from itself.",
    "definition",
    float,
    lambda _: 1.0,
    "it has no signature of its own there",
)
LATE: Final = (MOST_RULE, WORTH_RULE)
FULL_FITS: Final = (
    FINALIST,
    NUMBERS,
    RIVAL,
    FULL,
    OWN,
    SETTLED,
    *FORCES,
)


def full_refused(test: Threshold, s: Scored, fall: float, beside: Sequence[str] = ()) -> Refusal | None:
    """The refusal of a cause by its full fit, or None.

    Args:
        test: of the log.
        s: the score by which the cause came in.
        fall: of chi-squared in the full fit.
        beside: other causes that the model holds.
    """
    return FULL.refuses(Full(fall, test.chance(s, fall), test.level), beside)


def refused_by(rule: Rule[bool], beside: Sequence[str]) -> Refusal:
    """The refusal of a cause that fails a rule of yes or no."""
    refusal = rule.refuses(False, beside)
    assert refusal is not None
    return refusal


def compared(
    best: Rival, tried: Sequence[Rival], beside: Sequence[str], asked: Round | None = None
) -> tuple[tuple[Rival, ...], dict[str, Refusal]]:
    """Causes that the log does not tell from the best, in the given order, and the refusals of the others by id.

    Args:
        best: the cause that fits best.
        tried: causes that were fitted in full in its place, itself among them.
        beside: other causes that the model holds.
        asked: the model without the cause and its scores, where they are held against any thrust curve as well.
    """
    said = {r.id: RIVAL.refuses(Tried(r, best, _free(best, r, asked)), beside) for r in tried}
    return tuple(r for r in tried if said[r.id] is None), {i: q for i, q in said.items() if q is not None}


def _free(best: Rival, rival: Rival, asked: Round | None) -> float:
    """Lead of a cause over another beside any thrust curve; infinite where neither was scored, or both bend the errors, which no score does."""
    if asked is None or rival is best or all(EFFECTS[r.id].form.bends for r in (best, rival)):
        return float("inf")
    scores = {s.id: s for s in asked.scored if s.id in (best.id, rival.id)}
    return asked.free(scores[best.id]) - asked.free(scores[rival.id]) if len(scores) == 2 else float("inf")
