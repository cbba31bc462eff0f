"""Axes that are left out of a fit: yaw where a vehicle hardly turns, or where its turns are over within rows.

Source: docs/theory.md, "Axes that are left out".
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.estimation.noise import HALF, QUICKER
from ivsid.diagnosis.plant.usual_hull import hull_length
from ivsid.diagnosis.prediction.innovations import Predictor

Array = NDArray[np.float64]
# A vehicle turns if its yaw rate varies by this multiple of its filter's error.
# Source: measured: make constants
MOVING: Final = 20.0
# Least standard deviation of the yaw rate of a hull of 1 m that turns [rad/s]; longer hulls turn more slowly, after Froude.
# Source: measured: make constants
TURNING: Final = 0.015
# Standard deviations of a damping that the noise of the readings changes it by, up to which yaw is not left out.
# Source: definition: an error that is told with 95 %
TOLD: Final = 2.0
# Damping of the turns, in inverse rows, beyond which yaw is left out however good its readings are.
# Source: measured: four logs of an ROV of 6 kg with 0.97 to 1.33, `unknown` with yaw and right without it, and of the tutorial's boat with 0.60 to 0.76
WITHIN_ROW: Final = 0.9
# The axis that is left out where a vehicle hardly turns, or damps its turns within a row or two of the log.
# Source: definition: the third of surge, sway and yaw
YAW: Final = frozenset({2})


def rows_too_long(predictor: Predictor, slopes: Array) -> bool:
    """Whether a hull damps its turns so quickly that no filter of rows this far apart forgets as quickly, and the log shows it, or within about a row.

    A turn is then over within a row or two, and what a model makes of the readings before it holds all of their noise: errors in variables make
    the damping too small by the square of the noise's share in the turning, and the log tells it to that share over the root of its rows.

    Args:
        predictor: of the log.
        slopes: of the accelerations with the velocities [1/s], shape (3, 3, samples).
    """
    rows = float(predictor.log.h * np.sqrt(np.mean(slopes[2, 2] ** 2)))
    told = predictor.axes[2].spread * np.sqrt(predictor.log.n) <= TOLD * _turning(predictor)
    return rows > WITHIN_ROW or (QUICKER * rows > 1 and not told)


def _turning(predictor: Predictor) -> float:
    """Standard deviation of the yaw rate over a log [rad/s]: a steady turn, as under a gyro's bias, says nothing of inertia and damping."""
    return float(uniform_filter1d(predictor.log.nu[2], max(2, round(HALF / predictor.log.h))).std())


def axes_left_out(predictor: Predictor) -> frozenset[int]:
    """Yaw and sway if the vehicle hardly turns, else no axis.

    An autopilot that keeps a heading answers to the motion itself. If little else turns the vehicle, demands and errors go together, and
    inertia and damping come out wrong. Such axes are left out of the fit, and their causes are not tested.
    """
    turning = _turning(predictor)
    # Sway follows from u r, so that it is not known without a yaw rate either.
    least = TURNING / np.sqrt(hull_length(predictor.vehicle))
    return frozenset() if turning >= max(MOVING * predictor.axes[2].spread, least) else YAW
