"""Shared by the tests: the embedded vehicle, simulated trials, and where the real data stand."""

import fcntl
import os
import pickle
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from ivsid import identify
from ivsid.log import Log, read_log
from ivsid.programme.scenario import Scenario, parse_scenario
from ivsid.simulation import Simulated, simulate
from ivsid.vehicle import Vehicle, parse_vehicle
from ivsid.verification.rows import Rows
from ivsid.workflow.log_files import csv
from sampling import NIGHTLY

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"
# The gate draws the same cases every time; in the nightly run draws are fresh.
settings.register_profile("fixed", derandomize=True)
settings.register_profile("fresh", print_blob=True)
settings.load_profile("fresh" if NIGHTLY else "fixed")


def embedded(name: str) -> str:
    return (files("ivsid") / "data" / name).read_text()


@pytest.fixture(scope="session")
def once(tmp_path_factory):
    """``once(name, make)``: what ``make(folder)`` returns, made by the first process of the run that asks, read by the others."""
    place = tmp_path_factory.getbasetemp()
    shared = place.parent if "PYTEST_XDIST_WORKER" in os.environ else place

    def get(name: str, make: Callable[[Path], Any]) -> Any:
        folder, made = shared / f"once-{name}", shared / f"once-{name}.pickle"
        with (shared / f"once-{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not made.exists():
                folder.mkdir(exist_ok=True)
                value = make(folder)
                made.write_bytes(pickle.dumps(value))
        return pickle.loads(made.read_bytes())

    return get


@pytest.fixture(scope="session", autouse=True)
def _savefig():
    """How figures are laid out and rendered. Fixtures of a module find both replaced, but for the nightly run."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    laid_out, rendered = ConstrainedLayoutEngine.execute, Figure.savefig
    with pytest.MonkeyPatch.context() as patch:
        if not NIGHTLY:
            patch.setattr(ConstrainedLayoutEngine, "execute", lambda engine, figure: {})
            patch.setattr(Figure, "savefig", lambda figure, file, **how: file.write(b"not rendered"))
        yield laid_out, rendered


@pytest.fixture(autouse=True)
def _figures(request, monkeypatch, _savefig):
    """Figures are drawn in every test, and laid out and rendered in those that are marked ``figures`` and in the nightly run."""
    if request.node.get_closest_marker("figures") is not None:
        laid_out, rendered = _savefig
        monkeypatch.setattr("matplotlib.layout_engine.ConstrainedLayoutEngine.execute", laid_out)
        monkeypatch.setattr("matplotlib.figure.Figure.savefig", rendered)


@pytest.fixture(autouse=True)
def _catalogue():
    """A test leaves the catalogue of effects as it was, its order included: cases are drawn from it."""
    from ivsid.effects import EFFECTS

    before = list(EFFECTS)
    yield
    assert list(EFFECTS) == before


@pytest.fixture
def without_hump(_catalogue):
    """The catalogue without the hump of the wave resistance; afterwards with it, in the same order."""
    from ivsid.effects import EFFECTS

    everything = dict(EFFECTS)
    del EFFECTS["drag.surge.hump"]
    yield
    EFFECTS.clear()
    EFFECTS.update(everything)


@pytest.fixture(scope="module")
def _rows_by_model() -> dict[tuple[Any, ...], tuple[Log, Rows]]:
    return {}


@pytest.fixture(autouse=True)
def _same_rows(request, monkeypatch):
    """Rows of one log and one vehicle's text are recomputed once for all edits of a file's results, and for each at night."""
    if NIGHTLY or request.node.get_closest_marker("same_rows") is None:
        return
    kept = request.getfixturevalue("_rows_by_model")

    def rows(log: Log, vehicle: Vehicle, form: str, **how: Any) -> Rows:
        key = (id(log), vehicle.text, form, *sorted(how.items()))
        # The log is kept with its rows: no other one can stand at its place in memory.
        if key not in kept:
            kept[key] = log, Rows(log, vehicle, form, **how)
        made = kept[key][1]
        made._counts.clear()
        return made

    monkeypatch.setattr("ivsid.verification.checker.Rows", rows)


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
def fits(once, swan, twin):
    """Results of ``identify`` of several kinds, the log that they share, and the folder."""
    return once("fits", lambda place: _fits(place, swan, twin))


def _fits(place: Path, swan: Vehicle, twin: Simulated) -> tuple[dict[str, Path], Log, Path]:
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
