"""Motion that no consistent vehicle makes: a contradiction of the model where each row alone agrees with it.

Source: docs/theory.md, "Guaranteed simulation", Refutation.
"""

from __future__ import annotations

from typing import Final

from ivsid.diagnosis.statements.proved import Proof
from ivsid.log import Log
from ivsid.tubes.equations import Equations
from ivsid.tubes.reached import TubeCheck, reached

# Lengths of the windows [s]. The rows have longer ones, and what all logs show, windows of 1 s show.
# Source: measured: make refuted
WINDOWS: Final = (1.0,)
# Steps that are followed in each log, in evenly spaced windows.
# Source: resource: half a second where a channel has some hundred vertices, beside the trial of both models
STEPS: Final = 1500


def motion_of(proof: Proof, *logs: Log) -> tuple[TubeCheck, ...]:
    """The readings of each log against the tubes of all vehicles that the rows of TRAIN allow; none where those rows prove nothing, or refute."""
    fit = proof.identification
    if fit is None or proof.status != "not_refuted":
        return ()
    equations: dict[str, Equations] = {}
    return tuple(reached(fit, log, windows=WINDOWS, whole=False, steps=STEPS, equations=equations) for log in logs)


def sentences(motion: tuple[TubeCheck, ...], *names: str) -> list[str]:
    """A sentence on each log whose motion refutes the model; names are those of TRAIN and TEST."""
    said = []
    for number, (name, found) in enumerate(zip(names, motion, strict=False)):
        if not found.guaranteed or found.clearest is None:
            continue
        differs = "its numbers differ between the logs, " if number else ""
        said.append(
            f"proved by motion: no vehicle that is consistent with every row of {names[0]} moves {found.clearest.words} of {name}: the model "
            f"is wrong, {differs}or an error of sensors, thrust or ambient force was larger there than declared"
        )
    return said
