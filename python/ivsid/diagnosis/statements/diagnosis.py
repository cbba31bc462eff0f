"""Result of a diagnosis as one immutable value, and its record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

from ivsid.diagnosis.candidates.intervals import Bound, intervals
from ivsid.diagnosis.null.leaving import Others
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.null.visibility import Visibility
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.selection.rivals import swapped
from ivsid.diagnosis.selection.select import Selection
from ivsid.diagnosis.selection.structure import Adequacy
from ivsid.diagnosis.statements.claims import Claim
from ivsid.diagnosis.statements.comparison import Gain
from ivsid.diagnosis.statements.extended import extended_text
from ivsid.diagnosis.statements.findings import Finding
from ivsid.diagnosis.statements.model_file import against
from ivsid.diagnosis.statements.motion import sentences
from ivsid.diagnosis.statements.proved import Proof
from ivsid.diagnosis.statements.rejected import Rejected, rejected
from ivsid.diagnosis.statements.shallow_water import Change
from ivsid.diagnosis.statements.upper_limits import allowed
from ivsid.display.shown import Result
from ivsid.display.table import Cells
from ivsid.effects import EFFECTS, Effect
from ivsid.files.records import envelope
from ivsid.intervals import shown
from ivsid.log import Log
from ivsid.setup import SetupFinding, in_doubt
from ivsid.tubes.reached import TubeCheck
from ivsid.vehicle import Vehicle

# Name of the extended model's file.
MODEL: Final = "model.toml"


@dataclass(frozen=True, repr=False)
class Diagnosis(Result):
    """Diagnosis of a simulation: the causes of its errors, and the gain of a better model.

    Attributes:
        verdict: ``adequate``, ``wrong`` or ``unknown``.
        findings: the causes, the strongest first.
        hints: sentences on structure that declared errors explain.
        not_tested: entries with the id of an effect that the log cannot test, the reason and the remedy.
        visible: visibility of each effect at its typical size, by id.
        calibration: method and numbers of the threshold, as in result.json.
        unexplained: share of the innovations' energy above the noise, by channel.
        gain: of the extended model on TEST.
        adequacy: of the plain and of the extended model on TRAIN.
        selection: the causes with their rivals and scores.
        model: the extended model: the plain one with the findings.
        vehicle: of the file.
        inputs: names and SHA-256 hashes of the files.
        seed: of every random draw.
        proofs: on the plain model and TRAIN, and on the extended model if a guarantee was asked for.
        motion: readings of TRAIN and TEST against the tubes of the plain model; empty where it is adequate, or where its rows prove nothing.
        notes: sentences on the logs and the proofs.
        claims: of the vehicle file, each against the log.
        withdrawn: refusals of causes that the fit holds and that are no findings, by id.
        change: masses and drags of TEST over those of TRAIN; None where the logs do not tell.
        setup: faults of the set-up that the vehicle file accepts, or that are not beyond doubt.
        beside: the gain where both models keep the thrust errors that TRAIN shows, if the findings stand by it; None otherwise.
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
    model: Hypothesis
    vehicle: Vehicle
    inputs: tuple[tuple[str, str], ...]
    seed: int
    proofs: tuple[Proof, Proof | None]
    motion: tuple[TubeCheck, ...]
    notes: tuple[str, ...] = field(default=())
    claims: tuple[Claim, ...] = field(default=())
    withdrawn: Mapping[str, Refusal] = field(default_factory=dict)
    change: Change | None = None
    setup: tuple[SetupFinding, ...] = ()
    beside: Gain | None = None

    def _heading(self) -> str:
        logs = " and ".join(name for name, _ in self.inputs[1:])
        return f"of {self.vehicle.name} on {logs}: {self.verdict}, {len(self.findings)} findings{in_doubt(self.setup)}"

    def _cells(self) -> Cells:
        bounds = [[f"{k} {shown(b.lower, b.upper)} {b.unit}" for k, b in f.parameters.items()] for f in self.findings]
        return {
            "cause": [f.effect for f in self.findings],
            "probability": [None if f.like is None else f.like.probability for f in self.findings],
            "interval": ["; ".join(words) or None for words in bounds],
            "could also be": [", ".join(f.alternatives) or None for f in self.findings],
        }

    def _columns(self) -> Mapping[str, object]:
        rows: list[tuple[Finding, str | None, Bound | None]] = []
        for f in self.findings:
            rows += [(f, k, b) for k, b in f.parameters.items()] or [(f, None, None)]
        return {
            "cause": [f.effect for f, _, _ in rows],
            "probability": [None if f.like is None else f.like.probability for f, _, _ in rows],
            "weight": [f.confidence for f, _, _ in rows],
            "parameter": [k for _, k, _ in rows],
            "unit": [None if b is None else b.unit for _, _, b in rows],
            "lower": [None if b is None else b.lower for _, _, b in rows],
            "upper": [None if b is None else b.upper for _, _, b in rows],
            "guaranteed": [None if b is None else b.guaranteed for _, _, b in rows],
        }

    @property
    def moved(self) -> list[str]:
        """A sentence on each log whose motion refutes the plain model."""
        return sentences(self.motion, *(name for name, _ in self.inputs[1:3]))

    @property
    def rejected(self) -> tuple[Rejected, ...]:
        """Candidates that are no findings, the best first, each with the reason."""
        return rejected(self.findings, self.selection, self.withdrawn)

    @cached_property
    def against_model(self) -> tuple[str, ...]:
        """Sentences on why the extended model is not handed out as a vehicle file; none where it is."""
        return against(self.vehicle, self.model, self.selection.last.states.points, self.gain)

    @cached_property
    def allowed(self) -> dict[str, Bound]:
        """Intervals of causes that are no findings, each alone beside the extended model, by parameter."""
        # Claims have intervals of their own.
        named = {*(i for f in self.findings for i in (f.effect, *f.alternatives)), *self.vehicle.model.values}
        unnamed = [f.id for f in self.selection.found if f.id not in named]
        left = [s for s in self.selection.leftover if s.id not in named]
        others = tuple(Others(self.selection.last).beside()) if self.adequacy[1].leans else ()
        return allowed(self.selection.last, left, unnamed, others)

    def record(self) -> dict[str, Any]:
        """The content of result.json."""
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
            "motion": [m.record() for m in self.motion],
            "guarantees": None if self.proofs[1] is None else self.proofs[1].record(),
            "unexplained": self.unexplained,
            "gain": self.gain.record(),
            "model": None if self.against_model else MODEL,
            "why_no_model": list(self.against_model),
            "parameters": {k: float(v) for k, v in self.model.values.items()},
            "notes": list(self.notes),
            "setup": [f.record() for f in self.setup],
        }


