"""``ivsid example``: its files, its hidden cause, and the first diagnosis."""

import csv
import hashlib
import json
import tomllib

import numpy as np
import pytest

import ivsid
from command_line import run
from conftest import embedded
from ivsid import simulation
from ivsid.effects import EFFECTS
from ivsid.files.seal import seal_of
from ivsid.files.shipped import shipped
from ivsid.log import Log
from ivsid.programme.scenario import read_scenario
from ivsid.vehicle import read_vehicle

# The cause of the default seed and of another one, by the sealed files.
CAUSES = {None: "sensor.velocity.lever_arm", 8: "thruster.gain"}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    place = tmp_path_factory.mktemp("example")
    done = run("example", place / "first")
    assert done.returncode == 0, done.stderr
    return place / "first", done


def readings(path):
    with path.open() as file:
        rows = list(csv.reader(file))
    return rows[0], np.array(rows[1:], dtype=float)


def test_two_runs_with_their_vehicle_file_and_the_truth_apart(made):
    folder, done = made
    names = {p.name for p in folder.iterdir()}
    assert {"boat.toml", "programme.toml", "run1.csv", "run2.csv", "result.json", "report.html", "truth"} <= names
    assert f"next: ivsid diagnose {folder / 'boat.toml'} {folder / 'run1.csv'} {folder / 'run2.csv'}" in done.stdout
    vehicle = read_vehicle(folder / "boat.toml")
    (header, first), (_, second) = (readings(folder / f"run{k}.csv") for k in (1, 2))
    assert header == ["t", "u", "v", "r", "ax", "ay", "psi", "x", "y", "demand_port", "demand_starboard"]
    assert len(first) == len(second) == 1800 and np.ptp(first[:, 0]) == pytest.approx(179.9)
    assert not np.array_equal(first[:, 1], second[:, 1])
    assert {f"demand_{t.name}" for t in vehicle.thrusters} <= set(header)


def test_the_sealed_truth_names_a_cause_that_no_other_file_names(made):
    folder, done = made
    truth = json.loads((folder / "truth" / "truth.json").read_text())
    assert truth["seal"] == seal_of((folder / "truth" / "truth.json").read_text())
    assert truth["effect"] == CAUSES[None] and truth["cause"] == EFFECTS[truth["effect"]].cause
    assert all(
        truth["runs"][f"run{k}.csv"]["parameters"][id_] == v for k in (1, 2) for id_, v in truth["numbers"].items()
    )
    # The boat is one boat: the errors of its thrusters are the same in both runs.
    boats = [json.dumps(truth["runs"][f"run{k}.csv"]["thrust_error"]) for k in (1, 2)]
    assert boats[0] == boats[1]
    model = tomllib.loads((folder / "boat.toml").read_text())["model"]["terms"]
    assert truth["effect"] not in model
    spoken = done.stdout + "".join(
        p.read_text() for p in folder.iterdir() if p.suffix in (".toml", ".csv", ".json", ".html")
    )
    assert truth["effect"] not in spoken and truth["cause"] not in spoken


def test_the_hidden_cause_moves_the_boat(made):
    """The same programme without it, by the package's simulator: the readings differ by more than their noise."""
    from ivsid.programme.scenario import parse_scenario
    from ivsid.simulation import simulate
    from ivsid.workflow.example_runs import SEED, noise_seed

    folder, _ = made
    scenario = parse_scenario(embedded("example_programme.toml"), "programme")
    quiet = simulate(read_vehicle("otter"), scenario, noise_seed(SEED, 1), thrusters=noise_seed(SEED, 0))
    _, logged = readings(folder / "run1.csv")
    assert np.abs(logged[:, 2] - quiet.columns["v"]).max() > 0.05
    np.testing.assert_array_equal(logged[:, 0], quiet.t)


