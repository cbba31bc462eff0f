"""The fall of chi-squared that each candidate brings beside the model and all declared errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ivsid.diagnosis.candidates.finer import with_finer
from ivsid.diagnosis.candidates.one_thruster import clearer, with_one_thruster
from ivsid.diagnosis.candidates.searched import with_searched
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.plant.physics import Hypothesis


def score(fit: Fit) -> tuple[Fit, list[Scored]]:
    """The scores of all candidates, best first.

    Args:
        fit: of the model.

    Returns:
        The fit with the columns of searched causes, and the scores.
    """
    p = fit.projection
    found = [s for c in fit.candidates if (s := c.score(p, fit.signatures)) is not None]
    fit, searched = with_searched(fit, p)
    # The errors of a cause of all thrusters and of one jump at the same values: both are asked at finer ones before they are compared.
    fit, found = with_finer(fit, found)
    fit, alone = with_one_thruster(fit, found)
    fit, alone = with_finer(fit, _merged(alone))
    return fit, sorted(_merged([*clearer(found, alone), *searched]), key=lambda s: -s.merit)


def _merged(found: Sequence[Scored]) -> list[Scored]:
    """One score an effect: the best of its candidates."""
    best: dict[str, Scored] = {}
    for s in found:
        if s.id not in best or s.merit > best[s.id].merit:
            best[s.id] = s
    return list(best.values())


def adopted(h: Hypothesis, s: Scored, fit: Fit) -> Hypothesis:
    """The hypothesis with a candidate's effect in it, at the values of its score.

    Args:
        h: the hypothesis.
        s: the score.
        fit: in which it was found.
    """
    return s.candidate.adopted(h, s.values, fit.signatures)


def everything(fit: Fit) -> Fit:
    """The fit with the columns of searched causes and of steps in time, at their best values."""
    fit, scored = score(fit)
    g = fit.gram
    steps = [s for s in scored if s.candidate.starts]
    if not steps:
        return fit
    x = g.columns([s.columns[0] for s in steps])
    names = []
    for one, s in zip(x, steps, strict=True):
        one[: s.first_block(g, fit.noise.predictor.log)] = 0.0
        names.append(f"{s.id}@{s.values[-1]!r}")
    unit = np.sqrt(np.maximum(np.einsum("cbi,cbi->c", x, x), 1e-300))
    return replace(fit, gram=g.joined(names, x / unit[:, None, None], unit))
