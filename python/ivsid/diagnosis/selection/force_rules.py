"""Rules of forces in the place of causes: what a cause has to be beyond a force that the catalogue lacks.

Source: docs/theory.md, "Diagnosis"; the table docs/rules.md is made of these objects.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from scipy.special import chdtri

from ivsid.diagnosis.estimation.kinds.candidate import PRICE
from ivsid.diagnosis.null.gradual import CURVED
from ivsid.diagnosis.null.rule import Rule
from ivsid.diagnosis.selection.rivals import MARGIN

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
# Standard deviations by which numbers of two logs have to differ.
# Source: definition: 6e-7 of normal errors lie beyond
SIGMAS: Final = 5.0
# Share by which numbers of two logs that are determined to more digits may differ.
# Source: definition: a tenth; a delay of 0.3 s is determined to a microsecond, and equations and clocks are not as exact
ALIKE: Final = 0.1


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
        logs: on which logs, in words, where it is not one.
    """

    ids: tuple[str, ...]
    fall: float
    numbers: int
    force: str
    alone: float
    one: float = 0.0
    everywhere: bool = False
    logs: str = ""

    @property
    def words(self) -> str:
        """The causes in words."""
        return " and ".join(self.ids)


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
    f"that the catalogue lacks. It is not asked where one of the causes alone explains as much as the force does, to {BENT:.0%}: the force is that cause. "
    "A cause of them whose own force it may be, by the rule of a single one, keeps its name, and the others lose theirs.",
    "definition: 0.3 % of normal errors lie beyond",
    lambda c: c.fall - PRICE * (c.numbers - 1) - c.alone,
    lambda _: MARGIN,
    "{case.words} explain {case.fall:.0f} in chi² together{case.logs}, and one force, {case.force}, explains {case.alone:.0f} in their place: causes "
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
    "{case.words} explain {case.fall:.0f} in chi² together{case.logs}, and one force in rough outline, {case.force}, explains {case.alone:.0f} in their place, where causes of "
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
    "one force, {case.force}, explains {case.alone:.0f} in chi² in its place{case.logs}, where it explains {case.fall:.0f}: by more than {limit:.0f} the force is one "
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


@dataclass(frozen=True)
class Slewed:
    """A cause by which thrusts follow late.

    Attributes:
        fall: of chi-squared by it, fitted in full.
        more: what thrusts whose rate is limited explain beyond it.
    """

    fall: float
    more: float


SLEWED: Final = Rule[Slewed](
    "slewed",
    "fall of chi² by thrusts whose rate is limited, beyond that of a cause by which they follow late, once that is fitted in full",
    f"at most {MARGIN:g}, or {100 * CURVED:g} % of the fall where that is more",
    "A drive that changes its thrust no faster than it can follows a small step at once and a large one late, and is no lag and no delay.",
    "definition: 0.3 % of normal errors lie beyond three standard deviations",
    lambda c: c.more,
    lambda c: max(MARGIN, CURVED * c.fall),
    "thrusts that change no faster than a limit explain {value:.0f} more in chi², and by more than {limit:.0f} they are no thrusts that lag",
    least=False,
)


@dataclass(frozen=True)
class Changed:
    """A cause whose number is another one on the other log.

    Attributes:
        id: of the cause.
        ratio: its number there over that on this log.
        z: standard deviations of the noise by which they differ by more than ``ALIKE``, beyond what errors inside their accuracies explain.
    """

    id: str
    ratio: float
    z: float


SAME_NUMBER: Final = Rule[Changed](
    "same number",
    f"standard deviations by which a thruster's number differs between the logs by more than {ALIKE:.0%}, beyond what thrust curves inside their accuracy and slow forces explain",
    f"at most {SIGMAS:g}",
    "Thrusters are the same in both logs, and so is what is wrong with them: a number that follows the manoeuvre is one of a force that the catalogue lacks. It is "
    "asked where the model leaves nothing on the other log, and of no cause that starts at a time.",
    "definition: 6e-7 of normal errors lie beyond",
    lambda c: c.z,
    lambda _: SIGMAS,
    "on the other log its number is {case.ratio:.2g} times as large, {value:.1f} standard deviations beyond what errors inside their accuracies and rough equations explain, and "
    "{limit:g} is the limit: a cause of the thrusters is the same on both",
    least=False,
)
FORCES: Final = (ONE_FORCE, ROUGH_FORCE, SLOW_FORCE, BETTER_FORCE, BETTER_CURVE, OUTLINE, SLEWED, SAME_NUMBER)
