"""Records for result.json (docs/guide.md) from the values that the stages return; an identification makes its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING

from ivsid.files.records import envelope

if TYPE_CHECKING:
    from ivsid.log import Quality
    from ivsid.propulsion.bollard import Bollard
    from ivsid.sensors.allan import AllanDeviation
    from ivsid.validation import Validation


def validation_record(result: Validation) -> dict[str, object]:
    """The record of a validation."""
    fit = result.fit
    inputs = {fit.log_name: fit.log_sha256, result.log_name: result.log_sha256}
    if fit.log_name == result.log_name:
        inputs = {f"{fit.log_name} (identified)": fit.log_sha256, f"{result.log_name} (validated)": result.log_sha256}
    return {
        **envelope("validate", inputs),
        "method": fit.method,
        "fit_status": fit.status,
        "fit_guaranteed": fit.guaranteed,
        "setup": [f.record() for f in result.setup],
        "force": {
            f.channel: {
                "rows": f.time.size,
                "unit": "N m" if f.channel == "yaw" else "N",
                "error_mean": f.mean,
                "error_sigma": f.sigma,
                "error_mean_absolute": f.mean_absolute,
                "coverage": f.coverage,
                "falsified_samples": f.falsified,
            }
            for f in result.forces
        },
        "motion": {
            "windows": result.motion.window,
            "rms": result.motion.rms,
            "median": result.motion.median,
            "reason": result.motion.reason,
        },
        "tubes": result.tubes.record(),
        "notes": result.notes,
    }


def allan_record(curves: dict[str, AllanDeviation]) -> dict[str, dict[str, object]]:
    """The record of an Allan analysis: noise coefficients and curve of each channel."""
    return {
        name: {
            "random_walk": a.random_walk,
            "bias_instability": a.bias_instability,
            "bias_time": a.bias_time,
            "rate_random_walk": a.rate_random_walk,
            "bands": {k: [low, high if high < float("inf") else None] for k, (low, high) in a.bands.items()},
            "bias_resolved": a.resolved,
            "bias_flicker": a.flicker,
            "fit_explained": a.explained,
            "fit_start": a.start,
            "filter_bandwidth": a.signs.bandwidth,
            "step": a.signs.step,
            "sinusoid": a.signs.sinusoid,
            "motion": a.motion,
            "drift": a.signs.drift,
            "flicker": a.floor,
            "floor_time": a.floor_time,
            "sigma_c": a.sigma_c,
            "three_sigma": 3 * a.sigma_c,
            "mean": a.mean,
            "taus": a.taus,
            "deviation": a.deviation,
            "deviation_band": a.band,
        }
        for name, a in curves.items()
    }


def bollard_record(table: Bollard) -> dict[str, object]:
    """The record of a bollard-pull table: candidates for the thrust curve with their residuals [N]."""
    return {
        "points": table.demand.size,
        "range": [float(table.demand[0]), float(table.demand[-1])],
        "thrust_range": [float(table.thrust.min()), float(table.thrust.max())],
        "monotone": table.monotone,
        "dead_band": table.dead_band,
        "fits": [
            {
                "name": f.name,
                "coefficients": f.coefficients,
                "quadratic": f.quadratic,
                "rms": f.rms,
                "largest": f.largest,
                "band": f.band,
                "residual": f.residual,
            }
            for f in table.fits
        ],
        "recommended": table.recommended.name,
    }


def quality_record(quality: Mapping[str, Quality]) -> dict[str, object]:
    """The record of a log's quality, by channel."""
    return {name: asdict(q) for name, q in quality.items()}
