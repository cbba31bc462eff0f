"""Vehicles that steer, from a scenario file through a log on disk to intervals; what `simulate` writes and hides."""

import json

import numpy as np
import pytest

from conftest import embedded
from ivsid import IvsidError, read_log, read_vehicle, workflow
from ivsid.effects import EFFECTS, sort_given
from ivsid.programme.manoeuvres import Segment
from ivsid.programme.scenario import parse_scenario
from ivsid.report import page
from ivsid.simulation import hidden, hidden_effect, hidden_effects, simulate
from ivsid.vehicle import parse_vehicle
from test_actuators import HULL, POD, PRBS, SENSORS, TRUTH, VALUES
from test_rudders import RUDDER

MANOEUVRES = Segment.model_fields["manoeuvre"].annotation.__args__
VSP = """
[[thrusters]]
name = "vsp"
kind = "voith-schneider"
position = [-0.4, 0.05]
gain = 1.5
demand_range = [-80, 80]
accuracy = { absolute = 0.2, relative = 0.02 }
[[thrusters]]
name = "bow"
position = [0.5, 0.0]
azimuth = 1.5707963267948966
gain = 0.3
demand_range = [-80, 80]
accuracy = { absolute = 0.2 }
"""


def written(tmp_path, thrusters, table="csv"):
    """A simulated log on disk, by the command's own workflow."""
    (tmp_path / "vehicle.toml").write_text(HULL + thrusters + SENSORS)
    (tmp_path / "scenario.toml").write_text(PRBS.replace("[[segments]]", TRUTH + "[[segments]]", 1))
    made = workflow.simulate(tmp_path / "vehicle.toml", tmp_path / "scenario.toml", table=table)
    page.write(made, tmp_path / "out")
    return tmp_path / "vehicle.toml", tmp_path / "out" / f"log.{table}"


# Nightly: the other format of each kind; the doubles of both are the same, below.
@pytest.mark.parametrize(
    ("thrusters", "column", "table"),
    [
        (POD, "azimuth_pod", "csv"),
        (RUDDER, "rudder_screw", "csv"),
        (VSP, "demand_vsp_sway", "parquet"),
        pytest.param(POD, "azimuth_pod", "parquet", marks=pytest.mark.nightly),
        pytest.param(RUDDER, "rudder_screw", "parquet", marks=pytest.mark.nightly),
        pytest.param(VSP, "demand_vsp_sway", "csv", marks=pytest.mark.nightly),
    ],
)
def test_a_vehicle_that_steers_is_identified_from_its_file(tmp_path, thrusters, column, table):
    vehicle, log = written(tmp_path, thrusters, table)
    assert column in read_log(log, read_vehicle(vehicle).log).columns
    fit = workflow.identify(vehicle, log).record
    assert fit["status"] in ("enclosed", "unbounded") and fit["guaranteed"]
    bounded = 0
    for id_, p in fit["parameters"].items():
        low, high = (float(p[e]) for e in ("lower", "upper"))
        assert low <= VALUES[id_] <= high, id_
        bounded += np.isfinite(high - low)
    assert bounded >= 3
    page.write(workflow.identify(vehicle, log), tmp_path / "fit")
    checked = workflow.validate(tmp_path / "fit", log).record
    assert sum(f["falsified_samples"] for f in checked["force"].values()) == 0
    assert checked["motion"]["rms"]["u"] < 0.1


def test_parquet_and_csv_hold_the_same_doubles(tmp_path):
    _, one = written(tmp_path, POD, "csv")
    _, two = written(tmp_path, POD, "parquet")
    a, b = read_log(one), read_log(two)
    np.testing.assert_array_equal(a.t, b.t)
    for name, values in a.columns.items():
        np.testing.assert_array_equal(values, b.columns[name])
    with pytest.raises(IvsidError, match="not written as 'xlsx'; use csv or parquet"):
        workflow.simulate("otter", "otter", table="xlsx")


