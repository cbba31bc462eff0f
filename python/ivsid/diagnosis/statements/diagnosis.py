"""The result of a diagnosis, as one immutable value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ivsid.diagnosis.candidates.intervals import Bound
from ivsid.diagnosis.null.visibility import Visibility
from ivsid.diagnosis.selection.adequacy import Adequacy
from ivsid.diagnosis.selection.select import Selection
from ivsid.diagnosis.statements.claims import Claim
from ivsid.diagnosis.statements.comparison import Gain
from ivsid.diagnosis.statements.extended import extended_text
from ivsid.diagnosis.statements.findings import Finding
from ivsid.diagnosis.statements.proved import Proof
from ivsid.diagnosis.statements.rejected import Rejected, rejected
from ivsid.diagnosis.statements.upper_limits import allowed
from ivsid.effects import EFFECTS
from ivsid.files.records import envelope
from ivsid.vehicle import Vehicle


@dataclass(frozen=True)
class Diagnosis:
    """What the simulation gets wrong.

    Attributes:
        verdict: adequate, wrong or unknown.
        findings: the causes, strongest first.
        hints: structure that declared errors can explain, in sentences.
        not_tested: ids that this log cannot show, with the reason and what it would need.
        visible: how far each effect of typical size would have stood out.
        calibration: how the thresholds were made.
        unexplained: share of the residual's energy above the noise, by channel.
        gain: on TEST.
        adequacy: what a generic dictionary sees, of the model as it was and with the findings.
        selection: the steps behind it.
        vehicle: of the file.
        inputs: names and hashes.
        seed: of every random draw.
        proofs: of the model as it was on TRAIN, and of the extended one where a guarantee was asked for.
        claims: what the log says of each number that the vehicle file claims.
    """

    verdict: str
    findings: tuple[Finding, ...]
    hints: tuple[str, ...]
    not_tested: tuple[dict[str, str], ...]
    visible: Mapping[str, Visibility]
    calibration: dict[str, Any]
    unexplained: dict[str, float]
    gain: Gain
    adequacy: tuple[Adequacy, Adequacy]
    selection: Selection
    vehicle: Vehicle
    inputs: tuple[tuple[str, str], ...]
    seed: int
    proofs: tuple[Proof, Proof | None]
    notes: tuple[str, ...] = field(default=())
    claims: tuple[Claim, ...] = field(default=())

    @property
    def rejected(self) -> tuple[Rejected, ...]:
        """The candidates that are no findings, the best first, and why each is none."""
        return rejected(self.findings, self.selection, self.visible, float(self.calibration["threshold"]))

    @property
    def allowed(self) -> dict[str, Bound]:
        """How large causes that are no findings may be, each alone beside the extended model, by the names of their numbers."""
        # What the log says of claims stands with them.
        named = {*(i for f in self.findings for i in (f.effect, *f.alternatives)), *self.vehicle.model.values}
        unnamed = [f.id for f in self.selection.found if f.id not in named]
        return allowed(self.selection.last, [s for s in self.selection.leftover if s.id not in named], unnamed)

    def record(self) -> dict[str, Any]:
        """As in result.json."""
        return {
            **envelope("diagnose", self.inputs, self.seed),
            "verdict": self.verdict,
            "findings": [f.record() for f in self.findings],
            "rejected": [r.record() for r in self.rejected],
            "claims": [c.record() for c in self.claims],
            "hints": list(self.hints),
            "not_tested": list(self.not_tested),
            "detectable": _detectable(self.visible),
            "allowed": {k: b.record() for k, b in self.allowed.items()},
            "calibration": self.calibration,
            "falsified": self.proofs[0].record(),
            "guarantees": None if self.proofs[1] is None else self.proofs[1].record(),
            "unexplained": self.unexplained,
            "gain": self.gain.record(),
            "parameters": {k: float(v) for k, v in self.selection.last.h.values.items()},
            "notes": list(self.notes),
        }


def extended_vehicle(result: Diagnosis) -> str:
    """The text of the vehicle file with the findings in its model; what a file cannot state stands in comments."""
    return extended_text(result.vehicle, result.selection.last.h)


def _detectable(visible: Mapping[str, Visibility]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for id_, v in visible.items():
        if not v.tested:
            continue
        units = {n: p.unit for e in _forms(id_) for n, p in zip(e.parts, e.parameters, strict=True)}
        for name, value in v.detectable.items():
            found[name] = {"value": abs(value), "unit": units.get(name, "")}
    return found


def _forms(id_: str) -> list[Any]:
    effect = EFFECTS[id_]
    return [effect] if effect.measured is None else [effect, effect.measured]
