"""What is said of a cause that was found, and of what nobody explains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ivsid.diagnosis.candidates.intervals import Bound, intervals
from ivsid.diagnosis.candidates.scored import Scored
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.selection.adequacy import Adequacy, energy_of
from ivsid.diagnosis.selection.select import Found
from ivsid.diagnosis.statements.shallow_water import Change
from ivsid.effects import EFFECTS

# No log shows these by itself.
_TWINS: Final = {
    "added_mass.munk": ("drag.lift.yaw",),
    "drag.lift.yaw": ("added_mass.munk",),
    "thruster.asymmetry": ("thruster.failure",),
}


@dataclass(frozen=True)
class Finding:
    """A cause, with those that could be taken for it."""

    effect: str
    confidence: float
    alternatives: tuple[str, ...]
    separate_by: str
    parameters: dict[str, Bound]
    evidence: dict[str, Any]
    description: str = ""

    def record(self) -> dict[str, Any]:
        """As in result.json."""
        out: dict[str, Any] = {
            "effect": self.effect,
            "confidence": self.confidence,
            "alternatives": list(self.alternatives),
            "separate_by": self.separate_by,
            "parameters": {k: b.record() for k, b in self.parameters.items()},
            "evidence": self.evidence,
        }
        if self.description:
            out["description"] = self.description
        return out


def finding(
    found: Found,
    last: Fit,
    left: Sequence[Scored],
    evidence: Mapping[str, dict[str, Any]],
    rest: Adequacy,
) -> Finding:
    """A cause with its set, its intervals and what speaks for it."""
    channel = _channel(last, found.id)
    weights = np.array([np.exp(-0.5 * (found.rivals[0].merit - r.merit)) for r in found.rivals])
    names = [r.id for r in found.rivals]
    for twin in _TWINS.get(found.id, ()):
        if twin not in names:
            names.append(twin)
            weights = np.r_[weights, 1.0 if twin in ("added_mass.munk", "drag.lift.yaw") else 0.3]
    confidence = float(weights[0] / weights.sum())
    alternatives = tuple(n for n in names if n != found.id)[:4]
    effect = EFFECTS[found.id]
    return Finding(
        found.id,
        confidence,
        alternatives,
        effect.separate if alternatives else "",
        intervals(last, found.id, last.fixed, left, unknown=not rest.quiet),
        {
            "channel": channel,
            **evidence.get(channel, {}),
            "z": float(np.sqrt(max(found.fall, 0.0))),
            "chance": found.chance,
        },
    )


def may_be_none(finding: Finding) -> bool:
    """Whether the interval of a cause's only number holds that at which it is none."""
    parameters = EFFECTS[finding.effect].parameters
    bounds = list(finding.parameters.values())
    if not len(parameters) == len(bounds) == 1:
        return False
    lower, upper = bounds[0].within or (bounds[0].lower, bounds[0].upper)
    return lower <= parameters[0].none <= upper


def shallow(moved: Change) -> Finding:
    """Masses and drags scale alike from one log to the other."""
    assert moved.factor is not None
    factor, sigma = moved.factor
    p = EFFECTS["environment.shallow_water"].parameters[0]
    bound = Bound(factor - 4 * sigma, factor + 4 * sigma, p.unit, p.symbol)
    evidence = {
        "channel": "surge",
        "z": abs(np.log(factor)) * factor / sigma,
        "ratio": {k: r for k, (r, _) in moved.ratio.items()},
        "ratio_deviation": {k: sigma for k, (_, sigma) in moved.ratio.items()},
    }
    id_ = "environment.shallow_water"
    return Finding(id_, 1.0, (), "", {id_: bound}, evidence)


def unknown(left: Adequacy, near: Sequence[str]) -> Finding:
    """A finding without a name: what the residual looks like."""
    likely = ", ".join(f"{name} in {channel} ({np.sqrt(fall):.0f} sigma)" for name, channel, fall in left.strongest)
    channel = left.strongest[0][1]
    text = (
        f"the errors that the model leaves still follow the motion (dictionary statistic {left.statistic:.2f}, about 1 where nothing is "
        f"left), strongest with {likely}; no cause of the catalogue explains it"
    )
    if near:
        text += f"; the nearest are {' and '.join(near)}, which the extended model holds and nothing proves"
    evidence = {
        "channel": channel,
        "z": float(np.sqrt(left.strongest[0][2])),
        "statistic": left.statistic,
        "chance": left.chance,
    }
    return Finding("unknown", 1.0, (), "", {}, evidence, text)


def _channel(fit: Fit, id_: str) -> str:
    """Where an effect shows most."""
    own = own_columns(fit, id_)
    return fit.noise.predictor.channels[int(np.argmax(energy_of(fit, own)))] if own else ""


def own_columns(fit: Fit, id_: str) -> list[int]:
    """An effect's columns in a fit that has it."""
    g = fit.gram
    return [k for k in fit.base if g.names[k] == id_ or g.names[k].startswith(f"{id_}.")]
