"""Readings in few decimals: most equal the one before, and their differences hide how far they are off."""

import numpy as np
import pytest

from diagnosis_logs import screened, train_of, vehicle_of
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.data.sensor_noise import scale_step
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

SCALES = {"u": 0.02, "v": 0.02, "r": 0.004, "ax": 0.02, "ay": 0.02, "psi": 0.004}


def coarse():
    """A vessel that sways little, its log in few decimals, and the file that allows for them."""
    vehicle = vehicle_of()
    log = train_of(vehicle)
    columns = {k: np.round(x / SCALES[k]) * SCALES[k] if k in SCALES else x for k, x in log.columns.items()}
    text = vehicle.text.replace("accuracy = 0.006", "accuracy = 0.016").replace(
        "bias_instability = 3.0e-4", "bias_instability = 3.0e-4\naccuracy = 0.01"
    )
    text = text.replace("accuracy = 0.015", "accuracy = 0.017")
    return parse_vehicle(text, "coarse.toml"), Log(log.name, log.sha256, log.t, columns)


@pytest.mark.parametrize("step", [0.01, 0.1, 0.25])
@pytest.mark.parametrize("noise", [0.1, 3.0])
def test_the_step_of_a_scale(step, noise):
    rng = np.random.default_rng(1)
    x = np.sin(0.01 * np.arange(6000)) + noise * step * rng.standard_normal(6000)
    assert scale_step(np.round(x / step) * step) == pytest.approx(step)
    x[::7] = np.nan
    assert scale_step(np.round(x / step) * step) == pytest.approx(step)
    assert scale_step(x) == 0.0 == scale_step(np.full(100, 0.3))


def test_a_slow_coarse_reading_is_off_by_its_rounding_at_the_least():
    """By hand: the difference from the reading before it was rounded."""
    vehicle, log = coarse()
    exact = train_of(vehicle_of())
    data = channels(log, vehicle)
    for name in ("u", "v"):
        off = float(np.std(log.columns[name] - exact.columns[name]))
        assert off > 0.9 * SCALES[name] / np.sqrt(12)
        assert data.noise[name] >= 0.95 * off


# Nightly: that the log shows it without.
@pytest.mark.parametrize("counted", [True, pytest.param(False, marks=pytest.mark.nightly)])
def test_rounding_is_no_force(counted, monkeypatch):
    """Without it the slopes of what is rounded are a force that the file does not declare."""
    vehicle, log = coarse()
    if counted:
        found = screened(vehicle, log)
        assert found.passed == [] and found.quiet and max(found.fit.noise.alone[0]) < 1.5
    else:
        monkeypatch.setattr("ivsid.diagnosis.data.channels.scale_step", lambda x: 0.0)
        found = screened(vehicle, log)
        assert not found.quiet or found.passed or max(found.fit.noise.alone[0]) > 1.5
