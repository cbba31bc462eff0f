"""Rules of the verdict: what the structure that a model leaves has to keep for the model to be adequate.

Source: docs/theory.md, "Diagnosis"; the table docs/rules.md is made of these objects.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from ivsid.diagnosis.null.blows import BLOWS
from ivsid.diagnosis.null.levels import STRUCTURE
from ivsid.diagnosis.null.rule import Rule, first_refusal
from ivsid.diagnosis.selection.structure import PARTED, REPEATS, RISK, ROUGHER, SCATTERED, Adequacy

# Share of the excess of the plain model that the right causes may leave. States that the ambient force carries over half a step have less excess in the
# plain model: on a full simulator's log in a current 0.7 of what it was, of which its six right causes leave 0.0204, and left 0.0148;
# 2.5 % of the smaller excess allow 678 there in chi-squared, and 2 % of the larger one allowed 775.
# Source: measured: make constants
REST: Final = 0.025
# Fall of the dictionary over its degrees of freedom above which what a model leaves is louder than noise alone, whether or not noise of few frequencies
# makes as much.
# Source: measured: the examination; beside wrong causes from 1.64 on; of the right ones of more than 80 logs four stood beside more, two of them in swells and one in a slow wind
LOUDER: Final = 1.6


@dataclass(frozen=True)
class Left:
    """The structure that a model leaves.

    Attributes:
        after: adequacy of the model with the causes that were found.
        before: adequacy of the plain model.
        findings: number of causes that were found.
        straight: whether yaw is left out: slow causes imitate one another there, so that no rest is little.
        imitated: falls of chi-squared by causes that passed every test and are no findings: one force of no cause explains as much, or better, or what
            stays unexplained may be most of what they seem to explain.
        wider: factor on all declared bounds from which on some numbers of the plain model explain the rows of the log; at most 1 without a proof that
            none do inside the bounds, and infinite where no factor would do.
    """

    after: Adequacy
    before: Adequacy
    findings: int
    straight: bool = False
    imitated: tuple[float, ...] = ()
    wider: float = 0.0

    @property
    def little(self) -> bool:
        """Whether causes leave less than the share ``REST`` of the structure before, and what a force of no cause explains is less as well."""
        # Regressors see most of what the refused causes explained, so that the two are not added.
        left = max(self.after.unexplained, sum(self.imitated))
        return self.findings > 0 and not self.straight and left < REST * self.before.unexplained

    @property
    def louder(self) -> bool:
        """Whether more is left than noise of all frequencies alone makes, and not little of the structure before."""
        return not self.little and self.after.statistic > LOUDER

    @property
    def sufficient(self) -> bool:
        """Whether the structure is chance, or little beside the structure before, with numbers of hulls."""
        return first_refusal(VERDICT, self) is None


STRUCTURE_RULE: Final = Rule[Left](
    "structure",
    f"chance of the structure, where {100 * REST:g} % or more of the structure before is left, no cause was found or yaw is left out",
    f"at least {RISK:g}, or less where null logs of this programme say so",
    f"Over regressors and thrust errors together, {100 * STRUCTURE:g} % of logs with nothing hidden may be called unknown.",
    "definition: levels of the verdict in docs/constants.md",
    lambda c: c.after.probability,
    lambda c: c.after.risk,
    "the structure that is left has probability {value:.1g}, and {limit:.1g} is the limit",
    lambda c: not c.little,
)
OF_HULLS: Final = Rule[Left](
    "numbers of hulls",
    "numbers that the log asks for and no hull of this mass and length has",
    "0",
    "A model with an absurd mass or a drag that drives is adequate for no vehicle.",
    "definition: limits of hulls in docs/constants.md",
    lambda c: len(c.after.hulls),
    lambda _: 0,
    "{value:.0f} numbers that the log asks for are none that a hull of this mass and length has",
    least=False,
)
OF_THE_SEA: Final = Rule[Left](
    "declared ambient force",
    "ambient acceleration that the log shows at the least, over the declared one with that of thrust errors, on the worst axis",
    f"at most {ROUGHER:g}",
    "The noise is learnt from the log, so that a force outside the catalogue may pass for ambient force, and would hide itself.",
    "make exam",
    lambda c: c.after.roughest,
    lambda _: ROUGHER,
    "the log shows at least {value:.2g} times the declared ambient force, and {limit:g} times are none",
    least=False,
)
OF_READINGS: Final = Rule[Left](
    "stated accuracy",
    "prediction errors of the readings that scatter most, rms at the least, over their stated accuracy",
    f"at most {SCATTERED:g}",
    "The noise is learnt from the log, so that readings that jump in spells may pass for noisy ones, and would hide themselves.",
    "make exam",
    lambda c: c.after.scattered[1],
    lambda _: SCATTERED,
    "readings scatter by at least {value:.2g} times their stated accuracy, and {limit:g} times are none",
    least=False,
)
OF_ONE_ANOTHER: Final = Rule[Left](
    "readings part",
    "change of a heading over 5 to 240 s less what a gyro adds up, or of a position less what velocities do, at the most, over what their stated "
    "accuracies allow",
    f"at most {PARTED:g}",
    "A filter follows a compass that is drawn aside for half a minute, so that its prediction errors are small. No model of the vehicle is asked.",
    "theorem: errors inside their bounds part by 1 at most",
    lambda c: c.after.parted[1],
    lambda _: PARTED,
    "readings that follow from one another part by {value:.2g} times what their stated accuracies allow, and {limit:g} times are none",
    least=False,
)
OF_THE_WAY: Final = Rule[Left](
    "rhythm",
    "chance of a force that repeats with the way through the water, where it stands out twice as far as any that repeats with time, where "
    f"{100 * REST:g} % or more of the structure before is left, no cause was found or yaw is left out",
    f"at least {REPEATS:g}",
    "Vortices come once in some widths of what sheds them, at any speed: over time their spectrum is that of an ambient force, and over the way it is a line.",
    "theorem: docs/theory.md, Rhythms",
    lambda c: c.after.rhythm.chance,
    lambda _: REPEATS,
    "a force that repeats with the way through the water has probability {value:.1g}, and {limit:.1g} is the limit",
    lambda c: not c.little,
)
OF_BLOWS: Final = Rule[Left](
    "blows",
    "the strongest short force that nothing explains, over the declared ambient force beside errors of thrusts and readings at their bounds, or over the "
    f"scatter of most of the log, whichever is less, where {100 * REST:g} % or more of the structure before is left, no cause was found or yaw is left out",
    f"at most {BLOWS:g}",
    "The mean square hardly shows a force that is short and seldom, and no function of the motion follows it. Noise is a sum of many pushes, and hardly ever reaches "
    "six deviations.",
    "make exam",
    lambda c: c.after.blow.times,
    lambda _: BLOWS,
    "a short force that nothing explains is {value:.2g} times the declared ambient force and the scatter of most of the log, and {limit:g} times are none",
    lambda c: not c.little,
    least=False,
)
OF_FORCES: Final = Rule[Left](
    "force of no cause",
    "causes that passed every test and that one force of no cause explains as well, or better, or that do not dominate what is left, where "
    f"{100 * REST:g} % or more of the structure before is left, no cause was found or yaw is left out",
    "0",
    "What passes every test is no chance, however little of it the regressors see. Logs with nothing hidden give such causes as rarely as findings.",
    "definition: levels of the verdict in docs/constants.md",
    lambda c: len(c.imitated),
    lambda _: 0,
    "{value:.0f} causes passed every test and are no findings, since a force of no cause, or what is left, explains as much",
    lambda c: not c.little,
    least=False,
)
OF_ROWS: Final = Rule[Left](
    "rows",
    "factor on all declared bounds from which on some numbers of the model explain the rows of the log, where no cause was found",
    "at most 1",
    "A proof that no numbers explain the log inside the declared bounds stands above all statistics: the model is wrong, or a bound is. In 150 logs "
    "with nothing hidden, whose sensors had normal errors, the factor was 0.27 to 0.57.",
    "theorem: docs/theory.md, The feasible set",
    lambda c: c.wider,
    lambda _: 1.0,
    "all declared bounds would have to be {value:.3g} times as wide for some numbers of the model to explain the rows of the log",
    lambda c: c.findings == 0,
    least=False,
)
VERDICT: Final = (
    STRUCTURE_RULE,
    OF_HULLS,
    OF_THE_SEA,
    OF_READINGS,
    OF_ONE_ANOTHER,
    OF_THE_WAY,
    OF_BLOWS,
    OF_FORCES,
    OF_ROWS,
)
