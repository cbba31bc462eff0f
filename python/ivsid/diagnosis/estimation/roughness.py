"""How much rougher a log is than its vehicle file declares: the ambient acceleration that it shows, at the least, over the declared one.

The noise of a log is learnt from what no cause explains, so that a force outside the catalogue is learnt as ambient force, and hides itself.
The declared ambient force is a bound all the same, and where a file declares none, the absolute accuracy of the thrusts. So is the whole accuracy of
the thrusts, whose errors a log holds that no declared function follows: both count as declared.

Source: docs/theory.md, "Noise"; for means over blocks Künsch, "The jackknife and the bootstrap for general stationary observations",
Annals of Statistics 17, 1989.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.data.sensor_noise import NORMAL_MEDIAN
from ivsid.diagnosis.estimation.noise import (
    ASSUMED_ACCURACY,
    ASSUMED_ARM,
    absolute_force,
    declared_ambient,
    lightest,
    slopes_of,
)
from ivsid.diagnosis.plant.usual_hull import hull_length
from ivsid.diagnosis.prediction.filtered_states import FilteredStates
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Length of the blocks whose scatter tells how well a correlation is known [s].
# Source: geometry: several correlation times of an ambient force
BLOCK: Final = 20.0
# Blocks from which a scatter is told.
# Source: definition: fewer have hardly any
FEWEST: Final = 4
# Blocks from which the scatter of their middle half counts: of fewer it may be small by chance.
# Source: definition: half of eight are four
MANY: Final = 8
# Standard errors below the estimate that count as "at the least".
# Source: definition: of twelve normal estimates three in a thousand lie below, over three axes one in a hundred logs
ERRORS: Final = 3.0
# Times after which slopes of readings over a second share no noise that adds to the covariance of both [s].
# Source: geometry: a slope is the difference of two means over half a second; a second apart one begins where the other ends, which lowers it
APART: Final = (1.0, 2.0)
# Time after which readings of an accelerometer have nothing in common but a force [s].
# Source: geometry: two samples at 10 Hz; a slam, or a blow of a propeller, lasts as long
QUICK: Final = 0.2
# Share of a thrust's error inside the cells of its demand that lasts for two seconds at the least: it comes in spells, which count as doubt.
# Source: measured: a sound ROV whose thrusts jump by 51 times the declared force had 4.8 times it beyond any curve, 0.9 with this share; a sea of eight times
# the declared one beneath thrusts that may be off by 23 times it 4.3, and 2.2
SPELLS: Final = 0.25


def roughness(
    predictor: Predictor,
    residual: Array,
    rows: NDArray[np.bool_],
    left_out: frozenset[int],
    states: FilteredStates,
) -> tuple[Array, Array]:
    """Ambient acceleration at the least over what is declared, by axis, shape (3,), and over the declared ambient force alone, shape (2, 3).

    The latter is first that of what lasts for a second or two, by the scatter of all blocks, and then that of what accelerometers read.

    Args:
        predictor: whose filters made the errors.
        residual: prediction errors without all that any column explains, shape (rows, n).
        rows: samples that count, shape (n,).
        left_out: indices of the axes that are left out of a fit.
        states: of the fitted model.
    """
    vehicle = predictor.vehicle
    inertia, declared = allowed_ambient(vehicle, states.h.values)
    times = declared_ambient(vehicle).time
    noisy = _of_states(predictor, states)
    quick = quick_ambient(predictor, residual, rows, left_out, noisy)
    most, lasting = quick, np.zeros(3)
    for time in APART:
        of_most, of_all = least_ambient(predictor, residual, rows, left_out, time)
        # Spells of quick turns scatter the blocks as spells of a force do.
        found = np.maximum(np.sqrt(np.maximum(of_most**2 - noisy, 0.0)), of_all)
        # An ambient force that forgets at the declared rate keeps this share of its deviation.
        kept = np.exp(-0.5 * time / np.array(times))
        most, lasting = np.maximum(most, found / kept), np.maximum(lasting, of_all)
    alone = np.stack([lasting, quick]) / declared if vehicle.ambient is not None else np.zeros((2, 3))
    return most / np.hypot(declared, _of_thrusts(predictor) / inertia), alone


def rougher_alone(
    predictor: Predictor,
    residual: Array,
    rows: NDArray[np.bool_],
    left_out: frozenset[int],
    states: FilteredStates,
    share: float,
) -> Array:
    """Ambient acceleration at the least over what is declared of it, by axis, of residuals beyond any thrust curve in cells of demand.

    Arguments are those of ``roughness``, and the share of the thrusts' accuracy that the cells leave, which counts as declared.

    Returns:
        What lasts for a second or two, by the scatter of all blocks, and what accelerometers read, as of ``roughness``, shape (2, 3).
    """
    least = lightest(predictor.vehicle, states.h.values)
    declared = np.array(declared_ambient(predictor.vehicle, least).deviation)
    thrusts = share * _of_thrusts(predictor) / np.array(list(least.values()))
    of_all = np.max([least_ambient(predictor, residual, rows, left_out, time)[1] for time in APART], axis=0)
    quick = quick_ambient(predictor, residual, rows, left_out, _of_states(predictor, states))
    return np.stack([of_all / np.hypot(declared, SPELLS * thrusts), quick / np.hypot(declared, thrusts)])


def allowed_ambient(vehicle: Vehicle, masses: Mapping[str, float]) -> tuple[Array, Array]:
    """Masses [kg] and inertia in yaw [kg m^2] on which forces act, at the least, and the ambient acceleration that counts as declared, shape (3,) each.

    Args:
        vehicle: whose file declares a force, or thrusts whose absolute accuracy stands for one.
        masses: of the fitted model by id.
    """
    least = lightest(vehicle, masses)
    inertia = np.array(list(least.values()))
    if vehicle.ambient is None:
        return inertia, _undeclared(vehicle) / inertia
    return inertia, np.array(declared_ambient(vehicle, least).deviation)


def _undeclared(vehicle: Vehicle) -> Array:
    """Forces X, Y [N] and moment N [N m] that a vehicle file without an ambient force allows, shape (3,).

    Such a file says nothing of the sea: what is assumed without an accuracy is allowed beside a better one as well.
    """
    force = max(absolute_force(vehicle), ASSUMED_ACCURACY * vehicle.hull.mass)
    return np.array([force, force, force * ASSUMED_ARM * hull_length(vehicle)])


def least_ambient(
    predictor: Predictor, residual: Array, rows: NDArray[np.bool_], left_out: frozenset[int], time: float
) -> tuple[Array, Array]:
    """Ambient acceleration of each axis at the least [m/s^2, rad/s^2], shape (3,); 0 where an axis is left out or a rudder pushes.

    It is what lasts for some time: no force of any spectrum is less. A force in spells scatters the blocks itself, which is no doubt of its mean;
    where the accuracy of the thrusts does not count as declared it is one, since an error that jumps with the demand comes in spells as well.

    Args:
        predictor: whose filters made the errors.
        residual: prediction errors without all that is explained, shape (rows, n).
        rows: samples that count, shape (n,).
        left_out: indices of the axes that are left out of a fit.
        time: for which it lasts [s], one of ``APART``.

    Returns:
        By the scatter of most blocks, and by that of all.
    """
    out = np.zeros((2, 3))
    for k, (slope, good) in enumerate(slopes_of(predictor, residual, rows)):
        if told(predictor, k, left_out):
            # Readings on a coarse scale are off by what the motion makes of it: a slope over a second by as much as two independent ones.
            rounded = predictor.log.steps.get("uvr"[k], 0.0) ** 2 / 6
            out[:, k] = np.sqrt(np.maximum(_lasting(slope, good, time, predictor.log.h) - rounded, 0.0))
    return out[0], out[1]


def quick_ambient(
    predictor: Predictor,
    residual: Array,
    rows: NDArray[np.bool_],
    left_out: frozenset[int],
    noisy: Array,
) -> Array:
    """The same of what lasts for a fifth of a second, where accelerometers read it; 0 for the others, shape (3,).

    The model's acceleration is that at filtered velocities, whose errors last as well: what they make of it is no force.

    Args:
        predictor: whose filters made the errors.
        residual: prediction errors without all that is explained, shape (rows, n).
        rows: samples that count, shape (n,).
        left_out: indices of the axes that are left out of a fit.
        noisy: mean square of what errors of filtered velocities make of the model's acceleration, by axis, shape (3,).
    """
    out, row = np.zeros(3), 0
    for k, here in enumerate(predictor.axes[:2]):
        errors = residual[row : row + len(here.outputs)]
        row += len(here.outputs)
        if "acceleration" in here.outputs and told(predictor, k, left_out):
            # What the filter expects of the ambient acceleration before each reading is a part of it.
            expected, _ = here.ambient(errors)
            read = errors[here.outputs.index("acceleration")] + expected
            out[k] = np.sqrt(max(_lasting(read, rows, QUICK, predictor.log.h)[0] - noisy[k], 0.0))
    return out


def _of_states(predictor: Predictor, states: FilteredStates) -> Array:
    """Mean square of what errors of the filtered velocities make of the model's acceleration, by axis, shape (3,)."""
    spreads = np.array([a.spread for a in predictor.axes[:3]])
    return np.asarray(np.mean(predictor.slopes(states) ** 2, axis=2) @ spreads**2)


