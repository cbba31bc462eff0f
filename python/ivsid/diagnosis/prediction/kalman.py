"""A steady Kalman filter of one axis, and its one-step prediction errors.

Its states are a position (heading), a velocity and the ambient acceleration, a Gauss-Markov process. The model's acceleration drives it. It
is linear, so that data and signatures pass through the same recursion.

Source: Anderson and Moore 1979 (steady filter, innovations form).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_discrete_are

from ivsid.linear.filters import decaying, respond

Array = NDArray[np.float64]
KINDS: Final = ("position", "velocity", "acceleration")
# Samples of an impulse response that are summed for the memory of a filter.
# Source: resource: time of one recursion; 80 s at the highest rate of the clock
LONGEST: Final = 2000
# Coefficients of a polynomial in the delay.
# Source: definition: three states make polynomials of degree three
TAPS: Final = 4
# Process noise of the velocity, as a share of the velocity that the ambient acceleration gives in a step.
# Source: theorem: the Riccati equation has a stabilising solution if process noise reaches every state (Anderson and Moore 1979)
VELOCITY_NOISE: Final = 1e-3


@dataclass(frozen=True)
class Axis:
    """The filter of one axis.

    Attributes:
        outputs: those of position, velocity and acceleration that are measured.
        kalman_gain: Kalman gain, from errors to states, shape (3, outputs).
        spread: standard deviation of the filtered velocity's error, by the filter's own covariance [m/s, rad/s].
        numerators: transfer functions' numerators in powers of the delay, by input (an output's name, or "process") and output.
        denominator: their common denominator.
        decay: factor of the ambient acceleration over a step.
    """

    outputs: tuple[str, ...]
    kalman_gain: Array
    spread: float
    numerators: Mapping[tuple[str, str], Array]
    denominator: Array
    decay: float

    def errors(self, inputs: Mapping[str, Array]) -> Array:
        """Prediction errors of inputs of shape (..., n), by input, shape (..., outputs, n)."""
        arrays = list(inputs.values())
        shape, count = arrays[0].shape, len(self.outputs)
        top = np.stack([self.numerator(name) for name in inputs], axis=1)
        below = np.tile(_padded(self.denominator), (count, 1))
        flat = [x.reshape(-1, shape[-1]) for x in arrays]
        found = [respond([x[i] for x in flat], top, below) for i in range(len(flat[0]))]
        return np.stack(found).reshape(*shape[:-1], count, shape[-1])

    def ambient(self, errors: Array) -> tuple[Array, Array]:
        """The ambient acceleration at each sample that the past lets expect, and the one that the readings of the sample let, shape (n,) each.

        Args:
            errors: of predictions, shape (outputs, n).
        """
        filtered = decaying(self.kalman_gain[2] @ errors, self.decay)
        return np.concatenate([np.zeros(1), self.decay * filtered[:-1]]), filtered

    def numerator(self, name: str) -> Array:
        """Numerators of each output's transfer function from one input, shape (outputs, TAPS)."""
        return np.stack([_padded(self.numerators[name, output]) for output in self.outputs])

    @cached_property
    def memory(self) -> float:
        """Memory of an acceleration [s]: the largest shift of the filtered velocity under one that is bounded by 1."""
        impulse = np.zeros(LONGEST)
        impulse[0] = 1.0
        errors = self.errors({"process": impulse})
        return float(np.abs(self.kalman_gain[1] @ errors - errors[self.outputs.index("velocity")]).sum())


def apart(outputs: Sequence[str], spread: float) -> Axis:
    """An axis whose velocity is known apart from it: readings of the velocity pass, and nothing else acts.

    Args:
        outputs: those of position, velocity and acceleration that are measured.
        spread: standard deviation of the velocity's error [m/s, rad/s].
    """
    names = (*outputs, "process")
    numerators = {(a, b): np.array([float(a == b and a != "acceleration")]) for a in names for b in outputs}
    return Axis(tuple(outputs), np.zeros((3, len(outputs))), spread, numerators, np.ones(1), 0.0)


