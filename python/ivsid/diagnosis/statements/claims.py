"""Claims of the vehicle file, the numbers that ``[model] values`` state, against a log."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ivsid.diagnosis.candidates.intervals import Bound, intervals
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.plant.usual_hull import hull_limits
from ivsid.diagnosis.selection.structure import Adequacy
from ivsid.diagnosis.statements.findings import Finding
from ivsid.diagnosis.statements.power import largest_drag
from ivsid.effects import EFFECTS, Parameter, Term

# A column of less than this length has no signature: its axis is left out.
# Source: definition: columns of zeros get the length 1e-150
NOTHING: Final = 1e-100


@dataclass(frozen=True)
class Claim:
    """A claim of the vehicle file against a log.

    Attributes:
        parameter: id of the parameter.
        value: the claimed number.
        unit: of the number.
        contradicted: whether a finding says that the number is wrong.
        z: distance of the log's own number from the claim in standard deviations, with the other claims fixed; None without a signature.
        beside: the log's own interval with the other claims fixed.
        alone: the log's own interval with all claims fitted.
        reason: sentence if there is no interval.
    """

    parameter: str
    value: float
    unit: str
    contradicted: bool
    z: float | None = None
    beside: Bound | None = None
    alone: Bound | None = None
    reason: str = ""

    def record(self) -> dict[str, object]:
        """An entry of ``claims`` in result.json."""
        out: dict[str, object] = {
            "parameter": self.parameter,
            "value": self.value,
            "unit": self.unit,
            "contradicted": self.contradicted,
            "z": self.z,
            "interval": None if self.beside is None else self.beside.record(),
            "without_claims": None if self.alone is None else self.alone.record(),
        }
        return {**out, "reason": self.reason} if self.reason else out


def claims(
    last: Fit, left: Sequence[Scored], findings: Sequence[Finding], *, unknown: Adequacy | None = None
) -> tuple[Claim, ...]:
    """Claims of the vehicle file against the log of a fit.

    Each claim is fitted, by itself and with all others, in a linear step from the last model. Both intervals are statistical and allow for
    causes that were not found. What an unknown cause does along a number's own signature cannot be seen: it may be as much as shows beside it, in
    numbers that hulls have, and no drag takes more than drives.

    Args:
        last: fit of the model with all causes that were found.
        left: scores of the other causes beside them.
        findings: of the diagnosis.
        unknown: unexplained structure that is left, in which a cause may hide.
    """
    values = last.noise.predictor.vehicle.model.values
    wrong = {f.effect for f in findings}
    by_id = {t.id: t for t in last.h.terms}
    terms = {i: by_id[i] for i in values if i in by_id}
    shown = [i for i in terms if i in EFFECTS and _acts(last, i)]
    # The other claims are fixed in one interval and fitted in the other, so none of them can hide in either.
    hidden = [s for s in left if s.id not in terms]
    without = _freed(last, shown)
    out = []
    for id_, term in terms.items():
        made = Claim(id_, float(values[id_]), term.unit, id_ in wrong)
        if id_ not in shown:
            out.append(replace(made, reason="nothing in this log shows it"))
            continue
        beside, alone = (
            _beside(unknown, intervals(fit, id_, hidden, unknown=unknown is not None)[id_], fit, term)
            for fit in (_freed(last, [id_]), without)
        )
        out.append(replace(made, z=_away(last, id_), beside=beside, alone=alone))
    return tuple(out)


def _beside(unknown: Adequacy | None, bound: Bound, fit: Fit, term: Term) -> Bound:
    """An interval with room for a force along the number's signature as large as the structure that is left, both in standard deviations."""
    if unknown is None:
        return bound
    k = fit.base.index(fit.gram.index[term.id])
    sigma = float(np.sqrt(fit.projection.covariance[k, k])) / float(fit.gram.unit[fit.gram.index[term.id]])
    room = float(np.sqrt(unknown.unexplained)) * sigma
    # The room is for numbers that hulls have, and above a drag for a force that drives along the motion.
    least, most = hull_limits(fit.noise.predictor.vehicle, [term]).get(term.id, (-np.inf, np.inf))
    most = min(most, largest_drag(fit, term, dict(unknown.outside)))
    lower, upper = possible(
        min(max(bound.lower - room, least), bound.lower),
        max(min(bound.upper + room, most), bound.upper),
        EFFECTS[term.id].parameters[0],
    )
    return replace(bound, lower=lower, upper=upper)


def possible(lower: float, upper: float, parameter: Parameter) -> tuple[float, float]:
    """Ends of an interval of a claim without negative masses and drags.

    Only a claim is asked: it is the single number of its effect, whereas a wind or an anchor has parts of either sign, whatever the sign of its size.
    An interval that holds no other numbers keeps its ends: the log contradicts the physics, and says by how much.
    """
    return (lower, upper) if parameter.signed or upper <= 0.0 else (max(lower, 0.0), upper)


def _acts(fit: Fit, id_: str) -> bool:
    """Whether a parameter has a signature in the log."""
    return id_ in fit.gram.index and float(fit.gram.unit[fit.gram.index[id_]]) > NOTHING


def _away(last: Fit, id_: str) -> float:
    """Distance of the log's own number from the claim, in standard deviations by the noise model."""
    g = last.gram
    k = g.index[id_]
    p = Projection(g, [q for q in last.base if q != k])
    claimed = float(last.noise.predictor.vehicle.model.values[id_])
    distance = (float(last.h.values[id_]) - claimed) * float(g.unit[k]) + float(p.solve([k])[0][0])
    return float(abs(distance) * np.sqrt(max(float(p.information([k])[0, 0]), 0.0)))


def _freed(last: Fit, ids: Collection[str]) -> Fit:
    """The fit with some claims fitted, moved to the numbers that the log gives them."""
    g = last.gram
    columns = [g.index[i] for i in ids if g.index[i] not in last.base]
    base = (*last.base, *columns)
    step = Projection(g, base).coefficients[len(last.base) :]
    blocks = g.blocks[:, :, columns]
    y = g.y - np.einsum("cbj,c->bj", g.columns(columns), step)
    moved = replace(g, y=y, score=g.score - blocks @ step, energy=np.einsum("bi,bi->b", y, y))
    values = {g.names[k]: float(last.h.values[g.names[k]] + s / g.unit[k]) for k, s in zip(columns, step, strict=True)}
    h = replace(last.h, values={**last.h.values, **values}, freed=last.h.freed | set(values))
    return replace(last, gram=moved, base=base, states=last.states.under(h))
