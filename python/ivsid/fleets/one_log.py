"""Work on one log, in whichever process: its identification, its diagnosis, and its rows for the scans."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import TypeAlias, TypedDict, cast

from ivsid.diagnosis.stages import diagnose
from ivsid.effects import terms_of
from ivsid.errors import IvsidError
from ivsid.fleets.finished import Finished, key_of
from ivsid.fleets.log_rows import LogRows, of_regression
from ivsid.fleets.places import Place, opened
from ivsid.fleets.scan import Question, Violated, scan
from ivsid.identification import identify
from ivsid.log import Log, Parts, digest_of, read_log
from ivsid.rows import build_rows, window_count
from ivsid.sensors.bounds import bound_log
from ivsid.vehicle import Vehicle, parse_vehicle
from ivsid.verification.result import Stored

# A finished result, as it was read from its file or made.
Record: TypeAlias = Stored


class Options(TypedDict):
    """Options of the identifications."""

    form: str
    rows: str
    window: float | Sequence[float]


@dataclass(frozen=True)
class Settings:
    """What every process needs to know.

    Attributes:
        vehicle: text of the vehicle file.
        source: its name.
        options: of the identification: ``form``, ``rows`` and ``window``.
        diagnosis: options of the diagnosis, ``seed`` and ``null_logs``; None to leave it out.
        finished: folder of finished logs.
        version: of the package that started the run.
    """

    vehicle: str
    source: str
    options: Options
    diagnosis: Mapping[str, int] | None
    finished: Finished
    version: str

    def checked(self) -> Vehicle:
        """The vehicle file as a checked value.

        Raises:
            IvsidError: this process has another version of the package.
        """
        if version("ivsid") != self.version:
            raise IvsidError(
                f"a worker has ivsid {version('ivsid')}, and this run is of {self.version}; install the same version on every worker"
            )
        return _vehicle(self.vehicle, self.source)


@lru_cache(maxsize=2)
def _vehicle(text: str, source: str) -> Vehicle:
    return parse_vehicle(text, source)


@dataclass(frozen=True)
class Outcome:
    """What became of the work on one log.

    Attributes:
        record: the finished result; None of a log that failed.
        error: the sentence of a failure, or None.
        reused: whether the result was there already.
        bytes: size of the log's files.
        seconds: time of the work [s].
    """

    record: Record | None
    error: str | None
    reused: bool
    bytes: int
    seconds: float


def _outcome(work: Callable[[], tuple[Record, bool, int]]) -> Outcome:
    """The work with its failure as a value: one bad log does not end a fleet."""
    begin = time.monotonic()
    try:
        record, reused, size = work()
    except IvsidError as error:
        return Outcome(None, str(error), False, 0, time.monotonic() - begin)
    except MemoryError:
        return Outcome(None, "not enough memory for this log", False, 0, time.monotonic() - begin)
    except Exception as error:
        words = f"an internal fault, {type(error).__name__}: {error}"
        return Outcome(None, words, False, 0, time.monotonic() - begin)
    return Outcome(record, None, reused, size, time.monotonic() - begin)


def identified(place: Place, settings: Settings) -> Outcome:
    """The identification of a log, from the folder of finished ones if it is there."""
    return _outcome(lambda: _identified(place, settings))


def _identified(place: Place, settings: Settings) -> tuple[Record, bool, int]:
    vehicle = settings.checked()
    with opened(place.address) as path:
        log: Log | None = None
        if isinstance(path, Parts) or vehicle.log.span is not None:
            # What its identity stands for is known when it has been read.
            log = read_log(path, vehicle.log)
            digest = log.sha256
        else:
            digest = digest_of(path)
        key = key_of("identify", [digest], settings.vehicle, settings.options)
        known = settings.finished.read("identify", key)
        if known is not None:
            return _small({**known, "name": place.name}), True, _size(path)
        log = log or read_log(path, vehicle.log)
        size = _size(path)
    fit = identify(vehicle, log, bias="sample", **settings.options)
    record = {
        "key": key,
        "name": place.name,
        "sha256": log.sha256,
        "began": log.began,
        "samples": int(log.t.size),
        "length": float(log.t[-1] - log.t[0]),
        "status": fit.status,
        "guaranteed": fit.guaranteed,
        "assumes": fit.assumes,
        # Bounds as hexadecimals, which read back exactly.
        "bounds": {k: [p.lower.hex(), p.upper.hex()] for k, p in fit.parameters.items()},
        "inflation": fit.inflation,
        "reason": fit.reason,
        "rows": fit.rows,
        "notes": fit.notes,
        "setup": [f.record() for f in fit.setup],
        "blocks": _blocks(fit.certificates),
        "certificates": fit.certificates,
        "contradictions": fit.contradictions,
    }
    settings.finished.write("identify", key, record)
    return _small(record), False, size


def _small(record: Record) -> Record:
    """What travels of an identification: the certificates, nine tenths of it, stay in its file until they are asked for."""
    return {k: v for k, v in record.items() if k not in ("certificates", "seal")}


def certificates_of(record: Record, finished: Finished) -> Sequence[Stored]:
    """The certificates of an identification, from its file.

    Raises:
        IvsidError: the file is gone.
    """
    known = finished.read("identify", str(record["key"]))
    if known is None:
        raise IvsidError(f"the finished log {record['name']} is gone from {finished.folder}; run the command again")
    found: Sequence[Stored] = cast(Record, known)["certificates"]
    return found


def _blocks(certificates: Sequence[Stored]) -> list[list[str]]:
    """The parameters that share rows, by block."""
    return [list(ids) for ids in dict.fromkeys(tuple(c["orthant"]) for c in certificates)]


def _size(path: Path | Parts) -> int:
    """Bytes of a log, or those that were fetched of it."""
    if isinstance(path, Parts):
        return path.moved
    files = [path] if path.is_file() else [Path(w, n) for w, _, names in os.walk(path) for n in names]
    return sum(f.stat().st_size for f in files)


def diagnosed(place: Place, other: Place, digests: tuple[str, str], settings: Settings) -> Outcome:
    """The diagnosis of a log, tried on another one."""
    return _outcome(lambda: _diagnosed(place, other, digests, settings))


def _diagnosed(place: Place, other: Place, digests: tuple[str, str], settings: Settings) -> tuple[Record, bool, int]:
    vehicle, options = settings.checked(), settings.diagnosis or {}
    key = key_of("diagnose", digests, settings.vehicle, options)
    known = settings.finished.read("diagnose", key)
    if known is not None:
        return known, True, 0
    with opened(place.address) as first, opened(other.address) as second:
        logs = [read_log(p, vehicle.log) for p in (first, second)]
        size = _size(first) + _size(second)
    _same((place, other), [log.sha256 for log in logs], digests)
    found = diagnose(vehicle, *logs, seed=options["seed"], null_logs=options["null_logs"])
    record = {
        "key": key,
        "name": place.name,
        "other": other.name,
        "verdict": found.verdict,
        "findings": [
            {
                "effect": f.effect,
                "probability": None if f.like is None else f.like.probability,
                "confidence": f.confidence,
                "alternatives": f.alternatives,
                "parameters": {
                    k: {"lower": b.lower.hex(), "upper": b.upper.hex(), "unit": b.unit, "guaranteed": b.guaranteed}
                    for k, b in f.parameters.items()
                },
            }
            for f in found.findings
        ],
        "refuted": found.proofs[0].refuted,
        "notes": found.notes,
    }
    settings.finished.write("diagnose", key, record)
    return record, False, size


def _same(logs: Sequence[Place], found: Sequence[str], known: Sequence[str]) -> None:
    for log, digest, before in zip(logs, found, known, strict=True):
        if digest != before:
            raise IvsidError(f"{log.name} changed while the fleet was at work; run the command again")


def rows_of(logs: Sequence[tuple[int, Place, str]], settings: Settings) -> list[LogRows]:
    """The rows of some logs, as their identification has them.

    Args:
        logs: number, place and SHA-256 of each.
        settings: with the options of the identification.

    Raises:
        IvsidError: a log that changed.
    """
    vehicle, options = settings.checked(), settings.options
    terms = terms_of(vehicle, options["form"])
    parts = []
    for number, place, digest in logs:
        with opened(place.address) as path:
            log = read_log(path, vehicle.log)
        _same([place], [log.sha256], [digest])
        made = build_rows(
            bound_log(log, vehicle, window_count(options["window"])),
            vehicle,
            terms,
            added_mass=options["form"] == "added",
            kind=options["rows"],
            window=options["window"],
        )
        parts.append(of_regression(made, number))
    return parts


def scanned(rows: list[LogRows], questions: Sequence[Question]) -> list[Violated]:
    """The answers of some logs; a name of its own, by which processes find it."""
    return scan(rows, questions)
