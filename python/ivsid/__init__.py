"""ivsid: guaranteed system identification for unmanned marine vehicles.

From logged demands, accelerations, velocities and yaw rates to parameter intervals that are proved under stated bounds on
sensors and thrust. See the README for the commands, and ``docs/`` for the user's guide.
"""

from importlib.metadata import version

from ivsid import linalg, regression
from ivsid.diagnosis import Diagnosis, diagnose
from ivsid.errors import IvsidError
from ivsid.identification import Identification, Parameter, identify
from ivsid.intervals import EndpointPair, Interval, IntervalArray
from ivsid.log import Log, read_log
from ivsid.validation import Validation, validate
from ivsid.vehicle import Vehicle, read_vehicle
from ivsid.verification import Verification, verify

__version__ = version("ivsid")

__all__ = [
    "Diagnosis",
    "EndpointPair",
    "Identification",
    "Interval",
    "IntervalArray",
    "IvsidError",
    "Log",
    "Parameter",
    "Validation",
    "Vehicle",
    "Verification",
    "__version__",
    "diagnose",
    "identify",
    "linalg",
    "read_log",
    "read_vehicle",
    "regression",
    "validate",
    "verify",
]
