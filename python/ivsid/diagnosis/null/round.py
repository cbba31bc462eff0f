"""What all causes of one screening share: the fit without them, and what each of them may have to stand beside, made where it is first asked for.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.kinds.step import StepCandidate
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import is_declared, lost
from ivsid.diagnosis.null.beside import Beside
from ivsid.diagnosis.null.boxed import Boxed
from ivsid.diagnosis.null.directions import Directions
from ivsid.diagnosis.null.frequencies import Frequencies
from ivsid.diagnosis.null.gradual import BETTER, NO_FORCES, beside_curves, gradual, most_beyond
from ivsid.diagnosis.null.inside_cells import CLEAR, Cells, inside_cells, settled
from ivsid.diagnosis.null.modulated import modulated_columns
from ivsid.diagnosis.null.own_past import FORETOLD, OwnPast
from ivsid.diagnosis.null.reached import Reached
from ivsid.diagnosis.null.slow_force import SlowForce, slow_force
from ivsid.diagnosis.null.visibility import Visibility

Array = NDArray[np.float64]
# Fall of chi-squared from which on a cause at a thruster is asked for beside errors that keep their bounds, too.
# Source: resource: three standard deviations, and the cells take as long as a survey
ASKED: Final = 9.0
# Fall of chi-squared of a cause beside more cells, from which on it is asked whether still more would leave it.
# Source: definition: five standard deviations; fainter causes are no findings
DOUBTED: Final = 25.0


@dataclass(frozen=True)
class Round(Cells):
    """What all causes of one screening share.

    Attributes:
        fit: of the model without them.
        scored: the scores of all causes.
        chance: threshold of the calibration.
        seen: visibility by id.
    """

    fit: Fit
    scored: Sequence[Scored]
    chance: float
    seen: Mapping[str, Visibility]
    _left: dict[tuple[tuple[object, ...], tuple[float, ...]], float] = field(
        default_factory=dict, repr=False, compare=False
    )
    _gradual: dict[tuple[tuple[object, ...], tuple[float, ...]], float] = field(
        default_factory=dict, repr=False, compare=False
    )
    _beside: dict[tuple[int, int], Directions] = field(default_factory=dict, repr=False, compare=False)

    @cached_property
    def directions(self) -> Directions:
        """Directions of causes beside any thrust curve."""
        return Directions(self.curve)

    @cached_property
    def closer_directions(self) -> Directions:
        """Directions with twice the cells, for faint causes, and with most where errors of the log jump inside the usual ones."""
        return self.finest_directions if self.unsettled else Directions(self.closer)

    @cached_property
    def finest_directions(self) -> Directions:
        """The same with most cells."""
        return Directions(self.finest)

    @cached_property
    def finer_directions(self) -> Directions:
        """The same with more cells."""
        return Directions(self.finer)

    @cached_property
    def frequencies(self) -> Frequencies:
        """The base at the frequencies of the log."""
        return Frequencies(self.fit)

    @cached_property
    def past(self) -> OwnPast:
        """The base beside the log's own past errors."""
        return OwnPast(self.fit)

    @cached_property
    def slow(self) -> SlowForce | None:
        """The base beside slow forces; None beside a strong cause, which they would follow, and where no ambient force is declared."""
        return None if self.strong else slow_force(self.fit)

    @cached_property
    def strong(self) -> bool:
        """Whether a cause stands out of any colour of the noise, which is found first: fainter ones are asked again beside it.

        One that thrust errors inside their bounds may make is never found.
        """
        shown = (s for s in self.scored if s.physical and s.shown >= FORETOLD)
        return any(max(self._left_settled(s), self._boxed_settled(s)) >= FORETOLD for s in shown)

    @cached_property
    def boxed(self) -> Boxed:
        """The errors at the knots inside their bounds."""
        return Boxed(self.fit)

    @cached_property
    def reached(self) -> Reached:
        """What curves inside their accuracy reach of the errors at the knots."""
        return Reached(self.curve)

    @cached_property
    def unsettled(self) -> bool:
        """Whether errors of the log jump inside the usual cells: these leave it more than twice as far from its errors at the knots as twice the cells do.

        Where the ambient force is small beside the accuracy such a jump stands out far, and causes beside the usual cells with it.
        """
        if self._kept > self.chance or self._allows(self.reached):
            return False
        return not settled(self.reached.leaving, Reached(self.closer).leaving)

    @cached_property
    def _settled(self) -> Reached:
        """What curves reach in as many cells as the log asks for."""
        return Reached(self.finest) if self.unsettled else self.reached

    def _allows(self, reached: Reached) -> bool:
        """Whether the log allows the errors at the knots among curves inside their accuracy."""
        return bool(chdtrc(max(reached.knots, 1), reached.leaving) > self.chance)

    @cached_property
    def _kept(self) -> float:
        """Probability of the log if the errors at the knots keep their bounds."""
        return float(chdtrc(max(self.boxed.knots, 1), self.boxed.leaving))

    def left(self, s: Scored) -> float:
        """Fall of chi-squared of a family that no declared error inside its bound can make."""
        asked = (s.id, *s.columns), s.theta
        if asked not in self._left:
            inside = inside_cells(self.fit, s)
            left = (self.finer_directions if inside else self.directions).left(s)
            if inside and left >= DOUBTED and not settled(self.directions.left(s), left):
                # Errors that jump inside these cells, too, may make what is left.
                left = min(left, self.finest_directions.left(s))
            self._left[asked] = left
        return self._left[asked]

    def left_beside(self, s: Scored, other: Beside, *, closer: bool = False) -> float:
        """The same of scores beside something that all causes share: its part and that of declared errors are asked together.

        Args:
            s: a family.
            other: the log's own past errors, or slow forces.
            closer: whether errors may jump in twice as many cells.
        """
        finer = inside_cells(self.fit, s)
        curves = self.closer_directions if closer else self.finer_directions if finer else self.directions
        asked = id(other), id(curves)
        if asked not in self._beside:
            self._beside[asked] = Directions(curves.free.under(other))
        return min(self._beside[asked].left(s), other.fall(s))

    @cached_property
    def _modulated(self) -> tuple[Array, list[int | None]]:
        """Thrusts that fall with the motion or with their heat, whitened, and whose they are."""
        _, x, own = modulated_columns(self.fit)
        return x, own

    def weaker_thrusts(self, s: Scored) -> Array:
        """Thrusts that may fall in the place of a step, its own and all together; none in that of a step that is no thruster's."""
        if not isinstance(s.candidate, StepCandidate) or s.candidate.thruster is None:
            return NO_FORCES
        x, own = self._modulated
        return x[[k in (None, s.candidate.thruster) for k in own]]

    def gradual(self, s: Scored) -> float:
        """What a force that comes gradually explains beyond one that starts at a time, also where thrust errors inside their accuracy explain what they can.

        Errors of a thrust come and go with its demands, and where these change over minutes they are like a gradual force.
        """
        asked = (s.id, *s.columns), s.theta
        if asked not in self._gradual:
            weaker = self.weaker_thrusts(s)
            more = gradual(self.fit, s, weaker) - s.fall
            if more > most_beyond(s):
                # Beside the curves less is left of either, so that they decide only where they reverse it and something is left.
                sudden, slow = beside_curves(self.curve, s, weaker)
                more = slow - sudden if sudden >= max(slow, BETTER) else more
            self._gradual[asked] = more
        return self._gradual[asked]

    def abrupt(self, s: Scored) -> bool:
        """Whether a cause, if it is one that starts at a time, does."""
        return not s.candidate.starts or self.gradual(s) <= most_beyond(s)

    def lingers(self, s: Scored) -> bool:
        """Whether the log does not tell a cause that starts at a time from the same force that comes gradually."""
        return s.candidate.starts and self.gradual(s) > -BETTER

    def faint(self, s: Scored) -> bool:
        """Whether errors inside the usual cells may look like a cause by chance, and no stronger one is found first."""
        if inside_cells(self.fit, s) or self.left(s) >= CLEAR:
            return False
        stronger = (q for q in self.scored if q.physical and q.shown >= CLEAR)
        return not any(self.left(q) >= CLEAR for q in stronger)

    def free(self, s: Scored) -> float:
        """Merit of a family beside any thrust curve inside its accuracy: of an error in each cell of demand, with the bound as its prior."""
        g, at = self.curve.beside(s)
        return replace(s, fall=Projection(g, self.curve.projection.base).solve(at)[1]).merit

    def lost(self, s: Scored, *, closer: bool = False) -> float:
        """Standard deviations of a score that declared errors inside their bounds may make.

        A fall stands beside all of them if the worst of them leaves it, or if it takes what no curve inside its accuracy reaches.

        Args:
            s: a family.
            closer: whether errors may jump in twice as many cells, or in as many as the log asks for.
        """
        reached, boxed = (self._settled, self._boxed_settled(s)) if closer else (self.reached, s.boxed)
        left = max(min(self.closer_directions.left(s) if closer else self.left(s), s.fall), boxed)
        if self._kept <= self.chance:
            left = max(left, min(reached.of(s), s.fall))
        return lost(s.shown, left)

    def in_box(self, s: Scored) -> Scored:
        """A cause with its fall of chi-squared beside errors that keep their bounds.

        Asked are causes that are a declared error beyond its bound, and those at a thruster where the log leaves these errors no curve.
        """
        if not s.physical or s.fall < ASKED:
            return s
        if is_declared(self.fit, s):
            return replace(s, boxed=self.left(s))
        # Values at the knots have room for overshoots, so that they may keep their bounds where no curve does.
        return replace(s, boxed=self._boxed(s, self.reached)) if s.candidate.effect.acts.at_thruster else s

    def _left_settled(self, s: Scored) -> float:
        """Fall of a family that no declared error inside its bound can make, in as many cells as the log asks for."""
        return self.finest_directions.left(s) if self.unsettled else self.left(s)

    def _boxed_settled(self, s: Scored) -> float:
        """Fall of a family beside errors that keep their bounds, in as many cells as the log asks for."""
        return self._boxed(s, self._settled) if self.unsettled and not is_declared(self.fit, s) else s.boxed

    def _boxed(self, s: Scored, reached: Reached) -> float:
        """Fall of a cause at a thruster beside errors that keep their bounds; 0 where the log allows them, and of other causes."""
        return 0.0 if not s.candidate.effect.acts.at_thruster or self._allows(reached) else reached.of(s)

    def blind(self, id_: str) -> bool:
        """Whether a cause's signature is mostly made of the errors of the filtered states."""
        return id_ in self.seen and self.seen[id_].blind
