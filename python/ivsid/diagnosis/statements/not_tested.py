"""Effects that a log cannot test, with the reason and the remedy, and the note on axes that are left out."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.learning import undetermined
from ivsid.diagnosis.estimation.left_out import axes_left_out
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.estimation.whitening import SLOW
from ivsid.diagnosis.null.visibility import VISIBLE, Visibility
from ivsid.diagnosis.plant.usual_hull import usual_numbers
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.effects import EFFECTS


def not_tested(fit: Fit, visible: Mapping[str, Visibility], named: Collection[str] = ()) -> tuple[dict[str, str], ...]:
    """Effects that the log cannot test.

    Args:
        fit: of the plain model.
        visible: visibility by id.
        named: effects that are findings or alternatives of one: the log has shown those, whatever their usual size shows.

    Returns:
        Entries of ``not_tested`` in result.json: ``effect``, ``reason`` and ``needs``.
    """
    out = [
        {"effect": id_, "reason": why, "needs": ", ".join(EFFECTS[id_].needs)}
        for id_, why in fit.refused.items()
        if id_ not in named
    ]
    for id_, v in visible.items():
        if id_ in named:
            continue
        if v.blind and v.z >= VISIBLE:
            reason = "in this log its signature is mostly made of the sensors' own errors"
            out.append({"effect": id_, "reason": reason, "needs": EFFECTS[id_].separate})
        elif v.z < VISIBLE and fit.noise.left_out and EFFECTS[id_].turning:
            reason = f"{_why(fit)}, and yaw is left out: beside it an effect of typical size would stand out by {v.z:.1f} standard deviations"
            out.append({"effect": id_, "reason": reason, "needs": EFFECTS[id_].separate})
        elif v.z < VISIBLE:
            reason = f"an effect of typical size would stand out by {v.z:.1f} standard deviations, and {VISIBLE:g} are needed"
            out.append({"effect": id_, "reason": reason, "needs": EFFECTS[id_].separate})
    return tuple(out)


def left_out_note(fit: Fit) -> list[str]:
    """A sentence on the axes that are left out and on the numbers that a log leaves open, or none."""
    unknown = undetermined(fit)
    if not fit.noise.left_out:
        if not unknown:
            return []
        return [
            f"the log does not determine {', '.join(unknown)}: the models state what a usual hull of this mass and length has"
        ]
    claimed = fit.noise.predictor.vehicle.model.values
    kept = [t.id for t in fit.h.terms if t.id in fit.fixed and t.id not in claimed]
    hulls = usual_numbers(fit.noise.predictor.vehicle)
    usual = [t.id for t in fit.h.terms if (t.id in kept and fit.fixed[t.id] == hulls.get(t.id)) or t.id in unknown]
    own = [i for i in kept if i not in usual]
    said = [f"{', '.join(own)} are those of a first model, with yaw"] if own else []
    if usual or not own:
        said.append(
            f"{', '.join(usual) or 'the parameters of yaw'} are those of a usual hull of this mass and length, not of this log"
        )
    return [
        f"{_why(fit)}: yaw is left out, so that causes that act by their moment alone are not tested. The yaw rate is that of its sensors, and sway "
        f"counts in means over {SLOW:g} s. Of the models {', and '.join(said)}"
    ]


def _why(fit: Fit) -> str:
    """The reason why yaw is left out."""
    predictor = fit.noise.predictor
    # The axis is left out by the filters that the file lets expect, or by those of the fit.
    first = Predictor(predictor.vehicle, predictor.log, declared_ambient(predictor.vehicle), driving=predictor.driving)
    if axes_left_out(first) or axes_left_out(predictor):
        return "the vehicle hardly turns"
    return f"the hull damps its turns too quickly for readings of yaw every {predictor.log.h:.3g} s (more rows a second, or a better gyro, may show them)"
