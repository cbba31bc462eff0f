"""Demands to forces, in intervals.

- ``thrust``: the curve of one thruster, from demand to a force interval; ``configuration``: thrusts to forces on the hull.
- ``bollard``: bollard-pull tables, and candidates for a curve.
- ``demand_unit``: pulse widths and fractions told apart by their range, for the sentence about a demand outside of its curve.
- ``foil``: lift and drag of a low-aspect-ratio foil; ``rudder``: the force of a rudder over boxes of speeds and angles.
- ``lag``: forces behind a first-order lag.
- ``carried``: gains, asymmetry and delays that ``[model.fitted]`` states.
- ``actuation``: the forces of a whole vehicle in time, azimuth thrusters and rudders included.

The chapter may use ``log``, ``vehicle`` and what is below them.
"""