def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_cause(made, tmp_path):
    folder, _ = made
    for seed, name in ((2, "again"), (8, "other")):
        done = run("example", tmp_path / name, "--seed", seed, "--json")
        assert done.returncode == 0 and json.loads(done.stdout)["seed"] == seed
    for path in ("boat.toml", "run1.csv", "run2.csv", "truth/truth.json"):
        assert (folder / path).read_bytes() == (tmp_path / "again" / path).read_bytes(), path
    assert json.loads((tmp_path / "other" / "truth" / "truth.json").read_text())["effect"] == CAUSES[8]


# Of a gain of 7 %, beside an accuracy of 2 % and half a newton, three minutes show 3.4 standard deviations: the threshold says so since calibrated.
SHOWN = {s: c for s, c in CAUSES.items() if c != "thruster.gain"} | {
    3: "drag.surge.sideslip",
    5: "sensor.attitude_leak",
    7: "sensor.acceleration.lever_arm",
    9: "tether.tension",
    11: "thruster.curve",
}


# Nightly: seeds other than that of the documents.
@pytest.mark.parametrize("seed", [pytest.param(s, marks=[pytest.mark.nightly] * (s is not None)) for s in SHOWN])
def test_the_first_diagnosis_names_the_hidden_cause_and_reads_no_truth(tmp_path, seed):
    folder = tmp_path / "example"
    assert run("example", folder, *(() if seed is None else ("--seed", seed))).returncode == 0
    truth = json.loads((folder / "truth" / "truth.json").read_text())
    (folder / "truth" / "truth.json").unlink()
    logs = [folder / f"run{k}.csv" for k in (1, 2)]
    done = run("diagnose", folder / "boat.toml", *logs, "--out", tmp_path / "found", "--json", "--no-cache")
    assert done.returncode == 0, done.stderr
    record = json.loads(done.stdout)
    assert record["verdict"] == "wrong"
    (finding,) = record["findings"]
    assert truth["effect"] == SHOWN[seed] in {finding["effect"], *finding["alternatives"]}
    # Intervals are those of the first of a set.
    for id_, value in truth["numbers"].items() if finding["effect"] == truth["effect"] else ():
        assert finding["parameters"][id_]["lower"] <= value <= finding["parameters"][id_]["upper"], id_
    digests = {i["sha256"] for i in record["inputs"]}
    assert hashlib.sha256(logs[0].read_bytes()).hexdigest() in digests


@pytest.mark.nightly
def test_a_cause_that_the_example_hardly_shows_has_no_wrong_name(tmp_path):
    assert run("example", tmp_path / "example", "--seed", 8).returncode == 0
    place = tmp_path / "example"
    result = ivsid.diagnose(place / "boat.toml", place / "run1.csv", place / "run2.csv")
    assert all("thruster.gain" in {f.effect, *f.alternatives} for f in result.findings)
    # A cause of z below eight may show enough to be named since; it says what explains that as well.
    assert "inside the stated accuracies may explain it" in result.selection.refused["thruster.gain"].sentence


# Nightly: a whole diagnosis; the gate has the example that the documents follow.
@pytest.mark.nightly
def test_a_gain_beside_a_stated_centre_of_gravity_is_no_other_centre():
    """Every mass and drag takes up a gain but the moments of the stated centre of gravity: the log does not tell it from another centre."""
    vehicle, first = read_vehicle(shipped("otter")), read_scenario(shipped("example", "_programme"))
    assert vehicle.hull.centre_of_gravity[0] > 0.1
    second = first.model_copy(update={"segments": first.segments[::-1]})
    logs = []
    for k, programme in enumerate((first, second), 1):
        made = simulation.simulate(vehicle, programme, 24 + k, {"thruster.gain": 0.2}, thrusters=24)
        logs.append(Log(f"{k}.csv", str(k) * 64, made.t, made.columns))
    result = ivsid.diagnose(vehicle, *logs)
    assert [{f.effect, *f.alternatives} for f in result.findings] == [{"coupling.cg_x", "thruster.gain"}]
