"""Intervals of a cause's numbers: by the noise model, by the scatter of half-minutes, by causes that were not found, and by profiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.profile import bent, ends, first_step, moved, profile, region, rise, slack
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.effects import EFFECTS, Given, Parameter
from ivsid.files.records import Lower, Upper

Array = NDArray[np.float64]
# Half-width of an interval in standard deviations.
# Source: theorem: two-sided 99.9 % quantile of the standard normal distribution, 3.29
SIGMAS: Final = 3.3
# Fall of chi-squared from which on a cause that was not found may still be there.
# Source: measured: make constants
DOUBTFUL: Final = 6.0
# Size that a cause may have beyond its score without being found, in standard deviations.
# Source: theorem: one-sided 97.7 % quantile of the standard normal distribution
HIDDEN: Final = 2.0
# A cause is no other than those that were found if their columns leave this share of its signature's squared length.
# Source: measured: make constants
SAME: Final = 1e-3
# Squared length of a column, in its unit length, below which the log has nothing of it.
# Source: definition: it is one or zero, up to rounding
MOVES: Final = 0.5
# Distance of an anchor, in the reach of the track, from which on an end of its interval is open.
# Source: geometry: a pull from there turns by half a degree over the whole track
FAR: Final = 100.0


@dataclass(frozen=True)
class Bound:
    """An interval of one number of an effect.

    Attributes:
        lower: end, in ``unit``.
        upper: end, in ``unit``.
        unit: of the number.
        symbol: of the number.
        guaranteed: whether it is proved; else it is statistical.
        statistical: the statistical interval beside a proved one.
        proved: the proved interval beside a statistical one.
        within: the interval as it would be if nothing unknown were left.
        stands_for: the name of the thruster whose index the number is, or of those that do as well; empty for another number.
    """

    lower: float
    upper: float
    unit: str
    symbol: str
    guaranteed: bool = False
    statistical: tuple[float, float] | None = None
    proved: tuple[float, float] | None = None
    within: tuple[float, float] | None = None
    stands_for: str = ""

    def record(self) -> dict[str, object]:
        """As in result.json."""
        beside: dict[str, object] = {}
        for key, found in (("statistical", self.statistical), ("proved", self.proved)):
            if found is not None:
                beside[key] = {"lower": Lower(found[0]), "upper": Upper(found[1])}
        if self.stands_for:
            beside["thruster"] = self.stands_for
        return {
            "lower": Lower(self.lower),
            "upper": Upper(self.upper),
            "unit": self.unit,
            "symbol": self.symbol,
            "guaranteed": self.guaranteed,
            **beside,
        }


@dataclass(frozen=True)
class Reach:
    """Errors of a number beside free errors of the thrust curves.

    Attributes:
        noise: standard deviation by the noise alone, in the number's unit.
        worst: most that declared errors inside their bounds move the number, in its unit.
    """

    noise: float
    worst: float


def intervals(
    fit: Fit,
    id_: str,
    left: Sequence[Scored] = (),
    *,
    unknown: bool = False,
    curves: Mapping[str, Reach] | None = None,
    swapped: Mapping[str, tuple[float, float]] | None = None,
) -> dict[str, Bound]:
    """Intervals of an effect's numbers, by name.

    The standard deviation of a number is the larger of two: by the noise model, and by the scatter of half-minutes. An interval is widened by
    the shift of the number beside each cause that may be there without being found. Numbers in which the errors bend or jump are profiled. An
    interval holds the number whatever curve inside its accuracy each thruster has: priors alone scatter these errors as if they were many.

    Args:
        fit: of the last model.
        id_: of the effect.
        left: scores of the causes that were not found.
        unknown: whether something unknown is left; then each of these causes may hide in it, at up to ``HIDDEN`` standard deviations beyond
            its score.
        curves: what any thrust curve inside its accuracy makes of each number, by column.
        swapped: shifts down and up of each number where other causes act in the place of those that were found beside this one, by name.
    """
    curves, swapped = curves or {}, swapped or {}
    p, g = fit.projection, fit.gram
    variance, robust = np.diag(p.covariance), scatter(p)
    out: dict[str, Bound] = {}
    worse = 1.0
    shifted = _moved(fit, left)
    hidden = _hidden(fit, left) if unknown else shifted
    hidden = np.stack([np.minimum(shifted[0], hidden[0]), np.maximum(shifted[1], hidden[1])])
    for i, k in enumerate(p.base):
        name = g.names[k]
        if name != id_ and not name.startswith(f"{id_}."):
            continue
        sigma = float(np.sqrt(max(variance[i], robust[i]))) / float(g.unit[k])
        value, parameter = _number(fit, name)
        least = -np.inf if parameter.lowest is None else parameter.lowest
        if g.total[k, k] < MOVES:
            # Nothing of the log moves with the number, as with an arm where yaw is left out.
            out[name] = Bound(least, np.inf, parameter.unit, parameter.symbol)
            continue
        # The last step of the fit is not taken, so that the interval has to hold it.
        rest = abs(float(p.coefficients[i])) / float(g.unit[k])
        reach = SIGMAS * sigma + rest
        beside = curves.get(name, Reach(sigma, 0.0))
        wide = max(reach, SIGMAS * beside.noise + beside.worst + rest)
        worse = max(worse, robust[i] / variance[i])
        unit = float(g.unit[k])
        low, high = (shifted[:, i] / unit).tolist()
        down, up = swapped.get(name, (0.0, 0.0))
        within = (max(value - reach + low, least), value + reach + high)
        low, high = (hidden[:, i] / unit).tolist()
        lower, upper = max(value - wide + low + down, least), value + wide + high + up
        out[name] = Bound(lower, upper, parameter.unit, parameter.symbol, within=within)
    _canonical(out, id_)
    _searched(fit, id_, worse, out, curves, swapped)
    return out


def _searched(
    fit: Fit,
    id_: str,
    worse: float,
    out: dict[str, Bound],
    curves: Mapping[str, Reach],
    swapped: Mapping[str, tuple[float, float]],
) -> None:
    """Adds the intervals of numbers that are searched: thrusters, places, and those in which the errors bend or jump.

    Args:
        fit: of the last model.
        id_: of the effect.
        worse: variance by the scatter of half-minutes over the variance by the noise model.
        out: intervals by name.
        curves: as of ``intervals``.
        swapped: likewise.
    """
    for given in fit.h.given:
        if given.effect.id != id_:
            continue
        for j, (name, parameter) in enumerate(zip(given.parts, given.effect.parameters, strict=True)):
            if parameter.draw == "thruster":
                known = fit.noise.predictor.vehicle.thrusters
                like = _thrusters(fit, given, j, worse)
                named = " or ".join(known[k].name for k in like)
                out[name] = Bound(float(like[0]), float(like[-1]), parameter.unit, parameter.symbol, stands_for=named)
        if given.effect.form.place:
            _places(fit, given, worse, out, swapped)
        for j in bent(given):
            chi2 = profile(fit.problem, fit.states, given, j)
            lower, upper = ends(chi2, given.values[j], first_step(fit.problem, given, j), rise(given, j, SIGMAS, worse))
            around = slack(fit.problem, given, j) + curves.get(given.parts[j], Reach(0.0, 0.0)).worst
            down, up = swapped.get(given.parts[j], (0.0, 0.0))
            lower, upper = max(lower - around + down, 0.0), upper + around + up
            parameter = given.effect.parameters[j]
            if parameter.draw == "time":
                # What starts outside the log acts in all of it or in none.
                begin, end = float(fit.noise.predictor.log.t[0]), float(fit.noise.predictor.log.t[-1])
                lower, upper = min(max(lower, begin), end), max(min(upper, end), begin)
            if given.effect.form.limits:
                # A limit is one of the true thrust, which the curve gives within its accuracy.
                error = max(
                    t.accuracy.absolute + t.accuracy.relative * upper for t in fit.noise.predictor.vehicle.thrusters
                )
                lower, upper = max(lower - error, 0.0), upper + error
            out[given.parts[j]] = Bound(lower, upper, parameter.unit, parameter.symbol)


def _thrusters(fit: Fit, given: Given, j: int, worse: float) -> list[int]:
    """Indices of the thrusters at which an effect explains as much as at its own, this among them, in increasing order.

    Args:
        fit: of the last model.
        given: the effect.
        j: index of the number that stands for the thruster.
        worse: variance by the scatter of half-minutes over the variance by the noise model.
    """
    problem, own = fit.problem, int(given.values[j])
    most = problem.chi2(fit.states) + rise(given, j, SIGMAS, worse)
    found = [own]
    for k in range(len(fit.noise.predictor.vehicle.thrusters)):
        if k != own:
            values = [float(k) if i == j else x for i, x in enumerate(given.values)]
            there = improve(problem, fit.states.under(moved(fit.h, fit.fixed, given, values)))
            found += [k] if problem.chi2(there) <= most else []
    return sorted(found)


def _places(
    fit: Fit, given: Given, worse: float, out: dict[str, Bound], swapped: Mapping[str, tuple[float, float]]
) -> None:
    """Widens the intervals of an anchor to those of all places that the log allows.

    Args:
        fit: of the last model.
        given: the effect.
        worse: variance by the scatter of half-minutes over the variance by the noise model.
        out: intervals by name.
        swapped: as of ``intervals``.
    """
    north, east = given.effect.form.place
    names = [given.parts[j] for j in (north, east)]
    if any(n not in out for n in names):
        return
    chi2 = profile(fit.problem, fit.states, given, north, east)
    best = given.values[north], given.values[east]
    reach = [0.5 * (out[n].upper - out[n].lower) for n in names]
    found = region(chi2, best, (reach[0], reach[1]), rise(given, north, SIGMAS, worse))
    track = fit.states.points.place
    for n, (low, high), along in zip(names, found, track, strict=True):
        down, up = swapped.get(n, (0.0, 0.0))
        lower, upper = min(low + down, out[n].lower), max(high + up, out[n].upper)
        # From farther away a pull has a direction, and no place.
        far = FAR * float(np.ptp(track, axis=1).max())
        middle = 0.5 * float(along.min() + along.max())
        out[n] = replace(
            out[n],
            lower=lower if lower > middle - far else -np.inf,
            upper=upper if upper < middle + far else np.inf,
        )


def _canonical(out: dict[str, Bound], id_: str) -> None:
    """Chooses one of several equal descriptions of an effect."""
    effect = EFFECTS[id_]
    pairs = zip(effect.parameters, effect.parts, strict=True)
    # A number that is open has no other description.
    own = {p.part: name for p, name in pairs if name in out and np.isfinite(out[name].upper)}
    for part, (lower, upper) in effect.form.canonical(
        {q: (out[n].lower, out[n].upper) for q, n in own.items()}
    ).items():
        out[own[part]] = replace(out[own[part]], lower=lower, upper=upper)


def _moved(fit: Fit, left: Sequence[Scored]) -> Array:
    """Largest shifts down and up of each fitted coefficient if one of the causes that are left is fitted beside it, shape (2, base)."""
    p = fit.projection
    span = np.zeros((2, len(p.base)))
    for s in left:
        # The column of a step in time begins at its start, and no cross-products hold it.
        if s.fall < DOUBTFUL or not s.physical or not s.columns or s.candidate.starts:
            continue
        wide = Projection(fit.gram, [*p.base, *s.columns])
        shift = wide.coefficients[: len(p.base)] - p.coefficients
        span[0], span[1] = np.minimum(span[0], shift), np.maximum(span[1], shift)
    return span


def _hidden(fit: Fit, left: Sequence[Scored]) -> Array:
    """Largest shifts down and up of the coefficients by causes that were not found, shape (2, base)."""
    p = fit.projection
    span = np.zeros((2, len(p.base)))
    for s in left:
        if len(s.columns) != 1 or s.candidate.starts:
            continue
        k = s.columns[0]
        seen = float(p.information([k])[0, 0])
        if seen <= SAME * float(p.total[k, k]):
            # A cause that no log tells from those that were found stands among their alternatives.
            continue
        theta, _ = p.solve([k])
        spread = HIDDEN / np.sqrt(seen)
        ends = np.array([theta[0] - spread, theta[0] + spread])
        if not s.candidate.effect.parameters[0].signed:
            ends = np.maximum(ends, 0.0)
        shift = -np.outer(p.g.regression([k], p.base), ends)
        span[0], span[1] = np.minimum(span[0], shift.min(axis=1)), np.maximum(span[1], shift.max(axis=1))
    return span


def scatter(p: Projection) -> Array:
    """Variances of the coefficients by the scatter of the scores of half-minutes, shape (base,).

    Source: the sandwich estimator (White 1982), with sums over half-minutes as its independent terms.

    Args:
        p: least squares on the base.
    """
    g = p.g
    coefficients = np.zeros(len(g.names))
    coefficients[p.base] = p.coefficients
    blocks, score = g.halves
    side = (score - blocks @ coefficients)[:, p.base]
    n = side.shape[0]
    middle = side.T @ side * n / max(n - 1, 1)
    return np.asarray(np.diag(p.covariance @ middle @ p.covariance))


def _number(fit: Fit, name: str) -> tuple[float, Parameter]:
    """The value of a number in the fit, and its parameter in the catalogue."""
    for given in fit.h.given:
        if name in given.parts:
            j = given.parts.index(name)
            return float(given.values[j]), given.effect.parameters[j]
    for effect in EFFECTS.values():
        for form in (effect, effect.measured):
            if form is not None and name in form.parts:
                return float(fit.h.values[name]), form.parameters[form.parts.index(name)]
    raise KeyError(name)
