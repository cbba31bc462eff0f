"""Prediction errors of a hypothesis on a log.

- ``kalman``: a steady filter of each axis, and how it answers to forces and readings.
- ``innovations``: states, innovations and their answers for a whole log.

The chapter may use ``data`` and ``plant``.
"""
