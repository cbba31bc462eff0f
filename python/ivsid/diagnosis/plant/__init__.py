"""The vehicle as the diagnosis models it: from states and demands to accelerations and readings.

A ``Hypothesis`` is a model with numbers: terms of the catalogue, effects that are no terms, and the sizes of the declared errors. The chapter
answers three questions about it, for whole logs at once:

- ``propulsion``: the thrust of each thruster at each sample and over each step, with lags, delays, dead bands and limits.
  ``declared_curve`` is the curve of one thruster with its declared errors (``thrust_errors``).
  ``driving`` keeps the thrusts of the hypotheses that are compared, with angles and known forces beside them.
- ``physics``: the accelerations at given states (``points``) by Fossen's equations in three degrees of freedom, and how they change with a
  term or an effect; ``thruster_forces`` are the thrusters' part of them.
- ``readings``: the numbers that an effect of a sensor adds to its readings; ``declared_readings``: those that the vehicle file allows for.

``usual_hull`` gives a length and plain numbers to a hull that states none.

The formulas of effects are the catalogue's (``ivsid.effects``), which rows and the simulator use as well. Everything else is written apart
from the simulator: neither its integration nor its code is used here, so that a mistake of one shows in the other.

The chapter may use ``data``.
"""
