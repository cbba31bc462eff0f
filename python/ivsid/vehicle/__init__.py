"""Vehicle files as checked, immutable values.

- ``vehicle``: the whole file: hull, ambient force, model, and the other parts.
- ``thrusters``, ``rudder``: thrusters with their thrust curves, and rudders behind them.
- ``known_force``: forces of a log as thrusters that follow them.
- ``voith_schneider``: a Voith-Schneider unit as two thrusters.
- ``sensors``: bounds of readings, and limits of the motion.
- ``mount``: position and orientation of a sensor.
- ``carried``: numbers of ``[model.fitted]`` that keys of the file can state.
- ``given``: a vehicle by its path or its name.
- ``reading``: a TOML table to a checked value, or one sentence about its first fault.

The chapter may use ``files`` and ``errors``. It holds no physics: ``propulsion`` turns demands into forces, ``sensors`` turns
readings into intervals, ``effects`` holds the equations of motion.
"""

from ivsid.files.section import Finite, NonNegative, Positive
from ivsid.vehicle.given import GivenVehicle, vehicle_of
from ivsid.vehicle.known_force import KnownForce, with_known_forces
from ivsid.vehicle.reading import validated
from ivsid.vehicle.rudder import Rudder
from ivsid.vehicle.sensors import AccelerationSensor, InertialSensor, Limits, Sensors, VelocitySensor
from ivsid.vehicle.thrusters import Thruster
from ivsid.vehicle.vehicle import Vehicle, parse_vehicle, read_vehicle

__all__ = [
    "AccelerationSensor",
    "Finite",
    "GivenVehicle",
    "InertialSensor",
    "KnownForce",
    "Limits",
    "NonNegative",
    "Positive",
    "Rudder",
    "Sensors",
    "Thruster",
    "Vehicle",
    "VelocitySensor",
    "parse_vehicle",
    "read_vehicle",
    "validated",
    "vehicle_of",
    "with_known_forces",
]
