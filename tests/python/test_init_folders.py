"""``ivsid init`` on a folder: the runs that it holds, and the reason for each file that is none."""

import json

import numpy as np
import polars as pl
import pytest

import program_logs as programs
from ivsid import IvsidError, read_log
from ivsid.files.log_map import LogMap
from ivsid.proposal import propose
from ivsid.workflow import init


def run(path, amplitude=1.0, form="csv"):
    m = programs.Motion(20.0, 10.0)
    path.parent.mkdir(parents=True, exist_ok=True)
    frame = pl.DataFrame(
        {"t": m.t, "u": amplitude * m.u, "v": m.v, "r": m.r, "rpm_port": m.port - 1600, "rpm_stbd": m.starboard - 1600}
    )
    if form == "json":
        path.write_text(json.dumps(frame.to_dicts()))
    else:
        frame.write_csv(path)


def names(paths, folder):
    return {str(p.relative_to(folder)) for p in paths}


def test_runs_are_found_in_subfolders_and_other_files_are_named_with_a_reason(tmp_path):
    season = tmp_path / "season"
    run(season / "may" / "run.csv")
    run(season / "may" / "again.csv")
    run(season / "june" / "run.json", 1.1, "json")
    run(season / "july" / "alone.csv", 1.2)
    (season / "readme.txt").write_text("A season of trials.\nWith a second line.\n")
    (season / "june" / "plot.png").write_bytes(b"\x89PNG")
    (season / "june" / "weather.csv").write_text("t,temperature\n0,12\n1,13\n")
    found = propose([season])
    assert names(found.paths, season) == {"may/again.csv", "june/run.json", "july/alone.csv"}
    left = {str(p.relative_to(season)): why for p, why in found.left}
    assert left["may/run.csv"] == "has the same bytes as may/again.csv"
    assert left["june/plot.png"] == "has the ending of no log"
    assert "no column whose name is known" in left["june/weather.csv"] and "readme.txt" in left
    assert [d.name for d in found.demands] == ["port", "stbd"] and found.demands[0].span == pytest.approx(80)
    made = init([season], tmp_path / "boat.toml")
    text = "\n".join(made.lines)
    assert "taken: " in text and "not taken: " in text and "weather.csv, which has no column" in text
    assert made.record["left"] and len(made.record["logs"]) == 3
    assert f"ivsid diagnose {tmp_path}/boat.toml {found.paths[0]} {found.paths[1]}" in text


def test_two_runs_in_one_folder_are_no_two_tables_of_one(tmp_path):
    run(tmp_path / "run1.csv")
    run(tmp_path / "run2.csv", 1.3)
    found = propose([tmp_path])
    assert names(found.paths, tmp_path) == {"run1.csv", "run2.csv"} and len(found.demands) == 2


@pytest.mark.parametrize("nested", [False, True])
def test_tables_that_say_different_things_are_one_log(tmp_path, nested):
    m = programs.Motion(20.0, 10.0)
    tables = {"dvl": {"u": m.u, "v": m.v}, "imu": {"r": m.r}, "thrusters": {"rpm_port": m.port - 1600}}
    for name, columns in tables.items():
        path = tmp_path / "log" / (f"{name}/data.csv" if nested else f"{name}.csv")
        path.parent.mkdir(parents=True, exist_ok=True)
        pl.DataFrame({"t": m.t, **columns}).write_csv(path)
    found = propose([tmp_path / "log"])
    assert found.paths == (tmp_path / "log",) and {"u", "v", "r"} <= found.channels.keys()
    np.testing.assert_allclose(found.logs[0].columns["r"], m.r)


def test_a_folder_without_a_log_says_what_it_holds(tmp_path):
    (tmp_path / "notes.txt").write_text("hello\n")
    (tmp_path / "photo.jpg").write_bytes(b"\xff\xd8")
    with pytest.raises(
        IvsidError, match=r"holds no log that can be read \(.*photo.jpg: has the ending of no log.*\); give a log file"
    ):
        propose([tmp_path])


@pytest.mark.parametrize("header", ["t,u,v,r", "t,surge_speed,sway_speed,yaw_rate", "t [s],u [m/s],v [m/s],r [deg/s]"])
def test_a_folder_of_runs_is_no_log_for_commands_that_take_one(tmp_path, header):
    for name in ("first", "second"):
        (tmp_path / f"{name}.csv").write_text(f"{header}\n" + "".join(f"{k},1.0,0.0,0.{k}\n" for k in range(9)))
    mapping = propose([tmp_path]).mapped.checked
    with pytest.raises(IvsidError, match=r"holds 2 runs \(first, second: .*; give one of these files"):
        read_log(tmp_path, mapping)
    assert read_log(tmp_path / "first.csv", mapping).t.size == 9
    if header == "t,u,v,r":
        # One of them by its full name is a choice, and tables of other columns are one log.
        chosen = LogMap.model_validate({"columns": {c: f"second/{c}" for c in "uvr"}})
        assert read_log(tmp_path, chosen).t.size == 9
        (tmp_path / "second.csv").write_text("t,demand_port\n" + "".join(f"{k},{k}\n" for k in range(9)))
        assert "demand_port" in read_log(tmp_path, LogMap.model_validate({"rates": dict.fromkeys("uvr", 1.0)})).columns
