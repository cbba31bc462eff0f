"""The noise of a log: the ambient force behind it, the samples that count, and filters that forget quickly."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.data.between import Straddled
from ivsid.diagnosis.estimation.whitening import Whitening, lags_of
from ivsid.diagnosis.plant.lost_demands import lost_impulses
from ivsid.diagnosis.plant.usual_hull import hull_length
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.prediction.kalman import Axis
from ivsid.diagnosis.prediction.passes import handed_on
from ivsid.effects.inertia import INERTIA_YAW, MASS_SURGE, MASS_SWAY
from ivsid.vehicle import Vehicle

Array = NDArray[np.float64]
# Time after the start of a log and after a gap in which the filters settle, and whose samples do not count [s].
# Source: geometry: longer than 1 / LEAST_RATE, the longest memory of a filter
SETTLING: Final = 4.0
# Memories of the slowest filter in which it forgets how a log began.
# Source: geometry: exp(-5) of an error is left, a thousandth of its square where noise of a hundredth stands beside it
FORGOTTEN: Final = 5.0
# Time constants of a thruster after which it runs as it is told: a log may begin with thrusters at rest or in steady motion, and no reading says which.
# Source: geometry: exp(-5) of a thrust is left, less than its accuracy
RUN_UP: Final = 5.0
# Deviations of a filtered velocity by which a jump of a demand in a lost row may move it before the samples after it do not count.
# Source: theorem: a state that is off by its own deviation adds one to chi-squared at most
UNSEEN: Final = 1.0
# Arm of a thrust over the hull's length from which on it is a known moment.
# Source: geometry: thrusters stand on their hull
FAR: Final = 100.0
# Half the time over which slopes of the velocity are taken [s].
# Source: measured: make constants
HALF: Final = 0.5
# Lags at which slopes are correlated [s].
# Source: geometry: a slope is made of 1.5 s of readings, so that slopes 2 s apart share no noise of a sensor
LAGS: Final = (2.0, 4.0)
# Least and largest ratio of the correlations at both lags.
# Source: geometry: keeps the logarithm finite; the correlation time is bounded further
RATIOS: Final = (1e-3, 0.9)
# Least and largest correlation time that is estimated [s].
# Source: measured: make constants
TIMES: Final = (1.0, 5.0)
# The ambient acceleration of an axis whose slopes are not correlated, as a share of the one before.
# Source: measured: make constants
UNCORRELATED: Final = 0.3
# Least and largest estimate of the ambient acceleration, in the declared one.
# Never estimate less than the declared noise: it would make slow signatures look significant.
# Source: measured: make constants
DECLARED_RANGE: Final = (1.0, 30.0)
# The same in the assumed one, where none is declared.
# Source: measured: make constants
ASSUMED_RANGE: Final = (0.05, 1e3)
# Least ambient acceleration that a vehicle file declares, in m/s^2 and, on the hull's radius of gyration, rad/s^2.
# Source: geometry: a filter needs some process noise
LEAST_DECLARED: Final = 1e-4
# The assumed ambient force, as a share of the thrusters' absolute accuracy.
# Source: measured: make constants
ASSUMED_SHARE: Final = 0.2
# Accuracy of thrust per mass where none is stated [m/s^2].
# Source: measured: make constants
ASSUMED_ACCURACY: Final = 0.01
# Arm of the assumed ambient force, in hull lengths.
# Source: measured: make constants
ASSUMED_ARM: Final = 0.3
# Assumed correlation time of the ambient force [s].
# Source: measured: make constants
ASSUMED_TIME: Final = 2.0
# Mass times squared length over the inertia in yaw of a usual hull.
# Source: physics: 12 is a uniform rod's, and added inertia makes it less
INERTIA_DIVISOR: Final = 8
# The memory of a filter times the damping of its axis is below the inverse of this.
# Source: measured: make constants
QUICKER: Final = 2.0
# The memory of a filter is below the inverse of this rate [1/s].
# Source: measured: make constants
LEAST_RATE: Final = 0.3
# Largest spectral radius of what a pass of the filters hands on of an error of the states.
# Source: geometry/physics: below one; two passes leave a third of an error, and the slopes differ along a log
CONTRACTION: Final = 0.6
# Factor of the ambient acceleration by which a filter is made quicker.
# Source: measured: make constants
QUICKENING: Final = 1.6
# A filter is made no quicker where that leaves more than this of its memory, nor all of them where it leaves more of what a pass hands on.
# Source: geometry: a quicker filter of velocities alone keeps the inverse root of the factor, 0.79
SHORTER: Final = 0.95
# Most times that a filter is made quicker.
# Source: resource: time of designing filters
MOST_QUICKENINGS: Final = 8


@dataclass(frozen=True)
class Noise:
    """The noise of a log, as it was learnt.

    Attributes:
        predictor: the log with its filters.
        whitening: of its prediction errors.
        good: samples that count, shape (n,).
        left_out: indices of the axes that are left out of the fit.
        rougher: ambient acceleration at the least over the declared one and that of thrust errors, by axis.
        alone: the same over the declared one alone.
        scatter: of prediction errors at the least over the stated accuracy, by channel.
        parted: the farthest that readings part which follow from one another, over what their stated accuracies allow, by channels.
    """

    predictor: Predictor
    whitening: Whitening
    good: NDArray[np.bool_]
    left_out: frozenset[int] = frozenset()
    rougher: tuple[float, ...] = (0.0, 0.0, 0.0)
    alone: tuple[tuple[float, ...], ...] = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    scatter: Mapping[str, float] = field(default_factory=dict)
    parted: Mapping[str, float] = field(default_factory=dict)


def declared_ambient(vehicle: Vehicle, masses: Mapping[str, float] | None = None) -> Ambient:
    """The ambient acceleration that the vehicle file declares; if it declares none, the one of a share of the thrusters' accuracy.

    Args:
        vehicle: whose file declares a force and a moment.
        masses: masses [kg] and inertia in yaw [kg m^2] of a fitted model by id, on which the declared force acts with the water that moves
            along; by default those of the hull alone, with the inertia of a usual one.
    """
    m = vehicle.hull.mass
    length = hull_length(vehicle)
    inertia = m * length**2 / INERTIA_DIVISOR
    a = vehicle.ambient
    if a is not None and (a.force or a.moment):
        said = ((MASS_SURGE, a.force, m), (MASS_SWAY, a.force, m), (INERTIA_YAW, a.moment, inertia))
        x, y, n = (max(load / (masses or {}).get(effect.id, own), LEAST_DECLARED) for effect, load, own in said)
        return Ambient((x, y, n), (a.time, a.time, a.time))
    force = absolute_force(vehicle)
    arm = ASSUMED_ARM * length
    surge = ASSUMED_SHARE * force / m
    return Ambient((surge, surge, ASSUMED_SHARE * force * arm / inertia), (ASSUMED_TIME, ASSUMED_TIME, ASSUMED_TIME))


def absolute_force(vehicle: Vehicle) -> float:
    """The absolute accuracy of all thrusts [N], or what is assumed where none is stated."""
    # A moment at a long arm is no force.
    forces = [t for t in vehicle.thrusters if t.own and np.hypot(*t.position) < FAR * hull_length(vehicle)]
    return sum(t.accuracy.absolute for t in forces) or ASSUMED_ACCURACY * vehicle.hull.mass


def lightest(vehicle: Vehicle, masses: Mapping[str, float]) -> dict[str, float]:
    """Masses [kg] and inertia in yaw [kg m^2] of the hull alone or of a fitted model, whichever is less, by id: forces accelerate none more.

    No mass is below the hull's, which holds no water. An inertia may be half of a usual one's where the mass lies amidships.

    Args:
        vehicle: with its hull.
        masses: of the fitted model by id.
    """
    m = vehicle.hull.mass
    own = {MASS_SURGE.id: m, MASS_SWAY.id: m, INERTIA_YAW.id: m * hull_length(vehicle) ** 2 / INERTIA_DIVISOR}
    return {i: min(x, masses.get(i, x)) for i, x in own.items()}


def ambient_of(predictor: Predictor, residual: Array, rows: NDArray[np.bool_], masses: Mapping[str, float]) -> Ambient:
    """The ambient acceleration behind prediction errors that no effect explains.

    The inverse of the filter gives the velocity readings that these errors stand for. Their slopes over a second, correlated at lags that
    share no noise of a sensor, give the standard deviation and the correlation time.

    Args:
        predictor: whose filters made the errors.
        residual: prediction errors without all that any column explains, shape (rows, n).
        rows: samples that count, shape (n,).
        masses: of the fitted model by id, on which the declared force acts.
    """
    deviations, times = [], []
    for k, (slope, good) in enumerate(slopes_of(predictor, residual, rows)):
        near, far = (_covariance(slope, good, round(s / predictor.log.h)) for s in LAGS)
        if near <= 0:
            deviations.append(predictor.ambient.deviation[k] * UNCORRELATED)
            times.append(predictor.ambient.time[k])
            continue
        ratio = np.clip(far / near, *RATIOS)
        time = float(np.clip(-LAGS[0] / np.log(ratio), *TIMES))
        deviations.append(float(np.sqrt(near * np.exp(LAGS[0] / time))))
        times.append(time)
    said = declared_ambient(predictor.vehicle, masses)
    given = predictor.vehicle.ambient is not None
    # The whitening takes out the colour that a quick filter leaves; a slow filter is wrong about the motion between samples.
    low, high = DECLARED_RANGE if given else ASSUMED_RANGE
    d = [float(np.clip(a, low * b, high * b)) for a, b in zip(deviations, said.deviation, strict=True)]
    if given:
        times = list(said.time)
    return Ambient((d[0], d[1], d[2]), (times[0], times[1], times[2]))


def slopes_of(
    predictor: Predictor, residual: Array, rows: NDArray[np.bool_]
) -> Iterator[tuple[Array, NDArray[np.bool_]]]:
    """Slopes over a second of the velocity readings that errors stand for, by axis, and the samples of them that count, each of shape (m,).

    Args:
        predictor: whose filters made the errors.
        residual: prediction errors, shape (rows, n).
        rows: samples that count, shape (n,).
    """
    h = predictor.log.h
    q = max(2, round(HALF / h))
    row = 0
    for k, here in enumerate(predictor.axes[:3]):
        count = len(here.outputs)
        velocity = _data_of(predictor, k, residual[row : row + count])
        row += count
        mean = uniform_filter1d(velocity, q)
        slope = (mean[2 * q :] - mean[: -2 * q]) / (2 * q * h)
        yield slope, rows[q:-q][: slope.size]


def _covariance(x: Array, good: NDArray[np.bool_], lag: int) -> float:
    both = good[lag:] & good[:-lag]
    x = np.where(good, x, 0.0)
    x = x - x.sum() / max(good.sum(), 1)
    return float(np.sum((x[lag:] * x[:-lag])[both]) / max(both.sum(), 1))


def _data_of(predictor: Predictor, k: int, errors: Array) -> Array:
    """The velocity readings that would give these errors without a model, shape (n,): the inverse of the filter."""
    here = predictor.axes[k]
    h = predictor.log.h
    decay = float(np.exp(-h / predictor.ambient.time[k]))
    if k == 2 and predictor.log.turned:
        return _slope_of_heading(here, errors, decay, h)
    at = here.outputs.index("velocity")
    K = here.kalman_gain
    # Velocity and ambient acceleration alone: the position does not act on them.
    out = np.empty(errors.shape[1])
    kalman_gain = K[1:]
    pushes = kalman_gain @ errors
    own = errors[at]
    w0, w1 = pushes.tolist()
    velocity, wind = 0.0, 0.0
    for i, e in enumerate(own.tolist()):
        out[i] = velocity + e
        velocity += w0[i]
        wind += w1[i]
        velocity += h * wind
        wind *= decay
    return out


def _slope_of_heading(here: Axis, errors: Array, decay: float, h: float) -> Array:
    """The slopes of the heading's readings that would give these errors without a model [rad/s], shape (n,)."""
    out = np.empty(errors.shape[1])
    w0, w1, w2 = (here.kalman_gain @ errors).tolist()
    heading, velocity, wind = 0.0, 0.0, 0.0
    for i, e in enumerate(errors[here.outputs.index("position")].tolist()):
        out[i] = heading + e
        heading, velocity, wind = heading + w0[i], velocity + w1[i], wind + w2[i]
        heading += h * velocity + 0.5 * h * h * wind
        velocity += h * wind
        wind *= decay
    return np.gradient(out, h)


