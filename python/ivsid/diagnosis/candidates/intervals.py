"""The intervals of a cause's numbers: by the noise model, by the scatter of half-minutes, by what is not found, and by profiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.families import Scored
from ivsid.diagnosis.candidates.profile import bent, ends, first_step, profile, rise, slack
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.gauss_newton import declared_columns
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.effects import EFFECTS, Parameter
from ivsid.files.records import Lower, Upper

Array = NDArray[np.float64]
# Half-widths of the intervals in standard deviations.
SIGMAS: Final = 3.3
# From this fall of chi^2 on a cause that is not found may still be there.
DOUBTFUL: Final = 6.0
# A cause that was not found is at most so many standard deviations larger than its score.
HIDDEN: Final = 2.0
# With so small a share of its signature left beside the others a cause is no other than they.
SAME: Final = 1e-3


@dataclass(frozen=True)
class Bound:
    """An interval of one number of an effect: statistical, or guaranteed, with the other kind beside it where there is one.

    ``within`` is what it would be if nothing unknown were left.
    """

    lower: float
    upper: float
    unit: str
    symbol: str
    guaranteed: bool = False
    statistical: tuple[float, float] | None = None
    proved: tuple[float, float] | None = None
    within: tuple[float, float] | None = None

    def record(self) -> dict[str, Any]:
        """As in result.json."""
        beside: dict[str, Any] = {}
        for key, found in (("statistical", self.statistical), ("proved", self.proved)):
            if found is not None:
                beside[key] = {"lower": Lower(found[0]), "upper": Upper(found[1])}
        return {
            "lower": Lower(self.lower),
            "upper": Upper(self.upper),
            "unit": self.unit,
            "symbol": self.symbol,
            "guaranteed": self.guaranteed,
            **beside,
        }


def intervals(
    fit: Fit, id_: str, fixed: Mapping[str, float], left: Sequence[Scored] = (), *, unknown: bool = False
) -> dict[str, Bound]:
    """Intervals of an effect's numbers: the larger of the errors by the noise model and by the blocks' own scatter.

    Each interval holds the number also where one of the causes that are ``left`` is there, too small to be found: how far it would move
    the number is added. Where something ``unknown`` is left, any of them may hide in it, at up to two standard deviations more than it is
    scored. Numbers in which the errors bend or jump are profiled.
    """
    p, g = fit.projection, fit.gram
    covariance = np.linalg.inv(p.total[np.ix_(p.base, p.base)] + np.diag(g.prior[p.base] + 1e-9))
    robust = scatter(p, covariance)
    out: dict[str, Bound] = {}
    worse = 1.0
    moved = _moved(fit, left)
    hidden = _hidden(fit, left) if unknown else moved
    hidden = np.stack([np.minimum(moved[0], hidden[0]), np.maximum(moved[1], hidden[1])])
    for i, k in enumerate(p.base):
        name = g.names[k]
        if name != id_ and not name.startswith(f"{id_}."):
            continue
        sigma = float(np.sqrt(max(covariance[i, i], robust[i]))) / float(g.unit[k])
        value, parameter = _number(fit, name)
        # The last step of the fit is not taken: it belongs into the interval.
        rest = abs(float(p.coefficients[i])) / float(g.unit[k])
        reach = SIGMAS * sigma + rest
        worse = max(worse, robust[i] / covariance[i, i])
        unit = float(g.unit[k])
        within = (value - reach + moved[0, i] / unit, value + reach + moved[1, i] / unit)
        lower, upper = value - reach + hidden[0, i] / unit, value + reach + hidden[1, i] / unit
        out[name] = Bound(lower, upper, parameter.unit, parameter.symbol, within=within)
    _turned(out, id_)
    for given in fit.h.given:
        if given.effect.id != id_:
            continue
        for name, parameter, value in zip(given.effect.parts, given.effect.parameters, given.values, strict=True):
            if parameter.draw == "thruster":
                out[name] = Bound(value, value, parameter.unit, parameter.symbol)
        for j in bent(given):
            known = declared_columns(fit.noise.predictor, fit.h, fit.states, fit.noise.whitening, fit.noise.good)
            chi2 = profile(fit.noise, fit.h, fit.states, fixed, known, given, j)
            lower, upper = ends(chi2, given.values[j], first_step(fit.noise, given, j), rise(given, j, SIGMAS, worse))
            around = slack(fit.noise, given, j)
            lower, upper = max(lower - around, 0.0), upper + around
            parameter = given.effect.parameters[j]
            if parameter.unit == "N":
                # The limit is of the true thrust, which the curve gives within its accuracy alone.
                error = max(
                    t.accuracy.absolute + t.accuracy.relative * upper for t in fit.noise.predictor.vehicle.thrusters
                )
                lower, upper = max(lower - error, 0.0), upper + error
            out[given.effect.parts[j]] = Bound(lower, upper, parameter.unit, parameter.symbol)
    return out


def _turned(out: dict[str, Bound], id_: str) -> None:
    """One of the ways to say the same: a wave, or a tide, half a turn later in the opposite direction is the same."""
    phase, direction = out.get(f"{id_}.phase"), out.get(f"{id_}.direction")
    if phase is None:
        return
    shift = 0.0
    parts = [out[f"{id_}.{q}"] for q in ("north", "east") if f"{id_}.{q}" in out]
    if parts:
        # The larger component is counted positive.
        most = max(parts, key=lambda b: abs(b.lower + b.upper))
        if most.lower + most.upper < 0:
            shift = np.pi
            for q in ("north", "east"):
                b = out[f"{id_}.{q}"]
                out[f"{id_}.{q}"] = replace(b, lower=-b.upper, upper=-b.lower)
    if direction is not None:
        middle = 0.5 * (direction.lower + direction.upper)
        half = np.floor(middle / np.pi) * np.pi
        out[f"{id_}.direction"] = replace(direction, lower=direction.lower - half, upper=direction.upper - half)
        shift = half
    middle = 0.5 * (phase.lower + phase.upper) + shift
    shift -= np.floor(middle / (2 * np.pi)) * 2 * np.pi
    out[f"{id_}.phase"] = replace(phase, lower=phase.lower + shift, upper=phase.upper + shift)


def _moved(fit: Fit, left: Sequence[Scored]) -> Array:
    """How far down and up each fitted coefficient goes when one of the causes that are left is fitted beside it, shape (2, base)."""
    p = fit.projection
    span = np.zeros((2, len(p.base)))
    for s in left:
        # A step in time has its column from its start on alone, which stands in no Gram.
        if s.fall < DOUBTFUL or not s.physical or not s.columns or s.family.kind == "step":
            continue
        wide = Projection(fit.gram, [*p.base, *s.columns])
        shift = wide.coefficients[: len(p.base)] - p.coefficients
        span[0], span[1] = np.minimum(span[0], shift), np.maximum(span[1], shift)
    return span


def _hidden(fit: Fit, left: Sequence[Scored]) -> Array:
    """How far causes that were not found may move the coefficients, each at up to two standard deviations beyond its score, shape (2, base)."""
    p = fit.projection
    base = list(p.base)
    inner = p.total[np.ix_(base, base)] + np.diag(p.g.prior[base] + 1e-9)
    span = np.zeros((2, len(base)))
    for s in left:
        if len(s.columns) != 1 or s.family.kind == "step":
            continue
        k = s.columns[0]
        seen = float(p.information([k])[0, 0])
        if seen <= SAME * float(p.total[k, k]):
            # What no log tells from the causes that were found stands among their alternatives.
            continue
        theta, _ = p.solve([k])
        spread = HIDDEN / np.sqrt(seen)
        ends = np.array([theta[0] - spread, theta[0] + spread])
        if not s.family.effect.parameters[0].signed:
            ends = np.maximum(ends, 0.0)
        shift = -np.outer(np.linalg.solve(inner, p.total[base, k]), ends)
        span[0], span[1] = np.minimum(span[0], shift.min(axis=1)), np.maximum(span[1], shift.max(axis=1))
    return span


def scatter(p: Projection, covariance: Array) -> Array:
    """Variances of the coefficients from the scores of half-minutes."""
    g = p.g
    score = g.score[:, p.base] - g.blocks[:, p.base][:, :, p.base] @ p.coefficients
    blocks = score.shape[0] // 3 * 3
    side = score[:blocks].reshape(-1, 3, score.shape[1]).sum(axis=1)
    n = side.shape[0]
    middle = side.T @ side * n / max(n - 1, 1)
    return np.asarray(np.diag(covariance @ middle @ covariance))


def _number(fit: Fit, name: str) -> tuple[float, Parameter]:
    for effect in EFFECTS.values():
        for form in (effect, effect.measured):
            if form is not None and name in form.parts:
                parameter = form.parameters[form.parts.index(name)]
                if name in fit.h.values:
                    return float(fit.h.values[name]), parameter
                for given in fit.h.given:
                    if name in given.named:
                        return float(given.named[name]), parameter
    raise KeyError(name)
