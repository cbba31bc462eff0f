"""TRAIN against TEST: masses and drags that scale together between two logs are shallow water."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ivsid.diagnosis.bench import Bench
from ivsid.diagnosis.channels import Channels
from ivsid.diagnosis.fit import Fit, Noise, fitted_gram, improve
from ivsid.diagnosis.noise import usable_rows
from ivsid.diagnosis.projection import Gram, Projection
from ivsid.vehicle import Vehicle

SCALED: Final = ("mass.surge", "mass.sway", "drag.surge.quadratic", "drag.sway.quadratic")
# Errors of two fits that a change has to exceed, and the least change that counts.
SIGMAS: Final = 5.0
LEAST: Final = 0.02


@dataclass(frozen=True)
class Change:
    """How the model differs between two logs.

    Attributes:
        ratio: TEST over TRAIN of each parameter, with its standard deviation.
        factor: the common one with its standard deviation, or None where there is none.
    """

    ratio: dict[str, tuple[float, float]]
    factor: tuple[float, float] | None


def change(vehicle: Vehicle, last: Fit, test: Channels) -> Change | None:
    """Fits the last hypothesis to the other log, too, under the noise of the first; None where the logs have other channels."""
    held = vehicle.model.values
    wanted = [i for i in SCALED if i in last.h.values and i not in held]
    if len(wanted) < 3:
        return None
    bench = Bench(vehicle, test, last.noise.bench.ambient)
    if bench.labels != last.noise.bench.labels or abs(test.h / last.noise.bench.log.h - 1) > 1e-6:
        return None
    noise = Noise(bench, last.noise.whitening, usable_rows(bench))
    # Biases and thrust errors are those of a log: they start anew.
    first = replace(last.h, declared={})
    try:
        anchor = bench.settle(first, bench.start(first), 2)
        h, anchor = improve(bench, first, anchor, noise.whitening, noise.good, held)
        g = fitted_gram(noise, h, anchor, held)
    except np.linalg.LinAlgError:
        return None
    ratio = {}
    for id_ in wanted:
        a, b = last.h.values[id_], h.values[id_]
        if a <= 0 or b <= 0:
            return None
        spread = np.hypot(_sigma(last.gram, last.base, id_) / a, _sigma(g, range(len(g.names)), id_) / b)
        ratio[id_] = (float(b / a), float(spread))
    return Change(ratio, _common(ratio))


def _common(ratio: dict[str, tuple[float, float]]) -> tuple[float, float] | None:
    logs = np.array([np.log(r) for r, _ in ratio.values()])
    sigma = np.maximum([s for _, s in ratio.values()], 1e-4)
    weight = 1 / sigma**2
    mean = float(np.sum(weight * logs) / np.sum(weight))
    error = float(1 / np.sqrt(np.sum(weight)))
    agree = bool((np.abs(logs - mean) < 4 * sigma).all())
    # Each parameter has to have moved by itself, not only their mean.
    moved = bool((np.abs(logs) > 3 * sigma).sum() >= 3)
    if abs(mean) < max(SIGMAS * error, LEAST) or not agree or not moved:
        return None
    return float(np.exp(mean)), float(np.exp(mean) * error)


def _sigma(g: Gram, base: Sequence[int], id_: str) -> float:
    p = Projection(g, base)
    inverse = np.linalg.inv(p.total[np.ix_(p.base, p.base)] + np.diag(g.prior[p.base] + 1e-9))
    i = p.base.index(g.at([id_])[0])
    return float(np.sqrt(inverse[i, i]) / g.unit[p.base[i]])
