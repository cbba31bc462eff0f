"""The result of an identification, as a value and as the file result.json."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, TypedDict

import numpy as np

from ivsid.display.shown import Result
from ivsid.display.table import Cells
from ivsid.effects import terms_of
from ivsid.errors import IvsidError
from ivsid.files.parsed import json_value
from ivsid.files.records import Lower, Upper, envelope, sealed, to_json
from ivsid.files.whole import write_whole
from ivsid.identification.stored import check_record
from ivsid.intervals import shown
from ivsid.setup import SetupFinding, in_doubt
from ivsid.vehicle import Vehicle, parse_vehicle


@dataclass(frozen=True)
class Parameter:
    """The interval of one parameter.

    Attributes:
        lower: -inf where no lower bound was proved; above ``upper`` where the published method left the bounds reversed.
        upper: inf where no upper bound was proved.
        unit: of the parameter.
        symbol: in SNAME notation.
    """

    lower: float
    upper: float
    unit: str
    symbol: str

    @property
    def midpoint(self) -> float:
        """Centre of a bounded interval, else the finite end, else NaN."""
        ends = [e for e in (self.lower, self.upper) if np.isfinite(e)]
        return float(np.mean(ends)) if ends else float("nan")

    @property
    def width(self) -> float:
        """``upper`` less ``lower``."""
        return self.upper - self.lower

    def record(self) -> dict[str, Any]:
        """The record of result.json, with bounds rounded outward."""
        return {"lower": Lower(self.lower), "upper": Upper(self.upper), "unit": self.unit, "symbol": self.symbol}


class ClaimCheck(TypedDict):
    """A claim, a number that the vehicle file states for a parameter, and whether its interval contradicts it."""

    parameter: str
    value: float
    contradicted: bool


@dataclass(frozen=True, repr=False)
class Identification(Result):
    """The result of a method for all parameters of a model.

    Attributes:
        method: its name.
        status: ``enclosed``, ``empty``, ``unbounded``, ``not_applicable`` or, for the published methods, ``not_proved``.
        guaranteed: true only where every step is proved.
        assumes: sentences that the guarantee relies on.
        parameters: by id; empty where no interval exists.
        estimate: a point for simulation, the midpoints or the parameter of least inflation, by id.
        inflation: the smallest factor on all row radii at which a parameter is consistent (an estimate), or None.
        improper: number of entries of published inverses with reversed bounds.
        reason: obstacle to a proved result, or None.
        directions: by parameter id, in which the set is unbounded.
        certificates: for each bound, the rows that prove it; ``block`` numbers sets of parameters that share no row.
        contradictions: numbers of the blocks without a consistent parameter.
        rows: number of rows of each channel.
        notes: sentences about the log and its outliers.
        ignored: columns of the log that no channel uses.
        options: of the method, to repeat the run.
        vehicle: the vehicle file.
        log_name: file name of the log.
        log_sha256: SHA-256 of the log.
        determined: combinations of parameters, by id, that stay bounded where some directions are open (an estimate).
        claims: numbers that the vehicle file states in ``[model] values``, and whether their intervals contradict them.
        outliers: for each block, with ``options.outliers``, the least number of rows that must be wrong, and every choice of that many.
        physical: bounds of every vessel that no parameter of the intervals keeps: ``bound``, ``parameters``, and a sentence ``says``.
        setup: faults of the set-up that the vehicle file accepts, or that are not beyond doubt.
    """

    method: str
    status: str
    guaranteed: bool
    assumes: tuple[str, ...]
    parameters: dict[str, Parameter]
    estimate: dict[str, float]
    inflation: float | None
    improper: int
    reason: str | None
    directions: tuple[dict[str, float], ...]
    certificates: tuple[dict[str, Any], ...]
    contradictions: tuple[int, ...]
    rows: dict[str, int]
    notes: tuple[str, ...]
    ignored: tuple[str, ...]
    options: dict[str, Any]
    vehicle: Vehicle
    log_name: str
    log_sha256: str
    determined: tuple[dict[str, float], ...] = ()
    claims: tuple[ClaimCheck, ...] = ()
    outliers: tuple[dict[str, Any], ...] = ()
    physical: tuple[dict[str, Any], ...] = ()
    setup: tuple[SetupFinding, ...] = ()

    def _heading(self) -> str:
        word = "guaranteed" if self.guaranteed else "not guaranteed"
        return (
            f"of {self.vehicle.name} by {self.method} on {self.log_name}: {self.status}, {word}{in_doubt(self.setup)}"
        )

    def _cells(self) -> Cells:
        found = self.parameters.items()
        if not found:
            return {
                "parameter": list(self.estimate),
                "point that contradicts the rows least": list(self.estimate.values()),
            }
        return {
            "parameter": [k for k, _ in found],
            "interval": [shown(p.lower, p.upper) for _, p in found],
            "unit": [p.unit for _, p in found],
        }

    def _columns(self) -> Mapping[str, object]:
        found = self.parameters.values()
        return {
            "parameter": list(self.parameters),
            "symbol": [p.symbol for p in found],
            "unit": [p.unit for p in found],
            "lower": [p.lower for p in found],
            "upper": [p.upper for p in found],
        }

    @property
    def falsifying(self) -> list[dict[str, Any]]:
        """The certificates of the blocks without a consistent parameter: the few rows that prove the model wrong."""
        return [c for c in self.certificates if c["proves"] == "empty" and c["block"] in self.contradictions]

    def record(self) -> dict[str, Any]:
        """The record of result.json, from which ``read_identification`` makes the identification again."""
        inputs = [
            (Path(self.vehicle.source or "vehicle.toml").name, self.vehicle.sha256),
            (self.log_name, self.log_sha256),
        ]
        return {
            **envelope("identify", inputs),
            "method": self.method,
            "status": self.status,
            "guaranteed": self.guaranteed,
            "assumes": self.assumes,
            "parameters": {k: p.record() for k, p in self.parameters.items()},
            "inflation": self.inflation,
            "estimate": self.estimate,
            "improper": self.improper,
            "reason": self.reason,
            "directions": self.directions,
            "determined": self.determined,
            "claims": self.claims,
            "outliers": self.outliers,
            "physical": self.physical,
            "setup": [f.record() for f in self.setup],
            "rows": self.rows,
            "notes": self.notes,
            "ignored": self.ignored,
            "options": self.options,
            "vehicle_source": self.vehicle.source,
            "vehicle": self.vehicle.text,
            "certificates": self.certificates,
            "contradictions": self.contradictions,
            "certificate": self.falsifying or None,
        }

    def save(self, path: str | Path) -> None:
        """Writes the result; a path without ``.json`` is a folder that gets a result.json."""
        target = Path(path)
        write_whole(
            target if target.suffix == ".json" else target / "result.json", to_json(sealed(self.record())) + "\n"
        )


def read_identification(path: str | Path) -> Identification:
    """Reads the result of ``ivsid identify``: its folder, or its result.json.

    Raises:
        IvsidError: the file is missing, damaged, or the result of another command.
    """
    path = Path(path)
    file = path / "result.json" if path.is_dir() else path
    try:
        record = json_value(file.read_text())
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
    except (KeyError, TypeError, AttributeError, IndexError, OverflowError):
        raise IvsidError(f"{file} is damaged or of another version; run ivsid identify again") from None


def _identification(record: dict[str, Any]) -> Identification:
    check_record(record)
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
        "setup": tuple(SetupFinding(**f) for f in record.get("setup", ())),
    }
    ids = {t.id for t in terms_of(given["vehicle"], given["options"]["form"])}
    if given["status"] in ("enclosed", "unbounded") and set(parameters) != ids:
        raise KeyError("the parameters are those of the model")
    for name in (
        "assumes",
        "directions",
        "determined",
        "claims",
        "outliers",
        "physical",
        "certificates",
        "notes",
        "ignored",
        "contradictions",
    ):
        given[name] = tuple(given[name])
    return Identification(**given)
