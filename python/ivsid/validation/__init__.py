"""A fitted model against another log.

- ``checks``: predicted against measured force, simulated against measured motion.
- ``dynamics``: the equations of motion of a point model, forward in time.

The chapter may use ``identification`` and what is below it.
"""

from ivsid.validation.checks import ForceCheck, MotionCheck, Validation, validate

__all__ = ["ForceCheck", "MotionCheck", "Validation", "validate"]