def test_a_scenario_holds_every_manoeuvre_and_every_fault(tmp_path):
    """One file with all manoeuvres and all faults of all sensors: it runs, and its log reads back with what was put on it."""
    segments = "\n".join(
        f'[[segments]]\nmanoeuvre = "{m}"\nduration = 10.0\nperiod = 2.0\nperiod_end = 1.0\namplitude = 10.0\nyaw_rate = 0.1\n'
        + ("heading_gain = 5.0\n" if m == "station" else "demand = 30.0\n")
        + ("heading = 0.2\n" if m in ("heading_zigzag", "station") else "")
        for m in MANOEUVRES
    )
    sensors = ("velocity", "acceleration", "yaw_rate", "heading", "position")
    faults = "\n".join(
        f"[sensing.{s}]\nperiod = 0.5\nhold = {'true' if k % 2 else 'false'}\ndrop_outs = 0.05\noutliers = 0.01\noutlier_size = 1.0\n"
        for k, s in enumerate(sensors)
    )
    text = f"duration = {10 * len(MANOEUVRES)}\nrate = 10\n{TRUTH}\n[environment]\ncurrent = [0.1, 0.0]\nwind_speed = 3.0\nvoltage = 16.0\nvoltage_fall = 0.001\ndepth = 5.0\n{faults}\n{segments}"
    vehicle = parse_vehicle(
        HULL + POD + SENSORS + "[sensors.heading]\naccuracy = 0.01\n[sensors.position]\naccuracy = 0.5\n",
        "v.toml",
    )
    made = simulate(vehicle, parse_scenario(text, "s.toml"), 1)
    n = made.t.size
    assert n == 100 * len(MANOEUVRES) and len(MANOEUVRES) == 13
    assert all(np.isfinite(x).all() for x in made.exact.values())
    for k, name in enumerate(("u", "ax", "r", "psi", "x")):
        missing = np.isnan(made.columns[name]).mean()
        assert (missing > 0.75) if k % 2 == 0 else (0 < missing < 0.2), name
    assert {"wind_speed", "wind_direction", "voltage", "depth"} <= set(made.columns)


def test_so_many_effects_are_hidden_as_are_asked_for(tmp_path, swan, monkeypatch):
    scenario = parse_scenario(embedded("swan_train.toml"), "swan_train.toml")
    seen = set()
    for seed in range(40):
        drawn = hidden_effects(swan, scenario, seed, 2)
        given = sort_given(drawn, ["port", "starboard"])
        assert len(given) == 2 and hidden_effects(swan, scenario, seed, 2) == drawn
        seen |= {g.effect.id for g in given}
    assert len(seen) > 20
    # An effect that leaves the catalogue, or joins it, changes the draws of the seeds that drew it, and of no others.
    for seed in range(10):
        drawn = {g.effect.id for g in sort_given(hidden_effects(swan, scenario, seed, 1), ["port", "starboard"])}
        with monkeypatch.context() as fewer:
            fewer.setattr(hidden, "EFFECTS", {k: e for k, e in EFFECTS.items() if k != "drag.surge.cubic"})
            again = hidden_effects(swan, scenario, seed, 1)
        assert "drag.surge.cubic" in drawn or {g.effect.id for g in sort_given(again, ["port", "starboard"])} == drawn
    assert len({bool(hidden_effect(swan, scenario, s)) for s in range(20)}) == 2, "without a number none may be hidden"
    with pytest.raises(IvsidError, match="can be hidden in SWAN; ask for fewer"):
        hidden_effects(swan, scenario, 0, 99)
    for name in ("swan.toml", "swan_train.toml"):
        (tmp_path / name).write_text(embedded(name))
    made = workflow.simulate(tmp_path / "swan.toml", tmp_path / "swan_train.toml", hide=3, hidden=2)
    truth = json.loads(made.files["truth.json"])
    names = {k.rsplit(".", 1)[0] if k.count(".") > 2 else k for k in truth["effects"]}
    assert truth["effects"] and not any(n in made.files["log.csv"] for n in names)
    with pytest.raises(IvsidError, match="give --hide SEED with it"):
        workflow.simulate(tmp_path / "swan.toml", tmp_path / "swan_train.toml", hidden=2)
