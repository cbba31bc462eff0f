"""Causes of one thruster alone, where a fitted error of its thrust has left its bound behind.

Each effect of a thrust may be one of a single thruster: a propeller that is nicked, a motor whose current is limited. Asked of every thruster in every
log they would be as many candidates again as there are thrusters. Errors that are declared tell where to look: such a cause has an error of its own
thruster leave its bound.

Source: docs/theory.md, "Causes of one thruster".
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.effects import Inflow, Thrust

# Fitted error of a thrust, in its bound, from which on causes of its thruster alone are asked for.
# Source: definition: an error is twice what is declared
LEAVING: Final = 2.0
# Thrusters that are asked for at most, those whose errors are farthest outside first.
# Source: resource: each adds a survey of its five causes, and the fit drags the errors of others along
THRUSTERS: Final = 4


def with_one_thruster(fit: Fit) -> tuple[Fit, list[Scored]]:
    """The fit with columns of causes of one thruster alone, and their scores.

    Args:
        fit: of the model.
    """
    predictor = fit.noise.predictor
    known = predictor.vehicle.thrusters
    errors = zip(known, predictor.propulsion.errors, strict=True)
    far = {t.name: e.largest(t.name, fit.h.declared_errors) for t, e in errors}
    names = [name for name in sorted(far, key=far.__getitem__, reverse=True)[:THRUSTERS] if far[name] > LEAVING]
    if len(known) == 1 or not names:
        return fit, []
    out = Columns()
    # A thrust that lags or is late moves no curve.
    asked = [c for c in fit.candidates if c.effect.per_thruster and isinstance(c.effect.acts, (Thrust, Inflow))]
    made = [one for c in asked for name in names for one in c.alone_on(fit.signatures, name, out)]
    if not made:
        return fit, []
    base = fit.projection.base
    fit = replace(fit, gram=fit.gram.extended(out.names, out.arrays))
    p = Projection(fit.gram, base)
    scored = (one.score(p, fit.signatures) for one in made)
    # They are searched as well as the causes of all thrusters together.
    return fit, [replace(s, looks=s.looks * (1 + len(names))) for s in scored if s is not None]
