"""Programmes beside the planned one: the library's, of equal length."""

from __future__ import annotations

from collections.abc import Callable

from ivsid.plans.sailed import sail, scenario_of
from ivsid.plans.search import Setting
from ivsid.programme.trials import library


def rivals(setting: Setting, progress: Callable[[str], None]) -> dict[str, float | None]:
    """The purpose's value of each manoeuvre of the library; None where it cannot be sailed, or leaves the fence or the stated limits."""
    shape = setting.shape
    found: dict[str, float | None] = {}
    for trial in library(shape.vehicle, shape.full):
        progress(f"sailing {trial.name}")
        sailed = sail(
            shape.vehicle, scenario_of(trial.segments, shape.seconds, setting.rate, setting.truth), setting.seed
        )
        outside = sailed is None or sailed.reach > setting.fence or max(sailed.hardest, sailed.spin) > 1
        found[trial.name] = None if sailed is None or outside else setting.purpose.value(sailed)
    return found
