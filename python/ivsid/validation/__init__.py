"""A fitted model against another log.

- ``checks``: predicted against measured force, simulated against measured motion.
- ``motion``: free runs over windows, by the simulator where the model has causes beside its terms.
- ``dynamics``: the equations of motion of a model with numbers for its parameters, forward in time.

The chapter may use ``identification``, ``simulation``, ``tubes`` and the chapters below them.
"""

from ivsid.validation.checks import ForceCheck, MotionCheck, Validation, validate

__all__ = ["ForceCheck", "MotionCheck", "Validation", "validate"]
