"""``verify``: the verdict on a result, as a value."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ivsid.errors import IvsidError
from ivsid.files.processor import check_rounding
from ivsid.log import PARTS, Log, read_log
from ivsid.verification.checker import READING_ERRORS, Checker
from ivsid.verification.fleet import FleetChecker, logs_of, needed_logs
from ivsid.verification.result import DamagedError, is_fleet, read_result

# Parts of a result beside its statements: the seal covers them, no proof does.
NOT_PROVED: Final = (
    "inflation",
    "estimate",
    "directions",
    "determined",
    "notes",
    "physical",
    "quality",
    "rows",
    "reason",
    "improper",
    "options that no certificate rests on",
    "that ends without a bound have none",
    "that no contradiction is left without the rows that outliers names",
    "what assumes says, and its wording",
)


@dataclass(frozen=True)
class Verification:
    """A verdict.

    Attributes:
        status: ``proved``, ``failed``, or ``not_checked`` where nothing failed and part of it cannot be recomputed.
        failures: certificates and statements that failed, with reasons; empty where all is proved.
        not_checked: parts that the checker cannot recompute.
        claim: the status of the result that was checked, such as ``enclosed``.
        certificates: number of certificates that hold.
        rows: number of rows of the log that they use.
        wrong: number of rows of each set of parameters that share equations that may be wrong; the status holds if no more are.
        result_name: name of the result's file.
        log_name: name of the log.
        inputs: name and SHA-256 of the vehicle file and of the log.
        not_proved: parts of the result beside its statements.
    """

    status: str
    failures: tuple[str, ...]
    not_checked: tuple[str, ...]
    claim: str
    certificates: int
    rows: int
    result_name: str
    log_name: str
    inputs: tuple[tuple[str, str], ...]
    wrong: int = 0
    not_proved: tuple[str, ...] = NOT_PROVED

    @property
    def proved(self) -> bool:
        """Whether every statement of the result was proved."""
        return self.status == "proved"

    def record(self) -> dict[str, object]:
        """The verdict as in result.json."""
        return {
            "status": self.status,
            "claim": self.claim,
            "failures": list(self.failures),
            "not_checked": list(self.not_checked),
            "certificates": self.certificates,
            "rows": self.rows,
            "outliers": self.wrong,
            "not_proved": list(self.not_proved),
        }


# The same of a fleet.
NOT_PROVED_OF_A_FLEET: Final = (
    "that the bounds of all logs are as tight as their rows allow (complete)",
    "the order of the logs, and that the logs of one period do not contradict each other",
    "that no smaller set of logs contradicts each other (irreducible)",
    "that a parameter could explain a change alone",
    "pairs of logs, findings and verdicts",
    "what assumes says, and its wording",
)


def verify(
    result: str | Path,
    log: str | Path | Log | Sequence[str | Path],
    *,
    progress: Callable[[str], None] = lambda _: None,
) -> Verification:
    """Checks the certificates of an identification in exact rational arithmetic, without the core (docs/theory.md, "Verification").

    Args:
        result: the folder of ``ivsid identify`` or ``ivsid fleet``, or its result.json.
        log: the log that was identified; of a fleet its logs, or their folder.
        progress: told of each certificate.

    Returns:
        A verdict; a failed proof is a verdict, not an error.

    Raises:
        IvsidError: a file that cannot be read, or that is no result of ``ivsid identify``.
    """
    check_rounding()
    path = Path(result)
    name = str(path)
    if is_fleet(path):
        return _of_fleet(path, log, progress)
    if not isinstance(log, str | Path | Log):
        raise IvsidError(
            f"{name} is the result of one log, and {len(log)} were given; give the log that was identified"
        )
    try:
        read = read_result(path)
    except DamagedError as error:
        shown = log.name if isinstance(log, Log) else Path(log).name
        return Verification("failed", (f"the result is damaged: {error}",), (), "", 0, 0, name, shown, ())
    data = log if isinstance(log, Log) else read_log(log, read.vehicle.log)
    checker = Checker(read, data)
    checker.run(progress)
    inputs = ((read.vehicle.source, read.vehicle.sha256), (data.name, data.sha256))
    return Verification(
        "failed" if checker.failures else "not_checked" if checker.unknown else "proved",
        tuple(checker.failures),
        tuple(checker.unknown),
        read.record["status"],
        checker.certificates,
        len(checker.rows_used),
        name,
        data.name,
        inputs,
        checker.wrong,
    )


def _of_fleet(
    path: Path, given: str | Path | Log | Sequence[str | Path], progress: Callable[[str], None]
) -> Verification:
    """The verdict on the result of a fleet."""
    if isinstance(given, Log):
        raise IvsidError(f"{path} is the result of a fleet; give the folder of its logs")

    def damaged(why: object) -> Verification:
        return Verification("failed", (f"the result is damaged: {why}",), (), "", 0, 0, str(path), str(given), ())

    try:
        read = read_result(path, "fleet")
        needed = needed_logs(read.record)
    except DamagedError as error:
        return damaged(error)
    except READING_ERRORS as error:
        return damaged(f"{type(error).__name__}: {error}")
    if not needed:
        return damaged("no row of any log proves anything")
    digests = {name: digest for digest, name in needed.items()}
    logs = {
        name: read_log(p, read.vehicle.log, parts=digests[name].startswith(PARTS))
        for name, p in logs_of(given, needed, read.vehicle.log).items()
    }
    checker = FleetChecker(read, logs)
    try:
        checker.run(progress)
    except READING_ERRORS as error:
        checker.failures.append(f"the statements: cannot be read ({type(error).__name__}: {error})")
    number = len(read.record["logs"].get("together", ()))
    return Verification(
        "failed" if checker.failures else "not_checked" if checker.unknown else "proved",
        tuple(checker.failures),
        tuple(checker.unknown),
        str(read.record["pooled"].get("status")),
        checker.certificates,
        len(checker.rows_used),
        str(path),
        f"{len(logs)} of {number} logs",
        ((read.vehicle.source, read.vehicle.sha256), *((n, log.sha256) for n, log in logs.items())),
        not_proved=NOT_PROVED_OF_A_FLEET,
    )