def settled_after(predictor: Predictor) -> float:
    """Time after the start of a log [s] in which thrusters run up and the filters forget how it began."""
    memory = max(axis.memory for axis in predictor.axes[:3])
    return max(SETTLING, FORGOTTEN * memory) + RUN_UP * _lag(predictor.vehicle)


def usable_rows(predictor: Predictor) -> NDArray[np.bool_]:
    """Samples whose errors count, shape (n,): neither in a gap, nor while the filter settles after the start, a gap or a jump in a lost row."""
    good, h = predictor.log.good.copy(), predictor.log.h
    settle = round(SETTLING / h)
    reach = np.convolve((~good).astype(float), np.ones(settle))[: good.size] > 0
    reach |= _unseen(predictor)
    reach[: round(settled_after(predictor) / h)] = True
    if predictor.rate is not None:
        # A yaw rate that is made of later readings as well settles at both ends.
        reach[good.size - settle :] = True
    return ~reach


def _unseen(predictor: Predictor) -> NDArray[np.bool_]:
    """Samples that a filter has not forgotten a jump before which a lost row may hide, shape (n,)."""
    log = predictor.log
    out = np.zeros(log.n, dtype=bool)
    if isinstance(log.between, Straddled):
        # A filter follows a reading that lies on a straight line over what nobody knows.
        kept = FORGOTTEN * max(axis.memory for axis in predictor.axes[:3]) + lags_of(log.h) * log.h
        out |= np.convolve(log.between.far, np.ones(round(min(SETTLING, kept) / log.h) + 1))[: log.n] > 0
    if log.lost is None:
        return out
    masses = lightest(predictor.vehicle, {})
    # The thrust is off while its lag lasts, and the whitening holds an error for its lags.
    longer = _lag(predictor.vehicle) * RUN_UP + lags_of(log.h) * log.h
    for axis, impulse, mass in zip(predictor.axes, lost_impulses(predictor.driving), masses.values(), strict=False):
        moved = impulse / (mass * UNSEEN * axis.spread)
        for k in np.flatnonzero(moved > 1.0).tolist():
            # A larger jump takes longer to be forgotten.
            kept = (FORGOTTEN + np.log(moved[k])) * axis.memory
            out[k : k + round(min(SETTLING, kept + longer) / log.h) + 1] = True
    return out


