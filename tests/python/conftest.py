"""What the tests share: the embedded vehicle, simulated trials, and where the real data stand."""

from importlib.resources import files
from pathlib import Path

import pytest

from ivsid.log import Log
from ivsid.scenario import Scenario, parse_scenario
from ivsid.simulation import Simulated, simulate
from ivsid.vehicle import Vehicle, parse_vehicle

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


@pytest.fixture
def real():
    """A path under the shared data, or a skip that says what is missing."""

    def find(name: str) -> Path:
        path = SHARED / name
        if not path.exists():
            pytest.skip(f"the shared data set {name} is not on this machine")
        return path

    return find
