"""Bounds that every vessel keeps, whatever its hull: the masses of a body in water, an inertia matrix that is one, drags that do not drive.

One file holds one bound, and all have one shape: inequalities that are linear in the parameters of a model, ``bound.Inequalities``. A point, a
box of parameters (``checks``) and a regression (``regression_bounds``) all take the same ones.
"""

from ivsid.physical.bound import Inequalities, Subject
from ivsid.physical.checks import Fault, faults, regression_bounds
from ivsid.physical.masses import MOST

__all__ = ["MOST", "Fault", "Inequalities", "Subject", "faults", "regression_bounds"]
