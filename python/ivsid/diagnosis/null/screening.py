"""Rules of the screening: what a cause has to keep by its score before it is fitted in full.

The rules stand in the order in which they are asked, the quick ones first. The first rule that a cause does not keep is its refusal.

Source: docs/theory.md, "Diagnosis"; the table docs/rules.md is made of these objects.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection, least_length
from ivsid.diagnosis.estimation.roughness import ERRORS
from ivsid.diagnosis.null.gradual import BETTER, CURVED, most_beyond
from ivsid.diagnosis.null.inside_cells import CLEAR
from ivsid.diagnosis.null.own_past import FORETOLD
from ivsid.diagnosis.null.round import Round
from ivsid.diagnosis.null.rule import Rule
from ivsid.diagnosis.null.second_opinion import second_opinion
from ivsid.diagnosis.null.thresholds import HIGH_SIDE
from ivsid.diagnosis.null.visibility import EXCITED, VISIBLE

# Chance that the second opinion may give: its blocks are few, so it is asked for less than the calibrated test.
# Source: measured: make constants
SECOND_OPINION: Final = 5e-3
# A fall of chi-squared from here on is no error of the noise model, and needs no second opinion: its few blocks may disagree because the
# fit is not finished. The largest fall in a hundred turning logs without an effect was 14.
# Source: measured: make constants
BEYOND_DOUBT: Final = 40.0
# The same where axes are left out: the largest fall without an effect was 90 there.
# Source: measured: make constants
BEYOND_DOUBT_AXES_LEFT_OUT: Final = 60.0
# Chance that a fall of chi-squared may have beside the worst declared errors inside their bounds. Errors that are the worst for one cause are not
# for causes of another kind, so that the number of causes, which the calibrated threshold counts, does not count a second time.
# Source: definition: half of the 1 % of logs without an effect that may give a finding
WORST: Final = 5e-3
# A smaller fall of chi-squared is no finding, whatever its chance: below five standard deviations the model of the noise is not trusted, and
# fresh logs without an effect reach 19.
# Source: measured: make null-logs
FAINT: Final = 25.0
# A cause that shows more than this multiple of what its typical size would is unusual.
# Source: definition: sizes are usual within a factor of two either way
UNUSUAL: Final = 2.0
# Below this share of its typical size a cause is smaller than the errors of the equations.
# Source: measured: make constants
NEGLIGIBLE: Final = 0.01
# A cause beyond this multiple of its typical size is not possible.
# Source: measured: make constants
IMPOSSIBLE: Final = 50.0


@dataclass(frozen=True)
class Case:
    """A cause in its round."""

    round: Round
    s: Scored

    @cached_property
    def share(self) -> float:
        """Size of the cause in typical sizes."""
        return self.s.share(self.round.fit.noise.predictor.vehicle.hull.mass)

    @cached_property
    def lost(self) -> float:
        """Standard deviations of the score that declared errors inside their bounds may make."""
        return self.round.lost(self.s)

    @property
    def beside_past(self) -> float:
        """Fall of chi-squared beside the log's own past errors, where it is less: a cause at a thruster keeps the share that its score does."""
        s = self.s
        return s.shown * min(self.round.past.fall(s) / s.fall, 1.0) if s.fall > 0 else 0.0

    @property
    def beside_slow(self) -> float:
        """Fall of chi-squared beside slow forces, in the same way."""
        s, slow = self.s, self.round.slow
        return s.shown * min(slow.fall(s) / s.fall, 1.0) if slow is not None and s.fall > 0 else s.shown

    @cached_property
    def beside_noise(self) -> float:
        """Least fall of chi-squared beside what the rules before ask of: the log's own past errors, for a cause that those may make, and slow forces."""
        past = self.beside_past if self.s.shown < FORETOLD else self.s.shown
        return min(self.s.shown, past, self.beside_slow)

    def beside_all(self, *, closer: bool = False) -> float:
        """Chance of what declared errors inside their bounds leave of the cause beside what the rules before ask of.

        What each of both takes of the score, one after the other, bounds what they take together. Where that is too much they are asked together.

        Args:
            closer: whether errors may jump in twice as many cells.
        """
        s, r = self.s, self.round
        alone = replace(s, lost=r.lost(s, closer=True) if closer else self.lost)
        apart = chance_beside(alone, self.beside_noise)
        if apart <= WORST or chance_beside(alone, s.shown) > WORST:
            return apart
        others = [*([r.past] if s.shown < FORETOLD else []), *([r.slow] if r.slow is not None else [])]
        left = (r.left_beside(s, q, closer=closer) for q in others)
        return max((chance(replace(s, fall=q, boxed=0.0)) for q in left), default=apart)

    @property
    def over_declared(self) -> float:
        """Size of the cause in the declared ambient force, where it is a part of that by its nature; infinite where it is none."""
        given, fit = self.s.candidate.given(self.s.values), self.round.fit
        sea, effect = fit.noise.predictor.vehicle.ambient, given.effect
        numbers = dict(zip((p.part for p in effect.parameters), given.values, strict=True))
        return effect.form.over_declared(numbers, 0.0 if sea is None else sea.force, lambda: fit.signatures.push(given))

    @property
    def least_share(self) -> float:
        """Least size of the cause that the log allows, over the fitted one."""
        s, fit, at = self.s, self.round.fit, list(self.s.columns)
        # Of a fall of nothing, which errors inside their bounds alone let count, no direction is known.
        if len(at) == 1 or s.shown <= ERRORS**2 or not s.fall > 0:
            return 1.0 - ERRORS / float(np.sqrt(s.shown))
        theta, unit = np.array(s.theta), fit.gram.unit[at]
        information = fit.projection.information(at) * np.outer(unit, unit)
        # Errors inside their bounds may make a part of the fall.
        return least_length(theta, information * (s.shown / float(theta @ information @ theta)), ERRORS)

    @property
    def least_beside_blind(self) -> float:
        """Least fall of chi-squared beside a stronger cause that cannot be named in this log; infinite if there is none."""
        fit, s = self.round.fit, self.s
        blind = [q for q in self.round.scored if self.round.blind(q.id) and q.fall > s.fall]
        return min((_beside(fit, s, q) for q in blind), default=float("inf"))

    @property
    def doubtful(self) -> bool:
        """Whether an error of the noise model could make the fall."""
        left_out = self.round.fit.noise.left_out
        return self.s.shown < (BEYOND_DOUBT_AXES_LEFT_OUT if left_out else BEYOND_DOUBT)


