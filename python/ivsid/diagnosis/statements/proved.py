"""What is proved of a model on a log, without any noise model: that no numbers explain it, or within which they must lie.

Rows over short and long windows, with the declared bounds of sensors, thrust and ambient force, go to the method ``feasible``; every statement
has certificates that ``ivsid verify`` checks in exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from ivsid.diagnosis.candidates.intervals import Bound
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.statements.extended import extended_text, stated
from ivsid.errors import IvsidError
from ivsid.files.records import sealed, to_json
from ivsid.identification import Identification, identify
from ivsid.log import Log
from ivsid.vehicle import Vehicle, parse_vehicle

# Lengths of the windows of integral rows [s]; where accelerations are measured rows are samples.
WINDOWS: Final = (0.5, 2.0, 10.0)
REFUTED: Final = "falsified.json"
GUARANTEED: Final = "guaranteed.json"


@dataclass(frozen=True)
class Proof:
    """What is proved of one model on one log.

    Attributes:
        identification: by ``feasible``; None where the log or the file does not allow it.
        reason: why not.
    """

    identification: Identification | None
    reason: str = ""

    @property
    def status(self) -> str:
        """``refuted`` (no numbers explain the log inside its bounds), ``not_refuted``, or ``not_applicable``."""
        fit = self.identification
        if fit is None or not fit.guaranteed:
            return "not_applicable"
        return "refuted" if fit.status == "empty" else "not_refuted"

    @property
    def refuted(self) -> bool:
        """Whether the model and the declared bounds contradict each other."""
        return self.status == "refuted"

    def record(self) -> dict[str, Any]:
        """As in result.json, under ``falsified``."""
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
        """The few rows that leave no numbers of the usual signs, and so show where the contradiction is; the others exclude the other signs."""
        if not self.refuted or self.identification is None:
            return []
        usual = min(
            self.identification.falsifying,
            key=lambda c: (sum(sign < 0 for sign in c["orthant"].values()), len(c["rows"])),
        )
        return list(usual["rows"])

    @property
    def certificate(self) -> str:
        """The identification's own result, for ``ivsid verify``."""
        if self.identification is None:
            raise ValueError("nothing is proved where nothing is identified")
        return to_json(sealed(self.identification.record())) + "\n"

    def sentence(self, verdict: str) -> str:
        """What a reader has to know of a refuted model."""
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
            else "the statistics see no structure that the model lacks, so an error of sensors, thrust or ambient force was larger there than "
            "declared, or the model is wrong in a way that only these rows show; the verdict holds for errors as they were estimated, and not "
            "for the bounds as they are declared"
        )
        return f"proved: no numbers of the model explain the log inside the declared bounds (rows in {where}); {wider}: {why}"


def proof_of(vehicle: Vehicle, log: Log) -> Proof:
    """What the rows of a log prove of a vehicle file's model."""
    try:
        return Proof(identify(vehicle, log, "feasible", window=WINDOWS))
    except IvsidError as error:
        return Proof(None, str(error))


def extended_proof(vehicle: Vehicle, log: Log, h: Hypothesis) -> Proof:
    """The same of the model that a diagnosis ended with, where it is made of linear terms alone."""
    if h.given:
        return Proof(None, f"{', '.join(g.effect.id for g in h.given)} is no linear term")
    if left_out := stated(h)[1]:
        # A model without a cause that was found is not the one that the findings are of.
        return Proof(None, f"{', '.join(left_out)} is no term that a vehicle file can state")
    return proof_of(parse_vehicle(extended_text(vehicle, h), "model.toml"), log)


def guaranteed(
    parameters: Mapping[str, Bound], proof: Proof, claimed: Mapping[str, float] | None = None
) -> dict[str, Bound]:
    """The proved interval in place of the statistical one where it leaves no effect out, so that the effect is proved, and beside it elsewhere.

    No effect is zero, or the number that the vehicle file claims (``claimed``). A proved interval is never narrowed by what the statistics say, nor theirs called guaranteed.
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
