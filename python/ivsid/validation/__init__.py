"""A fitted model against another log.

- ``checks``: predicted against measured force, simulated against measured motion.
- ``dynamics``: the equations of motion of a model with numbers for its parameters, forward in time.

The chapter may use ``identification`` and the chapters below it.
"""

from ivsid.validation.checks import ForceCheck, MotionCheck, Validation, validate

__all__ = ["ForceCheck", "MotionCheck", "Validation", "validate"]
