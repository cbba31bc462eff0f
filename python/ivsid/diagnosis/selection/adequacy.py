"""Adequacy of a model: the structure that a generic dictionary of regressors finds in its innovations.

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.any_curve import AnyCurve, beyond
from ivsid.diagnosis.null.beyond_curves import rougher_beyond
from ivsid.diagnosis.null.blows import BLOWS, Blow, blow
from ivsid.diagnosis.null.boxed import Leaving, outside
from ivsid.diagnosis.null.frequencies import Scatter, Spectrum, excess, spectrum
from ivsid.diagnosis.null.inside_cells import SETTLED
from ivsid.diagnosis.null.leaving import FAR, Others, misread_of, thrusts
from ivsid.diagnosis.null.own_past import FORETOLD
from ivsid.diagnosis.null.rhythm import Rhythm, rhythm
from ivsid.diagnosis.null.slow_force import SlowForce
from ivsid.diagnosis.plant.usual_hull import hull_length
from ivsid.diagnosis.selection.dictionary import MEMORY, Regressors, regressors
from ivsid.diagnosis.selection.hulls import Asked, asked_of_hulls
from ivsid.diagnosis.selection.standing import Standing
from ivsid.effects import CHANNELS

Array = NDArray[np.float64]
# Structure beside any thrust curve, with the cross-products, least squares and regressors that it is of, and the worst of declared errors there.
_Beside: TypeAlias = "tuple[Adequacy, Gram, Projection, range, Callable[[Array], Array]]"
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
# Fall of a single regressor beside slow forces from which on it is no scatter of the noise above their frequencies.
# Source: measured: the examination; sound logs in waves of half a minute had 52 at most, and the scatter takes four fifths of it
LOUD: Final = 100.0
# Eigenvalues of the correlation matrix below this belong to directions that other regressors explain to one per cent of their length.
# Source: measured: make constants
DEPENDENT: Final = 1e-4


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


def adequacy(fit: Fit, *, turning: bool = False, known: Regressors | None = None) -> Adequacy:
    """Adequacy of a fitted model; structure that is more than chance has to stand beside any thrust curve inside its accuracy.

    Args:
        fit: of the model.
        turning: whether functions of the yaw rate are structure where yaw is left out, as gusts that turn the hull may make them.
        known: the dictionary's regressors of the fit, where they were made before.
    """
    names, x, unit = known or regressors(fit, turning=turning)
    # The model's own columns stand beside the dictionary, and those of the causes do not.
    g = fit.gram.only(fit.base)
    first = len(g.names)
    wide = g.joined(names, x, unit)
    own, at = Projection(wide, range(first)), range(first, len(wide.names))
    found = _structure(own, at, names, _none)
    noise: Spectrum | None = None
    if not found.white:
        # An ambient force of another spectrum than the whitening knows scatters the scores as well.
        noise = spectrum(fit, wide)
        found = _structure(own, at, names, _none, excess(fit, own, at, noise))
    found = replace(found, alone=found.chance_of_one <= ALONE)
    others = Others(fit)
    left, knots, bare = thrusts(others)
    misread, bare_misread = misread_of(others) or (None, None)
    far = outside(fit)
    words = {t.name: t.words for t in fit.noise.predictor.vehicle.thrusters}
    hulls = asked_of_hulls(others)
    rougher, beyond_curves = fit.noise.rougher, (0.0, 0.0, 0.0)
    if max(rougher) <= ROUGHER < max(fit.noise.alone[0] + fit.noise.alone[1]):
        # What thrust errors allow may hide a force of the time, which no thrust curve makes.
        beyond_curves = rougher_beyond(others.curve, ROUGHER)
    found = replace(
        found,
        leaving=left,
        knots=knots,
        pushed=_pushed(fit, far),
        outside=tuple((words[name], most) for name, most in far),
        misread=misread,
        hulls=hulls,
        rougher=rougher,
        beyond_curves=beyond_curves,
        scattered=max(fit.noise.scatter.items(), key=lambda q: q[1], default=("", 0.0)),
        parted=max(fit.noise.parted.items(), key=lambda q: q[1], default=("", 0.0)),
        rhythm=rhythm(fit),
        blow=blow(others),
    )

    def beside_curves(free: AnyCurve) -> _Beside:
        wide = free.g.joined(names, x.reshape(len(x), *free.g.y.shape), unit)
        own, at = Projection(wide, free.projection.base), range(len(free.g.names), len(wide.names))
        scatter = excess(fit, own, at, spectrum(fit, wide) if noise is None else noise)
        return found.also(_structure(own, at, names, free.worst, scatter)), wide, own, at, free.worst

    worst: Callable[[Array], Array] = _none
    if not found.white:
        found, wide, own, at, worst = _resolved(others, found, beside_curves)
    leans = not found.white or not replace(found, leaving=bare, misread=bare_misread).in_bounds
    for other in others.beside():
        # A regressor that stands for coefficients that the whitening lacks has no more to say than past errors do, and one of minutes no more than
        # a slow force.
        if found.white or found.strongest[0][2] >= FORETOLD:
            break
        less = Projection(other.beside(wide), own.base)
        beside = found.also(_structure(less, at, names, worst))
        loud = not beside.white and beside.strongest[0][2] >= LOUD
        if not beside.white and not loud and (colour := other.spectrum(wide)) is not None:
            beside = found.also(_structure(less, at, names, worst, excess(fit, own, at, colour)))
        found = max(found, beside, key=lambda q: q.of_regressors)
        if loud and isinstance(other, SlowForce):
            # A wave that joins slow forces may follow what is no noise.
            break
    return replace(found, leans=leans)


def _resolved(others: Others, bare: Adequacy, beside: Callable[[AnyCurve], _Beside]) -> _Beside:
    """Structure beside any thrust curve in the usual cells, or in most where twice as many leave less than half of it: it is of errors that jump inside cells.

    Args:
        others: with the curves.
        bare: structure beside none.
        beside: structure beside curves.
    """
    usual = beside(others.curve)
    before, now = (q.strongest[0][2] for q in (bare, usual[0]))
    # Where the usual cells take little, more of them do.
    if usual[0].white or now >= SETTLED * before:
        return usual
    return beside(others.finest) if beside(others.closer)[0].strongest[0][2] < SETTLED * now else usual


def _pushed(fit: Fit, far: Sequence[tuple[str, float]]) -> str:
    """Channel in which the thruster pushes whose error is farthest outside of its bound; empty if none is."""
    if not far:
        return ""
    worst = max(far, key=lambda q: q[1])[0]
    vehicle = fit.noise.predictor.vehicle
    k = [t.name for t in vehicle.thrusters].index(worst)
    c, s = (x[k] for x in fit.noise.predictor.driving.swing)
    x, y = vehicle.thrusters[k].position
    # A force inside the hull turns it by less than its own axis; a known moment has a longer arm.
    sizes = [float(np.abs(q).mean()) for q in (c, s, (x * s - y * c) / hull_length(vehicle))]
    return CHANNELS[int(np.argmax(sizes))]


def _none(moved: Array) -> Array:
    """No declared error moves a sum."""
    return np.zeros(moved.shape[1:])


def _structure(
    p: Projection,
    at: Sequence[int],
    names: Sequence[str],
    most: Callable[[Array], Array],
    more: Scatter | None = None,
) -> Adequacy:
    """Structure that regressors find beside a base.

    Args:
        p: least squares on the base.
        at: indices of the regressors.
        names: theirs, ``channel|function``.
        most: what declared errors move sums by at most, from what a unit of each moves them by.
        more: how the scores scatter beyond what they do in white noise.
    """
    q = Standing.of(p, at, most, more)
    real, H, d, scores, moved, single = q.real, q.information, q.length, q.scores, q.moved, q.falls

    def gained(which: NDArray[np.bool_]) -> tuple[float, int]:
        values, vectors = np.linalg.eigh(H[np.ix_(which, which)] / np.outer(d[which], d[which]))
        keep = values > DEPENDENT
        s = vectors[:, keep].T @ scores[which]
        theta = vectors[:, keep] @ (s / values[keep])
        fall = float(np.sum(s**2 / values[keep]))
        return beyond(fall, float(most(moved[:, which] @ theta))), int(keep.sum())

    fall, freedom = gained(real)

    def beyond_directions(which: NDArray[np.bool_]) -> float:
        own, directions = gained(real & which)
        return max(own - directions, 0.0)

    of_axis = {axis: np.array([n.startswith(axis) for n in names]) for axis in CHANNELS}
    now = np.array([not n.endswith(MEMORY) for n in names])
    excess = {axis: beyond_directions(own) for axis, own in of_axis.items()}
    of_now = {axis: beyond_directions(own & now) for axis, own in of_axis.items()}
    order = np.argsort(-single)[:3]
    strongest = tuple((names[k].split("|", 1)[1], names[k].split("|", 1)[0], float(single[k])) for k in order)
    one = float(min(1.0, chdtrc(1, float(single.max())) * len(names)))
    return Adequacy(fall, freedom, float(chdtrc(freedom, fall)), strongest, one, excess, of_now)
