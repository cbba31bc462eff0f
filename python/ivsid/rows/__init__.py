"""Equations of motion to interval rows A theta = y that hold at the true parameter (paper eq. 3-6; METHODS 5.2).

Pointwise rows state the equations at a sample; they need measured accelerations. Integral rows state their mean over a
window: the mean of an acceleration is an exact difference of velocities, the mean thrust of held demands an exact sum, and
what is left is a quadrature whose error the stated limits of the vessel bound.
"""

from ivsid.rows.build import KINDS, WINDOW, build_rows
from ivsid.rows.record import ROW_KINDS, RegressionRows

__all__ = ["KINDS", "ROW_KINDS", "WINDOW", "RegressionRows", "build_rows"]
