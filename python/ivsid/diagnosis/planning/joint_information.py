"""Joint information of a log and a manoeuvre: the cross-products of both, as of one log.

Information adds. Parameters, causes and thrust errors are the same in both, and have one column; the slow biases of the sensors are not, and
have two. The manoeuvre counts as sailed by the fitted model, under the noise of the log.

Source: docs/theory.md, "Isolability".
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.fit import Fit, survey
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.noise import Noise, usable_rows
from ivsid.diagnosis.estimation.whitening import Whitening
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.errors import IvsidError
from ivsid.log import Log

Array = NDArray[np.float64]
# Prefix of the columns that two logs do not share: the slow biases of the sensors.
OWN: Final = "~bias."


def turning_fit(fit: Fit, log: Log | None) -> Fit:
    """Fit to a manoeuvre in which the vehicle turns, for the noise of the axes that the log leaves out.

    Args:
        fit: to the log.
        log: of the manoeuvre, or None.

    Raises:
        IvsidError: if there is no manoeuvre, or if the vehicle does not turn in it.
    """
    if log is not None:
        made = plain_fit(fit.noise.predictor.vehicle, channels(log, fit.noise.predictor.vehicle), everything)
        if not made.noise.left_out:
            return made
    raise IvsidError("no manoeuvre of the library turns this vehicle")


def manoeuvre_fit(fit: Fit, log: Log, turning: Fit | None) -> Fit:
    """Signatures of a manoeuvre at the fitted model, under the noise of the log.

    Args:
        fit: to the log.
        log: of the manoeuvre.
        turning: fit to a manoeuvre with turning, for the axes that the log leaves out.

    Raises:
        IvsidError: if the manoeuvre has other channels than the log.
    """
    vehicle = fit.noise.predictor.vehicle
    # The noise of the sensors is that of the log, since the simulated manoeuvre has none.
    data = replace(channels(log, vehicle), noise=fit.noise.predictor.log.noise)
    white, fixed, ambient = fit.noise.whitening, fit.fixed, fit.noise.predictor.ambient
    if turning is not None:
        white, fixed, ambient = _whitening(fit, turning), turning.fixed, _ambient(fit, turning)
    predictor = Predictor(vehicle, data, ambient)
    if predictor.labels != fit.noise.predictor.labels:
        raise IvsidError("the manoeuvre has other channels than the log")
    # Declared errors were fitted to the log, and are zero in the manoeuvre.
    h = replace(fit.h, declared_errors={})
    states = predictor.settle(predictor.start(h), 2)
    return survey(Noise(predictor, white, usable_rows(predictor), frozenset()), states, fixed)


def _ambient(fit: Fit, turning: Fit) -> Ambient:
    """Ambient acceleration: of the log in the axes that move in it, of the turning manoeuvre in the others."""
    own, other = fit.noise.predictor.ambient, turning.noise.predictor.ambient
    one = [other if k in fit.noise.left_out else own for k in range(3)]
    deviation, time = ([q[k] for k, q in enumerate(x)] for x in ([a.deviation for a in one], [a.time for a in one]))
    return Ambient((deviation[0], deviation[1], deviation[2]), (time[0], time[1], time[2]))


def _whitening(fit: Fit, turning: Fit) -> Whitening:
    """Whitening: of the log in the axes that move in it, of the turning manoeuvre in the others, or all of the latter if it couples the two."""
    own, other = fit.noise.whitening, turning.noise.whitening
    left_out = {i for i, (k, _) in enumerate(fit.noise.predictor.labels) if k in fit.noise.left_out}
    theirs = {g: t for g, t in zip(other.groups, other.taps, strict=True) if left_out & set(g)}
    mine = {g: t for g, t in zip(own.groups, own.taps, strict=True) if not left_out & set(g)}
    if any(set(g) - left_out for g in theirs):
        return other
    both = {**mine, **theirs}
    return Whitening(tuple(both), tuple(both.values()))


def joined(fit: Fit, more: Fit) -> Fit:
    """Both logs as one: blocks side by side, columns matched by name.

    Args:
        fit: to the log.
        more: fit to a manoeuvre on the same clock.

    Raises:
        IvsidError: if the clocks differ.
    """
    a, b = fit.gram, more.gram
    if a.length != b.length:
        raise IvsidError("the manoeuvre has another clock than the log")
    base_a = [a.names[k] for k in fit.base]
    base_b = [_apart(b.names[k]) for k in more.base]
    names_b = [_apart(n) for n in b.names]
    # Dead bands and limits have levels of their own in each log: each level of the log takes the nearest of the other.
    names_b = _matched(fit, more, names_b)
    base = list(dict.fromkeys([*base_a, *base_b]))
    names = tuple(dict.fromkeys([*base, *a.names, *names_b]))
    index = {n: k for k, n in enumerate(names)}
    scale_a, scale_b = np.zeros(len(names)), np.zeros(len(names))
    at_a, at_b = [index[n] for n in a.names], [index[n] for n in names_b]
    scale_a[at_a], scale_b[at_b] = a.unit, b.unit
    unit = np.hypot(scale_a, scale_b)
    blocks = np.concatenate(
        [_placed(g, at, s / unit, len(names)) for g, at, s in ((a, at_a, scale_a), (b, at_b, scale_b))]
    )
    prior = np.zeros(len(names))
    for g, at in ((b, at_b), (a, at_a)):
        prior[at] = g.prior * (unit[at] / g.unit) ** -2
    count = len(blocks)
    g = replace(
        a,
        names=names,
        parts=(),
        y=np.zeros((count, 0)),
        blocks=blocks,
        score=np.zeros((count, len(names))),
        energy=np.zeros(count),
        rows=np.r_[a.rows, b.rows],
        prior=prior,
        centre=np.zeros(len(names)),
        unit=unit,
    )
    fixed = {k: v for k, v in fit.fixed.items() if k in more.fixed}
    return replace(
        fit, gram=g, base=tuple(range(len(base))), noise=replace(fit.noise, left_out=frozenset()), fixed=fixed
    )


def _placed(g: Gram, at: list[int], scale: Array, size: int) -> Array:
    """Cross-products of one log among the columns of both."""
    out = np.zeros((len(g.blocks), size, size))
    out[np.ix_(range(len(g.blocks)), at, at)] = g.blocks
    return np.asarray(out * scale[:, None] * scale[None, :])


def _apart(name: str) -> str:
    """Name of the second log's column: biases get a name of their own."""
    return f"{name}'" if name.startswith(OWN) else name


def _matched(fit: Fit, more: Fit, names: list[str]) -> list[str]:
    """Names of the second log's columns, with those of dead bands and limits after the nearest level of the first log."""
    out = list(names)
    own = set(fit.gram.names)
    for candidate in more.candidates:
        tried = candidate.tried()
        levels = {v: n for c in fit.candidates if c.id == candidate.id for n, v in c.tried().items()}
        free = {v: n for v, n in levels.items() if n not in tried}
        for name, value in tried.items():
            if name in own or not free:
                continue
            near = min(free, key=lambda q: abs(np.log(max(q, 1e-12) / max(value, 1e-12))))
            out[out.index(name)] = free.pop(near)
    return out
