"""Fall of chi-squared of a force that comes gradually, in the place of one that starts at a time.

A battery, a motor or a growing load changes a force over minutes. A step in time explains most of such a change, with a start somewhere in it. Weights of
the blocks of the log make the gradual force of the column of the step: they change little within a block.

Source: docs/theory.md, "Test"; the shapes are a first-order approach and a ramp.
"""

from __future__ import annotations

import itertools
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.kinds.candidate import Scored
from ivsid.diagnosis.estimation.projection import Projection, largest_fall
from ivsid.diagnosis.null.any_curve import AnyCurve

Array = NDArray[np.float64]
# Least square of the length of a column.
# Source: definition: that of the core's whitening
NOTHING: Final = 1e-300
# Time constants of an approach from the start of the log, as shares of its length.
# Source: geometry: from six blocks of a log of ten minutes to a straight line
APPROACHES: Final = (0.1, 0.2, 0.4, 0.8, 10.0)
# Ends of ramps, as shares of the log: a ramp lasts two of these parts at least.
# Source: geometry: a fifth of the log is several blocks, which a step is told from
ENDS: Final = tuple(k / 10 for k in range(11))
# Fall of chi-squared by which the gradual force has to be better to stand in the place of the step.
# Source: definition: 0.3 % of normal errors lie beyond
BETTER: Final = 9.0
# The same as a share of the step's fall: equations that are linear in a large step are off by a part of it.
# Source: measured: the examination; steps of payloads and failures that thrust curves do not reverse were up to 2.4 % behind a gradual force, motors that grow warm at least 4.9 %
CURVED: Final = 0.035
# A column has to keep this share of its squared length beside the base.
# Source: geometry: as for a step, above the rounding of cross-products
LEFT: Final = 1e-6
# First words of the names of such forces.
GRADUAL: Final = "a gradual"
# No forces beside those of the step.
# Source: definition: an empty list of columns
NO_FORCES: Final = np.zeros((0, 0, 0))


def most_beyond(s: Scored) -> float:
    """Largest fall of chi-squared of the gradual force beyond that of a cause that starts at a time."""
    return max(BETTER, CURVED * s.fall)


def approaches(blocks: int) -> Array:
    """Sizes of a force in each block that approaches its last one from the start of the log on, shape (approaches, blocks)."""
    t = (np.arange(blocks) + 0.5) / blocks
    return np.stack([-np.expm1(-t / tau) for tau in APPROACHES])


def shapes(blocks: int) -> Array:
    """Sizes of a gradual force in each block, from none to all of it, shape (shapes, blocks)."""
    t = (np.arange(blocks) + 0.5) / blocks
    ramps = [np.clip((t - a) / (b - a), 0.0, 1.0) for a, b in itertools.combinations(ENDS, 2) if b - a > 1.5 * ENDS[1]]
    return np.stack([*approaches(blocks), *ramps])


def gradual_forces(fit: Fit) -> tuple[list[str], Array, Array]:
    """What causes that start at a time would do gradually: names, whitened columns in unit length, (forces, blocks, numbers), and their lengths."""
    g = fit.gram
    known = [c.variants[0][0] for c in fit.candidates if c.starts]
    weight, length = approaches(len(g.blocks)), len(g.blocks) * g.length * fit.noise.predictor.log.h
    names = [f"{GRADUAL} {n} over {min(tau, 1.0) * length:.0f} s" for n in known for tau in APPROACHES]
    x = (g.columns(g.at(known))[:, None] * weight[None, :, :, None]).reshape(-1, *g.y.shape)
    unit = np.sqrt(np.maximum(np.einsum("kbi,kbi->k", x, x), NOTHING))
    return names, x / unit[:, None, None], unit


def gradual(fit: Fit, s: Scored, weaker: Array = NO_FORCES) -> float:
    """Largest fall of chi-squared of the force of a step where it comes gradually.

    Args:
        fit: of the model without it.
        s: the step with its score.
        weaker: thrusts that fall with the motion or with their heat, whitened, shape (forces, blocks, numbers).
    """
    g, p, (j,) = fit.gram, fit.projection, s.columns
    slow = _largest(s, p, shapes(len(g.blocks)), g.blocks[:, j][:, p.base], g.blocks[:, j, j], g.score[:, j])
    return max(slow, largest_fall(fit.bare, range(len(p.base)), weaker))


def beside_curves(curve: AnyCurve, s: Scored, weaker: Array = NO_FORCES) -> tuple[float, float]:
    """Falls of chi-squared of a step, and of its force where it comes gradually, both beside any thrust curve inside its accuracy.

    Args:
        curve: the base beside any thrust curve.
        s: the step with its score.
        weaker: as of ``gradual``.
    """
    g, p, (j,) = curve.fit.gram, curve.projection, s.columns
    count, shape = len(g.blocks), (-1, *g.y.shape)
    x = g.columns([j])[0]
    base = curve.g.columns(p.base).reshape(shape)
    cross = np.stack([base[:, b] @ x[b] for b in range(count)])
    own, score = np.einsum("bi,bi->b", x, x), np.einsum("bi,bi->b", x, g.y)
    step = (np.arange(count) >= s.first_block(g, curve.fit.noise.predictor.log)).astype(float)
    sudden, slow = (_largest(s, p, weight, cross, own, score) for weight in (step[None], shapes(count)))
    return sudden, max(slow, largest_fall(curve.g, p.base, weaker))


def _largest(s: Scored, p: Projection, weight: Array, cross: Array, own: Array, score: Array) -> float:
    """Largest fall of chi-squared of a column with weights, beside a base.

    Args:
        s: the step whose column it is.
        p: least squares on the base.
        weight: of the column in each block, shape (weights, blocks).
        cross: products of the column with the base in each block, shape (blocks, base).
        own: its squared length, shape (blocks,).
        score: its products with the errors, shape (blocks,).
    """
    beside = weight @ cross
    left = weight**2 @ own
    information = left - np.einsum("ki,ik->k", beside, np.linalg.solve(p.normal, beside.T))
    found = weight @ score - beside @ p.coefficients
    usable = information > LEFT * np.maximum(left, 1e-300)
    if not s.candidate.effect.parameters[s.candidate.effect.draws.index("size")].signed:
        usable &= found > 0.0
    return float(np.where(usable, found**2 / np.where(usable, information, 1.0), 0.0).max())