def chance(s: Scored) -> float:
    """Probability of a family's fall of chi-squared without the effect, with the fall divided by ``HIGH_SIDE``."""
    return replace(s, fall=s.shown / HIGH_SIDE).chance


def chance_beside(s: Scored, fall: float) -> float:
    """Probability of another fall of the same family, less what declared errors inside their bounds make of the score.

    Where a full fit learns a smaller noise, errors stand out of it as much more as the cause does.
    """
    shown = float(np.sqrt(max(fall, 0.0)))
    scale = max(shown / float(np.sqrt(s.shown)), 1.0) if s.shown > 0 else 1.0
    left = max(shown - s.lost * scale, 0.0) ** 2
    return chance(replace(s, fall=left, boxed=0.0))


def _beside(fit: Fit, s: Scored, other: Scored) -> float:
    """Fall of chi-squared of one family beside another; infinite if the other is not physical, shares columns, or either is a step in time."""
    if not other.physical or s.candidate.starts or other.candidate.starts or set(s.columns) & set(other.columns):
        return float(np.inf)
    return Projection(fit.gram, [*fit.base, *other.columns]).solve(s.columns)[1]


VISIBLE_RULE: Final = Rule[Case](
    "visible",
    "z of the cause at its typical size",
    f"at least {VISIBLE:g} for a faint cause, and 1/{UNUSUAL:g} of the z that any other shows",
    f"A log that would hardly show the usual size shows an unusual size or another cause. Where the cause shows at most {UNUSUAL:g} times what its usual size would, its size is not unusual. "
    "A fall beyond doubt, and causes that are searched, are not asked.",
    "make exam",
    lambda c: c.round.seen[c.s.id].z if c.s.id in c.round.seen else 0.0,
    lambda c: VISIBLE if c.s.shown < FAINT else float(np.sqrt(c.s.shown)) / UNUSUAL,
    "this log does not test it: at its typical size it would stand out by {value:.1f} standard deviations, and {limit:.1f} are needed beside what it shows",
    lambda c: not c.round.blind(c.s.id) and c.s.shown < BEYOND_DOUBT and not c.s.candidate.searched,
)
SIGHTED: Final = Rule[Case](
    "sighted",
    "whether the signature is the motion's and not the sensors' own error (1 or 0)",
    f"1: the signature exceeds its part from errors of the states {EXCITED:g} times",
    "A regressor that is mostly noise is biased, whatever its score.",
    "make constants",
    lambda c: 0.0 if c.round.blind(c.s.id) else 1.0,
    lambda _: 1.0,
    "this log does not test it: its signature is mostly made of the sensors' own errors",
)
PHYSICAL: Final = Rule[Case](
    "physical",
    "whether the sign is one that the cause can have (1 or 0)",
    "1",
    "A drag that drives and a lag that foresees do not exist.",
    "definition",
    lambda c: 1.0 if c.s.physical else 0.0,
    lambda _: 1.0,
    "its sign is one that the cause cannot have",
)
FAINT_RULE: Final = Rule[Case](
    "faint",
    "fall of chi², at a thruster also beside errors that keep their bounds",
    f"at least {FAINT:g}",
    "Below five standard deviations the model of the noise is not trusted, whatever the chance.",
    "make null-logs",
    lambda c: c.s.shown,
    lambda _: FAINT,
    "no more than chance: a fall of chi² of {value:.1f} is less than the {limit:.0f} that count",
)
CHANCE: Final = Rule[Case](
    "chance",
    "chance of the fall of chi² over all values that were searched",
    "at most the calibrated threshold of this log",
    "Over all causes together, 0.5 % of logs with nothing hidden may give a finding.",
    "make null-logs",
    lambda c: chance(c.s),
    lambda c: c.round.chance,
    "no more than chance: its fall of chi² has probability {value:.1g}, and {limit:.1g} is the limit",
    least=False,
)
NEGLIGIBLE_RULE: Final = Rule[Case](
    "negligible",
    "size over the typical size, where the fall is not beyond doubt",
    f"at least {NEGLIGIBLE:g}",
    "A cause far below its usual size is an error of the equations.",
    "make constants",
    lambda c: c.share,
    lambda _: NEGLIGIBLE,
    "its size is {value:.2g} of the usual one, and below {limit:g} it is no more than an error of the equations",
    lambda c: c.s.shown < BEYOND_DOUBT,
)
ABRUPT: Final = Rule[Case](
    "abrupt",
    "fall of chi² by the same force where it comes gradually, beyond that of a start at a time, unless beside any thrust curve inside its accuracy the start is better",
    f"at most {BETTER:g}, or {100 * CURVED:g} % of the fall where that is more",
    "A motor that grows warm, a battery or a growing load changes a force over minutes, and a start at a time somewhere in such a change explains most of it.",
    "definition: 0.3 % of normal errors lie beyond three standard deviations",
    lambda c: c.round.gradual(c.s),
    lambda c: most_beyond(c.s),
    "the same force explains {value:.0f} more in chi² where it comes gradually and not at a time, and by more than {limit:.0f} it is no cause that starts",
    lambda c: c.s.candidate.starts,
    least=False,
)
POSSIBLE: Final = Rule[Case](
    "possible size",
    "size over the typical size",
    f"at most {IMPOSSIBLE:g}",
    "A cause far beyond its usual size stands for another one.",
    "make constants",
    lambda c: c.share,
    lambda _: IMPOSSIBLE,
    "its size is {value:.3g} times the usual one, and beyond {limit:g} times it is none that it can have",
    least=False,
)
BESIDE_BLIND: Final = Rule[Case](
    "beside blind causes",
    "fall of chi² beside a stronger cause that cannot be named in this log",
    f"at least {FAINT:g}",
    "A cause that cannot be named here explains the same and more.",
    "make null-logs",
    lambda c: c.least_beside_blind,
    lambda _: FAINT,
    "a cause that this log cannot name explains the same and more: {value:.1f} of its fall of chi² are left beside it, and {limit:.0f} count",
)
OPINION: Final = Rule[Case](
    "second opinion",
    "chance by the scatter of half-minutes, where the fall is not beyond doubt",
    f"at most {SECOND_OPINION:g}",
    "An error of the noise model shows in some half-minutes, a cause in most.",
    "make constants",
    lambda c: second_opinion(c.round.fit, c.s),
    lambda _: SECOND_OPINION,
    "the half-minutes of the log do not agree on it: by their scatter it has probability {value:.1g}, and {limit:.1g} is the limit",
    lambda c: c.doubtful,
    least=False,
)
FREQUENCIES: Final = Rule[Case](
    "own frequencies",
    "chance of the fall of chi² over the strength of the noise at the frequencies of the cause, as an estimate",
    "at most the calibrated threshold of this log",
    "An ambient force may have any spectrum: a band of a swell, or gusts that last longer than the filters expect. What the log holds beside the "
    "cause at the same frequencies makes such falls by itself, and a few frequencies tell little of it.",
    "make exam",
    lambda c: chance(replace(c.s, fall=c.round.frequencies.strength(c.s).beside(c.s.shown, c.s.count), boxed=0.0)),
    lambda c: c.round.chance,
    "the log holds as much at the same frequencies without it: beside that its fall of chi² has probability {value:.1g}, and {limit:.1g} is the limit",
    least=False,
)
OWN_PAST: Final = Rule[Case](
    "own past",
    f"chance of the fall of chi² beside the log's own past errors, where the fall is below {FORETOLD:g}",
    "at most the calibrated threshold of this log",
    "States answer to past errors, so that the signature of a delay, a lag or a drag is partly a filter of them. Where the noise has a colour that the "
    "whitening leaves, such a cause stands for it.",
    "make exam",
    lambda c: chance(replace(c.s, fall=c.beside_past, boxed=0.0)),
    lambda c: c.round.chance,
    "past errors of the log explain it as well: beside them its fall of chi² has probability {value:.1g}, and {limit:.1g} is the limit",
    lambda c: c.s.shown < FORETOLD,
    least=False,
)
MINUTES: Final = Rule[Case](
    "minutes",
    f"chance of the fall of chi² beside slow forces inside the declared ambient force, where all falls that thrust errors may not make are below {FORETOLD:g}",
    "at most the calibrated threshold of this log",
    "An ambient force may have any spectrum, that of minutes as well: over a log it looks like a wind, a drag that grows or a battery that runs down.",
    "make exam",
    lambda c: chance(replace(c.s, fall=c.beside_slow, boxed=0.0)),
    lambda c: c.round.chance,
    "an ambient force inside the declared one that changes over minutes, or hardly, explains it as well: beside that its fall of chi² has probability "
    "{value:.1g}, and {limit:.1g} is the limit",
    lambda c: c.round.slow is not None,
    least=False,
)
DECLARED_SEA: Final = Rule[Case](
    "declared sea",
    "rms of a swell, or of what a current that moves to and fro does to the hull, at the least, over the declared ambient force",
    "at least 1",
    "An ambient force may have any spectrum, that of a single line as well: a regular force inside [ambient] is what the vehicle file declares.",
    "definition: 0.13 % of normal estimates lie three standard errors or more above the truth, in the direction in which the log knows it least",
    lambda c: c.over_declared * c.least_share,
    lambda _: 1.0,
    "the rms of its force is at least {value:.2g} of the ambient force that the vehicle file declares, and below {limit:g} it is a part of that",
    lambda c: c.over_declared < float("inf"),
)
ANY_CURVE: Final = Rule[Case](
    "any curve",
    "chance of the fall of chi² that no declared error inside its bound can make, beside the log's own past errors and slow forces",
    f"at most {WORST:g}",
    "Any thrust curve inside the stated accuracy is possible, and it acts together with what the log holds without a cause. Errors that are the worst for one "
    "cause are not for causes of another kind, so that their number does not count again.",
    "theorem: docs/theory.md, Any thrust curve inside its accuracy",
    lambda c: c.beside_all(),
    lambda _: WORST,
    "errors inside the stated accuracies may explain it: beside the worst of them its fall of chi² has probability {value:.1g}, "
    "and {limit:.1g} is the limit",
    least=False,
)
CLOSER_CURVE: Final = Rule[Case](
    "closer curve",
    f"the same beside errors that jump in twice as many cells of demand, of a cause of which less than {CLEAR:g} in chi² is left; in six times as many, of any cause, "
    "where errors of the log jump inside the usual ones",
    f"at most {WORST:g}",
    "Errors that jump inside a cell are no constant share of their bound there. Many cells hold many such errors, and some look like any faint cause a little.",
    "definition: the limit of any curve",
    lambda c: c.beside_all(closer=True),
    lambda _: WORST,
    "errors inside the stated accuracies that jump more often may explain it: beside the worst of them its fall of chi² has probability {value:.1g}, "
    "and {limit:.1g} is the limit",
    lambda c: c.round.faint(c.s) or c.round.unsettled,
    least=False,
)
SCREENING: Final = (
    VISIBLE_RULE,
    SIGHTED,
    PHYSICAL,
    FAINT_RULE,
    CHANCE,
    NEGLIGIBLE_RULE,
    ABRUPT,
    POSSIBLE,
    BESIDE_BLIND,
    OPINION,
    FREQUENCIES,
    OWN_PAST,
    MINUTES,
    DECLARED_SEA,
    ANY_CURVE,
    CLOSER_CURVE,
)
# Rules on what the log holds without a cause: beside that a full fit explains no more than a score does.
IMITATED: Final = (FREQUENCIES, OWN_PAST, MINUTES)
