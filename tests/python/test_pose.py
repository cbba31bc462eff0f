"""Velocities enclosed from the pose hold the truth, under every error within the stated bounds."""

import numpy as np
import polars as pl
import pytest

from ivsid import IvsidError, identify, read_log
from ivsid.log import Log
from ivsid.sensors.bounds import bound_log
from ivsid.sensors.pose import with_velocities
from ivsid.vehicle import parse_vehicle

HEAD = 'name = "a"\n[hull]\nmass = 10\n'


def boat(position=0.01, heading=0.01, acceleration=0.5, yaw=0.6):
    return parse_vehicle(
        f"{HEAD}[sensors.position]\naccuracy = {position}\n[sensors.heading]\naccuracy = {heading}\n"
        f"[sensors.limits]\nacceleration = {acceleration}\nyaw_acceleration = {yaw}\n",
        "a.toml",
    )


def motion(seed, seconds=60.0, rate=20.0):
    """A smooth random run on a fine grid, whose pose is its own integral to 1e-7."""
    rng = np.random.default_rng(seed)
    fine = np.arange(0, seconds, 1 / (rate * 50))
    waves = [
        (a * w * np.cos(w * fine + p), a * np.sin(w * fine + p))
        for a, w, p in rng.uniform((0.05, 0.2, 0), (0.2, 0.9, 6), (9, 3))
    ]
    u, v, r = (sum(x[1] for x in waves[k::3]) for k in range(3))
    du, dv, dr = (sum(x[0] for x in waves[k::3]) for k in range(3))
    u = u + 0.6

    def integral(f):
        return np.r_[0.0, np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(fine))]

    psi = integral(r)
    x, y = integral(u * np.cos(psi) - v * np.sin(psi)), integral(u * np.sin(psi) + v * np.cos(psi))
    most = max(np.abs(du).max(), np.abs(dv).max()), np.abs(dr).max()
    s = slice(None, None, 50)
    return fine[s], {"x": x[s], "y": y[s], "psi": psi[s]}, {"u": u[s], "v": v[s], "r": r[s]}, most


@pytest.mark.parametrize("seed", range(12))
def test_the_truth_is_inside_under_the_worst_errors(seed):
    rng = np.random.default_rng(100 + seed)
    t, pose, truth, (acceleration, yaw) = motion(seed)
    position, heading = 0.004, 0.006
    noisy = {
        "x": pose["x"] + position * rng.choice([-1, 1], t.size) * 0.999,
        "y": pose["y"] + position * rng.choice([-1, 1], t.size) * 0.999,
        "psi": np.angle(np.exp(1j * (pose["psi"] + heading * rng.choice([-1, 1], t.size) * 0.999))),
    }
    noisy["x"][200:230] = np.nan
    vehicle = boat(position, heading, acceleration * 1.001, yaw * 1.001)
    log, found = with_velocities(Log("a.csv", "", t, noisy), vehicle.sensors)
    for name, x in found.items():
        there = np.isfinite(x.lower)
        assert ((x.lower <= truth[name]) & (truth[name] <= x.upper)).all(), name
        assert there.mean() > 0.9
        np.testing.assert_array_equal(np.isnan(log.columns[name]), ~there)
        if name != "r":
            assert not there[200:230].any()
    # Several windows together are narrower than any theory of one alone: 2 sqrt(acc A / 2) with the usual A.
    best = 2 * np.sqrt(position * np.sqrt(2) * acceleration * 1.001 / 2)
    assert np.median((found["u"].upper - found["u"].lower) / 2) < 1.6 * best


def test_too_small_limits_are_found_out():
    t, pose, _, (acceleration, yaw) = motion(3)
    log = Log("a.csv", "", t, pose)
    with_velocities(log, boat(1e-6, 1e-6, 1.01 * acceleration, 1.01 * yaw).sensors)
    with pytest.raises(IvsidError, match=r"around t = .* s the pose moves as no velocity within the bounds can"):
        with_velocities(log, boat(1e-6, 1e-6, 1.01 * acceleration, 0.05 * yaw).sensors)


def test_a_third_party_s_simulator(real):
    """The Otter in calm water: its own pose gives its own velocities back."""
    log = read_log(real("sim_truth_pvs/otter_calm.csv.gz"), boat().log.model_validate({"time": {"from": "t_s"}}))
    columns = {k: log.columns[k] for k in ("x", "y", "psi")}
    truth = log.columns
    # It pitches and rolls by a few degrees: what that does to the track stands in the position's accuracy.
    sensors = boat(0.01, 0.005, 1.5, 1.2).sensors
    assert np.abs(truth["udot"]).max() < 1.5 and np.abs(truth["vdot"]).max() < 1.5 and np.abs(truth["rdot"]).max() < 1.2
    _, found = with_velocities(Log("a.csv", "", log.t, columns), sensors)
    for name, x in found.items():
        assert ((x.lower <= truth[name]) & (truth[name] <= x.upper)).mean() == 1.0, name


