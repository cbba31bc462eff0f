"""``verify``: the verdict on a result, as a value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ivsid.files.processor import check_rounding
from ivsid.log import Log, read_log
from ivsid.verification.checker import Checker
from ivsid.verification.result import DamagedError, read_result

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
            "not_proved": list(NOT_PROVED),
        }


def verify(
    result: str | Path, log: str | Path | Log, *, progress: Callable[[str], None] = lambda _: None
) -> Verification:
    """Checks the certificates of an identification in exact rational arithmetic, without the core (docs/theory.md, "Verification").

    Args:
        result: the folder of ``ivsid identify`` or its result.json.
        log: the log that was identified.
        progress: told of each certificate.

    Returns:
        A verdict; a failed proof is a verdict, not an error.

    Raises:
        IvsidError: a file that cannot be read, or that is no result of ``ivsid identify``.
    """
    check_rounding()
    path = Path(result)
    name = str(path)
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
