"""True thrust curves of an examination: the stated curve and an error that fills a share of its accuracy, of a shape that the diagnosis does not know.

Nothing here is shared with the simulator's own errors or with the declared errors of the diagnosis.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.interpolate import PchipInterpolator

from ivsid.vehicle import Vehicle

# Entries of a true curve over the range of its demands.
ENTRIES = 241
# A shape takes places from 0 to 1 over the range of demands, and the place of no demand, and gives shares of the bound from -1 to 1.
Shape = Callable[[np.ndarray, float], np.ndarray]


def sawtooth(rng: np.random.Generator) -> Shape:
    teeth, phase, sign = rng.uniform(2, 6), rng.uniform(), rng.choice([-1, 1])
    return lambda x, zero: sign * (2 * ((teeth * x + phase) % 1.0) - 1)


def steps(rng: np.random.Generator) -> Shape:
    places = np.sort(rng.uniform(0, 1, int(rng.integers(1, 4))))
    levels = rng.uniform(-1, 1, places.size + 1)
    levels /= np.abs(levels).max()
    return lambda x, zero: levels[np.searchsorted(places, x)]


def spline(rng: np.random.Generator) -> Shape:
    inner = np.sort(rng.uniform(0.03, 0.97, int(rng.integers(4, 10))))
    curve = PchipInterpolator(np.r_[0.0, inner, 1.0], rng.uniform(-1, 1, inner.size + 2))
    return lambda x, zero: curve(x)


def two_waves(rng: np.random.Generator) -> Shape:
    """An offset that changes sign with the demand, and two incommensurate waves."""
    a, b, c = rng.uniform(0.2, 1.0, 3)
    whole = a + b + c
    first = rng.uniform(1.0, 2.5)
    phases = rng.uniform(0, 2 * np.pi, 2)
    side = rng.choice([-1, 1])

    def shape(x: np.ndarray, zero: float) -> np.ndarray:
        waves = b * np.sin(2 * np.pi * first * x + phases[0]) + c * np.sin(2 * np.pi * first * np.e / 2 * x + phases[1])
        return (side * a * np.sign(x - zero) + waves) / whole

    return shape


def offset(rng: np.random.Generator) -> Shape:
    """The whole bound ahead, and a share of it astern."""
    ahead, astern = rng.choice([-1, 1]), rng.uniform(-1, 1)
    return lambda x, zero: np.where(x >= zero, ahead, astern)


def hump(rng: np.random.Generator) -> Shape:
    """An error in one part of the range alone."""
    middle, width, sign = rng.uniform(0.5, 0.95), rng.uniform(0.05, 0.2), rng.choice([-1, 1])
    return lambda x, zero: sign * np.exp(-(((x - middle) / width) ** 2))


def levels(rng: np.random.Generator) -> Shape:
    """One end of the bound or the other, drawn anew every fortieth of the range."""
    side = rng.choice([-1.0, 1.0], 41)
    return lambda x, zero: side[np.clip((41 * x).astype(int), 0, 40)]


SHAPES = {f.__name__: f for f in (sawtooth, steps, spline, two_waves, offset, hump, levels)}


def with_errors(
    vehicle: Vehicle, family: str, share: float, rng: np.random.Generator, *, alike: bool = False
) -> Vehicle:
    """The vehicle whose thrust curves are wrong by a share of their accuracy, and are then known exactly.

    Args:
        vehicle: with tables of thrust about a neutral of zero.
        family: of the errors.
        share: of the accuracy that the error fills.
        rng: draws the shapes.
        alike: whether all thrusters have the same shape.
    """
    thrusters, shape = [], SHAPES[family](rng)
    for t in vehicle.thrusters:
        if not alike:
            shape = SHAPES[family](rng)
        given, forces = np.asarray(t.table.demand), np.asarray(t.table.thrust)
        d = np.unique(np.r_[np.linspace(given[0], given[-1], ENTRIES), given, 0.0])
        nominal = PchipInterpolator(given, forces)(d)
        bound = np.minimum(t.accuracy.absolute + t.accuracy.relative * np.abs(nominal), np.abs(nominal))
        wrong = share * bound * shape((d - d[0]) / (d[-1] - d[0]), float(-d[0] / (d[-1] - d[0])))
        table = t.table.model_copy(update={"demand": tuple(d.tolist()), "thrust": tuple((nominal + wrong).tolist())})
        thrusters.append(t.model_copy(update={"table": table, "accuracy": type(t.accuracy)()}))
    return vehicle.model_copy(update={"thrusters": tuple(thrusters)})