def test_measured_velocities_are_not_replaced():
    t, pose, truth, _ = motion(5)
    log, found = with_velocities(Log("a.csv", "", t, {**pose, **truth}), boat().sensors)
    assert not found and log.columns["u"] is truth["u"]
    _, found = with_velocities(Log("a.csv", "", t, {**pose, "u": truth["u"], "v": truth["v"]}), boat().sensors)
    assert set(found) == {"r"}


def test_without_bounds_on_the_pose_the_log_says_what_would_do(tmp_path):
    t, pose, _, _ = motion(6)
    pl.DataFrame({"t": t, **pose, "force_X": 0 * t, "force_Y": 0 * t, "moment_N": 0 * t}).write_csv(
        tmp_path / "log.csv"
    )
    vehicle = parse_vehicle(HEAD, "a.toml")
    with pytest.raises(IvsidError) as caught:
        identify(vehicle, read_log(tmp_path / "log.csv"))
    words = str(caught.value)
    assert "no column u (needed for mass.surge, inertia.yaw" in words or "no column u (needed for mass.surge" in words
    assert "velocities follow from x, y, psi where" in words and "\n" not in words


@pytest.mark.parametrize("seed", [1, 2])
def test_the_parameters_of_a_towed_model_are_held(seed):
    """From pose and force alone: the intervals hold the truth, and the result says what they rest on."""
    t, pose, truth, (acceleration, yaw) = motion(seed, 120.0)
    fine = np.gradient
    m_u, m_v, i_z, x_uu, y_vv = 12.0, 18.0, 1.5, 6.0, 20.0
    u, v, r = truth["u"], truth["v"], truth["r"]
    columns = {
        **pose,
        "force_X": m_u * fine(u, t) - m_v * v * r + x_uu * u * abs(u),
        "force_Y": m_v * fine(v, t) + m_u * u * r + y_vv * v * abs(v),
        "moment_N": i_z * fine(r, t),
    }
    vehicle = parse_vehicle(
        f"{HEAD}[sensors.position]\naccuracy = 1e-3\n[sensors.heading]\naccuracy = 1e-3\n"
        f"[sensors.limits]\nacceleration = {acceleration * 1.01}\nyaw_acceleration = {yaw * 1.01}\n"
        "[sensors.force]\naccuracy = 0.05\n[sensors.moment]\naccuracy = 0.01\n",
        "a.toml",
    )
    fit = identify(vehicle, Log("a.csv", "0" * 64, t, columns), window=5.0)
    assert fit.status == "enclosed" and fit.guaranteed
    for id_, value in zip(
        ("mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic"),
        (m_u, m_v, i_z, x_uu, y_vv),
        strict=True,
    ):
        p = fit.parameters[id_]
        assert p.lower <= value <= p.upper, id_
    assert any("follow from the pose (position within 0.001 m" in a for a in fit.assumes)


def test_cse1_is_enclosed_from_its_cameras(real):
    """A free run has velocities at all rows that have a pose, but for the ends; its differences of the pose lie inside."""
    from conftest import embedded
    from ivsid.adapters import read_cse1

    part = read_cse1(real("cse1")).logs["random_run3"]
    vehicle = parse_vehicle(embedded("cse1.toml"), "cse1.toml")
    log = Log("random_run3.csv", "", part.t, {k: c for k, c in part.columns.items() if not k.startswith("raw_")})
    bounded = bound_log(log, vehicle)
    for name in ("u", "v", "r"):
        x, raw = bounded.channels[name], part.columns[f"raw_{name}"]
        both = bounded.present[name] & np.isfinite(raw)
        assert both.mean() > 0.97
        assert ((x.lower <= raw) & (raw <= x.upper))[both].mean() > 0.999


def test_turns_that_the_error_of_the_heading_hides_are_not_followed():
    """Nearly half a turn between samples: with an error of 0.1 rad the way round is not certain, and no window crosses it."""
    t = np.arange(0, 40, 1.0)
    vehicle = boat(heading=0.1, yaw=0.05)
    for rate, certain in ((3.0, False), (1.5, True)):
        psi = rate * t + 0.0999 * np.where(np.arange(t.size) % 2, 1, -1)
        _, found = with_velocities(Log("a.csv", "", t, {"psi": np.angle(np.exp(1j * psi))}), vehicle.sensors)
        if certain:
            known = np.isfinite(found["r"].lower)
            assert known.sum() > 30 and found["r"][known].contains(np.full(known.sum(), rate)).all()
        else:
            assert not found or all(
                (~np.isfinite(x.lower) | x.contains(np.full(t.size, rate))).all() for x in found.values()
            )