def _lag(vehicle: Vehicle) -> float:
    """The longest time constant of a thruster [s]."""
    return max((t.time_constant or 0.0 for t in vehicle.thrusters), default=0.0)


def quick_enough(predictor: Predictor, slopes: Array) -> Predictor:
    """A predictor whose filters forget faster than the vehicle, so that their states hardly depend on the hypothesis, and passes settle.

    A pass of the filters hands an error of the states on by the slopes of the accelerations, each over the memory of its axis. The errors
    die out if the spectral radius of that matrix is below one.

    Args:
        predictor: with filters of the estimated ambient force.
        slopes: of the accelerations with the velocities [1/s], shape (3, 3, samples).
    """
    damping = [max(float(-np.mean(slopes[k, k])), 0.0) for k in range(3)]
    shortest: set[int] = set()
    for _ in range(MOST_QUICKENINGS):
        memory = np.array([axis.memory for axis in predictor.axes[:3]])
        slow = [k for k in range(3) if memory[k] * max(QUICKER * damping[k], LEAST_RATE) > 1]
        radius = handed_on(predictor.axes, slopes)
        joint = not slow and radius > CONTRACTION
        if joint:
            slow = [0, 1, 2]
        slow = [k for k in slow if k not in shortest]
        if not slow:
            return predictor
        quicker = _quickened(predictor, slow)
        in_vain = {k for k in slow if quicker.axes[k].memory > SHORTER * memory[k]}
        if in_vain:
            # An accelerometer tells the ambient acceleration at once, and the velocity's readings alone give the memory: a filter that expects
            # more of it follows the noise of its readings.
            shortest |= in_vain
            slow = [k for k in slow if k not in in_vain]
            quicker = _quickened(predictor, slow) if slow else predictor
        if joint and handed_on(quicker.axes, slopes) > SHORTER * radius:
            # What is handed on goes through axes that cannot forget sooner; such passes go a share of the way.
            return predictor
        predictor = quicker
    return predictor


def _quickened(predictor: Predictor, slow: Collection[int]) -> Predictor:
    """The predictor with more ambient acceleration in some axes."""
    x, y, n = (d * (QUICKENING if k in slow else 1.0) for k, d in enumerate(predictor.ambient.deviation))
    return predictor.adopt(Ambient((x, y, n), predictor.ambient.time))
