"""ivsid: guaranteed system identification for unmanned marine vehicles.

From logged demands, accelerations, velocities and yaw rates to parameter intervals that are proved under stated bounds on
sensors and thrust. See the README for the commands, and ``docs/`` for the user's guide.

Names are loaded when they are first used: ``import ivsid`` itself loads the compiled core and the bases of what shows itself, and none of the
libraries that the stages rest on. A processor that does not round to nearest is refused here, before anything is computed.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Final

from ivsid import _core
from ivsid.display.shown import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ivsid.diagnosis import Diagnosis

    # In the import cycle mypy takes re-exports of functions for second definitions.
    from ivsid.diagnosis.stages import diagnose
    from ivsid.errors import IvsidError
    from ivsid.exports.export import export
    from ivsid.fleets import Fleet, fleet
    from ivsid.identification import Following, Identification, Parameter, follow, identify
    from ivsid.intervals import EndpointPair, Interval, IntervalArray, exchange
    from ivsid.linear import linalg, regression
    from ivsid.log import Log, read_log
    from ivsid.plans import Plan, plan
    from ivsid.setup import setup_findings
    from ivsid.tubes import Tube, tube
    from ivsid.validation import Validation, validate
    from ivsid.vehicle import Vehicle, read_vehicle
    from ivsid.verification import Verification
    from ivsid.verification.verify import verify

    __version__: str

if not _core.environment_is_default():
    raise ImportError(
        "the processor does not round to nearest or flushes subnormal numbers to zero; ivsid cannot prove anything "
        "here: undo the change of the floating-point mode before importing it"
    )

_HOMES: Final = {
    "Diagnosis": "ivsid.diagnosis",
    "EndpointPair": "ivsid.intervals",
    "Fleet": "ivsid.fleets",
    "Following": "ivsid.identification",
    "Identification": "ivsid.identification",
    "Interval": "ivsid.intervals",
    "IntervalArray": "ivsid.intervals",
    "IvsidError": "ivsid.errors",
    "Log": "ivsid.log",
    "Parameter": "ivsid.identification",
    "Plan": "ivsid.plans",
    "Tube": "ivsid.tubes",
    "Validation": "ivsid.validation",
    "Vehicle": "ivsid.vehicle",
    "Verification": "ivsid.verification",
    "diagnose": "ivsid.diagnosis",
    "export": "ivsid.exports",
    "fleet": "ivsid.fleets",
    "follow": "ivsid.identification",
    "identify": "ivsid.identification",
    "linalg": "ivsid.linear",
    "plan": "ivsid.plans",
    "read_log": "ivsid.log",
    "read_vehicle": "ivsid.vehicle",
    "regression": "ivsid.linear",
    "setup_findings": "ivsid.setup",
    "tube": "ivsid.tubes",
    "validate": "ivsid.validation",
    "verify": "ivsid.verification",
}

__all__ = [
    "Diagnosis",
    "EndpointPair",
    "Fleet",
    "Following",
    "Identification",
    "Interval",
    "IntervalArray",
    "IvsidError",
    "Log",
    "Parameter",
    "Plan",
    "Tube",
    "Validation",
    "Vehicle",
    "Verification",
    "__version__",
    "diagnose",
    "exchange",
    "export",
    "fleet",
    "follow",
    "identify",
    "linalg",
    "plan",
    "read_log",
    "read_vehicle",
    "regression",
    "setup_findings",
    "tube",
    "validate",
    "verify",
]


def __getattr__(name: str) -> object:
    if name == "__version__":
        found: object = import_module("importlib.metadata").version("ivsid")
    elif name in ("linalg", "regression"):
        found = import_module(f"ivsid.linear.{name}")
    elif name == "exchange":
        found = import_module("ivsid.intervals.exchange")
    elif name in _HOMES:
        found = getattr(import_module(_HOMES[name]), name)
    else:
        raise AttributeError(f"module 'ivsid' has no attribute '{name}'")
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)


def _drawn(result: Result, figure: "Figure | None") -> "tuple[Axes, ...]":
    from ivsid.report.figures.plots import plot  # noqa: PLC0415 - loads Matplotlib, which only drawings need

    return plot(result, figure)


# Results are defined below the chapter that draws them. Only the root knows both, and hands the function down.
Result.drawn_by = staticmethod(_drawn)