def told(predictor: Predictor, k: int, left_out: frozenset[int]) -> bool:
    """Whether an axis tells of an ambient force: the error of a rudder's force has no bound in newtons, and it pushes sideways."""
    return k not in left_out and (k == 0 or all(t.rudder is None for t in predictor.vehicle.thrusters))


def _lasting(x: Array, good: NDArray[np.bool_], time: float, h: float) -> Array:
    """The variance of a series at the least, by what a time apart [s] has in common; 0 where too few samples count.

    Args:
        x: the series, shape (m,).
        good: samples that count, shape (m,).
        time: apart.
        h: step [s].

    Returns:
        By the scatter of most blocks, and by that of all, shape (2,).
    """
    lag, block = max(2, round(time / h)), round(BLOCK / h)
    both = (good[lag:] & good[:-lag]).astype(float)
    edges = np.arange(0, both.size - block + 1, block)
    count = np.add.reduceat(both, edges) if edges.size else np.zeros(0)
    whole = count > 0.5 * block
    if whole.sum() < FEWEST:
        return np.zeros(2)
    x = np.where(good, x - x[good].mean(), 0.0)
    each = np.add.reduceat(x[lag:] * x[:-lag], edges)[whole] / count[whole]
    return at_the_least(each, _of_noise(x, lag, int(good.sum())))