def extended_vehicle(result: Diagnosis) -> str:
    """Text of the vehicle file with the findings in its model, every number in a key, with its interval where the log gives one."""
    return extended_text(result.vehicle, result.model, {k: (b.lower, b.upper) for k, b in _bounds(result).items()})


def _bounds(result: Diagnosis) -> dict[str, Bound]:
    """Intervals of the extended model's numbers by parameter: of the findings, and of the plain terms beside all that was found."""
    last, left = result.selection.last, result.selection.leftover
    bounds: dict[str, Bound] = {}
    swaps = swapped(result.selection.found)
    plain = result.selection.plain.h
    ids = [t.id if t.id in EFFECTS else t.id.rpartition(".")[0] for t in plain.terms]
    for id_ in dict.fromkeys((*ids, *(g.effect.id for g in plain.given))):
        bounds |= intervals(last, id_, left, unknown=result.verdict == "unknown", swapped=swaps)
    for finding in result.findings:
        bounds |= finding.parameters
    return bounds


def model_files(result: Diagnosis) -> dict[str, str]:
    """The file of the extended model by its name, where the model is a vessel's and better on the other log; else none."""
    return {} if result.against_model else {MODEL: extended_vehicle(result)}


def inputs_of(vehicle: Vehicle, *logs: Log) -> tuple[tuple[str, str], ...]:
    """Names and SHA-256 hashes of a vehicle file and of logs."""
    return (
        (vehicle.source.rsplit("/", 1)[-1] or vehicle.name, vehicle.sha256),
        *((log.name, log.sha256) for log in logs),
    )


def _detectable(visible: Mapping[str, Visibility]) -> dict[str, dict[str, object]]:
    """Smallest sizes that the log would have shown, with their units, by parameter."""
    found: dict[str, dict[str, object]] = {}
    for id_, v in visible.items():
        if not v.tested:
            continue
        units = {n: p.unit for e in _forms(id_) for n, p in zip(e.parts, e.parameters, strict=True)}
        for name, value in v.detectable.items():
            found[name] = {"value": abs(value), "unit": units.get(name, "")}
    return found


def _forms(id_: str) -> list[Effect]:
    """An effect and its form by a measured quantity, if there is one."""
    effect = EFFECTS[id_]
    return [effect] if effect.measured is None else [effect, effect.measured]
