"""The result of ``follow``: parameter intervals at several moments of a log, and the changes that were proved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from ivsid.display.shown import Result
from ivsid.display.table import Cells
from ivsid.files.records import Lower, Upper, envelope
from ivsid.identification.result import Parameter
from ivsid.intervals import shown
from ivsid.setup import SetupFinding, in_doubt
from ivsid.vehicle import Vehicle


@dataclass(frozen=True)
class Moment:
    """What the rows up to a time prove.

    Attributes:
        time: [s].
        rows: number of rows so far.
        parameters: intervals by id; empty where no parameters explain the rows.
    """

    time: float
    rows: int
    parameters: dict[str, Parameter]


@dataclass(frozen=True)
class Change:
    """A proof that no parameters explain the rows, or no constant ones where windows are compared.

    Attributes:
        time: of the row at which it was proved [s].
        since: time of the oldest row that the proof names, or begin of the window in which it was proved [s].
        parameter: id of the parameter whose ends do not meet; None for a combination of rows.
        rows: number of half-spaces that the proof names; 0 where windows contradict one another.
    """

    time: float
    since: float
    parameter: str | None
    rows: int

    @property
    def sentence(self) -> str:
        """The proof in a sentence."""
        what = (
            "the rows contradict each other" if self.parameter is None else f"the ends of {self.parameter} do not meet"
        )
        return f"at {self.time:.6g} s {what} (since {self.since:.6g} s)"


@dataclass(frozen=True, repr=False)
class Following(Result):
    """Parameter intervals of a log as they narrow, row by row.

    Attributes:
        status: ``enclosed``, ``unbounded`` (an end is open) or ``empty``.
        guaranteed: true only where every step is proved.
        assumes: sentences that the guarantee relies on.
        parameters: intervals by id after the last row; empty where no parameters explain the rows.
        moments: in order of time.
        changes: proofs of changes, or the one proof of ``empty``.
        rows: number of rows of each channel.
        notes: sentences about the log.
        ignored: columns of the log that no channel uses.
        options: to repeat the run.
        vehicle: the vehicle file.
        log_name: file name of the log.
        log_sha256: SHA-256 of the log.
        setup: what is doubtful about the set-up.
    """

    status: str
    guaranteed: bool
    assumes: tuple[str, ...]
    parameters: dict[str, Parameter]
    moments: tuple[Moment, ...]
    changes: tuple[Change, ...]
    rows: dict[str, int]
    notes: tuple[str, ...]
    ignored: tuple[str, ...]
    options: dict[str, object]
    vehicle: Vehicle
    log_name: str
    log_sha256: str
    setup: tuple[SetupFinding, ...] = ()

    def _heading(self) -> str:
        word = "guaranteed" if self.guaranteed else "not guaranteed"
        return f"of {self.vehicle.name} along {self.log_name}: {self.status}, {word}{in_doubt(self.setup)}"

    def _cells(self) -> Cells:
        found = self.parameters.items()
        return {
            "parameter": [k for k, _ in found],
            "interval": [shown(p.lower, p.upper) for _, p in found],
            "unit": [p.unit for _, p in found],
        }

    def _columns(self) -> Mapping[str, object]:
        rows = [(m.time, k, p) for m in self.moments for k, p in m.parameters.items()]
        return {
            "time": [t for t, _, _ in rows],
            "parameter": [k for _, k, _ in rows],
            "lower": [p.lower for _, _, p in rows],
            "upper": [p.upper for _, _, p in rows],
        }

    def record(self) -> dict[str, object]:
        """The record of result.json."""
        inputs = [
            (Path(self.vehicle.source or "vehicle.toml").name, self.vehicle.sha256),
            (self.log_name, self.log_sha256),
        ]
        ids = list(next((m.parameters for m in self.moments if m.parameters), {}))
        there = [m for m in self.moments if m.parameters]
        return {
            **envelope("follow", inputs),
            "status": self.status,
            "guaranteed": self.guaranteed,
            "assumes": self.assumes,
            "parameters": {k: p.record() for k, p in self.parameters.items()},
            "changes": [asdict(c) for c in self.changes],
            "time": [m.time for m in there],
            "narrowing": {
                k: {
                    "lower": [Lower(m.parameters[k].lower) for m in there],
                    "upper": [Upper(m.parameters[k].upper) for m in there],
                }
                for k in ids
            },
            "rows": self.rows,
            "notes": self.notes,
            "ignored": self.ignored,
            "options": self.options,
            "setup": [f.record() for f in self.setup],
            "vehicle_source": self.vehicle.source,
            "vehicle": self.vehicle.text,
        }
