"""Thrusts that lag by less than a step of a slow clock turn a hull later than even ones."""

import numpy as np
import pytest

from diagnosis_logs import TWIN, train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data import channels as clock
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.plant.driving import Driving
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

SMALL = 20
CRAFT = """
name = "craft"
[hull]
mass = 25.0
length = 1.2
[[thrusters]]
name = "port"
position = [-0.45, -0.3]
gain = 0.2
demand_range = [-100, 100]
time_constant = {lag}
accuracy = { absolute = 0.1, relative = 0.01 }
[[thrusters]]
name = "starboard"
position = [-0.45, 0.3]
gain = 0.2
demand_range = [-100, 100]
time_constant = {lag}
accuracy = { absolute = 0.1, relative = 0.01 }
[sensors]
[sensors.velocity]
accuracy = 0.01
[sensors.yaw_rate]
random_walk = 0.0003
bias_instability = 0.0001
[sensors.heading]
accuracy = 0.01
[ambient]
force = 0.2
moment = 0.03
time = 2.0
[model]
terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.surge.linear", "drag.sway.linear", "drag.yaw.linear"]
"""


def sailed(seconds, seed, lag, rate):
    """The craft by hand, in steps of a hundredth of a second: thrusts approach demands that change every two seconds."""
    rng = np.random.default_rng(seed)
    h, n = 1 / rate / SMALL, round(seconds * rate)
    arms, thrusts = np.array([0.3, -0.3]), np.zeros(2)
    state, rows = np.zeros(4), []
    for k in range(n):
        if k % round(2 * rate) == 0:
            demand = rng.uniform(10.0, 70.0) + rng.choice([-1.0, 1.0]) * rng.uniform(8.0, 16.0) * np.array([1.0, -1.0])
        rows.append([k / rate, *state, *demand])
        for _ in range(SMALL):
            still = 0.2 * demand
            middle, thrusts = (still + (thrusts - still) * np.exp(-q * h / lag) for q in (0.5, 1.0))

            def rates(x, push=middle):
                u, v, r, _ = x
                X = push.sum() + 37.0 * v * r - 15.0 * u * abs(u) - 5.0 * u
                Y = -26.0 * u * r - 20.0 * v
                N = push @ arms - 7.0 * r
                return np.array([X / 26.0, Y / 37.0, N / 4.3, r])

            state = state + h * rates(state + 0.5 * h * rates(state))
    t, u, v, r, psi, port, starboard = np.array(rows).T
    noise = lambda size: size * rng.standard_normal(n)  # noqa: E731 - three readings alike
    readings = {"u": u + noise(0.003), "v": v + noise(0.003), "r": r + noise(0.0007), "psi": psi + noise(0.003)}
    return Log("craft.csv", "0" * 64, t, {**readings, "demand_port": port, "demand_starboard": starboard})


@pytest.mark.parametrize("by", ["parts", "lines", "neither"])
@pytest.mark.parametrize(("lag", "rate"), [(0.12, 5.0), (0.06, 10.0)])
def test_a_stated_lag_is_none_beside_itself(lag, rate, by, monkeypatch):
    """By whole steps a sound craft had another lag by 520 and by 67 in chi-squared. Thrusts on straight lines inside them leave 3 and 6."""
    vehicle = parse_vehicle(CRAFT.replace("{lag}", str(lag)), "craft.toml")
    if by == "neither":
        monkeypatch.setattr(Driving, "_running", lambda *_: None)
    if by != "parts":
        monkeypatch.setattr(clock, "LONG", 10.0)
        monkeypatch.setattr(clock, "LONG_BESIDE_LAG", 10.0)
    log = channels(sailed(240.0, 3, lag, rate), vehicle)
    assert (log.between is not None) == (by == "parts")
    scored = score(plain_fit(vehicle, log, everything))[1]
    fall = max(s.fall for s in scored if s.id == "thruster.lag")
    assert fall < 16.0 if by != "neither" else fall > (100.0 if rate == 5.0 else 50.0), fall


def test_steps_have_parts_where_thrusts_change_within_them():
    """Parts of 0.025 s, none where a lag is five steps long, and none at 10 Hz where the vehicle file has no lag."""
    late = ((0.12, 5.0, 8), (0.12, 10.0, 4), (0.6, 10.0, 0), (1.2, 5.0, 0), (0.9, 5.0, 8), (0.9, 2.0, 20))
    for seconds, rate, parts in (*late, (None, 10.0, 0), (None, 5.0, 8)):
        lag = "" if seconds is None else f"time_constant = {seconds}\n"
        vehicle = vehicle_of(TWIN.replace("accuracy", f"{lag}accuracy"))
        log = channels(train_of(vehicle, duration=120.0, rate=rate), vehicle)
        assert (0 if log.between is None else log.between.demands.shape[2]) == parts
        if parts:
            assert np.array_equal(log.between.demands, np.repeat(log.demands[:, :, None], parts, axis=2))
