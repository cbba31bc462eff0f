"""Commands as calls in order: read, bound, compute, report. No mathematics of their own.

- ``allan_analysis``: noise coefficients of a static recording, by ``allan_recording`` (what is read) and ``allan_words`` (what is said).
- ``thrust_curves``: candidates for a thrust curve from a bollard-pull table.
- ``data_sets``: a public data set as logs, thrust tables and a vehicle file.
- ``proposal``: a vehicle file proposed from logs.
- ``example_runs``: two logs with a hidden cause, for a first diagnosis.
- ``simulation``: a log from a known truth.
- ``identification``, ``verification``, ``validation``: parameter intervals, their proof, and another log against them.
- ``following``: parameter intervals as they narrow along a log.
- ``trajectories``: bounds of every trajectory that a fit allows.
- ``trial_plan``: the demands of a next trial, as a scenario.
- ``exporting``: a model as a file of another simulator.
- ``many_logs``: many logs of a vehicle, one by one and together.
- ``diagnosis``, ``planning``: causes of what the simulation gets wrong, and manoeuvres that would separate them.
- ``diagnosis_screen``, ``diagnosis_series``, ``diagnosis_tables``: parts of the page of a diagnosis.
- ``first_screens``: what the other pages say first.
- ``paper_trials``, ``paper_page``: the paper's experiment on a twin of its vehicle, and its page.
- ``parameters``, ``log_files``, ``progress``: intervals in words, logs as files, and progress, which several commands share.

Each command is a function of this package and returns a ``Report``. A function is loaded when it is first used, so that a
command does not wait for the libraries of the others. The chapter may use every other but ``cli``.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from ivsid.workflow.allan_analysis import allan
    from ivsid.workflow.data_sets import import_set
    from ivsid.workflow.diagnosis import diagnose
    from ivsid.workflow.example_runs import example
    from ivsid.workflow.exporting import export
    from ivsid.workflow.following import follow
    from ivsid.workflow.identification import identify
    from ivsid.workflow.many_logs import fleet
    from ivsid.workflow.paper_trials import demo
    from ivsid.workflow.planning import isolability
    from ivsid.workflow.proposal import init
    from ivsid.workflow.simulation import simulate
    from ivsid.workflow.thrust_curves import thrust
    from ivsid.workflow.trajectories import tube
    from ivsid.workflow.trial_plan import plan
    from ivsid.workflow.validation import validate
    from ivsid.workflow.verification import verify

_HOMES: Final = {
    "allan": "allan_analysis",
    "demo": "paper_trials",
    "diagnose": "diagnosis",
    "example": "example_runs",
    "export": "exporting",
    "fleet": "many_logs",
    "follow": "following",
    "identify": "identification",
    "import_set": "data_sets",
    "init": "proposal",
    "isolability": "planning",
    "plan": "trial_plan",
    "simulate": "simulation",
    "thrust": "thrust_curves",
    "tube": "trajectories",
    "validate": "validation",
    "verify": "verification",
}

__all__ = [
    "allan",
    "demo",
    "diagnose",
    "example",
    "export",
    "fleet",
    "follow",
    "identify",
    "import_set",
    "init",
    "isolability",
    "plan",
    "simulate",
    "thrust",
    "tube",
    "validate",
    "verify",
]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'ivsid.workflow' has no attribute '{name}'")
    found: object = getattr(import_module(f"ivsid.workflow.{_HOMES[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
