"""Programmes: the demands that a vehicle is sent.

- ``scenario``: a scenario file as a checked value: duration, segments, truth, environment.
- ``manoeuvres``: the demands of each kind of segment.
- ``trials``: a library of manoeuvres, sized for a vehicle.

The chapter may use ``propulsion`` (how large a demand a thruster takes), ``vehicle`` and what is below them.
"""

from ivsid.programme.scenario import Scenario, parse_scenario, read_scenario

__all__ = ["Scenario", "parse_scenario", "read_scenario"]