def _of_noise(x: Array, lag: int, count: int) -> float:
    """Standard error of a covariance some samples apart in noise that nothing else correlates.

    Source: Bartlett, *JRSS Supplement* 8, 1946.

    Args:
        x: the series, zero where it does not count, shape (m,).
        lag: samples apart, beyond those that share noise.
        count: of the samples that count.
    """
    near = [float(x[k:] @ x[: x.size - k]) / count for k in range(lag)]
    return float(np.sqrt((near[0] ** 2 + 2.0 * sum(c * c for c in near[1:])) / count))


def at_the_least(each: Array, noise: float = 0.0) -> Array:
    """The mean of blocks at the least, by the scatter of most of them, and by that of all, shape (2,).

    Args:
        each: mean of each block.
        noise: standard error of the mean at the least; the scatter of a few dozen blocks may be half of it by chance.
    """
    spread = float(each.std(ddof=1))
    # Most blocks are as evenly rough as noise is.
    usual = float(np.median(np.abs(each - np.median(each)))) / NORMAL_MEDIAN if each.size >= MANY else spread
    error = np.maximum(np.array([min(usual, spread), spread]) / np.sqrt(each.size), noise)
    return np.asarray(each.mean() - ERRORS * error)


def _of_thrusts(predictor: Predictor) -> Array:
    """Forces X, Y [N] and moment N [N m] that errors of all thrusts together make at their bounds, rms, shape (3,)."""
    return np.asarray(sum(np.sqrt(np.mean(x**2, axis=1)) for x in bounds_of_thrusts(predictor)), float) + np.zeros(3)


def bounds_of_thrusts(predictor: Predictor) -> Iterator[Array]:
    """Forces X, Y [N] and moment N [N m] that the error of each own thrust makes at its bound, shape (3, n) each.

    Args:
        predictor: whose demands they are.
    """
    vehicle, propulsion = predictor.vehicle, predictor.propulsion
    for k, (thruster, errors) in enumerate(zip(vehicle.thrusters, propulsion.errors, strict=True)):
        if not thruster.own:
            continue
        size = errors.bound(propulsion.demands[k])
        angle, (x, y) = predictor.driving.turned[k, : size.size], thruster.position
        c, s = np.cos(angle), np.sin(angle)
        yield np.stack([c, s, x * s - y * c]) * size