class Filters:
    """The filters of several axes, applied together."""

    def __init__(self, axes: Sequence[Axis]) -> None:
        self.axes = tuple(axes)
        self._below = np.concatenate([np.tile(_padded(a.denominator), (len(a.outputs), 1)) for a in self.axes])
        self._tops: dict[tuple[tuple[int, str], ...], Array] = {}

    def errors(self, inputs: Mapping[tuple[int, str], Array]) -> Array:
        """Prediction errors of inputs of shape (n,) each, by axis and name, shape (rows, n)."""
        key = tuple(inputs)
        top = self._tops.get(key)
        if top is None:
            top = self._tops[key] = self._top(key)
        return respond(list(inputs.values()), top, self._below)

    def _top(self, key: tuple[tuple[int, str], ...]) -> Array:
        out = np.zeros((len(self._below), len(key), TAPS))
        first = 0
        for k, here in enumerate(self.axes):
            for i, (axis_, name) in enumerate(key):
                if axis_ == k:
                    out[first : first + len(here.outputs), i] = here.numerator(name)
            first += len(here.outputs)
        return out


def _padded(polynomial: Array) -> Array:
    return np.concatenate([polynomial, np.zeros(TAPS - polynomial.size)])


def axis(h: float, noise: Mapping[str, float], ambient: float, time: float) -> Axis:
    """The steady Kalman filter of one axis.

    Args:
        h: step [s].
        noise: standard deviation of each measured output's white noise, by output.
        ambient: standard deviation of the ambient acceleration [m/s^2, rad/s^2].
        time: its correlation time [s].

    Raises:
        numpy.linalg.LinAlgError: the Riccati equation has no stabilising solution.
    """
    outputs = tuple(k for k in KINDS if k in noise)
    decay = float(np.exp(-h / time))
    A = np.array([[1.0, h, 0.5 * h * h], [0.0, 1.0, h], [0.0, 0.0, decay]])
    B = np.array([0.5 * h * h, h, 0.0])
    C = np.array([[float(KINDS.index(o) == j) for j in range(3)] for o in outputs])
    if "position" not in noise:
        # No sensor sees the position: it is left out of the filter.
        A, B, C = A[1:, 1:], B[1:], C[:, 1:]
    scale = np.zeros(len(B))
    scale[-1] = ambient**2 * (1 - decay**2)
    # A trace of noise on the velocity keeps the Riccati equation solvable if there is almost no ambient force.
    scale[-2] = (VELOCITY_NOISE * ambient * h) ** 2
    R = np.diag([noise[o] ** 2 for o in outputs])
    X = solve_discrete_are(A.T, C.T, np.diag(scale), R)
    S = C @ X @ C.T + R
    K = X @ C.T @ np.linalg.inv(S)
    closed = A @ (np.eye(len(B)) - K @ C)
    inputs = np.column_stack([A @ K, B])
    D = np.column_stack([np.eye(len(outputs)), np.zeros(len(outputs))])
    numerators = {}
    # Transfer functions C' (z - A)^-1 B + D by characteristic polynomials: det(z - A - B C') = det(z - A) (1 - C' (z - A)^-1 B).
    denominator = np.asarray(np.poly(closed), dtype=np.float64)
    for i, name in enumerate((*outputs, "process")):
        for j, output in enumerate(outputs):
            numerators[name, output] = np.poly(closed + np.outer(inputs[:, i], C[j])) + (D[j, i] - 1) * denominator
    kalman_gain = K if "position" in noise else np.vstack([np.zeros(len(outputs)), K])
    spread = float(np.sqrt(((np.eye(len(B)) - K @ C) @ X)[-2, -2]))
    return Axis(outputs, kalman_gain, spread, numerators, denominator, decay)
