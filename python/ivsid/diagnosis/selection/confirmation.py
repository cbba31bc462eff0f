"""Confirmation of findings, and of structure that no cause explains, where they are close to their threshold, by simulated null logs.

Null logs are examined until they decide about all that is close, and all of them only where doubt is left. They make a threshold stricter,
and never looser. Those of findings follow the plain model, or the last one with the causes that are beyond doubt, and those of structure the
last one with all causes that were found.

Source: docs/theory.md, "Null logs"; Clopper and Pearson, "The use of confidence or fiducial limits illustrated in the case of the binomial",
Biometrika 26, 1934.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.cache import key_of
from ivsid.diagnosis.null.calibration import trial_of
from ivsid.diagnosis.null.closed_loop import not_followed
from ivsid.diagnosis.null.examination import Families
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.levels import STRUCTURE
from ivsid.diagnosis.null.looks import Looks
from ivsid.diagnosis.null.tail import NullTest
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.rivals import Found
from ivsid.diagnosis.selection.structure import RISK
from ivsid.diagnosis.selection.verdict import STRUCTURE_RULE, VERDICT, Left

# Null logs at most, by default: two of them exceed a threshold of 0.5 %.
# Source: resource: a minute on two processors
NULL_LOGS: Final = 400
# A finding or structure is close if it is less strong than this multiple of its threshold, in minus the logarithm of the chance. The null
# logs of anything stronger would follow a model that is far from the motion.
# Source: measured: make constants
CLOSE: Final = 3.0


@dataclass(frozen=True)
class Confirmation:
    """Outcome of the confirmation.

    Attributes:
        test: the test with the stricter threshold.
        nulls: scores of the null logs, or None if no finding was close.
        note: sentence for the notes of the result, or an empty string.
    """

    test: Threshold
    nulls: NullTest | None = None
    note: str = ""

    @property
    def stricter(self) -> bool:
        """Whether null logs made the threshold stricter than the Gaussian draws did."""
        return self.nulls is not None and self.test.calibration.chance < self.nulls.first

    def record(self) -> dict[str, object]:
        """The entry ``calibration`` of result.json."""
        out = self.test.calibration.record()
        if self.nulls is None:
            return out
        said = self.nulls.record()
        return {
            **out,
            "method": f"{out['method']}; null logs of this programme, simulated forward, where a finding is close",
            "achieved": said["achieved"],
            "simulated": {**said, "gaussian_threshold": self.nulls.first},
        }


def strength(test: Threshold, found: Found) -> float:
    """Minus the natural logarithm of the chance of a finding's fall of chi-squared."""
    return -float(np.log(max(test.chance(found.first, found.fall), 1e-300)))


def confirmed(fit: Fit, test: Threshold, found: Sequence[Found], looks: Looks, last: Fit | None = None) -> Confirmation:
    """Confirms the findings that are close to the threshold.

    Args:
        fit: of the plain model.
        test: with the threshold of the Gaussian draws.
        found: causes that passed the test.
        looks: null logs that may be looked at.
        last: fit of the model with all of them, whose null logs are asked where some are beyond doubt; None asks those of the plain model.
    """
    asked = -float(np.log(test.calibration.chance))
    strengths = {f.id: strength(test, f) for f in found}
    near = {i: s for i, s in strengths.items() if s < CLOSE * asked}
    if not near or looks.most <= 0:
        return Confirmation(test)
    level, first = test.calibration.level, test.calibration.chance
    beside = last is not None and len(near) < len(strengths)
    if last is not None and beside:
        # The plain model is far from a log that holds a strong cause.
        fit = sound(last, fit, near)
    predictor = fit.noise.predictor
    used = looks.decided(
        lambda: trial_of(fit, test.visible, Families(test)),
        lambda: key_of(
            predictor.vehicle, predictor.log, looks.seed, level, test.visible, first, fit.h if beside else None
        ),
        NullTest(np.zeros(0), np.zeros(0, dtype=bool), level, first=first),
        list(near.values()),
    )
    note = _left_its_motion("the Gaussian draws stand", used)
    return Confirmation(replace(test, calibration=replace(test.calibration, chance=used.chance)), used, note)


