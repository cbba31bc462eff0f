"""Accelerations from velocities, and velocities from the pose by a spline: what is enclosed holds, what is estimated says so."""

import numpy as np
import pytest

from conftest import as_log
from ivsid import IvsidError, identify
from ivsid.effects import terms_of
from ivsid.intervals import IntervalArray
from ivsid.log import Log
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.sensors.derivatives import enclosed_rate
from ivsid.vehicle import parse_vehicle
from sampling import spaced
from test_pose import HEAD, boat, motion


def wave(seed, n=800, h=0.05):
    """A smooth velocity with its rate, and bounds of the rate and of its own rate."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.5 * h, 1.5 * h, n))
    parts = rng.uniform((0.1, 0.3, 0), (0.5, 2.0, 6), (4, 3))
    x = sum(a * np.sin(w * t + p) for a, w, p in parts)
    rate = sum(a * w * np.cos(w * t + p) for a, w, p in parts)
    limit, jerk = sum(a * w for a, w, _ in parts), sum(a * w * w for a, w, _ in parts)
    return t, x, rate, float(limit), float(jerk)


@pytest.mark.parametrize("seed", range(10))
def test_the_true_rate_lies_inside_under_the_worst_errors(seed):
    t, x, rate, limit, jerk = wave(seed)
    accuracy = 0.002
    reading = x + np.random.default_rng(seed).choice([-1, 1], x.size) * accuracy * 0.999
    channel = IntervalArray.around(reading, accuracy)
    lower, upper = channel.lower.copy(), channel.upper.copy()
    lower[300:310], upper[300:310] = -np.inf, np.inf
    log = Log("a.csv", "", t, {"u": reading})
    found = enclosed_rate(log, IntervalArray(lower, upper), limit, jerk, "u")
    assert found.contains(rate).all()
    # One window leaves 2 sqrt(width J) or so; the limit alone would leave 2 limit.
    assert np.median(found.width) < 3 * np.sqrt(2 * accuracy * jerk) < limit
    only = enclosed_rate(log, IntervalArray(lower, upper), limit, None, "u")
    assert (only.upper >= limit).all() and (only.width <= 2 * limit * (1 + 1e-12)).all()
    assert enclosed_rate(log, channel, None, None, "u") is None


def test_a_jerk_that_is_too_small_is_found_out():
    t, x, _, limit, jerk = wave(3)
    log = Log("a.csv", "", t, {"u": x})
    with pytest.raises(IvsidError, match=r"around t = .* u changes as no motion within the limits can"):
        enclosed_rate(log, IntervalArray.around(x, 1e-6), limit, 0.01 * jerk, "u")


def towed(seed, accuracy=2e-4):
    """A vessel under smooth known forces, with velocities and no accelerometer."""
    t, _, truth, (acceleration, yaw) = motion(seed, 120.0)
    u, v, r = truth["u"], truth["v"], truth["r"]
    values = {
        "mass.surge": 12.0,
        "mass.sway": 18.0,
        "inertia.yaw": 1.5,
        "drag.surge.quadratic": 6.0,
        "drag.sway.quadratic": 20.0,
    }
    du, dv, dr = (np.gradient(q, t) for q in (u, v, r))
    columns = {
        **truth,
        "force_X": 12.0 * du - 18.0 * v * r + 6.0 * u * abs(u),
        "force_Y": 18.0 * dv + 12.0 * u * r + 20.0 * v * abs(v),
        "moment_N": 1.5 * dr,
    }
    jerk = 1.1 * max(np.abs(np.gradient(q, t)).max() for q in (du, dv))
    twist = 1.1 * np.abs(np.gradient(dr, t)).max()
    text = (
        f"{HEAD}[sensors.velocity]\naccuracy = {accuracy}\n[sensors.yaw_rate]\naccuracy = {accuracy}\n"
        f"[sensors.force]\naccuracy = 0.05\n[sensors.moment]\naccuracy = 0.01\n"
        f"[sensors.limits]\nacceleration = {acceleration * 1.01}\nyaw_acceleration = {yaw * 1.01}\n"
    )
    smooth = f"{text}jerk = {jerk}\nyaw_jerk = {twist}\n"
    return Log("a.csv", "0" * 64, t, columns), parse_vehicle(text, "a.toml"), parse_vehicle(smooth, "b.toml"), values


@pytest.mark.parametrize("seed", [1, 2])
def test_stated_jerk_gives_pointwise_rows_without_an_accelerometer(seed):
    log, plain, smooth, values = towed(seed)
    with pytest.raises(IvsidError):
        build_rows(bound_log(log, plain), plain, terms_of(plain), kind="pointwise")
    rows = build_rows(bound_log(log, smooth), smooth, terms_of(smooth), kind="pointwise")
    assert set(rows.channel) == {0, 1, 2} and (rows.duration == 0).all()
    theta = IntervalArray(np.array([values[t.id] for t in rows.terms]))
    assert (rows.matrix @ theta - rows.right).contains(np.zeros(rows.time.size)).all()


@pytest.mark.parametrize("seed", [1, 2])
def test_derived_accelerations_only_add_rows(seed):
    """By default both kinds of rows are taken: never wider than the windows alone, and still guaranteed."""
    log, plain, smooth, values = towed(seed)
    one, two = identify(plain, log), identify(smooth, log)
    assert one.status == two.status == "enclosed" and two.guaranteed
    assert any("d2u/dt2| never exceeds" in a for a in two.assumes)
    for id_, value in values.items():
        a, b = one.parameters[id_], two.parameters[id_]
        assert b.lower <= value <= b.upper
        assert b.width <= a.width * (1 + 1e-9), id_


def test_a_measured_acceleration_is_not_replaced(swan, twin):
    text = swan.text.replace("yaw_acceleration = 1.5", "yaw_acceleration = 1.5\njerk = 50.0\nyaw_jerk = 50.0")
    vehicle = parse_vehicle(text, "jerk.toml")
    bounded = bound_log(as_log(twin), vehicle)
    assert "udot" not in bounded.channels and "rdot" in bounded.channels and "rdot" in bounded.log.derived


def test_a_spline_is_narrow_and_never_called_guaranteed():
    t, pose, truth, (acceleration, yaw) = motion(4, 120.0)
    rng = np.random.default_rng(4)
    columns = {
        "x": pose["x"] + rng.standard_normal(t.size) * 0.002,
        "y": pose["y"] + rng.standard_normal(t.size) * 0.002,
        "psi": np.angle(np.exp(1j * (pose["psi"] + rng.standard_normal(t.size) * 0.002))),
        "force_X": 0 * t,
        "force_Y": 0 * t,
        "moment_N": 0 * t,
    }
    columns["x"][500:520] = np.nan
    enclosing = boat(0.01, 0.01, 1.01 * acceleration, 1.01 * yaw)
    text = enclosing.text.replace("[sensors.position]", '[sensors]\nfrom_pose = "spline"\n[sensors.position]', 1)
    smooth = parse_vehicle(f"{text}[sensors.force]\naccuracy = 50.0\n[sensors.moment]\naccuracy = 50.0\n", "s.toml")
    log = Log("a.csv", "0" * 64, t, columns)
    wide, narrow = bound_log(log, enclosing), bound_log(log, smooth)
    assert not wide.statistical and len(narrow.statistical) == 1
    for name in ("u", "v", "r"):
        x, known = narrow.channels[name], narrow.present[name]
        assert known.mean() > 0.97
        assert x.contains(truth[name])[known].mean() > 0.999, name
        assert np.median(x.width[known]) < 0.5 * np.median(wide.channels[name].width[wide.present[name]]), name
    fit = identify(smooth, log)
    assert not fit.guaranteed and any("an estimate, not a bound" in a for a in fit.assumes)


@pytest.mark.sampled
@pytest.mark.parametrize("seed", spaced(range(6), 1))
def test_the_spline_s_band_holds_for_other_noise(seed):
    t, pose, truth, _ = motion(20 + seed, 90.0)
    rng = np.random.default_rng(seed)
    size = 10 ** rng.uniform(-3.5, -1.5)
    noisy = {k: pose[k] + rng.standard_normal(t.size) * size for k in ("x", "y", "psi")}
    sensors = boat(3 * size, 3 * size).sensors.model_copy(update={"from_pose": "spline"})
    from ivsid.sensors.smoothing import splined

    _, found, words = splined(Log("a.csv", "", t, noisy), sensors)
    for name, x in found.items():
        assert x.contains(truth[name]).mean() > 0.995, (name, size)
    assert "not a bound" in words[0]
