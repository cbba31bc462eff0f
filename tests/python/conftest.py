"""Shared by the tests: the embedded vehicle, simulated trials, and where the real data stand."""

from importlib.resources import files
from pathlib import Path

import pytest

from ivsid import identify
from ivsid.log import Log, read_log
from ivsid.programme.scenario import Scenario, parse_scenario
from ivsid.simulation import Simulated, simulate
from ivsid.vehicle import Vehicle, parse_vehicle
from ivsid.workflow.common import csv

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"


def embedded(name: str) -> str:
    return (files("ivsid") / "data" / name).read_text()


@pytest.fixture(scope="session")
def swan() -> Vehicle:
    return parse_vehicle(embedded("swan.toml"), "swan.toml")


@pytest.fixture(scope="session")
def programme() -> Scenario:
    """The first trial's manoeuvres, shortened."""
    scenario = parse_scenario(embedded("swan_train.toml"), "swan_train.toml")
    return scenario.model_copy(update={"duration": 100.0})


def as_log(made: Simulated, name: str = "twin.csv") -> Log:
    return Log(name, "0" * 64, made.t, made.columns)


@pytest.fixture(scope="session")
def twin(swan: Vehicle, programme: Scenario) -> Simulated:
    return simulate(swan, programme.model_copy(update={"noise": "uniform"}), 7)


@pytest.fixture(scope="session")
def fits(tmp_path_factory, swan, twin):
    """Results of ``identify`` of several kinds, the log that they share, and the folder."""
    place = tmp_path_factory.mktemp("verify")
    path = place / "log.csv"
    path.write_text(csv(twin.t, twin.columns))
    log = read_log(path, swan.log)
    wrong = parse_vehicle(
        swan.text.split("[model]")[0] + '[model]\nterms = ["mass.surge", "drag.surge.linear"]\n', "wrong.toml"
    )
    made = {
        "pointwise": identify(swan, log),
        "integral": identify(swan, log, rows="integral", window=1.0),
        "both": identify(swan, log, rows="both"),
        "added": identify(swan, log, form="added"),
        "empty": identify(wrong, log),
        "published": identify(swan, log, "published"),
    }
    files = {}
    for name, fit in made.items():
        fit.save(place / f"{name}.json")
        files[name] = place / f"{name}.json"
    return files, log, place


@pytest.fixture
def real():
    """A path under the shared data, or a skip that says what is missing."""

    def find(name: str) -> Path:
        path = SHARED / name
        if not path.exists():
            pytest.skip(f"the shared data set {name} is not on this machine")
        return path

    return find
