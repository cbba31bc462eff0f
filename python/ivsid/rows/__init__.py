"""Equations of motion to interval rows A theta = y that hold at the true parameter (paper, eq. 3-6; docs/theory.md, "Rows").

One file a kind of row:

- ``pointwise``: the equations at a sample; they need accelerations.
- ``integral``: the mean of the equations over a window. The mean of an acceleration is an exact difference of velocities, and the
  mean thrust of held demands is an exact sum. A quadrature bounds the rest, under the stated limits of the vessel.
- ``weak``: the equations weighted by a hat over two windows, with means of velocities from the pose itself.

The parts that all kinds share:

- ``build``: all rows that a log supports. ``record``: the rows as a value.
- ``equations``: the log, the model and the forces together. ``forces``: known forces at rows and over steps.
- ``motion``: a quantity with its rate of change, for the error of the quadrature.
- ``required_columns``: the columns of a log that each parameter needs.

The chapter may use ``effects``, ``propulsion``, ``sensors`` and the chapters below them.
"""

from ivsid.rows.build import KINDS, WINDOW, build_rows, window_count
from ivsid.rows.record import ROW_KINDS, RegressionRows

__all__ = ["KINDS", "ROW_KINDS", "WINDOW", "RegressionRows", "build_rows", "window_count"]
