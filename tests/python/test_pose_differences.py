"""Velocities of a pose alone, at any rate of the log."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import SENSORS, TWIN, screened, train_of
from ivsid.diagnosis.data.from_pose import differenced
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

# A camera: its position is off by millimetres.
SENSED = TWIN + SENSORS.replace("accuracy = 0.5", "accuracy = 0.003")


def turning(t):
    """Pose and velocities on a circle of 4 m: ahead with 0.6 m/s and to the side with 0.1 m/s, with slow waves on both."""
    fine = np.arange(0.0, 100.0, 1e-3)
    u, v = 0.6 + 0.2 * np.sin(0.2 * fine), 0.1 * np.cos(0.3 * fine)
    c, s = np.cos(0.15 * fine), np.sin(0.15 * fine)
    x, y = (np.cumsum(q) * 1e-3 for q in (u * c - v * s, u * s + v * c))
    pose = {"x": np.interp(t, fine, x), "y": np.interp(t, fine, y), "psi": 0.15 * t}
    return pose, lambda at: {"u": np.interp(at, fine, u), "v": np.interp(at, fine, v)}


@pytest.mark.parametrize("rate", [3, 4, 5, 6, 7, 8, 10, 20])
def test_a_pose_gives_velocities_at_any_rate(rate):
    """Those at the middle of each step, by the formula of the path itself."""
    t = np.arange(0.0, 100.0, 1 / rate)
    pose, truth = turning(t)
    made = differenced(Log("pose.csv", "0" * 64, t, pose))
    there = np.isfinite(made.columns["u"])
    assert there.sum() > 100.0 / 0.4 * 0.9
    assert np.median(np.diff(made.t[there])) <= 0.34
    for name, x in truth(made.t[there]).items():
        np.testing.assert_allclose(made.columns[name][there], x, atol=4e-3)


def test_a_gyro_beside_a_pose_is_read_at_its_own_rows():
    """A stranger's workboat with a position, a compass and a gyro was refused for want of a column u."""
    t = np.arange(0.0, 100.0, 0.1)
    pose, truth = turning(t)
    gyro = 0.15 + 0.01 * np.cos(t)
    made = differenced(Log("pose.csv", "0" * 64, t, {**pose, "r": gyro}))
    read, there = np.isin(made.t, t), np.isfinite(made.columns["u"])
    assert np.array_equal(made.columns["r"][read], gyro) and np.isnan(made.columns["r"][~read]).all()
    np.testing.assert_allclose(made.columns["u"][there], truth(made.t[there])["u"], atol=4e-3)
    assert "x" not in made.columns


@pytest.mark.nightly
def test_a_sound_log_of_a_pose_and_a_gyro_is_sound():
    vehicle = parse_vehicle(SENSED, "boat.toml")
    log = train_of(vehicle)
    found = screened(vehicle, replace(log, columns={k: x for k, x in log.columns.items() if k not in "uv"}))
    assert found.passed == [] and found.quiet
