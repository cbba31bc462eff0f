"""What a model leaves in a log: structure that regressors find, declared errors that leave their bounds, and numbers of no hull, with their limits.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.blows import BLOWS, Blow
from ivsid.diagnosis.null.boxed import Leaving
from ivsid.diagnosis.null.leaving import FAR
from ivsid.diagnosis.null.rhythm import Rhythm
from ivsid.diagnosis.selection.hulls import Asked

Array = NDArray[np.float64]
# Probability with which a true model is called insufficient by its regressors, and by its thrust errors, where no null logs are asked.
# Source: definition: a tenth of the 1 % of logs without an effect that may give a finding
RISK: Final = 1e-3
# Probability of the best single fall, over the whole dictionary, from which on no second statistic is asked.
# Source: measured: the examination; the least of 712 logs with nothing hidden was 2e-4, and the tail of the falls is that of theory
ALONE: Final = 1e-5
# Ambient acceleration over the declared one, with that of thrust errors or beyond any of their curves, at the least, that is no declared one any more.
# Source: measured: the examination; sound logs of strangers reached 1.4, by theorem it is 1 beyond three standard errors; a sheared current outside the
# catalogue was 1.63, weed on a bow 1.78, a line that is slack and taut 3.7
ROUGHER: Final = 1.6
# Root mean square of a sensor's prediction errors at the least, in its stated accuracy, that is no stated one any more.
# Source: measured: the examination; 60 sound logs reached 0.4, and a position in multipath 9.1
SCATTERED: Final = 2.0
# What readings part by that follow from one another, over what their stated accuracies allow, that these do not allow any more.
# Source: theorem: errors inside their bounds part by 1 at most; twice that leaves room for noise whose standard deviation alone is stated. Of 75 sound logs
# and 45 with causes in the hull or the water one reached 0.95, and compasses near steel and velocities that were lost and kept were 3.2 to 26
PARTED: Final = 2.0
# Probability of a line over the way from which on it is no more than chance.
# Source: definition: a tenth of the risk of structure
REPEATS: Final = 1e-4


@dataclass(frozen=True)
class Adequacy:
    """Structure in the innovations of a model.

    Attributes:
        fall: fall of chi-squared by the whole dictionary.
        freedom: number of its directions that the model lacks.
        chance: probability of such a fall in white innovations.
        strongest: the three best single regressors with their channels and falls, the best first.
        chance_of_one: probability of the best single fall, over the whole dictionary.
        excess: fall beyond the number of directions, by channel.
        of_now: the same of functions of the moment alone, without memories of the motion.
        leaving: fall of chi-squared where thrust errors may leave their bounds.
        knots: number of values of these errors that may.
        pushed: channel in which the thruster pushes whose error is farthest outside of its bound.
        outside: the thrusts, in words, whose fitted error leaves its bound, with its largest value in bounds.
        elsewhere: name of the other log, where it is that one on which thrust errors leave their bounds; empty where it is not.
        misread: the error of readings that leaves its bound most, by name, with what it gains and the probability of that over all such errors.
        hulls: numbers that the log asks for and that no hull has.
        rougher: ambient acceleration that the log shows at the least, over the declared one with that of thrust errors, by axis.
        beyond_curves: the same beyond any thrust curve inside its accuracy, over the declared one alone; 0 where the log asks for none.
        scattered: channel whose readings scatter most, and by how much at the least, in its stated accuracy.
        parted: channels whose readings follow from one another and part most, and by how much, in what their stated accuracies allow.
        rhythm: the force that repeats with the way through the water which stands out most.
        blow: the strongest short force that comes seldom.
        risk: probability below which structure is more than chance.
        alone: whether the best single fall is so rare that no second statistic is asked.
        shared: name of the other log, where the strongest regressor stands out of both logs together, by that fall; empty where it does not.
        only: name of the other log, where the strongest regressors stand out of that alone; empty where they do not.
        leans: whether past errors or slow forces inside the declared ones had to take structure for no more than chance to be left, so that they may
            have moved the numbers as well.
    """

    fall: float
    freedom: int
    chance: float
    strongest: tuple[tuple[str, str, float], ...]
    chance_of_one: float
    excess: Mapping[str, float]
    of_now: Mapping[str, float] = field(default_factory=dict)
    leaving: float = 0.0
    knots: int = 0
    pushed: str = ""
    outside: tuple[tuple[str, float], ...] = ()
    elsewhere: str = ""
    misread: tuple[str, Leaving, float] | None = None
    hulls: tuple[Asked, ...] = ()
    rougher: tuple[float, ...] = (0.0, 0.0, 0.0)
    beyond_curves: tuple[float, ...] = (0.0, 0.0, 0.0)
    scattered: tuple[str, float] = ("", 0.0)
    parted: tuple[str, float] = ("", 0.0)
    rhythm: Rhythm = field(default_factory=Rhythm)
    blow: Blow = field(default_factory=Blow)
    risk: float = RISK
    alone: bool = False
    shared: str = ""
    only: str = ""
    leans: bool = False

    @property
    def statistic(self) -> float:
        """Fall over its degrees of freedom; about 1 in white innovations."""
        return self.fall / max(self.freedom, 1)

    @property
    def inside(self) -> float:
        """Probability of the log if every thrust error lies inside its bound, at most."""
        return float(chdtrc(self.knots, self.leaving)) if self.knots else 1.0

    @property
    def unexplained(self) -> float:
        """Falls of chi-squared by the dictionary and by declared errors that leave their bounds, beyond their degrees of freedom."""
        more = 0.0 if self.misread is None else max(self.misread[1].fall - self.misread[1].freedom, 0.0)
        return max(self.fall - self.freedom, 0.0) + max(self.leaving - self.knots, 0.0) + more

    @property
    def probability(self) -> float:
        """Probability of the structure: of the regressors or of the declared errors, whichever is smaller."""
        return min(self.of_regressors, self.inside, self.read)

    @property
    def read(self) -> float:
        """Probability of the log if every error of its readings lies inside its bound, at most."""
        return 1.0 if self.misread is None else self.misread[2]

    @property
    def of_regressors(self) -> float:
        """Probability of the regressors' falls, where both statistics are rare; a single one that is rare enough is not lost among a hundred others."""
        return self.chance_of_one if self.alone else max(self.chance, self.chance_of_one)

    @property
    def strength(self) -> float:
        """Minus the natural logarithm of the probability of the structure."""
        return -float(np.log(max(self.probability, 1e-300)))

    @property
    def white(self) -> bool:
        """Whether the innovations hold no more structure than chance."""
        return self.of_regressors >= self.risk

    @property
    def bounded(self) -> bool:
        """Whether the log allows every thrust error inside its bound."""
        return self.inside >= self.risk

    @property
    def sensed(self) -> bool:
        """Whether the log allows every error of its readings inside its bound."""
        return self.read >= self.risk

    @property
    def in_bounds(self) -> bool:
        """Whether the log allows every declared error inside its bound."""
        return self.bounded and self.sensed

    @property
    def roughest(self) -> float:
        """How much rougher the worst axis is than declared."""
        return max(*self.rougher, *self.beyond_curves)

    @property
    def certain(self) -> bool:
        """Whether it is quiet without past errors and slow forces, so that intervals need no room for them."""
        return self.quiet and not self.leans

    @property
    def quiet(self) -> bool:
        """Whether the innovations hold no more structure than chance, with every declared error and the ambient force inside its bound and every number one of hulls."""
        kept = self.roughest <= ROUGHER and self.scattered[1] <= SCATTERED and self.parted[1] <= PARTED
        kept = kept and self.rhythm.chance >= REPEATS and self.blow.times <= BLOWS
        return self.white and self.in_bounds and not self.hulls and kept

    @property
    def strained(self) -> bool:
        """Whether it is quiet though a fitted thrust error is far outside of its bound: the other log has the same thrusters."""
        return self.quiet and max((most for _, most in self.outside), default=0.0) > FAR

    def with_thrusts_of(self, other: Adequacy, name: str) -> Adequacy:
        """The same with the thrust errors of another log of the same model, where that does not allow them inside their bounds.

        Args:
            other: adequacy of the model fitted to that log.
            name: of the log.
        """
        if other.bounded:
            return self
        return replace(
            self,
            leaving=other.leaving,
            knots=other.knots,
            pushed=other.pushed,
            outside=other.outside,
            elsewhere=name,
        )

    def also(self, beside: Adequacy) -> Adequacy:
        """The same with the structure that stands beside more.

        Args:
            beside: the regressors beside more than these stood.
        """
        return replace(
            self,
            fall=beside.fall,
            freedom=beside.freedom,
            chance=beside.chance,
            strongest=beside.strongest,
            chance_of_one=beside.chance_of_one,
            excess=beside.excess,
            of_now=beside.of_now,
            alone=self.alone and beside.chance_of_one <= ALONE,
        )

    def beside(self, fit: Fit, columns: Sequence[int], *, memory: bool = True) -> float:
        """Excess in the channels where a cause acts, weighted by the energy of its signature in each.

        Args:
            fit: of the model.
            columns: of the cause.
            memory: whether what memories of the motion explain counts. Where little is left a cause of the moment may be another one of the moment.
        """
        whole = max(self.fall - self.freedom, 0.0)
        energy = energy_of(fit, columns)
        if not energy.sum() > 0:
            return whole
        by_row = [(self.excess if memory else self.of_now).get(c, whole) for c in fit.noise.predictor.channels]
        return float(energy @ np.array(by_row) / energy.sum())


def energy_of(fit: Fit, columns: Sequence[int]) -> Array:
    """Energy of signatures by row of the innovations, shape (rows,)."""
    rows = len(fit.noise.predictor.labels)
    x = fit.gram.columns(columns)
    return np.asarray((x.reshape(-1, rows, fit.gram.length) ** 2).sum(axis=(0, 2)))
