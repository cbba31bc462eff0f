"""A row that a log lost may have carried a new demand: nothing is concluded from the step over it."""

from importlib.resources import files

import numpy as np
import pytest

from ivsid import identify, verify
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from sampling import spaced

DATA = files("ivsid") / "data"

PUSHED = """
name = "pushed"
[hull]
mass = 50
centre_of_gravity = [0.0, 0.0]
[[thrusters]]
name = "stern"
position = [-0.5, 0.0]
gain = 0.3
demand_range = [-100, 100]
accuracy = { absolute = 0.01 }
[sensors.velocity]
accuracy = 0.0001
[sensors.yaw_rate]
random_walk = 1e-6
[sensors.limits]
acceleration = 1.0
yaw_acceleration = 0.01
[model]
terms = ["mass.surge"]
"""


def without(t, columns, lost):
    """The log without some rows."""
    kept = np.ones(t.size, bool)
    kept[list(lost)] = False
    return Log("lost.csv", "0" * 64, t[kept], {name: x[kept] for name, x in columns.items()})


@pytest.mark.parametrize("lag", ["demand", "thrust"])
@pytest.mark.sampled
def test_a_lag_starts_anew_where_a_row_was_lost(lag, tmp_path):
    lagging = f'\ntime_constant = 1.0\nlag = "{lag}"\nposition = ['
    vehicle = parse_vehicle((DATA / "swan.toml").read_text().replace("\nposition = [", lagging), "swan")
    scenario = parse_scenario((DATA / "swan_train.toml").read_text(), "train")
    made = simulate(vehicle, scenario.model_copy(update={"duration": 100.0, "rate": 10.0, "noise": "none"}), 1)
    demand = made.columns["demand_port"]
    changes = np.flatnonzero(np.diff(demand)) + 1
    alone = [int(i) for i in changes if i - 1 not in changes and i + 1 not in changes]
    assert len(alone) >= 3
    for lost in spaced(([], alone[1:2], alone), 2):
        log = without(made.t, made.columns, lost)
        fit = identify(vehicle, log)
        assert fit.status == "enclosed" and fit.guaranteed
        assert all(p.lower <= scenario.truth[id_] <= p.upper for id_, p in fit.parameters.items()), lost
        fit.save(tmp_path / "result.json")
        assert verify(tmp_path / "result.json", log).status == "proved"


def test_no_window_goes_over_a_lost_row(tmp_path):
    """m udot = F held for half a second at a time, exactly; any one row may be lost."""
    t, demand = np.arange(120) / 10, np.repeat([40.0, -40.0], 5)[np.arange(120) % 10]
    u = np.r_[0, np.cumsum(0.3 * demand[:-1] / 60.0 * 0.1)]
    columns = {"u": u, "v": 0 * u, "r": 0 * u, "demand_stern": demand}
    for window in (1.0, 0.3):
        for row in range(50, 61):
            log = without(t, columns, [row])
            fit = identify(parse_vehicle(PUSHED, "pushed"), log, rows="integral", window=[window])
            p = fit.parameters["mass.surge"]
            assert fit.status in ("enclosed", "unbounded") and p.lower <= 60 <= p.upper, (window, row)
    fit.save(tmp_path / "result.json")
    assert verify(tmp_path / "result.json", log).status == "proved"
