"""Readings to intervals.

- ``bounds``: an interval for every sample of a log.
- ``corrections``: biases, scales and a current that ``[model.fitted]`` states, taken out of the readings.
- ``noise``: the number of sigmas that bounds a whole log, and half-widths of inertial channels; ``doppler``: velocity sensors.
- ``allan``, ``allan_fit``: the Allan deviation of a static recording, and the noise coefficients read off it, by ``allan_model`` (formulas) and
  ``allan_search`` (minima); ``recording``: a filter, steps, a sinusoid or a drift in it.
- ``pose``, ``derivatives``: positions to velocities, velocities to accelerations.
- ``mounting``, ``origin``: lever arms, rotations and gravity in intervals, and logs brought to the body origin by them.
- ``lever_arms``: readings brought to the body origin in plain numbers, for the diagnosis and the examination of the set-up.
- ``smoothing``: velocities by splines, an estimate; ``weak_form``: means of velocities from the pose, without velocities at rows.

The chapter may use ``log``, ``vehicle`` and what is below them.
"""

from ivsid.sensors.bounds import BoundedLog, bound_log

__all__ = ["BoundedLog", "bound_log"]
