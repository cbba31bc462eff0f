"""The stages in turn: a log, its model, what is wrong with it, and what the better model is worth on another log."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.thresholds import calibrate
from ivsid.diagnosis.null.visibility import VISIBLE, Threshold, Visibility, visibility
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.confirmation import NULL_LOGS, confirmed
from ivsid.diagnosis.selection.parallel import at_once
from ivsid.diagnosis.selection.select import select
from ivsid.diagnosis.statements.claims import claims
from ivsid.diagnosis.statements.comparison import compare, missing_force
from ivsid.diagnosis.statements.diagnosis import Diagnosis
from ivsid.diagnosis.statements.falsified import falsified
from ivsid.diagnosis.statements.findings import finding, may_be_none, own_columns, shallow, unknown
from ivsid.diagnosis.statements.hints import hints
from ivsid.diagnosis.statements.proved import extended_proof, guaranteed, proof_of
from ivsid.diagnosis.statements.shallow_water import change
from ivsid.effects import EFFECTS
from ivsid.log import Log
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
LEVEL: Final = 0.005
# What a cause has to explain, times what is left unexplained beside it, to keep its name.
DOMINANT: Final = 9.0
EPOCH: Final = 1e8


# A candidate that runs away is tried, found useless and left: its overflows are no news.
@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def diagnose(
    vehicle: Vehicle,
    train: Log,
    test: Log,
    *,
    seed: int = 1,
    progress: Callable[[str], None] = lambda _: None,
    null_logs: int = NULL_LOGS,
    cache: Path | None = None,
) -> Diagnosis:
    """Compares the vehicle file's simulation with a log, and what it finds with another.

    Args:
        vehicle: whose ``[model]`` is examined; the plain model by default.
        train: the log in which causes are looked for.
        test: another log, on which the better model is tried.
        seed: of the random draws.
        progress: told of each step.
        null_logs: that a finding close to its threshold has to pass, at most; 0 leaves it to the Gaussian draws.
        cache: folder where their scores are kept, or None.

    Raises:
        IvsidError: a log that the model cannot be held against, in one sentence.
    """
    origin = float(train.t[0]) if max(train.t[0], test.t[0]) > EPOCH else None
    log, other = channels(train, vehicle, origin), channels(test, vehicle, origin)
    progress("fitting the model")
    fit = plain_fit(vehicle, log, everything)
    visible = visibility(fit)
    seen = frozenset(i for i, v in visible.items() if v.tested)
    calibration = calibrate(fit, seen, LEVEL, seed)
    test_of = Threshold(calibration, seen, frozenset(i for i, v in visible.items() if v.blind))
    progress("looking for causes")
    selection = select(fit, test_of, fit.fixed, progress)
    confirmation = confirmed(fit, test_of, selection.found, seed, null_logs, cache, progress)
    if confirmation.stricter and not all(confirmation.test.stands(f.first, f.fall) for f in selection.found):
        progress("looking again, at the threshold of the null logs")
        selection = select(fit, confirmation.test, fit.fixed, progress)
    before = adequacy(fit)
    after = adequacy(selection.last) if selection.found else before
    evidence = _before_and_after(vehicle, train, fit, selection.last) if selection.found else {}
    named = selection.found
    complete = after.sufficient(before, len(named))
    if not after.quiet:
        # Where much is left that nobody explains, only a cause that explains far more than that, where it acts, keeps its name.
        last, factor = selection.last, 1.0 if complete else DOMINANT
        named = tuple(f for f in named if f.fall >= factor * after.beside(last, own_columns(last, f.id)))
    findings = tuple(finding(f, selection.last, selection.leftover, evidence, after) for f in named)
    if not after.quiet:
        findings = tuple(f for f in findings if not may_be_none(f))
    proof = proof_of(vehicle, train)
    extended = None
    # An interval rests on the model: another cause that would do as well, or one that nobody knows, ends its guarantee.
    if findings and complete and not any(f.alternatives for f in findings):
        extended = extended_proof(vehicle, train, selection.last.h)
        findings = tuple(
            replace(f, parameters=guaranteed(f.parameters, extended, vehicle.model.values)) for f in findings
        )
    if not complete:
        kept = {f.effect for f in findings}
        findings = (*findings, unknown(after, [f.id for f in selection.found if f.id not in kept]))
    claimed = claims(selection.last, selection.leftover, findings, unknown=not after.quiet)
    progress("trying both models on the other log")
    # What TRAIN's sensors and thrusters were off by is no part of the model, and none of model.toml.
    plain = replace(fit.h, declared_errors={})
    extended_h = plain if selection.last.h is fit.h else replace(selection.last.h, declared_errors={})
    predictor = Predictor(vehicle, other, selection.last.noise.predictor.ambient)
    moved, gain = at_once(
        partial(change, vehicle, selection.last, other), partial(compare, predictor, plain, extended_h, seed)
    )
    if moved is not None and moved.factor is not None:
        findings = (*findings, shallow(moved))
    verdict = "adequate" if not findings else ("wrong" if any(f.effect != "unknown" for f in findings) else "unknown")
    said = [n for n in (confirmation.note, proof.sentence(verdict) if proof.refuted else "") if n]
    return Diagnosis(
        verdict,
        findings,
        hints(selection.last),
        _not_tested(fit, visible),
        visible,
        confirmation.record(),
        _unexplained(selection.last),
        gain,
        (before, after),
        selection,
        vehicle,
        (
            (vehicle.source.rsplit("/", 1)[-1] or vehicle.name, vehicle.sha256),
            (train.name, train.sha256),
            (test.name, test.sha256),
        ),
        seed,
        (proof, extended),
        (*log.notes, *train.notes, *_left_out(fit), *said),
        claimed,
    )


def _left_out(fit: Fit) -> list[str]:
    """What is said where axes were left out."""
    if not fit.noise.left_out:
        return []
    usual = [t.id for t in fit.h.terms if t.id in fit.fixed and t.id not in fit.noise.predictor.vehicle.model.values]
    return [
        "the vehicle hardly turns: sway and yaw are left out, and "
        f"{', '.join(usual) or 'their parameters'} of the models are those of a usual hull of this mass and length, not of this log"
    ]


def _not_tested(fit: Fit, visible: Mapping[str, Visibility]) -> tuple[dict[str, str], ...]:
    out = [{"effect": id_, "reason": why, "needs": ", ".join(EFFECTS[id_].needs)} for id_, why in fit.refused.items()]
    for id_, v in visible.items():
        if v.blind and v.z >= VISIBLE:
            reason = "in this log its signature is mostly made of the sensors' own errors"
            out.append({"effect": id_, "reason": reason, "needs": EFFECTS[id_].separate})
        elif v.z < VISIBLE:
            reason = f"an effect of typical size would stand out by {v.z:.1f} standard deviations, and 8 are needed"
            out.append({"effect": id_, "reason": reason, "needs": EFFECTS[id_].separate})
    return tuple(out)


def _unexplained(fit: Fit) -> dict[str, float]:
    """The share of each channel's squared errors above what its noise gives."""
    p = fit.projection
    g = fit.gram
    left = g.y - g.explained(p.base, p.coefficients)
    rows = len(fit.noise.predictor.labels)
    energy = (left.reshape(-1, rows, g.length) ** 2).sum(axis=(0, 2))
    count = g.rows.sum() / rows
    out: dict[str, float] = {}
    for channel in ("surge", "sway", "yaw"):
        at = [i for i, c in enumerate(fit.noise.predictor.channels) if c == channel]
        total = float(energy[at].sum())
        out[channel] = max(0.0, 1.0 - count * len(at) / total) if total > 0 else 0.0
    return out


def _before_and_after(vehicle: Vehicle, log: Log, plain: Fit, last: Fit) -> dict[str, dict[str, Any]]:
    """Force residuals and contradicted rows of both models on TRAIN, by channel."""
    rms = [missing_force(f.noise.predictor, f.h, f.states) for f in (plain, last)]
    rows = [falsified(vehicle, log, f.h) for f in (plain, last)]
    return {
        c: {
            "residual_rms_before": rms[0][c],
            "residual_rms_after": rms[1][c],
            "falsified_samples_before": None if rows[0] is None else rows[0][c],
            "falsified_samples_after": None if rows[1] is None else rows[1][c],
        }
        for c in ("surge", "sway", "yaw")
    }
