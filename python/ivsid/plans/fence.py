"""How far from its start a planned vehicle gets: the tube proves it of every consistent vehicle, as long as it holds; members show it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Final, TypeAlias

import numpy as np

from ivsid.errors import IvsidError
from ivsid.identification import Identification
from ivsid.log import Log
from ivsid.plans.sailed import Sailed, sail, truth_of
from ivsid.programme.scenario import Scenario
from ivsid.tubes import tube

# Vehicles that are simulated: the estimate, and ends of the intervals.
# Source: resource: a tenth of a second each
MEMBERS: Final = 32
# Time, whether that is the whole programme, why it is not, and what the proof relies on.
Proved: TypeAlias = tuple[float, bool, str | None, tuple[str, ...]]
STEERED: Final[Proved] = (0.0, False, "the programme steers by feedback, so that its demands depend on the vehicle", ())


@dataclass(frozen=True)
class Fence:
    """Distances from the start.

    Attributes:
        radius: of the fence [m]; infinite without one.
        proved_until: time [s] up to which every consistent vehicle stays inside at each sample; 0 without a tube.
        whole: whether that is the whole programme.
        reason: why it is not, or None.
        assumes: sentences that the proof relies on.
        members: number of simulated members of the fit's box, with thrust errors of their own.
        inside: number of those that stay inside.
        farthest: of any of them [m].
    """

    radius: float
    proved_until: float
    whole: bool
    reason: str | None
    assumes: tuple[str, ...]
    members: int
    inside: int
    farthest: float

    def record(self) -> dict[str, object]:
        """The entry ``fence`` of result.json."""
        return {
            "radius": self.radius if np.isfinite(self.radius) else None,
            "proved": self.whole,
            "proved_until": self.proved_until,
            "reason": self.reason,
            "assumes": list(self.assumes),
            "members": self.members,
            "inside": self.inside,
            "farthest": self.farthest,
        }


def fence_of(
    fit: Identification,
    scenario: Scenario,
    sailed: Sailed,
    radius: float,
    *,
    middle: Mapping[str, float],
    feedback: bool,
    progress: Callable[[str], None],
) -> Fence:
    """The distances that the demands of a sailed programme lead to."""
    progress("proving the fence")
    until, whole, reason, assumes = STEERED if feedback else proved(fit, at_rest(fit, scenario, sailed), radius)
    progress("simulating members")
    reaches = [m.reach for m in members(fit, scenario, middle)]
    inside = sum(x <= radius for x in reaches)
    return Fence(radius, until, whole, reason, assumes, len(reaches), inside, max(reaches, default=0.0))


def at_rest(fit: Identification, scenario: Scenario, sailed: Sailed) -> Sailed | None:
    """The same demands after a reading of rest without noise, from which the tube starts: a drawn one may miss rest."""
    still = sail(fit.vehicle, scenario, scenario.seed, noise="none")
    if still is None:
        return None
    starting = {n: np.where(np.arange(x.size) == 0, still.log.columns[n][0], x) for n, x in sailed.log.columns.items()}
    log = Log(sailed.log.name, sailed.log.sha256, sailed.log.t, starting)
    return replace(sailed, log=log)


def proved(fit: Identification, sailed: Sailed | None, radius: float) -> Proved:
    """Time up to which the tube stays inside the fence, whether that is all, and why it is not."""
    if sailed is None:
        return 0.0, False, "the programme cannot be sailed without noise", ()
    try:
        found = tube(fit, sailed.log, windows=(), inner=False, examine=False)
    except IvsidError as error:
        return 0.0, False, str(error), ()
    if not found.guaranteed:
        return 0.0, False, "the fit is not guaranteed, and a tube proves what the fit proves", ()
    start = "the trial starts at rest, and its demands are those of the plan"
    assumes = (start, *(a for a in found.assumes if not a.startswith("the readings of")))
    run = found.runs[0].horizon
    position = run.bounds[:, 4:6]
    most = np.maximum(np.abs(position.lower), np.abs(position.upper))
    # Two roundings of a square, one of the sum, one of the root: a share of 2^-50 holds them.
    farthest = np.hypot(most[:, 0], most[:, 1]) * (1 + 2.0**-50)
    window = run.windows[0]
    there = np.arange(farthest.size) <= window.proved
    inside = there & (farthest <= radius)
    first = int(np.argmin(inside)) if not inside.all() else farthest.size
    until = float(found.t[first - 1] - found.t[0]) if first else 0.0
    if first == farthest.size:
        return until, True, None, assumes
    if first > window.proved:
        return until, False, "the tube ends there: what vehicles may do is no longer bounded", assumes
    return until, False, "the tube reaches the fence there", assumes


def members(fit: Identification, scenario: Scenario, middle: Mapping[str, float]) -> list[Sailed]:
    """The programme sailed by one member and by ends of the fit's intervals, each with thrust errors and noise of its own.

    Args:
        fit: whose intervals they are.
        scenario: the programme.
        middle: parameters of the one member, which stand for open ends, too.
    """
    ids = list(fit.parameters)
    ends = [
        (p.lower, p.upper) if np.isfinite(p.lower) and np.isfinite(p.upper) else (middle[i], middle[i])
        for i, p in fit.parameters.items()
    ]
    corners = [dict(zip(ids, c, strict=True)) for c in product(*(sorted(set(e)) for e in ends))]
    step = max(1, len(corners) // (MEMBERS - 1))
    made = []
    for number, values in enumerate([dict(middle), *corners[::step]][:MEMBERS]):
        sailed = sail(fit.vehicle, scenario.model_copy(update={"truth": truth_of(fit, values)}), 1000 + number)
        if sailed is not None:
            made.append(sailed)
    return made
