"""Rules of the full fits: what a cause has to keep after the screening to be found, in the order in which they are asked.

Source: docs/theory.md, "Diagnosis"; the table docs/rules.md is made of these objects.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from scipy.special import chdtri

from ivsid.diagnosis.estimation.kinds.candidate import PRICE, Scored
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.gradual import CURVED
from ivsid.diagnosis.null.round import Round
from ivsid.diagnosis.null.rule import Refusal, Rule
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
# Share of a cause's fall of chi-squared by which a force may beat it and still be the cause's own.
# Source: measured: make exam
MORE: Final = 0.25
# Chance with which a function of a velocity may beat the true cause.
# Source: definition: a tenth of the level of a whole verdict
SHAPES: Final = 1e-3
# Share of the fall of chi-squared, by all causes over a velocity, by which a function of it may beat one of them and still be the cause's own.
# Source: measured: beside true drags it is at most 0.012 for falls above 1000, beside humps of the wave resistance 0.04 and more
BENT: Final = 0.02
# Share of what several causes explain that a force explains of which a rough outline is known, and of what that does, that one of them may explain.
# Source: definition: four fifths; the rest is the outline's
OUTLINED: Final = 0.8


@dataclass(frozen=True)
class Together:
    """Several causes whose sum one force may be.

    Attributes:
        ids: of the causes.
        fall: of chi-squared by all of them together.
        numbers: that they have.
        force: name of the single regressor that explains most in their place.
        alone: fall of chi-squared by it.
        one: fall of chi-squared by the best column of the causes in the place of all.
        everywhere: whether the force has all the channels in which it would act.
    """

    ids: tuple[str, ...]
    fall: float
    numbers: int
    force: str
    alone: float
    one: float = 0.0
    everywhere: bool = False

    @property
    def words(self) -> str:
        """The causes in words."""
        return " and ".join(self.ids)


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


@dataclass(frozen=True)
class Curve(Together):
    """Causes whose sum any function of one velocity may be.

    Attributes:
        directions: numbers of the function that the log determines.
        whole: fall of chi-squared by all causes over that velocity together.
    """

    directions: int = 0
    whole: float = 0.0


ONE_FORCE: Final = Rule[Together](
    "one force",
    "merit of several linear causes together over that of the best single force of no cause in their place",
    f"at least {MARGIN:g}",
    "Causes of independent origin that have the very sizes with which they add up to one simple force would be a coincidence: the force is one "
    f"that the catalogue lacks. It is not asked where one of the causes alone explains as much as the force does, to {BENT:.0%}: the force is that cause.",
    "definition: 0.3 % of normal errors lie beyond",
    lambda c: c.fall - PRICE * (c.numbers - 1) - c.alone,
    lambda _: MARGIN,
    "{case.words} explain {case.fall:.0f} in chi² together, and one force, {case.force}, explains {case.alone:.0f} in their place: causes "
    "of their own would together explain {limit:.0f} more than it",
    lambda c: c.alone > c.one + max(MARGIN, BENT * c.one),
)
ROUGH_FORCE: Final = Rule[Together](
    "rough force",
    "fall of chi² of several linear causes together over that of a force in their place whose shape is known in rough outline alone",
    f"at least {1 / OUTLINED:.2f}",
    "How a thrust falls with the speed or with its heat differs from thruster to thruster, so that two causes follow it closer than a rough outline does. It is not "
    f"asked where one of the causes alone explains more than {OUTLINED:.0%} of what the outline does.",
    "measured: the examination; of a thruster that lost up to 30 % with the speed two causes explained 1509, and the square of the speed 1246",
    lambda c: c.fall / max(c.alone, 1e-300),
    lambda _: 1.0 / OUTLINED,
    "{case.words} explain {case.fall:.0f} in chi² together, and one force in rough outline, {case.force}, explains {case.alone:.0f} in their place, where causes of "
    "their own would explain {limit:.2g} times as much",
    lambda c: c.one < OUTLINED * c.alone,
)


@dataclass(frozen=True)
class Slow:
    """A cause that one force explains as well or better, beside slow forces.

    Attributes:
        chance: of its fall of chi-squared there.
        level: threshold of the log.
    """

    chance: float
    level: float


SLOW_FORCE: Final = Rule[Slow](
    "slow force",
    "chance of the fall of chi² of a cause that one force explains as well, beside slow forces inside the declared ambient force",
    "at most the calibrated threshold of this log",
    "An ambient force may have any spectrum, that of minutes as well, and single forces of the time or the heading are such a one first: the log holds no force "
    "that the catalogue lacks, and no cause.",
    "theorem: docs/theory.md, Slow forces",
    lambda c: c.chance,
    lambda c: c.level,
    "an ambient force inside the declared one that changes over minutes explains it as well: beside that its fall of chi² has probability {value:.1g}, and "
    "{limit:.1g} is the limit",
    least=False,
)
BETTER_FORCE: Final = Rule[Together](
    "better force",
    "merit of the best single force of no cause over that of a linear cause in whose place it stands",
    f"at most {MARGIN:g}, or {MORE:g} of the cause's own fall of chi² where that is more; {CURVED:g} of it beside a force or a reading that has all its channels",
    "The dictionary holds the simple forces of the catalogue, too: one that explains more than the cause is one that the catalogue lacks. "
    "The cause's own force, in one channel and of the measured motion, explains about as much.",
    "definition: 0.3 % of normal errors lie beyond",
    lambda c: c.alone - (c.fall - PRICE * (c.numbers - 1)),
    lambda c: max(MARGIN, (CURVED if c.everywhere else MORE) * c.fall),
    "one force, {case.force}, explains {case.alone:.0f} in chi² in its place, where it explains {case.fall:.0f}: by more than {limit:.0f} the force is one "
    "that the catalogue lacks",
    least=False,
)
BETTER_CURVE: Final = Rule[Curve](
    "better curve",
    "merit of any function of one velocity over that of linear causes in whose place it stands",
    f"at most the fall of chi² that its further numbers exceed by chance once in {1 / SHAPES:.0f}, or {BENT:g} of the fall by all causes over that velocity where that is more",
    "A force that goes with one velocity and has another shape than the causes is one that the catalogue lacks: a hump of the wave resistance "
    "stands out as a linear, a dry or a cubic drag.",
    "theorem: chi-squared of the further numbers",
    lambda c: c.alone - c.fall,
    lambda c: max(float(chdtri(max(c.directions - c.numbers, 1), SHAPES)), BENT * max(c.fall, c.whole)),
    "{case.force} explains {case.alone:.0f} in chi² in its place, where it explains {case.fall:.0f}: by more than {limit:.0f} the shape is one that the "
    "catalogue lacks",
    least=False,
)


@dataclass(frozen=True)
class Remainder:
    """A cause beside another one whose curve over the same velocity is known in rough outline.

    Attributes:
        fall: of chi-squared by the cause.
        rough: id of the other.
        whole: fall of chi-squared by the other.
    """

    fall: float
    rough: str
    whole: float


OUTLINE: Final = Rule[Remainder](
    "outline",
    "fall of chi² of a function of one velocity over that of a hump of the same velocity beside it",
    f"at least {BENT:g}",
    "Humps differ in shape from hull to hull, so that a small function of the same velocity beside one is what its shape leaves.",
    "make exam",
    lambda c: c.fall / c.whole,
    lambda _: BENT,
    "it explains {value:.2%} of what {case.rough} explains over the same velocity, whose shape is known to {limit:.0%}",
)
LATE: Final = (MOST_RULE, WORTH_RULE)
FULL_FITS: Final = (
    FINALIST,
    NUMBERS,
    RIVAL,
    FULL,
    OWN,
    SETTLED,
    ONE_FORCE,
    ROUGH_FORCE,
    SLOW_FORCE,
    BETTER_FORCE,
    BETTER_CURVE,
    OUTLINE,
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
