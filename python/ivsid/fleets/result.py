"""The result of a fleet, as a value and as the record of result.json."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ivsid.display.shown import Result
from ivsid.display.table import Cells
from ivsid.effects import Term
from ivsid.files.records import Lower, Upper, envelope
from ivsid.fleets.consistency import Decision, Pooled
from ivsid.fleets.drift import Change, Drift
from ivsid.fleets.log_rows import with_rows
from ivsid.fleets.one_log import Outcome, Record
from ivsid.fleets.places import Place
from ivsid.identification import Parameter, checked_claims
from ivsid.intervals import shown
from ivsid.vehicle import Vehicle
from ivsid.verification.result import Stored


@dataclass(frozen=True)
class Entry:
    """One log of a fleet.

    Attributes:
        place: where it is.
        outcome: of its identification.
        diagnosis: of it, or None where none was asked for or the log failed.
    """

    place: Place
    outcome: Outcome
    diagnosis: Outcome | None = None

    @property
    def record(self) -> Record:
        """The finished identification; empty where it failed."""
        return self.outcome.record or {}

    @property
    def error(self) -> str | None:
        """The sentence of a failure, or None."""
        return self.outcome.error

    @property
    def status(self) -> str:
        """Status of the identification, or ``failed``."""
        return "failed" if self.error is not None else str(self.record["status"])

    @property
    def usable(self) -> bool:
        """Whether its rows can be held together with those of others."""
        return self.status in ("enclosed", "unbounded")

    def bound(self, id_: str) -> tuple[float, float]:
        """The bounds of a parameter; infinite where there are none."""
        given = self.record.get("bounds", {}).get(id_)
        return (-np.inf, np.inf) if given is None else (float.fromhex(given[0]), float.fromhex(given[1]))


@dataclass(frozen=True)
class Traffic:
    """What went between this process and the workers.

    Attributes:
        passes: over the rows of logs.
        sent: points, in bytes.
        received: violated rows, in bytes.
        rows: rows of all logs, which stayed where they were.
        seconds: time by step [s].
    """

    passes: int = 0
    sent: int = 0
    received: int = 0
    rows: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, repr=False)
class Fleet(Result):
    """What the logs of a vehicle say, one by one and together.

    Attributes:
        vehicle: its file.
        entries: the logs, by name.
        order: numbers of the logs whose rows hold in themselves, by date.
        dated: whether the order is that of the logs' dates; it is that of their names if one has none.
        terms: parameters of the model.
        pooled: the parameters that are consistent with all rows of these logs; None without a log.
        drift: what changed between them; None without a log.
        assumes: sentences that the pooled bounds rely on.
        guaranteed: whether every bound and contradiction is proved under these sentences, whose sensor bounds hold in all logs at once with a
            probability of at least a half.
        joint: probability that the sensor bounds hold in all logs at once, at least; None under the paper's rule.
        options: to repeat the run.
        traffic: what went between processes.
        proofs: certificates of the single logs whose intervals are disjoint.
    """

    vehicle: Vehicle
    entries: tuple[Entry, ...]
    order: tuple[int, ...]
    dated: bool
    terms: tuple[Term, ...]
    pooled: Pooled | None
    drift: Drift | None
    assumes: tuple[str, ...]
    guaranteed: bool
    joint: float | None
    options: dict[str, object]
    traffic: Traffic
    proofs: Mapping[int, Sequence[Stored]]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the logs."""
        return tuple(e.place.name for e in self.entries)

    @property
    def failed(self) -> dict[str, str]:
        """The sentences of the logs that failed."""
        return {e.place.name: e.error for e in self.entries if e.error is not None}

    @property
    def contradicted(self) -> tuple[str, ...]:
        """Names of the logs that contradict the model by themselves."""
        return tuple(e.place.name for e in self.entries if e.status == "empty")

    @property
    def parameters(self) -> dict[str, tuple[float, float]]:
        """Bounds of the parameters that are consistent with all rows of all logs; empty where there are none."""
        if self.pooled is None or self.pooled.solved.empty:
            return {}
        ends = zip(self.pooled.solved.lower.tolist(), self.pooled.solved.upper.tolist(), strict=True)
        return {t.id: e for t, e in zip(self.terms, ends, strict=True)}

    def findings(self) -> dict[str, list[str]]:
        """For each cause of the single diagnoses, the logs in which it stands."""
        found: dict[str, list[str]] = {}
        for e in self.entries:
            if e.diagnosis is not None and e.diagnosis.record is not None:
                for f in e.diagnosis.record["findings"]:
                    found.setdefault(f["effect"], []).append(e.place.name)
        return dict(sorted(found.items(), key=lambda kv: (-len(kv[1]), kv[0])))

    def verdicts(self) -> dict[str, int]:
        """The number of logs of each verdict."""
        given = [e.diagnosis.record["verdict"] for e in self.entries if e.diagnosis and e.diagnosis.record]
        return {v: given.count(v) for v in sorted(set(given))}

    def _heading(self) -> str:
        status = "no log" if self.pooled is None else self.pooled.solved.status
        return f"of {self.vehicle.name}: {len(self.entries)} logs, {len(self.failed)} failed, together {status}"

    def _cells(self) -> Cells:
        return {
            "parameter": list(self.parameters),
            "interval of all logs": [shown(*e) for e in self.parameters.values()],
            "unit": [t.unit for t in self.terms] if self.parameters else [],
        }

    def _columns(self) -> Mapping[str, object]:
        return {
            "parameter": list(self.parameters),
            "lower": [e[0] for e in self.parameters.values()],
            "upper": [e[1] for e in self.parameters.values()],
        }

    def record(self) -> dict[str, object]:
        """The record of result.json."""
        inputs = [(self.vehicle.source or "vehicle.toml", self.vehicle.sha256)]
        inputs += [(e.place.name, e.record["sha256"]) for e in self.entries if e.record]
        return {
            **envelope("fleet", inputs),
            "vehicle_source": self.vehicle.source,
            "vehicle": self.vehicle.text,
            "options": self.options,
            "logs": {
                "given": len(self.entries),
                "together": [self.names[k] for k in self.order],
                "by": "dates" if self.dated else "names",
                "contradict_the_model": self.contradicted,
                "failed": self.failed,
            },
            "assumes": self.assumes,
            "guaranteed": self.guaranteed,
            "joint_confidence": self.joint,
            "pooled": self._pooled_record(),
            "drift": self._drift_record(),
            "findings": {c: {"logs": len(n), "names": n} for c, n in self.findings().items()},
            "verdicts": self.verdicts(),
            "diagnosis_failed": {
                e.place.name: e.diagnosis.error for e in self.entries if e.diagnosis and e.diagnosis.error is not None
            },
        }

    def _pooled_record(self) -> dict[str, object] | None:
        if self.pooled is None:
            return None
        s = self.pooled.solved
        return {
            "status": s.status,
            "complete": self.pooled.complete,
            "parameters": {
                t.id: {"lower": Lower(a), "upper": Upper(b), "unit": t.unit, "symbol": t.symbol}
                for t, (a, b) in zip(self.terms, self.parameters.values(), strict=False)
            },
            "rows": self.pooled.rows.count,
            "claims": checked_claims(self.vehicle, self._intervals()),
            "reason": s.reason,
            "contradictions": s.contradictions,
            "certificates": named(s.certificates, self.names),
        }

    def _intervals(self) -> dict[str, Parameter]:
        ends = zip(self.terms, self.parameters.values(), strict=False)
        return {t.id: Parameter(a, b, t.unit, t.symbol) for t, (a, b) in ends}

    def _drift_record(self) -> dict[str, object] | None:
        if self.drift is None:
            return None
        ids = [t.id for t in self.terms]
        return {
            "periods": [[self.names[k] for k in p] for p in self.drift.periods],
            "changes": [self._change_record(c, ids) for c in self.drift.changes],
            "pairs": len(self.drift.pairs),
            "pairs_tried": self.drift.tried,
            "pairs_untried": self.drift.untried,
        }

    def _change_record(self, change: Change, ids: Sequence[str]) -> dict[str, object]:
        return {
            "logs": [self.names[k] for k in change.logs],
            "irreducible": change.irreducible,
            "changed": {ids[j]: [self.names[k] for k in change.between[j]] for j in change.changed},
            "could_explain_alone": [ids[j] for j in change.alone],
            "cannot_explain_alone": [ids[j] for j in change.excluded],
            "undecided": [ids[j] for j in change.undecided],
            "proof": self._proof(change.decision),
            "proofs_changed": {ids[j]: self._disjoint(ids[j], change.between[j]) for j in change.changed},
            "proofs_alone": {ids[j]: self._proof(d) for j, d in change.excluded.items()},
        }

    def _disjoint(self, id_: str, pair: tuple[int, int]) -> dict[str, object]:
        """The log whose lower end of a parameter lies above the upper end of the other one, with the proofs of both ends."""
        above, below = sorted(pair, key=lambda k: -self.entries[k].bound(id_)[0])
        made: dict[str, object] = {}
        for k, end in ((above, "lower"), (below, "upper")):
            mine = [
                c
                for c in self.proofs[k]
                if id_ in c["orthant"] and (c["proves"] != "bound" or (c["parameter"], c["end"]) == (id_, end))
            ]
            made[end] = {"log": self.names[k], "certificates": _of_log(mine, self.names[k])}
        return made

    def _proof(self, decision: Decision) -> dict[str, object]:
        s = decision.solved
        mine = [c for c in s.certificates if c["block"] in s.contradictions and c["proves"] in ("empty", "signs")]
        return {"contradictions": s.contradictions, "certificates": named(mine, self.names)}


def _of_log(certificates: Sequence[Stored], name: str) -> list[dict[str, object]]:
    """Certificates of a single log, whose rows then name it."""

    def row(r: Stored) -> dict[str, object]:
        return {**{k: v for k, v in r.items() if k != "row"}, "log": name}

    return with_rows(certificates, row)


def named(certificates: Sequence[Stored], names: Sequence[str]) -> list[dict[str, object]]:
    """Certificates whose rows have the names of their logs instead of numbers."""

    def row(r: Stored) -> dict[str, object]:
        return {**r, "log": names[r["log"]]}

    return with_rows(certificates, row)
