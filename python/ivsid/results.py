"""Results as plain tables for JSON, and back (INTERFACE.md, result.json)."""

from __future__ import annotations

import json
from dataclasses import fields
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ivsid.allan import AllanDeviation
from ivsid.errors import IvsidError
from ivsid.identification import Identification, Parameter
from ivsid.records import Lower, Upper
from ivsid.thrust import Bollard
from ivsid.validation import Validation
from ivsid.vehicle import parse_vehicle


def envelope(command: str, inputs: dict[str, str], seed: int | None = None) -> dict[str, Any]:
    """What every result.json starts with; ``inputs`` maps names to SHA-256."""
    listed = [{"name": name, "sha256": digest} for name, digest in inputs.items()]
    return {"ivsid": version("ivsid"), "command": command, "inputs": listed, "seed": seed}


def parameter_record(p: Parameter) -> dict[str, Any]:
    """One parameter, bounds rounded outward."""
    return {"lower": Lower(p.lower), "upper": Upper(p.upper), "unit": p.unit, "symbol": p.symbol}


def identification_record(fit: Identification) -> dict[str, Any]:
    """An identification as in INTERFACE.md, with what is needed to use it again."""
    inputs = {Path(fit.vehicle.source or "vehicle.toml").name: fit.vehicle.sha256, fit.log_name: fit.log_sha256}
    return {
        **envelope("identify", inputs),
        "method": fit.method,
        "status": fit.status,
        "guaranteed": fit.guaranteed,
        "assumes": fit.assumes,
        "parameters": {k: parameter_record(p) for k, p in fit.parameters.items()},
        "inflation": fit.inflation,
        "estimate": fit.estimate,
        "improper": fit.improper,
        "reason": fit.reason,
        "directions": fit.directions,
        "rows": fit.rows,
        "notes": fit.notes,
        "options": fit.options,
        "vehicle_source": fit.vehicle.source,
        "vehicle": fit.vehicle.text,
        "certificates": fit.certificates,
        "certificate": [c for c in fit.certificates if c["proves"] == "empty"] if fit.status == "empty" else None,
    }


def read_identification(path: str | Path) -> Identification:
    """Reads the result of ``ivsid identify``: its folder, or its result.json.

    Raises:
        IvsidError: the file is missing, damaged, or the result of another command.
    """
    path = Path(path)
    file = path / "result.json" if path.is_dir() else path
    try:
        record = json.loads(file.read_text())
    except OSError as error:
        raise IvsidError(
            f"fit {file} cannot be read ({error.strerror}); give the --out folder of ivsid identify"
        ) from None
    except ValueError:
        raise IvsidError(f"fit {file} is not JSON; give the --out folder of ivsid identify") from None
    if not isinstance(record, dict) or record.get("command") != "identify":
        raise IvsidError(f"{file} is not the result of ivsid identify; run that first and give its --out folder")
    try:
        return _identification(record)
    except (KeyError, TypeError, AttributeError):
        raise IvsidError(f"{file} is damaged or of another version; run ivsid identify again") from None


def _identification(record: dict[str, Any]) -> Identification:
    given = {f.name: record[f.name] for f in fields(Identification) if f.name in record}
    infinite = {"lower": float("-inf"), "upper": float("inf")}
    parameters = {
        k: Parameter(**{**p, **{end: infinite[end] for end in infinite if p[end] is None}})
        for k, p in record["parameters"].items()
    }
    given |= {
        "parameters": parameters,
        "vehicle": parse_vehicle(record["vehicle"], record["vehicle_source"]),
        "log_name": record["inputs"][1]["name"],
        "log_sha256": record["inputs"][1]["sha256"],
    }
    for name in ("assumes", "directions", "certificates", "notes"):
        given[name] = tuple(given[name])
    return Identification(**given)


def validation_record(result: Validation) -> dict[str, Any]:
    """A validation."""
    fit = result.fit
    inputs = {fit.log_name: fit.log_sha256, result.log_name: result.log_sha256}
    if fit.log_name == result.log_name:
        inputs = {f"{fit.log_name} (identified)": fit.log_sha256, f"{result.log_name} (validated)": result.log_sha256}
    return {
        **envelope("validate", inputs),
        "method": fit.method,
        "fit_status": fit.status,
        "fit_guaranteed": fit.guaranteed,
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
        "notes": result.notes,
    }


def allan_record(curves: dict[str, AllanDeviation]) -> dict[str, Any]:
    """The coefficients of each channel."""
    return {
        name: {
            "random_walk": a.random_walk,
            "bias_instability": a.bias_instability,
            "bias_time": a.bias_time,
            "bias_resolved": a.resolved,
            "flicker": a.floor,
            "floor_time": a.floor_time,
            "sigma_c": a.sigma_c,
            "three_sigma": 3 * a.sigma_c,
            "mean": a.mean,
            "taus": a.taus,
            "deviation": a.deviation,
        }
        for name, a in curves.items()
    }


def bollard_record(table: Bollard) -> dict[str, Any]:
    """The candidates for a thrust curve."""
    return {
        "points": table.demand.size,
        "range": [float(table.demand[0]), float(table.demand[-1])],
        "thrust_range": [float(table.thrust.min()), float(table.thrust.max())],
        "monotone": table.monotone,
        "dead_band": table.dead_band,
        "fits": [
            {"name": f.name, "coefficients": f.coefficients, "rms": f.rms, "largest": f.largest, "residual": f.residual}
            for f in table.fits
        ],
        "recommended": table.recommended.name,
    }
