"""Causes that imitate one force of no cause.

Two linear causes can add up to a force that neither of them is: a share of the thrust's moment, less a moment that follows the
acceleration, is one that follows the drag. Each then stands in a fit with many standard deviations, and nothing is left unexplained. But one
regressor of the adequacy's dictionary, in the place of all of them and with one number, explains as much. A single cause is none where
such a regressor explains more in its place than the cause does.

Source: docs/theory.md, "Diagnosis"; Akaike, "A new look at the statistical model identification", IEEE Transactions on Automatic Control 19,
1974.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import NOTHING_LEFT, Projection
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.selection.dictionary import regressors
from ivsid.diagnosis.selection.rivals import Found
from ivsid.diagnosis.selection.rules import BETTER_FORCE, ONE_FORCE, Together

Array = NDArray[np.float64]


def imitating(fit: Fit, found: Sequence[Found]) -> Mapping[str, Refusal]:
    """Refusals, by id, of linear causes that one force explains as well as they do together, or better than one of them.

    Args:
        fit: of the model with all causes.
        found: the causes.
    """
    numbers = _numbers(fit)
    own = {
        f.id: [k for k in fit.base if fit.gram.names[k] in numbers and _of(fit.gram.names[k], f.id)]
        for f in found
        if f.first.candidate.sums
    }
    own = {id_: at for id_, at in own.items() if at}
    if not own:
        return {}
    names, x, unit = regressors(fit)
    g = fit.gram.only(fit.base)
    first = len(g.names)
    wide = g.joined(names, x, unit)
    place = {k: i for i, k in enumerate(fit.base)}
    refused: dict[str, Refusal] = {}
    # The largest sets first: a set that one force explains takes its parts with it.
    for count in range(len(own), 0, -1):
        for ids in combinations(own, count):
            if refused.keys() & set(ids):
                continue
            at = [place[k] for i in ids for k in own[i]]
            held = np.array([numbers[g.names[k]] for k in at]) * g.unit[at]
            p = Projection(wide, [k for k in range(first) if k not in at])
            fall, alone = in_their_place(p, at, held, range(first, len(wide.names)))
            best = int(np.argmax(alone))
            channel, function = names[best].split("|", 1)
            case = Together(ids, fall, len(at), f"{function} in {channel}", float(alone[best]))
            others = [f.id for f in found if f.id not in ids]
            if (refusal := (ONE_FORCE if count > 1 else BETTER_FORCE).refuses(case, others)) is not None:
                refused |= dict.fromkeys(ids, refusal)
    return refused


def in_their_place(p: Projection, columns: Sequence[int], held: Array, forces: Sequence[int]) -> tuple[float, Array]:
    """Fall of chi-squared by some columns together, and by each force in their place, shape (forces,).

    Args:
        p: least squares on all that is neither.
        columns: of the causes.
        held: their coefficients that the errors no longer hold, in unit lengths, shape (columns,).
        forces: columns of which one at a time replaces the causes.
    """
    columns, forces = list(columns), list(forces)
    # What the hypothesis has taken out of the errors goes back into the scores.
    H = p.information(columns)
    score = p.left_score[columns] + p.left(columns, columns) @ held
    values, vectors = np.linalg.eigh(H)
    kept = values > NOTHING_LEFT * max(float(values.max()), 1e-300)
    fall = float((((vectors[:, kept].T @ score) ** 2) / values[kept]).sum())
    own = np.array([p.left([k], [k])[0, 0] for k in forces]) + p.g.prior[forces]
    real = own > NOTHING_LEFT * np.maximum(np.diag(p.total)[forces], 1e-300)
    alone = p.left_score[forces] + p.left(forces, columns) @ held
    return fall, np.where(real, alone**2 / np.where(real, own, 1.0), 0.0)


def _numbers(fit: Fit) -> dict[str, float]:
    """Numbers of the hypothesis by column, from no effect on."""
    numbers = {k: float(x) for k, x in fit.h.values.items()}
    for given in fit.h.given:
        none = dict(zip(given.effect.parts, (q.none for q in given.effect.parameters), strict=True))
        numbers |= {k: float(x) - none.get(k, 0.0) for k, x in given.named.items()}
    return numbers


def _of(name: str, id_: str) -> bool:
    """Whether a column is one of an effect's."""
    return name == id_ or name.startswith(f"{id_}.")
