"""Readings to intervals.

- ``bounds``: an interval for every sample of a log, under the stated probability or number of sigmas.
- ``allan``, ``allan_fit``: the Allan deviation of a static recording, and the noise coefficients read off it.
- ``pose``, ``derivatives``: positions to velocities, velocities to accelerations.
- ``origin``, ``mounting``: readings brought to the body origin by lever arms, rotations and gravity.
- ``smoothing``: velocities by splines, an estimate; ``weak_form``: means of velocities straight from the pose.

The chapter may use ``log``, ``vehicle`` and what is below them.
"""

from ivsid.sensors.bounds import BoundedLog, bound_log

__all__ = ["BoundedLog", "bound_log"]
