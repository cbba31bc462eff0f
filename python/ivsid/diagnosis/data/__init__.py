"""A log as the diagnosis reads it.

- ``channels``: all readings on one uniform clock, samples that are missing left out.
- ``from_pose``: velocities where a log holds poses alone.
- ``lever_arms``: what a sensor off the origin reads.

The chapter may use nothing else of the diagnosis.
"""
