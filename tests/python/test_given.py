"""Vehicles and logs as people give them: paths, names, tables in memory, checked objects."""

from pathlib import Path

import numpy as np
import polars as pl
import pytest

from conftest import as_log
from ivsid import IvsidError, identify, read_vehicle, validate, workflow
from ivsid.cli.command import _missing
from ivsid.cli.recognition import SCENARIO, VEHICLE, kinds
from ivsid.files.shipped import shipped, shipped_names
from ivsid.log import log_of, read_log
from ivsid.programme.scenario import read_scenario
from ivsid.vehicle import vehicle_of
from log_files import log_map


class Series:
    """What a column of a data frame of pandas offers."""

    def __init__(self, values):
        self.values = values

    def to_numpy(self):
        return self.values


class Pandas:
    """What a data frame of pandas offers; the package itself is no dependency."""

    def __init__(self, columns):
        self._columns = columns

    @property
    def columns(self):
        return list(self._columns)

    def __getitem__(self, name):
        return Series(self._columns[name])


def tables(made):
    columns = {"t": made.t, **made.columns}
    return pl.DataFrame(columns), Pandas(columns), columns, {n: list(v) for n, v in columns.items()}


def test_every_way_to_give_a_log_gives_the_same_intervals(tmp_path, swan, twin):
    path = tmp_path / "log.csv"
    pl.DataFrame({"t": twin.t, **twin.columns}).write_csv(path)
    file = tmp_path / "swan.toml"
    file.write_text(swan.text)
    want = identify(swan, as_log(twin))
    for vehicle in (swan, file, str(file)):
        for log in (path, str(path), as_log(twin), *tables(twin)):
            got = identify(vehicle, log)
            assert got.parameters == want.parameters and got.status == want.status
    assert validate(want, path).motion.rms == validate(want, as_log(twin)).motion.rms
    # The same table has the same hash, and another one another.
    assert len({log_of(t).sha256 for t in tables(twin)[:3]}) == 1
    changed = {**tables(twin)[2], "u": np.nextafter(twin.columns["u"], 9.0)}
    assert log_of(changed).sha256 != log_of(tables(twin)[2]).sha256


def test_a_table_in_memory_is_mapped_as_a_file_is(tmp_path):
    frame = pl.DataFrame(
        {"stamp": [f"2024-05-31 10:00:{k:02d}" for k in range(40)], "gyro [deg/s]": np.sin(np.arange(40.0))}
    )
    frame.write_csv(tmp_path / "log.csv")
    mapping = log_map(time={"from": "stamp"}, columns={"r": "gyro"})
    one, other = log_of(frame, mapping), read_log(tmp_path / "log.csv", mapping)
    np.testing.assert_array_equal(one.t, other.t)
    np.testing.assert_array_equal(one.columns["r"], other.columns["r"])
    assert one.notes == other.notes and one.name == "the table"


def test_shipped_vehicles_are_known_by_name_everywhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    otter = vehicle_of("otter")
    assert otter == read_vehicle("otter") and otter.name.lower().startswith("otter")
    # A file of that name comes first.
    (tmp_path / "otter").write_text('name = "mine"\n[hull]\nmass = 3\n')
    assert read_vehicle("otter").name == "mine" and vehicle_of(otter) is otter
    (tmp_path / "otter").unlink()
    with pytest.raises(IvsidError, match="vehicle file submarine cannot be read"):
        vehicle_of("submarine")


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (3, "a log is given as int; give its path"),
        ({"t": [0.0, 1.0], "u": [1.0]}, "have the shapes t .2,., u .1,.; each needs one dimension"),
        ({"t": [[0.0], [1.0]]}, "each needs one dimension"),
        ({"t": [0.0, 1.0], "u": ["a", "b"]}, "the table: column u holds 'a' in row 0"),
        (pl.DataFrame({"time": [0.0, 1.0]}), "the table has no column t for the time"),
    ],
)
def test_what_is_no_log_is_said(given, words):
    with pytest.raises(IvsidError, match=words):
        log_of(given)


def test_what_is_no_vehicle_is_said(twin):
    with pytest.raises(IvsidError, match="a vehicle is given as Log; give the path of its file"):
        identify(as_log(twin), as_log(twin))


def test_shipped_scenarios_are_known_by_their_vehicle_or_a_name_of_their_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert {"otter", "vectored_rov", "swan_train", "swan_test", "example"} <= set(shipped_names("_programme"))
    assert "swan_train" not in shipped_names() and "otter" in shipped_names()
    assert read_scenario(shipped("swan_train", "_programme")).duration == 300
    assert kinds("swan_train") == {SCENARIO} and kinds("otter") == {SCENARIO, VEHICLE} and not kinds("swan_tran")
    with pytest.raises(IvsidError, match="did you mean swan_train or swan_test"):
        read_scenario("swan_tran")
    words = _missing("simulate", ["VEHICLE", "SCENARIO"], [Path("otter")])
    assert words.endswith("ivsid simulate otter otter takes the scenario that comes with it")
    with pytest.raises(IvsidError, match="log or scenario otr is not there; did you mean otter"):
        workflow.isolability("otter", "otr")
