"""Errors of sensors that a vehicle file declares, beside noise and biases that wander: slow ones inside an accuracy, and sensors that are mounted elsewhere."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from scipy.interpolate import PchipInterpolator

# White noise alone, slow errors, or errors of the mounting.
SENSORS = ("white", "slow", "mounted")
# Share of an accuracy that a slow error may have; noise keeps the rest.
SHARE = (0.1, 0.9)
# Periods of a slow error over the log, and knots of one without a period.
PERIODS, KNOTS = (0.5, 3.0), 5
# Accuracy of a position, in lengths of the hull, and of a rotation [rad].
POSITION, ROTATION = 0.015, 0.01


def drawn_sensors(seed: int) -> str:
    """The kind of a seed's sensor errors, each as often as the others."""
    return str(np.random.default_rng([seed, 7]).choice(SENSORS))


def slow(n: int, rng: np.random.Generator) -> np.ndarray:
    """A slow error in units of its bound, shape (n,): a constant, a wave, or a curve through a few values."""
    kind, x = int(rng.integers(3)), np.arange(n) / n
    if kind == 0:
        return np.full(n, rng.choice([-1.0, 1.0]))
    if kind == 1:
        return np.sin(2 * math.pi * (rng.uniform(*PERIODS) * x + rng.uniform()))
    return PchipInterpolator(np.linspace(0.0, 1.0, KNOTS), rng.uniform(-1.0, 1.0, KNOTS))(x)


def stated(text: str, length: float) -> str:
    """A vehicle file that leaves room for the mounting of its velocity sensor and of its accelerometer."""
    room = f"position_accuracy = {POSITION * length:.4g}\nrotation_accuracy = {ROTATION}\n"
    for section in ("[sensors.velocity]\n", "[sensors.acceleration]\n"):
        text = text.replace(section, section + room)
    return text


def mounting(length: float, rng: np.random.Generator) -> dict[str, dict[str, float]]:
    """Errors of the mounting inside these bounds, as effects on the readings."""
    reach = POSITION * length
    arms = {
        f"sensor.{s}.lever_arm": dict(zip("xy", rng.uniform(-reach, reach, 2), strict=True))
        for s in ("velocity", "acceleration")
    }
    return {**arms, "sensor.velocity.misalignment": {"": float(rng.uniform(-ROTATION, ROTATION))}}


def slow_errors(
    sensors: Mapping[str, Mapping[str, float]], n: int, rng: np.random.Generator
) -> tuple[float, dict[str, np.ndarray]]:
    """Share of the accuracies that slow errors have, and these errors by column, shape (n,) each."""
    share = float(rng.uniform(*SHARE))
    bounds = {
        **dict.fromkeys("uv", sensors["velocity"]["accuracy"]),
        "psi": sensors["heading"]["accuracy"],
        **dict.fromkeys("xy", sensors["position"]["accuracy"]),
    }
    return share, {q: share * bound * slow(n, rng) for q, bound in bounds.items()}
