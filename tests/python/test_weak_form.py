"""Rows straight from the pose hold at the truth under the worst errors, and see accelerations that velocities do not."""

import numpy as np
import pytest

from ivsid import IntervalArray, IvsidError, identify
from ivsid.effects import terms_of
from ivsid.log import Log
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.sensors.pose import with_velocities
from ivsid.sensors.weak_form import pose_means
from ivsid.vehicle import parse_vehicle
from test_pose import HEAD, boat, motion

VALUES = {
    "mass.surge": 12.0,
    "mass.sway": 18.0,
    "inertia.yaw": 1.5,
    "drag.surge.quadratic": 6.0,
    "drag.sway.quadratic": 20.0,
    "drag.surge.linear": 2.0,
}


def worst(pose, t, seed, position=0.004, heading=0.006):
    """The pose with errors that jump between their bounds, or stand at one for a while: the worst for differences."""
    rng = np.random.default_rng(seed)

    def signs():
        fast = rng.choice([-1, 1], t.size)
        slow = np.repeat(rng.choice([-1, 1], t.size // 50 + 1), 50)[: t.size]
        return np.where(rng.uniform() < 0.5, fast, slow) * 0.999

    noisy = {c: pose[c] + position * signs() for c in ("x", "y")}
    noisy["psi"] = np.angle(np.exp(1j * (pose["psi"] + heading * signs())))
    return noisy


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("half", [10, 40, 80])
def test_differences_of_half_window_means_are_enclosed(seed, half):
    t, pose, truth, (acceleration, yaw) = motion(seed)
    vehicle = boat(0.004, 0.006, acceleration * 1.001, yaw * 1.001)
    noisy = worst(pose, t, seed)
    noisy["x"][300:330] = np.nan
    log, channels = with_velocities(Log("a.csv", "", t, noisy), vehicle.sensors)
    clock = IntervalArray.around(log.t, log.time_error)
    means = pose_means(log, vehicle.sensors, dict(channels), clock[1:] - clock[:-1])
    bad = np.r_[0, np.cumsum(~means.there)]
    starts = np.arange(0, t.size - 2 * half)
    starts = starts[bad[starts + 2 * half + 1] == bad[starts]]
    found = means.rising(starts, half)
    # The truth by Simpson's rule on the true velocities, good to 1e-6.
    from scipy.integrate import cumulative_simpson

    for name, x in found.items():
        way = cumulative_simpson(truth[name], x=t, initial=0)
        m, e = starts + half, starts + 2 * half
        true = (way[e] - way[m]) / (t[e] - t[m]) - (way[m] - way[starts]) / (t[m] - t[starts])
        if name == "r":
            psi = pose["psi"]
            true = (psi[e] - psi[m]) / (t[e] - t[m]) - (psi[m] - psi[starts]) / (t[m] - t[starts])
        assert ((x.lower - 2e-6 <= true) & (true <= x.upper + 2e-6)).all(), name
    # The difference of velocities at the ends of the same window is several times as wide.
    ends = channels["u"][starts + 2 * half] - channels["u"][starts]
    if half == 80:
        assert np.median(found["u"].width) < 0.5 * np.median(ends.width)


def test_the_way_of_a_turning_boat_holds_the_bulge_between_rows():
    """Rows say that the boat turns on one spot. Between them it may swing out sideways by A h^2 / 8, which leaves A h^2 / 12 times the turn in the way ahead."""
    h, turn, acceleration, half = 0.5, 0.01, 1.0, 20
    t = np.arange(120) * h
    vehicle = boat(1e-9, 1e-9, acceleration, 1e-6)
    pose = {"x": np.zeros(120), "y": np.zeros(120), "psi": turn * np.arange(120.0)}
    log, channels = with_velocities(Log("spot.csv", "", t, pose), vehicle.sensors)
    clock = IntervalArray.around(log.t, log.time_error)
    means = pose_means(log, vehicle.sensors, dict(channels), clock[1:] - clock[:-1])
    starts = np.arange(20, 60)
    swing = half * turn * acceleration * h**2 / 12
    for way in means._ways(half).values():
        found = way(starts, starts + half)
        assert (found.upper >= 0.99 * swing).all() and (-found.lower >= 0.99 * swing).all()
        assert (found.upper <= 4 * swing).all()


def test_the_way_of_a_boat_that_drifts_sideways_holds_the_curve_of_its_heading():
    """The heading is 0 at both rows and may bend by W t (h - t) / 2 between them: of a drift of 1 m/s, W h^2 / 12 looks like a way ahead."""
    h, yaw = 0.5, 1.0
    t = np.arange(60) * h
    vehicle = boat(1e-9, 1e-9, 1e-3, yaw)
    log, channels = with_velocities(Log("drift.csv", "", t, {"x": 0 * t, "y": t, "psi": 0 * t}), vehicle.sensors)
    clock = IntervalArray.around(log.t, log.time_error)
    means = pose_means(log, vehicle.sensors, dict(channels), clock[1:] - clock[:-1])
    starts = np.arange(20, 30)
    found, bent = means._ways(1)["u"](starts, starts + 1), yaw * h**3 / 12
    assert (found.upper >= bent).all() and (-found.lower >= bent).all() and (found.upper <= 2 * bent).all()


def towed(seed, length=90.0, accuracy=0.002):
    t, pose, truth, (acceleration, yaw) = motion(seed, length)
    u, v, r = truth["u"], truth["v"], truth["r"]
    rates = {n: np.gradient(truth[n], t) for n in "uvr"}
    force = {
        "force_X": 12.0 * rates["u"] - 18.0 * v * r + 6.0 * u * abs(u) + 2.0 * u,
        "force_Y": 18.0 * rates["v"] + 12.0 * u * r + 20.0 * v * abs(v),
        "moment_N": 1.5 * rates["r"],
    }
    terms = ", ".join(f'"{i}"' for i in VALUES)
    vehicle = parse_vehicle(
        f"{HEAD}[sensors.position]\naccuracy = {accuracy}\n[sensors.heading]\naccuracy = {accuracy}\n"
        f"[sensors.limits]\nacceleration = {acceleration * 1.01}\nyaw_acceleration = {yaw * 1.01}\n"
        f"[sensors.force]\naccuracy = 0.05\n[sensors.moment]\naccuracy = 0.01\n[model]\nterms = [{terms}]\n",
        "a.toml",
    )
    return Log("a.csv", "0" * 64, t, {**worst(pose, t, seed, accuracy, accuracy), **force}), vehicle


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("window", [0.5, 2.0])
def test_weak_rows_hold_at_the_truth(seed, window):
    log, vehicle = towed(seed)
    rows = build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle), kind="weak", window=window)
    theta = IntervalArray(np.array([VALUES[t.id] for t in rows.terms]))
    assert (rows.matrix @ theta - rows.right).contains(np.zeros(rows.time.size)).all()
    assert set(rows.channel) == {0, 1, 2} and rows.time.size > 1000
    assert rows.duration == pytest.approx(2 * window, abs=0.11)


