"""Yaw accelerations are read at their rows, also beside accelerometers that average: in logs and in null logs."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import SENSORS, TWIN, screened, train_of, vehicle_of
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.null import simulated_logs
from ivsid.vehicle import parse_vehicle
from test_irregular_clock import FELT, sailed
from test_slow_clock import CRAFT


@pytest.mark.parametrize(("usual", "astray"), [(0.1, 0.0), (0.1, 0.3), (0.04, 0.0)])
def test_a_yaw_acceleration_is_read_at_its_rows_beside_accelerometers_that_average(usual, astray):
    """It has a sensor of its own; as means over the step before, its readings were those of a sea six times as rough in yaw as declared."""
    craft = CRAFT.replace("time_constant = {lag}\n", "")
    felt = FELT.format(sampling="averaged") + "[sensors.yaw_acceleration]\naccuracy = 0.01\n\n"
    vehicle = parse_vehicle(craft.replace("[ambient]", f"{felt}[ambient]"), "craft.toml")
    found = screened(vehicle, sailed(100.0, 3, astray, usual, feels=True, turns=True))
    assert found.passed == [] and found.quiet


def test_null_logs_read_a_yaw_acceleration_at_its_rows_beside_means():
    """Accelerometers that average give the change of velocity over the step before, and what turns the axes; the yaw acceleration has its own sensor."""
    text = (TWIN + SENSORS).replace("[sensors.acceleration]\n", '[sensors.acceleration]\nsampling = "averaged"\n')
    vehicle = parse_vehicle(text, "twin.toml")
    log = train_of(vehicle_of(), duration=80.0)
    data = channels(replace(log, columns={**log.columns, "rdot": 0.0 * log.t}), vehicle)
    rng = np.random.default_rng(1)
    x, nudot = rng.standard_normal((6, data.n)), rng.standard_normal((6, data.n))
    none = dict.fromkeys(("u", "v", "r", "ax", "ay", "rdot", "psi", "x", "y"), np.zeros(data.n))
    read = simulated_logs._readings(data, x, nudot, none, {})
    u, v, r = x[:3]
    turned = -v * r
    np.testing.assert_array_equal(read.acceleration[2], nudot[2])
    mean = np.diff(u) / data.h + 0.5 * (turned[1:] + turned[:-1])
    np.testing.assert_allclose(read.acceleration[0], np.r_[nudot[0, 0] + turned[0], mean])