def _left_its_motion(theory: str, nulls: NullTest) -> str:
    """The note where too many null logs are lost for a threshold, or an empty string.

    Args:
        theory: what stands in its place.
        nulls: their scores.
    """
    if nulls.usable:
        return ""
    beside = "beside those that stay in it" if nulls.chance < nulls.first else "alone"
    return f"null logs of the model leave the motion of the log: {theory} {beside}"


def sound(last: Fit, plain: Fit, ids: Iterable[str]) -> Fit:
    """The last model without some causes, and without those that null logs do not follow: as it would be with neither in the log.

    All other numbers stay as they are beside these causes.

    Args:
        last: fit of the model with all causes.
        plain: fit of the model without any.
        ids: of the causes that are taken out.
    """
    h = last.h
    for id_ in {*ids, *not_followed(h)}:
        h = h.without(id_, plain.h)
    return replace(last, states=last.states.under(h))


@dataclass(frozen=True)
class StructureTest:
    """The examination of the structure that a model leaves in a null log.

    Attributes:
        level: probability with which the structure of a null log may exceed the threshold.
        surveyed: none: the dictionary needs no signatures of effects.
    """

    level: float = STRUCTURE
    surveyed: frozenset[str] = field(default_factory=frozenset)

    def __call__(self, fit: Fit) -> tuple[float, bool]:
        """The strength of the structure, and whether it is more than chance by theory."""
        left = adequacy(fit)
        return left.strength, not (left.white and left.bounded and left.sensed)


@dataclass(frozen=True)
class StructureConfirmation:
    """Outcome of the confirmation of structure.

    Attributes:
        risk: probability below which structure is more than chance.
        nulls: strengths of the null logs, or None if the structure was not close to its threshold.
        note: sentence for the notes of the result, or an empty string.
    """

    risk: float = RISK
    nulls: NullTest | None = None
    note: str = ""

    def record(self) -> dict[str, object]:
        """The entry ``calibration.structure`` of result.json."""
        out: dict[str, object] = {"level": STRUCTURE, "logs": 0, "lost": 0, "achieved": None, "cached": 0}
        said = {} if self.nulls is None else self.nulls.record()
        return {**out, **said, "theory": RISK, "threshold": self.risk}


def beyond_doubt(left: Left) -> bool:
    """Whether what a model leaves makes it insufficient, whatever null logs say of structure or of causes.

    Args:
        left: the structure before and after.
    """
    if any(rule.refuses(left) for rule in VERDICT if rule is not STRUCTURE_RULE):
        return True
    return STRUCTURE_RULE.refuses(left) is not None and left.after.strength >= -CLOSE * np.log(RISK)


def confirmed_structure(last: Fit, library: frozenset[str], left: Left, looks: Looks) -> StructureConfirmation:
    """Confirms structure that is close to its threshold and would make the verdict ``unknown``.

    Args:
        last: fit of the model with the causes that were found.
        library: ids of the effects that the log can show.
        left: the structure before and after.
        looks: null logs that may be looked at.
    """
    if looks.most <= 0 or left.sufficient or beyond_doubt(left):
        return StructureConfirmation()
    if causes := not_followed(last.h):
        return StructureConfirmation(
            note=f"null logs do not follow {' and '.join(causes)}: the threshold of structure is that of chi-squared"
        )
    predictor = last.noise.predictor
    used = looks.decided(
        lambda: trial_of(last, library, StructureTest()),
        lambda: key_of(predictor.vehicle, predictor.log, looks.seed, STRUCTURE, library, RISK, last.h),
        NullTest(np.zeros(0), np.zeros(0, dtype=bool), STRUCTURE, first=RISK),
        [left.after.strength],
    )
    return StructureConfirmation(used.chance, used, _left_its_motion("the threshold of chi-squared stands", used))
