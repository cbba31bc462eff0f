"""Rules of the findings: what a cause that the extended model holds has to keep to be named.

Source: docs/theory.md, "Diagnosis"; the table docs/rules.md is made of these objects.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import copysign, isfinite
from typing import Final

from ivsid.diagnosis.candidates.intervals import Bound
from ivsid.diagnosis.null.leaving import FAR
from ivsid.diagnosis.null.rule import Rule
from ivsid.diagnosis.null.screening import FAINT
from ivsid.diagnosis.null.visibility import VISIBLE
from ivsid.effects import Effect

# A cause is named only if its fall exceeds this multiple of the unexplained chi-squared, where unexplained structure is left.
# Source: measured: make constants
DOMINANT: Final = 9.0
# The same in its channels, where noise of few frequencies may make what is left, or weaker causes are refused that passed every test.
# Source: measured: the examination; right causes in swells and slow winds exceeded it 4.3 to 45 times, a crew that walks and a backlash 1.3 and 1.7 times
BESIDE_NOISE: Final = 3.0
# Alternatives that a finding names.
# Source: resource: the length of a list in the report
ALTERNATIVES: Final = 4
# Standard deviations beyond the worst declared errors inside their bounds from which on a cause is there, whatever its interval.
# Source: definition: five, as without declared errors
TOLD: Final = 5.0


@dataclass(frozen=True)
class Held:
    """A cause that the extended model holds.

    Attributes:
        effect: the cause.
        fall: of chi-squared against the model without it.
        left: unexplained chi-squared, in its channels alone where little is left, and ``FAINT`` and what causes explain that passed every test and are none
            at the least where more is, and what refused causes take that are weaker.
        parameters: its intervals.
        complete: whether little enough structure is left for a verdict.
        quiet: whether no structure is left.
        hulls: numbers that the extended model would need and no hull has.
        parts: whether it parts a number that the model has for two axes.
        boxed: whether its evidence is that declared errors would have to leave their bounds, of which its interval knows nothing.
        beside: standard deviations by which its score stands out of the worst declared errors inside their bounds.
        outside: largest error of a thrust beside it, in its bounds.
        louder: whether more is left than noise of all frequencies alone makes, though noise of few of them may make as much.
        refused: fall of weaker causes that passed every test and are refused.
        varying: fall of chi-squared by a change of the thrust of its own thrusters, among what is left most.
    """

    effect: Effect
    fall: float
    left: float
    parameters: Mapping[str, Bound]
    complete: bool
    quiet: bool
    hulls: int = 0
    parts: bool = False
    boxed: bool = False
    beside: float = 0.0
    outside: float = 0.0
    louder: bool = False
    refused: float = 0.0
    varying: float = 0.0

    @property
    def there(self) -> bool:
        """Whether its only number, or a sum of its sizes, is none beside no declared errors inside their bounds.

        Chi-squared is minimised over all of them together there. The interval takes the worst of them for the number and not for the log, and is wider.
        """
        if len(self.effect.parameters) == 1:
            return self.beside >= TOLD
        return len(self._sizes) > 1 and self.beside >= VISIBLE

    @property
    def least(self) -> float:
        """The least fall that names it, over what is left."""
        if not self.complete:
            return DOMINANT
        return BESIDE_NOISE if self.louder or self.refused else 1.0

    @property
    def distance(self) -> float:
        """Largest distance of "no effect" from the intervals of the sizes, or of an only one and the shape beside it, in half-widths beyond their ends."""
        # Of one thruster a number has a name of its own.
        parts = self.effect.parts if len(self.effect.parts) > 1 else tuple(self.parameters)[:1]
        numbers = dict(zip(parts, self.effect.parameters, strict=True))
        # A time alone is no sign: a step of any size has one.
        asked = self._sizes
        if len(numbers) == 1:
            asked = tuple(numbers)
        elif len(asked) == 1:
            asked = tuple(n for n, p in numbers.items() if p.draw in ("size", "fixed"))
        if not asked or any(name not in self.parameters for name in asked):
            return float("inf")
        return max(self._beyond(self.parameters[name], numbers[name].none) for name in asked)

    @property
    def _sizes(self) -> tuple[str, ...]:
        """Names of its sizes; the components of a vector are sizes, and those of a place beside one are none."""
        drawn = [p.draw for p in self.effect.parameters]
        told = ("size",) if "size" in drawn else ("north", "east")
        return tuple(n for n, draw in zip(self.effect.parts, drawn, strict=True) if draw in told)

    def _beyond(self, bound: Bound, none: float) -> float:
        said = bound.lower, bound.upper
        # What is unknown widens every interval; here it is asked whether the cause is there beside it.
        lower, upper = said if self.quiet else bound.within or said
        beyond = max(lower - none, none - upper)
        # An interval without an end has no half-width, and may have "no effect" beyond its other end all the same.
        return (
            beyond / max(0.5 * (upper - lower), 1e-300)
            if isfinite(upper - lower)
            else copysign(float(beyond != 0.0), beyond)
        )


DOMINANT_RULE: Final = Rule[Held](
    "dominant",
    "fall of chi² over the unexplained chi² and what weaker causes take that are refused, where structure is left, more than noise of all frequencies "
    "alone makes, or a weaker cause is refused; what causes explain that passed every test and that one force beats is unexplained at the least",
    f"at least {DOMINANT:g}, with {FAINT:g} unexplained at the least, or in its channels {BESIDE_NOISE:g} where noise of few frequencies may make it or a weaker cause is refused that "
    "passed every test, and 1 where little is left",
    "What no cause explains may be most of what this cause seems to explain, and several wrong causes imitate what no single one does. A force beyond the "
    "declared one that passes for noise leaves no structure, and makes causes as well. Noise of few "
    "frequencies may be what is left, and may as well be the rest of another cause.",
    "make constants",
    lambda c: c.fall / c.left if c.left > 0 else float("inf"),
    lambda c: c.least,
    "its fall of chi² is {value:.2g} times what stays unexplained, and {limit:g} times count",
    lambda c: not c.quiet or c.louder or not c.complete or c.refused > 0.0,
)
EXCLUDES: Final = Rule[Held](
    "excludes no effect",
    "distance of the value without effect from the intervals of the sizes, or of an only one and the shape beside it, in half-widths, the largest",
    "above 0",
    "Numbers that may all be none name nothing. A size that may be none with a shape that is told, as of a hump at a certain speed, does. Where structure is left, the interval is the one beside it, without what hides in it. A cause that stands "
    "out of declared errors inside their bounds, and not out of their priors, has its interval from the priors alone, and is not asked. Nor is one with a single number that "
    f"stands {TOLD:g} standard deviations out of the worst of them, or one of several sizes that does by {VISIBLE:g}, since a sum of them may be told where "
    "none of them is: its interval takes those that move the number most, whether the log allows them or not.",
    "definition",
    lambda c: c.distance,
    lambda _: 5e-324,
    "its interval holds the value without effect",
    lambda c: not (c.quiet and (c.boxed or c.there)),
)
UNNAMED: Final = Rule[int](
    "alternative",
    "rank among the causes that a log does not tell from a finding",
    f"at most {ALTERNATIVES}",
    "A set of more causes helps nobody.",
    "resource: the length of a list in the report",
    float,
    lambda _: ALTERNATIVES,
    "the log does not tell it from the finding, whose set names {limit:g} others that fit as well or better",
    least=False,
)
HULLS: Final = Rule[Held](
    "hulls",
    "numbers of the extended model that the log asks for and no hull of this mass and length has",
    "0",
    "A cause beside an absurd mass or a drag that drives is named by a model of no vehicle.",
    "definition: limits of hulls in docs/constants.md",
    lambda c: c.hulls,
    lambda _: 0,
    "{value:.0f} numbers of the model that it stands in are none that a hull of this mass and length has",
    least=False,
)
PARTED: Final = Rule[Held](
    "parted number",
    "whether it parts a number that the model has for two axes in two, where more structure is left than a verdict allows",
    "no",
    "The number of one axis is told from that of the other, which what stays unexplained may have moved: a wrong thrust curve moves the drag ahead alone.",
    "definition",
    lambda c: float(c.parts),
    lambda _: 0.0,
    "it is told from the number of another axis, which what stays unexplained may have moved",
    lambda c: not c.complete,
    least=False,
)
BOUNDS_KEPT: Final = Rule[Held](
    "errors inside their bounds beside it",
    "largest error of a thrust in the extended model, as a multiple of its bound",
    f"at most {FAR:g}",
    "A cause whose evidence is that thrust errors would have to leave their bounds explains it only where they keep them beside it: what still lies outside is "
    "a curve that the cause is not. A cause whose own fall counts beside the priors of these errors is not asked.",
    "measured: the examination; true asymmetries and gains left 1.1, two waves of three times the accuracy 2.4",
    lambda c: c.outside,
    lambda _: FAR,
    "an error of a thrust stays {value:.2g} times its bound beside it, and {limit:g} is the most that counts as inside",
    lambda c: c.boxed and c.fall < FAINT,
    least=False,
)
VARYING: Final = Rule[Held](
    "steady thrust",
    "fall of chi² by a thrust of the cause's own thrusters that falls with the speed, its heat or another's wash, among the three strongest regressors of what "
    "is left, where more structure is left than a verdict allows",
    f"at most {FAINT:g}",
    "A cause says how a thrust differs from its curve. A thrust that goes on changing beside it differs in another way: weed that winds on a screw and off again is a failure "
    "at the time of the first turn.",
    "definition: a fall of chi-squared that counts",
    lambda c: c.varying,
    lambda _: FAINT,
    "the thrust goes on changing beside it: {value:.0f} in chi², and {limit:g} is the most",
    lambda c: not c.complete,
    least=False,
)
HELD: Final = (HULLS, PARTED, VARYING, DOMINANT_RULE, EXCLUDES, BOUNDS_KEPT)
