"""What the vehicle file claims of its model, and what the log says of each of these numbers."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from ivsid.diagnosis.candidates.intervals import Bound, intervals
from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.statements.findings import Finding
from ivsid.effects import EFFECTS

# A column that is smaller than this has no signature at all: its axis is left out.
NOTHING: Final = 1e-100


@dataclass(frozen=True)
class Claim:
    """A number that the vehicle file claims, held against a log.

    Attributes:
        parameter: its id.
        value: as claimed.
        unit: of it.
        contradicted: the log's findings say that it is wrong.
        z: how many standard deviations the log stands away from it, the other claims held; None where nothing shows it.
        beside: the log's own interval with the other claims as they stand.
        alone: the log's own interval with no claim held at all.
        reason: why there is no interval.
    """

    parameter: str
    value: float
    unit: str
    contradicted: bool
    z: float | None = None
    beside: Bound | None = None
    alone: Bound | None = None
    reason: str = ""

    def record(self) -> dict[str, Any]:
        """As in result.json."""
        out: dict[str, Any] = {
            "parameter": self.parameter,
            "value": self.value,
            "unit": self.unit,
            "contradicted": self.contradicted,
            "z": self.z,
            "interval": None if self.beside is None else self.beside.record(),
            "without_claims": None if self.alone is None else self.alone.record(),
        }
        return {**out, "reason": self.reason} if self.reason else out


def claims(last: Fit, left: Sequence[Scored], findings: Sequence[Finding], *, unknown: bool) -> tuple[Claim, ...]:
    """Every claim of the vehicle file against the log that the last model was fitted to.

    Each claim is taken back, by itself and with all others, in a linear step from the last model. Both intervals are statistical, and
    hold what a cause that was not found may hide; where something ``unknown`` is left, all that may hide in it.

    Args:
        last: the model with all that was found.
        left: scores of what was not found, in its columns.
        findings: that stand.
        unknown: whether something is left that nothing explains.
    """
    values = last.noise.predictor.vehicle.model.values
    wrong = {f.effect for f in findings}
    by_id = {t.id: t for t in last.h.terms}
    terms = {i: by_id[i] for i in values if i in by_id}
    shown = [i for i in terms if i in EFFECTS and _acts(last, i)]
    # The other claims are held in one interval and fitted in the other: in neither may one of them hide.
    hidden = [s for s in left if s.id not in terms]
    without = _freed(last, shown)
    out = []
    for id_, term in terms.items():
        made = Claim(id_, float(values[id_]), term.unit, id_ in wrong)
        if id_ not in shown:
            out.append(replace(made, reason="nothing in this log shows it"))
            continue
        beside, alone = (
            intervals(fit, id_, fit.fixed, hidden, unknown=unknown)[id_] for fit in (_freed(last, [id_]), without)
        )
        out.append(replace(made, z=_away(last, id_), beside=beside, alone=alone))
    return tuple(out)


def _acts(fit: Fit, id_: str) -> bool:
    return id_ in fit.gram.index and float(fit.gram.unit[fit.gram.index[id_]]) > NOTHING


def _away(last: Fit, id_: str) -> float:
    """How far the log's own number is from the claim, in standard deviations by the noise model."""
    g = last.gram
    k = g.index[id_]
    p = Projection(g, [q for q in last.base if q != k])
    claimed = float(last.noise.predictor.vehicle.model.values[id_])
    distance = (float(last.h.values[id_]) - claimed) * float(g.unit[k]) + float(p.solve([k])[0][0])
    return float(abs(distance) * np.sqrt(max(float(p.information([k])[0, 0]), 0.0)))


def _freed(last: Fit, ids: Collection[str]) -> Fit:
    """The model without some claims, moved to the numbers that the log gives them."""
    g = last.gram
    columns = [g.index[i] for i in ids if g.index[i] not in last.base]
    base = (*last.base, *columns)
    step = Projection(g, base).coefficients[len(last.base) :]
    blocks = g.blocks[:, :, columns]
    y = g.y - np.einsum("cbj,c->bj", g.columns(columns), step)
    moved = replace(g, y=y, score=g.score - blocks @ step, energy=np.einsum("bi,bi->b", y, y))
    values = {g.names[k]: float(last.h.values[g.names[k]] + s / g.unit[k]) for k, s in zip(columns, step, strict=True)}
    h = replace(last.h, values={**last.h.values, **values}, freed=last.h.freed | set(values))
    return replace(last, gram=moved, base=base, h=h)