def test_a_wrong_mass_violates_weak_rows():
    log, vehicle = towed(1)
    rows = build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle), kind="weak", window=2.0)
    theta = IntervalArray(np.array([{**VALUES, "mass.surge": 40.0}[t.id] for t in rows.terms]))
    assert not (rows.matrix @ theta - rows.right).contains(np.zeros(rows.time.size)).all()


def test_every_kind_together_is_narrower_than_windows_alone():
    """The same log, the same bounds: the masses gain most, since the weak form sees accelerations."""
    log, vehicle = towed(2)
    one = identify(vehicle, log, window=1.5)
    two = identify(vehicle, log, window=1.5, rows="both")
    assert one.status in ("enclosed", "unbounded") and two.status == "enclosed" and two.guaranteed
    for id_, value in VALUES.items():
        a, b = one.parameters[id_], two.parameters[id_]
        assert b.lower <= value <= b.upper and b.lower >= a.lower - 1e-9 and b.upper <= a.upper + 1e-9, id_
    assert two.parameters["mass.surge"].width < 0.7 * one.parameters["mass.surge"].width


def test_weak_rows_need_a_pose(swan, twin):
    from conftest import as_log

    with pytest.raises(IvsidError, match="'weak' need velocities that are enclosed from the pose"):
        build_rows(bound_log(as_log(twin), swan), swan, terms_of(swan), kind="weak")
