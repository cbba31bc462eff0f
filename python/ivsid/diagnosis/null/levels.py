"""Levels: how the probability of a wrong verdict is divided among the statements that can make it wrong.

The parts add up, so the whole verdict keeps its level however the statements depend on each other (Bonferroni).

Source: docs/theory.md, "Diagnosis".
"""

from __future__ import annotations

from typing import Final

# Probability that a log without an effect gets any verdict but ``adequate``.
# Source: definition: at most 1 % of logs without an effect give a finding
VERDICT: Final = 0.01
# Part of the names, over a round: half, since waves and tethers are searched beside it.
# Source: definition: half of the whole verdict
NAMES: Final = 0.005
# Part of the structure that no cause explains: a chance of 0.1 % each for regressors and for thrust errors lies inside it.
# Source: definition: half of what the names leave
STRUCTURE: Final = 0.0025
# Part of shallow water, whose five standard deviations lie far inside it.
# Source: definition: the rest of the whole verdict
SHALLOW_WATER: Final = 0.0025


def split() -> dict[str, float]:
    """The entry ``calibration.verdict`` of result.json: the level of the whole verdict and its parts."""
    return {"whole": VERDICT, "names": NAMES, "structure": STRUCTURE, "shallow_water": SHALLOW_WATER}
