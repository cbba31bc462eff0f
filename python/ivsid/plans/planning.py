"""``plan``: the demands of a next trial."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ivsid.display.shown import Result
from ivsid.display.table import Cells
from ivsid.errors import IvsidError
from ivsid.identification import Identification
from ivsid.plans.fence import Fence, fence_of
from ivsid.plans.narrowing import Narrowing
from ivsid.plans.purpose import Purpose
from ivsid.plans.rivals import rivals
from ivsid.plans.sailed import Sailed, estimate_of, sail, scenario_of, truth_of, usual
from ivsid.plans.search import Setting, best
from ivsid.plans.separation import Separation
from ivsid.plans.shape import PARTS, Shape
from ivsid.programme.scenario import Scenario

# Length of a programme [s].
# Source: definition: a minute; a diagnosis needs a minute and more
SECONDS: Final = {"narrow": 60.0, "separate": 90.0}
# Shortest log of a diagnosis [s], with a sample beyond.
# Source: definition: the data of a diagnosis
DIAGNOSED: Final = 61.0
# Rate of the samples of planned logs [Hz].
# Source: definition: rate of the shipped scenarios
RATE: Final = 20.0
# Generations of the search for widths; a distance costs some ten times as much, and gets fewer.
# Source: resource: a minute
GENERATIONS: Final = {"narrow": 24, "separate": 4}
# Draws of sea, sensors and thrusters by which the value of the found programme is predicted; none of them is the search's.
# Source: resource: a second
DRAWS: Final = 9


@dataclass(frozen=True)
class Predicted:
    """What a log of a programme will say, over draws of sea, sensors and thrusters.

    Attributes:
        median: of the values.
        least: of the values.
        most: of the values.
    """

    median: float
    least: float
    most: float


@dataclass(frozen=True, repr=False)
class Plan(Result):
    """A programme for the next trial.

    Attributes:
        fit: what is known.
        purpose: ``narrow`` or ``separate``.
        causes: to be told apart; empty for ``narrow``.
        quantity: what the values are, in words.
        scenario: the programme as the estimate sails it; ``ivsid simulate`` runs it.
        sailed: by the estimate.
        before: the value without another log; None where there is none.
        predicted: the value after it.
        rivals: the value of each manoeuvre of the library of equal length; None where it leaves the fence or the stated limits.
        details: intervals by parameter, or what each cause shows.
        fence: how far the vehicle gets.
        notes: what has to be known of the vehicle that sails.
    """

    fit: Identification
    purpose: str
    causes: tuple[str, ...]
    quantity: str
    scenario: Scenario
    sailed: Sailed
    before: float | None
    predicted: Predicted
    rivals: Mapping[str, float | None]
    details: Mapping[str, object]
    fence: Fence
    notes: tuple[str, ...] = ()

    @property
    def best_rival(self) -> tuple[str, float] | None:
        """The best manoeuvre of the library that can be sailed there; None without one."""
        there = [(x, n) for n, x in self.rivals.items() if x is not None]
        if not there:
            return None
        value, name = max(there) if self.purpose == "separate" else min(there)
        return name, value

    def gain(self, value: float) -> float:
        """How many times better the programme is than one with this value."""
        if self.purpose == "separate":
            return self.predicted.median / value if value else math.inf
        return value / self.predicted.median if self.predicted.median else math.inf

    def _heading(self) -> str:
        return f"for {self.fit.vehicle.name}, {self.scenario.duration:g} s: {self.quantity} {self.predicted.median:.4g}"

    def _cells(self) -> Cells:
        return self._columns()

    def _columns(self) -> dict[str, Sequence[object]]:
        segments = self.scenario.segments
        return {
            "start [s]": np.cumsum([0.0, *(s.duration for s in segments[:-1])]).tolist(),
            "demand": [s.demand for s in segments],
            "differential": [s.differential for s in segments],
            "sway": [s.sway for s in segments],
            "rudder [rad]": [s.rudder for s in segments],
        }

    def record(self) -> dict[str, object]:
        """The summary of result.json, without its envelope."""
        beside = self.best_rival
        return {
            "purpose": self.purpose,
            "causes": list(self.causes),
            "quantity": self.quantity,
            "seconds": self.scenario.duration,
            "before": _finite(self.before),
            "predicted": {
                "median": _finite(self.predicted.median),
                "least": _finite(self.predicted.least),
                "most": _finite(self.predicted.most),
                "draws": DRAWS,
            },
            "details": dict(self.details),
            "library": {k: _finite(x) for k, x in self.rivals.items()},
            "best_of_library": None
            if beside is None
            else {"manoeuvre": beside[0], "value": _finite(beside[1]), "gain": _finite(self.gain(beside[1]))},
            "fence": self.fence.record(),
            "hardest": self.sailed.hardest,
            "guaranteed": False,
            "notes": list(self.notes),
            "assumes": [
                "values are predictions, by logs of the fit's estimate; the fence alone is proved, as far as it says"
            ],
        }


def _finite(x: float | None) -> float | None:
    return None if x is None or not math.isfinite(x) else x


def plan(
    fit: Identification,
    *,
    seconds: float | None = None,
    separate: tuple[str, str] | None = None,
    fence: float = math.inf,
    feedback: bool = False,
    window: float | Sequence[float] | None = None,
    rate: float = RATE,
    generations: int | None = None,
    seed: int = 1,
    progress: Callable[[str], None] = lambda _: None,
) -> Plan:
    """Demands of a next trial that narrow the widest relative interval of a fit, or tell two causes apart.

    Args:
        fit: by ``identify``.
        seconds: length of the programme [s]; None takes 60 s for widths, 90 s for causes.
        separate: two causes of the catalogue; None narrows intervals.
        fence: radius of the water about the start [m].
        feedback: whether the programme damps the yaw rate; a vehicle of little damping then turns less by its thrust errors, its demands depend on the vehicle, and no tube proves a fence.
        window: lengths of the integral rows [s] by which the next log will be identified; None takes those of the fit.
        rate: of the samples of the next log [Hz].
        generations: of the search; None takes those of the purpose.
        seed: of the search and of its draws; the same seed gives the same programme.
        progress: told of each step.

    Returns:
        The programme, what it is predicted to reach, the library beside it, and what is proved of the fence.

    Raises:
        IvsidError: a fit without an estimate, thrusters without a largest demand, an unknown cause, or water that is too narrow.
    """
    apart = None if separate is None else Separation(fit, separate)
    seconds = SECONDS["narrow" if apart is None else "separate"] if seconds is None else seconds
    least = 10.0 if separate is None else DIAGNOSED
    if not least <= seconds <= 3600.0:
        raise IvsidError(f"seconds = {seconds:g} was given; a length of {least:g} to 3600 s is needed")
    if not fence > 0:
        raise IvsidError(f"fence = {fence:g} m was given; a radius above 0 is needed")
    if not 1.0 <= rate <= 1000.0:
        raise IvsidError(f"rate = {rate:g} Hz was given; 1 to 1000 Hz are needed")
    if generations is not None and generations < 1:
        raise IvsidError(f"generations = {generations} was given; a number of at least 1 is needed")
    shape = Shape(fit.vehicle, seconds, feedback)
    values, note = _vehicle(fit, shape, rate, seed)
    purpose: Purpose = Narrowing(fit, window, values) if apart is None else apart
    setting = Setting(shape, purpose, truth_of(fit, values), rate, fence, seed)
    found = best(setting, generations or GENERATIONS[purpose.name], progress)
    scenario = scenario_of(setting.shape.segments(found), seconds, rate, setting.truth)
    sailed = sail(fit.vehicle, scenario, seed)
    if sailed is None or setting.over(sailed) > 0:
        raise IvsidError(
            f"no programme of {PARTS} parts was found that stays within {fence:g} m and the stated limits for {seconds:g} s; give a wider "
            "fence or fewer seconds, or look at [sensors.limits]"
        )
    progress("predicting")
    draws = [sail(fit.vehicle, scenario, seed + 1 + k) for k in range(DRAWS)]
    reached = [purpose.value(s) for s in draws if s is not None] or [purpose.value(sailed)]
    before = purpose.before() if isinstance(purpose, Narrowing) else None
    return Plan(
        fit,
        purpose.name,
        separate or (),
        purpose.quantity,
        scenario,
        sailed,
        before,
        Predicted(float(np.median(reached)), min(reached), max(reached)),
        rivals(setting, progress),
        purpose.details(sailed),
        fence_of(fit, scenario, sailed, fence, middle=values, feedback=feedback, progress=progress),
        (note,) if note else (),
    )


def _vehicle(fit: Identification, shape: Shape, rate: float, seed: int) -> tuple[dict[str, float], str]:
    """The parameters of the vehicle that sails programmes, in the fit's form, and a note where they are not the fit's estimate.

    Raises:
        IvsidError: neither the estimate nor a vessel of usual size can be simulated.
    """
    straight = shape.segments(np.full(shape.size, 0.5))

    def sails(values: dict[str, float]) -> bool:
        return sail(fit.vehicle, scenario_of(straight, shape.seconds, rate, truth_of(fit, values)), seed) is not None

    estimate = estimate_of(fit)
    if sails(estimate):
        return estimate, ""
    open_ = [k for k, p in fit.parameters.items() if not (math.isfinite(p.lower) and math.isfinite(p.upper))]
    listed = ", ".join(f"{k} = {fit.estimate[k]:.4g}" for k in open_ or fit.estimate)
    why = f"the fit's estimate cannot be simulated ({listed}{', which the fit leaves open' if open_ else ''})"
    if sails(found := usual(fit)):
        return found, f"{why}; a vessel of usual size inside the intervals sails in its place"
    raise IvsidError(
        f"{why}; identify with more rows, as --rows both or --window 0.5,2,10, or with a log that excites them"
    )
