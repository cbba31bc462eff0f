"""Causes that imitate one force of no cause.

Two linear causes can add up to a force that neither of them is: a share of the thrust's moment, less a moment that follows the
acceleration, is one that follows the drag. Each then stands in a fit with many standard deviations, and nothing is left unexplained. But one
regressor of the adequacy's dictionary, in the place of all of them and with one number, explains as much. A single cause is none where
such a regressor explains more in its place than the cause does. A regressor stands in the place of causes if hardly anything is left to
them beside it: one that explains another part of the errors replaces nothing. The same is asked of any function of one velocity
(``speed_curves``), which has many numbers.

Source: docs/theory.md, "Diagnosis"; Akaike, "A new look at the statistical model identification", IEEE Transactions on Automatic Control 19,
1974.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.projection import NOTHING_LEFT, Projection
from ivsid.diagnosis.null.rule import Refusal
from ivsid.diagnosis.selection.dictionary import regressors
from ivsid.diagnosis.selection.rivals import Found
from ivsid.diagnosis.selection.rules import BETTER_CURVE, BETTER_FORCE, ONE_FORCE, Curve, Together
from ivsid.diagnosis.selection.speed_curves import speed_curves, words

Array = NDArray[np.float64]
# Largest share of what causes explain that they explain beside a force which stands in their place.
# Source: definition: three quarters are the force's; of other parts of the errors it has nothing
REPLACED: Final = 0.25


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
    curves, lines, lengths, groups = speed_curves(fit)
    if groups:
        wide = wide.joined(curves, lines, lengths)
    place = {k: i for i, k in enumerate(fit.base)}
    last = first + len(names)
    refused: dict[str, Refusal] = {}
    # The largest sets first: a set that one force explains takes its parts with it.
    for count in range(len(own), 0, -1):
        for ids in combinations(own, count):
            if refused.keys() & set(ids):
                continue
            at = [place[k] for i in ids for k in own[i]]
            held = np.array([numbers[g.names[k]] for k in at]) * g.unit[at]
            p = Projection(wide, [k for k in range(first) if k not in at])
            fall, alone, kept = in_their_place(p, at, held, range(first, last))
            # A force beside which the causes explain what they did is another part of the errors.
            alone = np.where(kept <= REPLACED * fall, alone, 0.0)
            best = int(np.argmax(alone))
            channel, function = names[best].split("|", 1)
            case = Together(ids, fall, len(at), f"{function} in {channel}", float(alone[best]))
            others = [f.id for f in found if f.id not in ids]
            if (refusal := (ONE_FORCE if count > 1 else BETTER_FORCE).refuses(case, others)) is not None:
                refused |= dict.fromkeys(ids, refusal)
                continue
            for group in groups:
                shape, left, directions = curve_in_their_place(p, at, held, [last + k for k in group])
                if left <= REPLACED * fall:
                    case = Curve(ids, fall, len(at), words(curves, group), shape, directions)
                    if (refusal := BETTER_CURVE.refuses(case, others)) is not None:
                        refused |= dict.fromkeys(ids, refusal)
    return refused


def curve_in_their_place(
    p: Projection, columns: Sequence[int], held: Array, curve: Sequence[int]
) -> tuple[float, float, int]:
    """Fall of chi-squared by a curve of several columns in the place of causes, by the causes beside it, and its directions.

    Args:
        p: least squares on all that is neither.
        columns: of the causes.
        held: their coefficients that the errors no longer hold, in unit lengths, shape (columns,).
        curve: columns of the curve.
    """
    columns, curve = list(columns), list(curve)
    H, G, between = p.information(columns), p.information(curve), p.left(curve, columns)
    mine, own = p.left_score[columns] + H @ held, p.left_score[curve] + between @ held
    values, vectors = np.linalg.eigh(G)
    kept = values > NOTHING_LEFT * max(float(values.max()), 1e-300)
    inverse = (vectors[:, kept] / values[kept]) @ vectors[:, kept].T
    beside = _fall(
        H - between.T @ inverse @ between, mine - between.T @ (inverse @ own), float(np.linalg.eigvalsh(H).max())
    )
    return float(own @ inverse @ own), beside, int(kept.sum())


def in_their_place(
    p: Projection, columns: Sequence[int], held: Array, forces: Sequence[int]
) -> tuple[float, Array, Array]:
    """Fall of chi-squared by some columns together, by each force in their place, and by them beside each force, shape (forces,).

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
    largest = float(np.linalg.eigvalsh(H).max())
    fall = _fall(H, score, largest)
    own = np.array([p.left([k], [k])[0, 0] for k in forces]) + p.g.prior[forces]
    real = own > NOTHING_LEFT * np.maximum(np.diag(p.total)[forces], 1e-300)
    between = p.left(forces, columns)
    alone = p.left_score[forces] + between @ held
    inverse = np.where(real, 1.0 / np.where(real, own, 1.0), 0.0)
    # Both together, less the force alone.
    beside = H[None] - inverse[:, None, None] * between[:, :, None] * between[:, None, :]
    scores = score[None] - (inverse * alone)[:, None] * between
    kept = np.array([_fall(x, y, largest) for x, y in zip(beside, scores, strict=True)])
    return fall, inverse * alone**2, kept


def _fall(H: Array, score: Array, largest: float) -> float:
    """Fall of chi-squared by columns with the information ``H``, along what is determined beside the largest eigenvalue of all."""
    values, vectors = np.linalg.eigh(H)
    kept = values > NOTHING_LEFT * max(largest, 1e-300)
    return float((((vectors[:, kept].T @ score) ** 2) / values[kept]).sum())


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
