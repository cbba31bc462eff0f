"""Vehicle files as checked, immutable values.

- ``vehicle``: hull, thrusters, sensors, limits, ambient force and model, as a TOML file states them.
- ``actuator``: azimuth thrusters, rudders and the rates at which they turn.
- ``mount``: where a sensor stands and which way it looks.

The chapter may use ``files`` and ``errors``. It holds no physics: ``propulsion`` turns demands into forces, ``sensors`` turns
readings into intervals, ``effects`` holds the equations of motion.
"""

from ivsid.vehicle.vehicle import (
    AccelerationSensor,
    Finite,
    InertialSensor,
    Limits,
    NonNegative,
    Positive,
    Sensors,
    Thruster,
    Vehicle,
    VelocitySensor,
    parse_vehicle,
    read_vehicle,
    validated,
)

__all__ = [
    "AccelerationSensor",
    "Finite",
    "InertialSensor",
    "Limits",
    "NonNegative",
    "Positive",
    "Sensors",
    "Thruster",
    "Vehicle",
    "VelocitySensor",
    "parse_vehicle",
    "read_vehicle",
    "validated",
]
