"""Velocities from the pose by smoothing splines: a narrow estimate and no bound.

Cubic splines follow x, y and psi between gaps; cross-validation chooses their stiffness. The band of the slopes comes from the
residuals. For white errors of variance s^2 at step h, a smoothing spline acts like the kernel K(q) = exp(-q) sin(q + pi/4) / 2 with
q = |t| / (b sqrt 2) and b = (lambda h)^(1/4) (Silverman 1984), so that the variance of the slope is s^2 h / b^3 times the energy of K'.
The bias is taken to be no larger, which cross-validation aims at without proof. A result that uses these velocities is never
guaranteed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.sensors.pose import POSE
from ivsid.vehicle import Sensors

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

# Energy of the kernel's slope, integral of K'^2 = 2^(-5/2) / 2.
# Source: Silverman 1984, Spline smoothing: the equivalent variable kernel method.
SLOPE_ENERGY: Final = 2.0**-3.5
# Samples below which a stretch is left out: cross-validation needs residuals on both halves of it.
# Source: measured: make constants
LEAST_SAMPLES: Final = 30
# Sigmas of a whole log, counted once for the noise and once for the bias of the spline.
# Source: theorem: union bound, 1e4 errors at a confidence of 0.999.
SIGMAS: Final = 5.3
# Missing time, in tens of periods, beyond which no spline crosses a gap.
# Source: measured: make constants
_GAP: Final = 2.5

Array = NDArray[np.float64]


def splined(log: Log, sensors: Sensors) -> tuple[Log, dict[str, IntervalArray], tuple[str, ...]]:
    """The log with the velocities that it lacks (u, v [m/s], r [rad/s]), their bands of shape (n,), and a sentence on them."""
    has = {"r": "psi" in log.columns, "u": all(c in log.columns for c in POSE)}
    wanted = [n for n in ("u", "v", "r") if n not in log.columns and has["r" if n == "r" else "u"]]
    if not wanted:
        return log, {}, ()
    psi = log.columns["psi"]
    there = np.all([np.isfinite(log.columns[c]) for c in (POSE if "u" in wanted else ("psi",))], axis=0)
    n = log.t.size
    centre = {name: np.full(n, np.nan) for name in wanted}
    reach = {name: np.full(n, np.inf) for name in wanted}
    for part in _stretches(log.t, there, log.period):
        t = log.t[part]
        heading = np.unwrap(psi[part])
        smooth_psi, rate, rate_band = _smoothed(t, heading)
        if "r" in wanted:
            centre["r"][part], reach["r"][part] = rate, rate_band
        if "u" in wanted:
            _, north, north_band = _smoothed(t, log.columns["x"][part])
            _, east, east_band = _smoothed(t, log.columns["y"][part])
            c, s = np.cos(smooth_psi), np.sin(smooth_psi)
            centre["u"][part], centre["v"][part] = north * c + east * s, east * c - north * s
            turned = 0.0 if sensors.heading is None else sensors.heading.accuracy
            speed = np.hypot(north, east)
            for name in ("u", "v"):
                reach[name][part] = np.hypot(north_band, east_band) + turned * speed
    found = {}
    for name in wanted:
        known = np.isfinite(centre[name])
        middle, width = np.where(known, centre[name], 0.0), np.where(known, reach[name], 0.0)
        found[name] = IntervalArray(np.where(known, middle - width, -np.inf), np.where(known, middle + width, np.inf))
    sentence = f"{', '.join(wanted)} are slopes of smoothing splines through the pose, with bands from their residuals: an estimate, not a bound"
    made = replace(
        log,
        columns={**log.columns, **centre},
        derived={**log.derived, **{name: POSE if name != "r" else ("psi",) for name in wanted}},
        notes=(*log.notes, sentence),
    )
    return made, found, (sentence,)


def _stretches(t: Array, there: NDArray[np.bool_], period: float) -> list[NDArray[np.intp]]:
    """Stretches of rows with a pose and no gap between them; short ones are left out."""
    rows = np.flatnonzero(there)
    if not rows.size:
        return []
    apart = np.flatnonzero(np.diff(t[rows]) > 10 * _GAP * period) + 1
    return [part for part in np.split(rows, apart) if part.size >= LEAST_SAMPLES]


def _smoothed(t: Array, x: Array) -> tuple[Array, Array, Array]:
    """The smoothed channel, its slope, and the half-width of the slope's band, each of shape (n,)."""
    from scipy.interpolate import make_smoothing_spline  # noqa: PLC0415 - slow to import, and only splines need it

    h = float(np.median(np.diff(t)))
    stiffness = _stiffness(t, x, h)
    spline: BSpline = make_smoothing_spline(t, x, lam=stiffness)
    value, slope = spline(t), spline.derivative()(t)
    bandwidth = (stiffness * h) ** 0.25
    # The part of the noise that the spline follows is missing from its residuals.
    used = min(0.5, h / (2 * np.sqrt(2.0) * bandwidth))
    spread = np.sqrt(np.mean((x - value) ** 2) / (1 - used))
    band = 2 * SIGMAS * spread * np.sqrt(h * SLOPE_ENERGY / bandwidth**3)
    # At the ends the slope rests on half the samples, and on the end of a line instead of its middle.
    edge = np.exp(-np.minimum(t - t[0], t[-1] - t) / (np.sqrt(2.0) * bandwidth))
    return value, slope, np.asarray(band * (1 + 3 * edge), dtype=np.float64)


def _stiffness(t: Array, x: Array, h: float) -> float:
    """The stiffness that predicts every other sample best from its neighbours (twofold cross-validation)."""
    from scipy.interpolate import make_smoothing_spline  # noqa: PLC0415 - slow to import, and only splines need it
    from scipy.optimize import minimize_scalar  # noqa: PLC0415 - slow to import, and only splines need it

    odd, even = slice(1, None, 2), slice(None, None, 2)

    def miss(log_bandwidth: float) -> float:
        stiffness = np.exp(4 * log_bandwidth) / (2 * h)
        total = 0.0
        for kept, left in ((odd, even), (even, odd)):
            spline = make_smoothing_spline(t[kept], x[kept], lam=stiffness)
            inside = (t[left] > t[kept][0]) & (t[left] < t[kept][-1])
            total += float(np.sum((spline(t[left][inside]) - x[left][inside]) ** 2))
        return total

    found = minimize_scalar(
        miss, bounds=(np.log(h), np.log(max(100 * h, 2 * h))), method="bounded", options={"maxiter": 20}
    )
    return float(np.exp(4 * found.x) / h)
