"""What would narrow an identification: further rows of its log, which are tried, and the bounds that every vessel keeps.

The rows that are taken by default are those of the measured accelerations, or of one window. Where they leave the sign of a parameter
open, rows of other kinds and windows may settle it, at no further assumption, and whether they do depends on the noise, the motion and the
gaps of the log. They are therefore tried. The physical bounds narrow an interval for certain where one of its ends is of no vessel
whatever the other parameters are inside their intervals; that follows from the intervals alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from ivsid.effects import terms_of
from ivsid.errors import IvsidError
from ivsid.identification.method import identify
from ivsid.identification.physics import subject_of
from ivsid.identification.result import Identification, Parameter
from ivsid.log import Log
from ivsid.physical import Subject, regression_bounds
from ivsid.rows import window_count
from ivsid.sensors.bounds import bound_log

# Samples of a log on which further rows are tried.
# Source: resource: some seconds
TRIED: Final = 20_000
# Windows of the rows that are tried [s].
# Source: definition: those of the command's help, which are far apart
WINDOWS: Final = (0.5, 2.0, 10.0)
# Share of the width that is left of an interval which is called narrower.
# Source: definition: a quarter less, which is seen beside the old one
SHARE: Final = 0.75
# Stands for an end that is open, far beyond what any vessel has, and small enough for products with velocities.
# Source: resource: the range of doubles
FAR: Final = 1e150


@dataclass(frozen=True)
class Narrower:
    """What would narrow an identification.

    Attributes:
        asked: whether the sign of a parameter is open, so that narrower intervals are of use.
        tried: whether further rows were tried.
        windows: of the rows that were tried [s].
        parameters: intervals by all rows, of the parameters that these make narrower.
        beyond: ids whose interval has an end that no vessel has, and that the physical bounds therefore narrow.
    """

    asked: bool
    tried: bool = False
    windows: tuple[float, ...] = ()
    parameters: dict[str, Parameter] = field(default_factory=dict)
    beyond: tuple[str, ...] = ()


def narrower(fit: Identification, log: Log) -> Narrower:
    """Tries further rows where a parameter's sign is open, and asks the physical bounds.

    Args:
        fit: of the log.
        log: that was identified.
    """
    found = fit.parameters
    wide = [k for k, p in found.items() if p.lower < 0 < p.upper]
    taken = fit.options
    if fit.method != "feasible" or fit.status not in ("enclosed", "unbounded") or taken["outliers"] or not wide:
        return Narrower(asked=False)
    if log.t.size > TRIED or taken["physical"]:
        return Narrower(asked=not taken["physical"] and taken["rows"] != "both")
    windows = tuple(w for w in WINDOWS if w <= log.t[-1] - log.t[0])
    rest = {k: taken[k] for k in ("partitions", "form", "bias")}
    more = None
    if windows and (taken["rows"] != "both" or isinstance(taken["window"], float | int)):
        try:
            more = identify(fit.vehicle, log, rows="both", window=windows, examine=False, **rest)
        except IvsidError:
            more = None
    clear = {}
    if more is not None and more.status in ("enclosed", "unbounded"):
        clear = {k: more.parameters[k] for k in wide if _clearly(more.parameters[k], found[k])}
    bounded = bound_log(log, fit.vehicle, window_count(taken["window"]))
    subject = subject_of(bounded, fit.vehicle, terms_of(fit.vehicle, taken["form"]), taken["form"])
    outside = () if fit.physical else beyond(subject, found)
    return Narrower(True, more is not None, windows, clear, outside)


def beyond(subject: Subject, parameters: Mapping[str, Parameter]) -> tuple[str, ...]:
    """Ids whose interval has an end that contradicts a physical bound, with all others anywhere inside their intervals.

    Args:
        subject: the model with its velocities.
        parameters: intervals by id.
    """
    ids = tuple(t.id for t in subject.terms)
    box = {i: (parameters[i].lower, parameters[i].upper) for i in ids}
    bounds = [b for b in regression_bounds(subject)[0] if b.least.size]

    def excluded(id_: str, end: float) -> bool:
        end = float(np.clip(end, -FAR, FAR))
        reached = [b.reached(ids, {**box, id_: (end, end)}) for b in bounds]
        return any(bool((r < b.least).any()) for r, b in zip(reached, bounds, strict=True))

    return tuple(i for i in ids if any(excluded(i, end) for end in box[i]))


def _clearly(new: Parameter, old: Parameter) -> bool:
    """Whether an interval lost a quarter of its width, or got an end that it did not have."""
    if not math.isfinite(old.width):
        return _ends(new) > _ends(old)
    return bool(new.width <= SHARE * old.width)


def _ends(p: Parameter) -> int:
    """The number of ends that were proved."""
    return int(math.isfinite(p.lower)) + int(math.isfinite(p.upper))
