"""Residuals of a model: the unexplained energy of its innovations, its missing force and its falsified rows, by channel."""

from __future__ import annotations

from typing import TypedDict

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.statements.comparison import missing_force
from ivsid.diagnosis.statements.falsified import falsified
from ivsid.effects import CHANNELS
from ivsid.log import Log
from ivsid.vehicle import Vehicle


class FindingEvidence(TypedDict, total=False):
    """Numbers of TRAIN that show a finding, with the keys of result.json.

    Attributes:
        channel: with most of the effect's signature.
        residual_rms_before: rms of the force that the plain model lacks in the channel [N, N m].
        residual_rms_after: the same of the extended model.
        falsified_samples_before: number of the channel's rows that the plain model contradicts.
        falsified_samples_after: the same of the extended model.
        z: standard deviations by which the effect stands out.
        chance: probability of its fall of chi-squared without the effect.
        statistic: of the adequacy, for ``unknown``.
        ratio: TEST over TRAIN by parameter, for shallow water.
        ratio_deviation: relative standard deviation of each ratio.
    """

    channel: str
    residual_rms_before: float
    residual_rms_after: float
    falsified_samples_before: int | None
    falsified_samples_after: int | None
    z: float
    chance: float
    statistic: float
    ratio: dict[str, float]
    ratio_deviation: dict[str, float]


def unexplained(fit: Fit) -> dict[str, float]:
    """Share of each channel's squared innovations above the share that its noise gives, by channel; 0 where there is none."""
    p = fit.projection
    g = fit.gram
    left = g.y - g.explained(p.base, p.coefficients)
    rows = len(fit.noise.predictor.labels)
    energy = (left.reshape(-1, rows, g.length) ** 2).sum(axis=(0, 2))
    count = g.rows.sum() / rows
    out: dict[str, float] = {}
    for channel in CHANNELS:
        at = [i for i, c in enumerate(fit.noise.predictor.channels) if c == channel]
        total = float(energy[at].sum())
        out[channel] = max(0.0, 1.0 - count * len(at) / total) if total > 0 else 0.0
    return out


def before_and_after(vehicle: Vehicle, log: Log, plain: Fit, last: Fit) -> dict[str, FindingEvidence]:
    """Missing force and falsified rows of the plain and the extended model, by channel.

    Args:
        vehicle: of the file.
        log: TRAIN.
        plain: fit of the plain model to it.
        last: fit of the extended model to it.
    """
    rms = [missing_force(f.noise.predictor, f.states) for f in (plain, last)]
    rows = [falsified(vehicle, log, f.h) for f in (plain, last)]
    return {
        c: {
            "residual_rms_before": rms[0][c],
            "residual_rms_after": rms[1][c],
            "falsified_samples_before": None if rows[0] is None else rows[0][c],
            "falsified_samples_after": None if rows[1] is None else rows[1][c],
        }
        for c in CHANNELS
    }
