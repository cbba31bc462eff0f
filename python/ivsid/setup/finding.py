"""A fault of the set-up: a sentence, the figures behind it, and the key of the vehicle file to change."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from ivsid.log import Log
from ivsid.vehicle import Vehicle


@dataclass(frozen=True)
class SetupFinding:
    """A wrong set-up, named before any fitting.

    Attributes:
        id: of the fault, as ``[setup] accept`` takes it.
        sentence: the fault in one sentence.
        evidence: figures behind it, by name.
        remedy: the key of the vehicle file to change, and its value.
        certain: whether two channels of the log, or the file's own statements, show it without a model of the vessel.
    """

    id: str
    sentence: str
    evidence: Mapping[str, float]
    remedy: str
    certain: bool

    def record(self) -> dict[str, Any]:
        """The entry of result.json."""
        return {
            "id": self.id,
            "sentence": self.sentence,
            "evidence": dict(self.evidence),
            "remedy": self.remedy,
            "certain": self.certain,
        }

    @property
    def line(self) -> str:
        """The sentence with its remedy, for the terminal and the page."""
        return f"{self.sentence}: {self.remedy}"


def in_doubt(findings: Iterable[SetupFinding]) -> str:
    """The end of a heading of a result from a doubtful set-up, empty without a finding."""
    ids = dict.fromkeys(f.id for f in findings)
    return f"; the set-up is doubtful: {', '.join(ids)}" if ids else ""


@dataclass(frozen=True)
class Checked:
    """The outcome of a check.

    Attributes:
        findings: faults, the plainest first.
        log: without them, for the checks that follow.
    """

    findings: tuple[SetupFinding, ...]
    log: Log


# A check of the set-up, of a vehicle and its log.
Check: TypeAlias = Callable[[Vehicle, Log], Checked]
