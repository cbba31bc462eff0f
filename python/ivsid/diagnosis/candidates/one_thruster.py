"""Causes of one thruster alone, where that of all shows something or a fitted error of its thrust has left its bound behind.

Each effect of a thrust may be one of a single thruster: a propeller that is nicked, a motor whose current is limited. Asked of every thruster in every
log they would be as many candidates again as there are thrusters. The same cause of all thrusters tells where to look, as it is partly that of one, and
errors that are declared do: a cause that moves a curve has an error of its own thruster leave its bound.

Source: docs/theory.md, "Causes of one thruster".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from ivsid.diagnosis.estimation.columns import Columns
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.effects import Response

# Fitted error of a thrust, in its bound, from which on causes of its thruster alone are asked for.
# Source: definition: an error is twice what is declared
LEAVING: Final = 2.0
# Fall of chi-squared by a cause of all thrusters from which on that of each is asked for.
# Source: definition: five standard deviations
SHOWN: Final = 25.0
# The same as a share of the largest fall by any cause.
# Source: geometry: that of all shows a quarter of what that of one of four alike thrusters does, and below a fifth of the largest fall this is not named next
BESIDE: Final = 0.05
# A cause of one thruster stands in the place of that of all where its merit is larger by more.
# Source: definition: three standard deviations
BETTER: Final = 9.0
# Thrusters that are asked for at most, those whose errors are farthest outside first.
# Source: resource: each adds a survey of its causes, and the fit drags the errors of others along
THRUSTERS: Final = 4


def with_one_thruster(fit: Fit, scored: Sequence[Scored]) -> tuple[Fit, list[Scored]]:
    """The fit with columns of causes of one thruster alone, and their scores.

    Args:
        fit: of the model.
        scored: its candidates, of all thrusters together.
    """
    predictor = fit.noise.predictor
    known = predictor.vehicle.thrusters
    if len(known) == 1:
        return fit, []
    errors = zip(known, predictor.propulsion.errors, strict=True)
    far = {t.name: e.largest(t.name, fit.h.declared_errors) for t, e in errors}
    farthest = sorted(far, key=far.__getitem__, reverse=True)[:THRUSTERS]
    leaving = [name for name in farthest if far[name] > LEAVING]
    least = max(SHOWN, BESIDE * max((s.fall for s in scored), default=0.0))
    shown = {s.id: s for s in scored if s.candidate.effect.per_thruster and s.fall > least}
    # A thrust that lags or is late moves no curve, so that no error of it leaves its bound.
    moved = [c for c in fit.candidates if c.effect.per_thruster and not isinstance(c.effect.acts, Response)]
    asked = [(s.candidate, farthest) for s in shown.values()] + [(c, leaving) for c in moved if c.id not in shown]
    out = Columns()
    made = [one for c, names in asked for name in names for one in c.alone_on(fit.signatures, name, out)]
    if not made:
        return fit, []
    base = fit.projection.base
    fit = replace(fit, gram=fit.gram.extended(out.names, out.arrays))
    p = Projection(fit.gram, base)
    one_each = [s for one in made if (s := one.score(p, fit.signatures)) is not None]
    # They are searched as well as the causes of all thrusters together.
    return fit, [replace(s, looks=s.looks * (1 + len(farthest if s.id in shown else leaving))) for s in one_each]


def clearer(scored: Sequence[Scored], alone: Sequence[Scored]) -> list[Scored]:
    """One score an effect: that of all thrusters, unless that of one is clearly better.

    Args:
        scored: candidates of all thrusters together, and of causes at none.
        alone: candidates of one, the best of each effect.
    """
    one = {s.id: s for s in alone}
    kept = [s for s in scored if s.id not in one or one[s.id].merit <= s.merit + BETTER]
    return [*kept, *(s for s in alone if s.id not in {q.id for q in kept})]
