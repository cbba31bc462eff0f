"""Every log of the shared data that has what a model needs: identified by default, and proved by the checker."""

from importlib.resources import files
from pathlib import Path

import pytest

from ivsid import identify, read_vehicle, verify
from ivsid.adapters.cse1 import read_cse1
from ivsid.adapters.rov30k import read_rov30k
from ivsid.log import read_log

EXAMPLES = Path(__file__).parents[2] / "examples"
OTTER = "sim_truth_pvs/otter_{}.csv.gz"


def proved(vehicle, path, tmp_path, **how):
    log = read_log(path, vehicle.log)
    fit = identify(vehicle, log, **how)
    assert fit.method == "feasible" and fit.guaranteed
    fit.save(tmp_path / "fit")
    verdict = verify(tmp_path / "fit", path)
    assert verdict.proved, verdict.failures[:3]
    assert verdict.certificates and verdict.claim == fit.status
    return fit


@pytest.mark.parametrize(
    ("model", "log", "status"),
    [
        ("otter", "calm", "empty"),
        ("otter", "current_0p4_30deg", "empty"),
        ("otter_extended", "calm", "enclosed"),
        ("otter_extended", "current_0p4_30deg", "empty"),
    ],
)
def test_otter(real, tmp_path, model, log, status):
    assert proved(read_vehicle(EXAMPLES / f"{model}.toml"), real(OTTER.format(log)), tmp_path).status == status


@pytest.mark.parametrize(("model", "status"), [("otter", "empty"), ("otter_extended", "enclosed")])
def test_otter_with_rows_that_may_be_wrong(real, tmp_path, model, status):
    fit = proved(read_vehicle(EXAMPLES / f"{model}.toml"), real(OTTER.format("calm")), tmp_path, outliers=1)
    assert fit.status == status and any(c.get("dropped") for c in fit.certificates)


# Nightly: the gate has weak rows of simulated poses in test_verification_weak.py.
@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize("rows", ["weak", "both"])
def test_cybership_straight_from_the_pose(real, tmp_path, rows):
    (tmp_path / "run.csv").write_text(read_cse1(real("cse1")).logs["random_run1"].text)
    vehicle = read_vehicle(str(files("ivsid") / "data" / "cse1.toml"))
    fit = proved(vehicle, tmp_path / "run.csv", tmp_path, rows=rows)
    assert "weak" in {r["kind"] for c in fit.certificates for r in c.get("rows", ())}


# Nightly: 780 certificates each; the gate proves the sets below and above.
@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize("run", ["random_run1", "random_run3"])
def test_cybership(real, tmp_path, run):
    """Velocities from camera poses, windows of a second, eight parameters: some 780 certificates."""
    part = read_cse1(real("cse1")).logs[run]
    (tmp_path / f"{run}.csv").write_text(part.text)
    vehicle = read_vehicle(str(files("ivsid") / "data" / "cse1.toml"))
    assert proved(vehicle, tmp_path / f"{run}.csv", tmp_path).status == "unbounded"


# Nightly: the gate has wrong rows of the Otter above.
@pytest.mark.slow
@pytest.mark.nightly
def test_remotely_operated_vehicle_with_a_row_that_may_be_wrong(real, tmp_path):
    (tmp_path / "manual.csv").write_text(read_rov30k(real("rov_30k")).logs["manual"].text)
    vehicle = read_vehicle(str(files("ivsid") / "data" / "rov30k.toml"))
    assert proved(vehicle, tmp_path / "manual.csv", tmp_path, outliers=1, rows="both").outliers


@pytest.mark.parametrize("part", ["manual", "automatic"])
def test_remotely_operated_vehicle(real, tmp_path, part):
    log = read_rov30k(real("rov_30k")).logs[part]
    (tmp_path / f"{part}.csv").write_text(log.text)
    vehicle = read_vehicle(str(files("ivsid") / "data" / "rov30k.toml"))
    assert proved(vehicle, tmp_path / f"{part}.csv", tmp_path).status == "unbounded"
