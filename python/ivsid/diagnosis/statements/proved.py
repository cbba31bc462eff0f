"""Proofs beside the statistics: that no parameters explain a log, or the intervals in which the parameters must lie.

Rows over short and long windows, with the declared bounds of sensors, thrust and ambient force, go to the method ``feasible``. Every proof
has certificates that ``ivsid verify`` checks in exact arithmetic.

Source: docs/theory.md, "The feasible set".
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from ivsid.diagnosis.candidates.intervals import Bound
from ivsid.diagnosis.data.outliers import outliers
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.statements.extended import extended_text, stated
from ivsid.diagnosis.statements.findings import Finding
from ivsid.errors import IvsidError
from ivsid.files.records import sealed, to_json
from ivsid.identification import Identification, identify
from ivsid.log import Log
from ivsid.vehicle import Vehicle, parse_vehicle

# Lengths of the windows of integral rows [s]: short ones show quick contradictions, long ones small and slow ones.
# Source: measured: make constants
WINDOWS: Final = (0.5, 2.0, 10.0)
# Times that the rows which refute a model are left out, until the refutation counts as the whole log's.
# Source: definition: three accidents a log, such as a wave of another ship
ROUNDS: Final = 3
# Time on either side of a row whose readings are left out with it [s].
# Source: geometry: ten samples at 20 Hz
SPREAD: Final = 0.5
# Columns that sensors measure.
MEASURED: Final = frozenset({"u", "v", "r", "ax", "ay", "udot", "vdot", "rdot", "psi", "x", "y"})
# What rows assume of an angle without a stated rate.
HOLDS: Final = re.compile(r"(azimuth|rudder)_.* holds from ")
REFUTED: Final = "falsified.json"
GUARANTEED: Final = "guaranteed.json"


@dataclass(frozen=True)
class Proof:
    """Proof on one model and one log.

    Attributes:
        identification: by ``feasible``; None if the log or the vehicle file does not allow it.
        reason: sentence if there is no identification.
    """

    identification: Identification | None
    reason: str = ""

    @property
    def status(self) -> str:
        """``refuted`` (no parameters explain the log inside the bounds), ``not_refuted``, or ``not_applicable``."""
        fit = self.identification
        if fit is None or not fit.guaranteed:
            return "not_applicable"
        return "refuted" if fit.status == "empty" else "not_refuted"

    @property
    def wider(self) -> float:
        """Factor on all declared bounds from which on some numbers explain the log, where none do inside the bounds; else 0."""
        if not self.refuted or self.identification is None:
            return 0.0
        return float("inf") if self.identification.inflation is None else self.identification.inflation

    @property
    def refuted(self) -> bool:
        """Whether the model and the declared bounds contradict each other."""
        return self.status == "refuted"

    def record(self) -> dict[str, Any]:
        """The entry ``falsified`` or ``guarantees`` of result.json."""
        fit = self.identification
        if fit is None or self.status == "not_applicable":
            reason = self.reason or (fit.reason if fit is not None else "") or "its bounds or its method prove nothing"
            return {"status": "not_applicable", "reason": reason}
        rows = [{k: r[k] for k in ("kind", "channel", "time", "duration", "side")} for r in self.contradiction]
        return {
            "status": self.status,
            "window": list(WINDOWS),
            "inflation": fit.inflation,
            "rows": rows,
            "assumes": list(fit.assumes),
            "certificate": REFUTED if self.refuted else None,
        }

    @property
    def contradiction(self) -> list[dict[str, Any]]:
        """The few rows that exclude all parameters of the usual signs; they show where the contradiction is."""
        if not self.refuted or self.identification is None:
            return []
        usual = min(
            self.identification.falsifying,
            key=lambda c: (sum(sign < 0 for sign in c["orthant"].values()), len(c["rows"])),
        )
        return list(usual["rows"])

    @property
    def certificate(self) -> str:
        """Text of the identification's result, for ``ivsid verify``.

        Raises:
            ValueError: if there is no identification.
        """
        if self.identification is None:
            raise ValueError("nothing is proved where nothing is identified")
        return to_json(sealed(self.identification.record())) + "\n"

    def sentence(self, verdict: str) -> str:
        """Sentence on a refuted model.

        Args:
            verdict: of the diagnosis.
        """
        assert self.identification is not None
        rows = self.contradiction
        where = ", ".join(sorted({f"{r['channel']} at t = {r['time']:.6g} s" for r in rows})[:6])
        factor = self.identification.inflation
        wider = (
            "no factor on the bounds would do"
            if factor is None
            else f"all bounds would have to be {factor:.3g} times as wide"
        )
        why = (
            "either the model is wrong, or an error of sensors, thrust or ambient force was larger there than declared"
            if verdict != "adequate"
            else "the statistics see no structure that the model lacks, and no rows refute it where the readings of these are left out, so an error of "
            "sensors, thrust or ambient force was larger there than declared; the verdict holds for errors as they were estimated, and not for the "
            "bounds as they are declared"
        )
        return f"proved: no numbers of the model explain the log inside the declared bounds (rows in {where}); {wider}: {why}"


def proof_of(vehicle: Vehicle, log: Log) -> Proof:
    """Proof on the model of a vehicle file, from the rows of a log."""
    try:
        return Proof(identify(vehicle, log, "feasible", window=WINDOWS, examine=False))
    except IvsidError as error:
        return Proof(None, str(error))


def upheld(proof: Proof, *, running: bool) -> Proof:
    """A proof, unless its rows assume that angles hold from row to row and the log shows that they run.

    Args:
        proof: on a model and a log.
        running: whether the log shows that (``estimation.angles``).
    """
    fit = proof.identification
    held = [] if fit is None or not running else [a for a in fit.assumes if HOLDS.match(a)]
    if not held:
        return proof
    return Proof(
        None, f"it would assume that {held[0]}, and the log shows that angles run: state their rates under [log] rates"
    )


def lasting(proof: Proof, vehicle: Vehicle, log: Log) -> float:
    """Factor on all declared bounds from which on some numbers explain a log without the readings that refute them first; 0 without a proof.

    A few readings far outside of their bounds refute every model. So readings that no motion explains are left out, and then those of the rows that
    contradict each other, ``ROUNDS`` times: what is refuted still is so by the whole log, and not by an accident in it.

    Args:
        proof: on the vehicle file's model and the whole log.
        vehicle: of the file.
        log: the log.
    """
    columns = {k: np.where(outliers(x), np.nan, x) if k in MEASURED else x for k, x in log.columns.items()}
    for _ in range(ROUNDS):
        if not proof.refuted:
            return 0.0
        for row in proof.contradiction:
            near = (log.t >= row["time"] - SPREAD) & (log.t <= row["time"] + row["duration"] + SPREAD)
            columns = {k: np.where(near, np.nan, x) if k in MEASURED else x for k, x in columns.items()}
        proof = proof_of(vehicle, replace(log, columns=columns))
    return proof.wider


def extended_proof(vehicle: Vehicle, log: Log, h: Hypothesis) -> Proof:
    """Proof on the extended model, if all of its causes are linear terms that a vehicle file can state."""
    if h.given:
        return Proof(None, f"{', '.join(g.effect.id for g in h.given)} is no linear term")
    if left_out := stated(h)[1]:
        # A model that lacks a cause is not the model of the findings.
        return Proof(None, f"{', '.join(left_out)} is no term that a vehicle file can state")
    return proof_of(parse_vehicle(extended_text(vehicle, h), "model.toml"), log)


def guaranteed(
    parameters: Mapping[str, Bound], proof: Proof, claimed: Mapping[str, float] | None = None
) -> dict[str, Bound]:
    """Intervals with the proved ones among them.

    A proved interval that excludes "no effect" proves the effect and takes the place of the statistical one. Any other proved interval
    stands beside the statistical one. A proved interval is never narrowed by statistics, and a statistical one is never called guaranteed.

    Args:
        parameters: statistical intervals by parameter.
        proof: on the extended model.
        claimed: numbers of the vehicle file by parameter, which are "no effect" there; zero is elsewhere.
    """
    fit = proof.identification
    out = dict(parameters)
    if fit is None or proof.status != "not_refuted":
        return out
    for id_, bound in parameters.items():
        found = fit.parameters.get(id_)
        if found is None or not np.isfinite([found.lower, found.upper]).all():
            continue
        none = (claimed or {}).get(id_, 0.0)
        if found.lower <= none <= found.upper:
            out[id_] = replace(bound, proved=(found.lower, found.upper))
            continue
        beside = (bound.lower, bound.upper)
        out[id_] = replace(bound, lower=found.lower, upper=found.upper, guaranteed=True, statistical=beside)
    return out


def proved_findings(
    findings: tuple[Finding, ...], vehicle: Vehicle, log: Log, h: Hypothesis, *, running: bool = False
) -> tuple[tuple[Finding, ...], Proof | None]:
    """Findings with proved intervals, and the proof on the extended model.

    An interval rests on the model. Alternatives that would do as well end its guarantee, so there is no proof beside them.

    Args:
        findings: of a diagnosis that leaves no unexplained structure.
        vehicle: of the file.
        log: TRAIN.
        h: the extended model.
        running: whether the log shows that angles run from row to row.

    Returns:
        The findings, with proved intervals if there is a proof, and the proof or None.
    """
    if not findings or any(f.alternatives for f in findings):
        return findings, None
    proof = upheld(extended_proof(vehicle, log, h), running=running)
    return tuple(replace(f, parameters=guaranteed(f.parameters, proof, vehicle.model.values)) for f in findings), proof
