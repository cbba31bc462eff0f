"""Causes whose columns are found by a search: waves and tides by their periods, tethers by their anchors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.candidates.tethers import anchors, pull_numbers
from ivsid.diagnosis.candidates.waves import periods, wave_numbers
from ivsid.diagnosis.estimation.candidate_columns import Family
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection

Array = NDArray[np.float64]


def with_searched(fit: Fit, p: Projection, found: list[Scored]) -> tuple[Fit, list[Scored]]:
    """The fit and the scores with those of waves and tethers, of which the best few values get exact columns.

    Args:
        fit: of the model.
        p: least squares beside which causes are scored.
        found: scores of the other families, to which theirs are added.
    """
    wanted = [f for f in fit.families if f.kind in ("wave", "tether")]
    if not wanted:
        return fit, found
    # The transposes of whitening and filters take the errors that the base leaves back to the accelerations that would explain them.
    g, predictor = fit.gram, fit.noise.predictor
    n, rows = predictor.log.n, len(predictor.labels)
    left = g.y - g.explained(p.base, p.coefficients)
    used = left.shape[0] * g.length
    errors = np.zeros((rows, n))
    errors[:, :used] = left.reshape(-1, rows, g.length).transpose(1, 0, 2).reshape(rows, used)
    back = fit.signatures.backward(_unwhiten(fit, errors))
    names: list[str] = []
    arrays: list[Array] = []
    plans: list[tuple[Family, list[tuple[float, ...]], int, float]] = []
    for family in wanted:
        values, looks = anchors(fit, back) if family.kind == "tether" else periods(fit, family, back)
        for value in values:
            for j, x in enumerate(_made(fit, family, value)):
                names.append(f"{family.id}@{value!r}.{j}")
                arrays.append(x)
        plans.append((family, values, 2 if family.kind == "tether" else 4, looks))
    if not names:
        return fit, found
    at = len(g.names)
    fit = replace(fit, gram=g.extended(names, arrays))
    wide = Projection(fit.gram, p.base)
    for family, values, size, looks in plans:
        best: Scored | None = None
        for value in values:
            columns = tuple(range(at, at + size))
            at += size
            theta, fall = wide.solve(columns)
            real = tuple((theta / fit.gram.unit[list(columns)]).tolist())
            if best is None or fall > best.fall:
                numbers = wave_numbers(family, value[0], real) if size == 4 else pull_numbers(value, real)
                ok = size == 4 or real[0] > 0
                # A far anchor is a wind: the two numbers of its place are paid for, too.
                best = Scored(family, fall if ok else 0.0, 4, looks, columns, real, numbers, ok)
        if best is not None:
            found.append(best)
    return fit, found


def _made(fit: Fit, family: Family, value: tuple[float, ...]) -> list[Array]:
    """The columns of a searched cause at a period [s], or at an anchor (north, east [m])."""
    if family.kind == "tether":
        return fit.signatures.pull((value[0], value[1]))
    return fit.signatures.earth_wave(value[0]) if family.id == "wave.force" else fit.signatures.earth_flow(value[0])


def _unwhiten(fit: Fit, errors: Array) -> Array:
    """The transpose of the whitening, applied to errors of shape (rows, n)."""
    out = np.zeros_like(errors)
    for rows, taps in zip(fit.noise.whitening.groups, fit.noise.whitening.taps, strict=True):
        here = errors[list(rows)]
        for lag, tap in enumerate(taps):
            part = tap.T @ here
            if lag:
                part = np.concatenate([part[:, lag:], np.zeros((len(rows), lag))], axis=1)
            out[list(rows)] += part
    return out
