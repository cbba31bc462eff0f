"""Real input: a third party's simulator, bollard tables of a maker, an IMU at sea. Skipped where the data are not."""

import pytest

from ivsid import read_vehicle, workflow

EXAMPLES = __import__("pathlib").Path(__file__).parents[2] / "examples"


def test_otter_plain_model_is_falsified_and_the_extended_one_holds_the_truth(real):
    log = real("sim_truth_pvs/otter_calm.csv.gz")
    plain = workflow.identify(EXAMPLES / "otter.toml", log).record
    assert plain["status"] == "empty" and plain["guaranteed"] and plain["inflation"] > 1
    extended = workflow.identify(EXAMPLES / "otter_extended.toml", log).record
    assert extended["status"] == "enclosed" and extended["inflation"] < 1
    # truth.json: M[0][0], M[1][1], M[5][5], D[0][0], D[1][1], D[5][5]
    truth = {
        "mass.surge": 85.5,
        "mass.sway": 162.5,
        "inertia.yaw": 42.65145,
        "drag.surge.linear": 77.554,
        "drag.sway.linear": 162.5,
        "drag.yaw.linear": 42.65145,
    }
    for id_, value in truth.items():
        p = extended["parameters"][id_]
        assert p["lower"] <= value <= p["upper"], id_


def test_a_current_contradicts_the_calm_fit(real, tmp_path):
    from ivsid.report import page

    fit = workflow.identify(EXAMPLES / "otter_extended.toml", real("sim_truth_pvs/otter_calm.csv.gz"))
    page.write(fit, tmp_path / "fit")
    calm = workflow.validate(tmp_path / "fit", real("sim_truth_pvs/otter_calm.csv.gz")).record
    current = workflow.validate(tmp_path / "fit", real("sim_truth_pvs/otter_current_0p4_30deg.csv.gz")).record
    assert sum(f["falsified_samples"] for f in calm["force"].values()) == 0
    assert sum(f["falsified_samples"] for f in current["force"].values()) > 1000
    # Tubes that end at their first step are no tubes, and are not followed window by window.
    assert current["tubes"]["channels"] == "" and "too wide for a tube of all channels" in current["tubes"]["reason"]


@pytest.mark.parametrize("volts", [10, 12, 14, 16, 18, 20])
def test_t200_tables(real, volts):
    record = workflow.thrust(real(f"t200/T200_{volts}V.csv")).record
    assert record["points"] == 201 and record["unit"] == "kgf" and record["range"] == [1100, 1900]
    low, high = record["dead_band"]
    assert low < 1500 < high
    if volts == 16:
        # From the maker's table: 5.245 / -4.069 kgf, no thrust from 1472 to 1528 us
        assert record["thrust_range"] == pytest.approx([-4.069476 * 9.80665, 5.245 * 9.80665], rel=1e-3)
        assert (low, high) == (1472, 1528)
    assert record["recommended"] == "monotone table (PCHIP)"


@pytest.mark.parametrize("volts", [10, 16, 20])
def test_every_candidate_for_a_t200_holds_its_table(real, volts):
    import numpy as np
    import polars as pl

    from ivsid.propulsion.thrust import ThrustCurve
    from ivsid.vehicle import parse_vehicle

    path = real(f"t200/T200_{volts}V.csv")
    frame = pl.read_csv(path)
    pwm, force = (frame[frame.columns[k]].to_numpy().astype(float) for k in (0, 5))
    candidates = workflow.thrust(path).record["candidates"]
    assert len(candidates) == 7
    for name, text in candidates.items():
        unit = parse_vehicle(f'name = "b"\n[hull]\nmass = 1\n{text}', "b.toml").thrusters[0]
        assert ThrustCurve(unit).interval(pwm).contains(force * 9.80665).all(), name
        assert np.isfinite(ThrustCurve(unit).largest)


# Nightly: twelve seconds; the gate fits simulated sensors.
@pytest.mark.nightly
def test_the_rov_on_deck(real):
    record = workflow.allan(real("rov_30k/20150518--1335_deck_imu.csv.gz")).record
    assert set(record["channels"]) == {"acc_x", "acc_y", "acc_z", "gyr_x", "gyr_y", "gyr_z"}
    # Means of the deck recording: gyro bias (-.00449, .00398, -.00110) rad/s
    means = [record["channels"][f"gyr_{a}"]["mean"] for a in "xyz"]
    assert means == pytest.approx([-0.00449, 0.00398, -0.00110], abs=4e-4)
    assert any("uneven" in n for n in record["notes"])
    for name in ("gyr_x", "gyr_y", "gyr_z"):
        assert 1e-4 < record["channels"][name]["random_walk"] < 1e-2


def test_example_vehicles_read():
    assert read_vehicle(EXAMPLES / "otter.toml").name == "Otter"
