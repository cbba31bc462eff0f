"""The vehicle as the diagnosis models it: states and demands to accelerations and readings.

- ``physics``: a hypothesis (terms, effects, numbers), its accelerations, and the columns of its terms.
- ``propulsion``: thrust of each thruster under a hypothesis.
- ``driving``: all that drives the vehicle, in time.
- ``readings``: what effects of sensors add to a reading.

The chapter may use ``data``.
"""
