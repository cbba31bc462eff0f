"""Velocities of a pose alone, at any rate of the log."""

import numpy as np
import pytest

from ivsid.diagnosis.data.from_pose import differenced
from ivsid.log import Log


@pytest.mark.parametrize("rate", [3, 4, 5, 6, 7, 8, 10, 20])
def test_a_pose_gives_velocities_at_any_rate(rate):
    """A turn with a wave in its speed: those at the middle of each step, by the formula of the path itself."""
    t = np.arange(0.0, 100.0, 1 / rate)
    psi = 0.15 * t
    # Along a circle of 4 m the vessel goes ahead with 0.6 m/s and sways 0.1 m/s, with slow waves on both.
    fine = np.arange(0.0, 100.0, 1e-3)
    u, v = 0.6 + 0.2 * np.sin(0.2 * fine), 0.1 * np.cos(0.3 * fine)
    c, s = np.cos(0.15 * fine), np.sin(0.15 * fine)
    x, y = (np.cumsum(q) * 1e-3 for q in (u * c - v * s, u * s + v * c))
    pose = {"x": np.interp(t, fine, x), "y": np.interp(t, fine, y), "psi": psi}
    made = differenced(Log("pose.csv", "0" * 64, t, pose))
    there = np.isfinite(made.columns["u"])
    assert there.sum() > 100.0 / 0.4 * 0.9
    assert np.median(np.diff(made.t[there])) <= 0.34
    for name, truth in (("u", u), ("v", v)):
        np.testing.assert_allclose(made.columns[name][there], np.interp(made.t[there], fine, truth), atol=4e-3)
