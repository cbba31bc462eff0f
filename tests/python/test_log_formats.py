"""Every format gives the same log, and every fault in every format gives one sentence."""

import importlib
import os
import threading

import numpy as np
import polars as pl
import pytest
from scipy.io import savemat

import log_files
from ivsid import IvsidError, read_log
from ivsid.files.log_map import LogMap


def mapping(table):
    return LogMap.model_validate(table)


def surge_velocity(monkeypatch, u):
    """Other values of u in every writer."""
    monkeypatch.setattr(log_files, "U", u)
    monkeypatch.setattr(log_files, "COLUMNS", {**log_files.COLUMNS, "u": u})
    monkeypatch.setattr(log_files.bag, "__defaults__", ("sqlite3", u, log_files.NS))
    monkeypatch.setattr(log_files.dataflash, "__defaults__", (u, None))


def sentence(path, table=None):
    with pytest.raises(IvsidError) as caught:
        read_log(path, mapping(table or {}))
    words = str(caught.value)
    assert "\n" not in words and "Traceback" not in words
    assert path.name in words or path.parent.name in words
    return words


@pytest.mark.parametrize("kind", list(log_files.FORMATS))
def test_every_format_is_the_same_log(tmp_path, kind):
    write, table = log_files.FORMATS[kind]
    log = read_log(write(tmp_path), mapping(table))
    np.testing.assert_allclose(log.t, log_files.T, atol=1e-9)
    for name, values in log_files.COLUMNS.items():
        np.testing.assert_array_equal(log.columns[name], values, err_msg=name)
        assert log.quality[name].samples == log_files.N and log.quality[name].missing == 0
    assert len(log.sha256) == 64
    # Stamps of several tables are assumed to agree, and the log says so; one clock needs no such assumption.
    several = kind in ("sqlite", "sqlite_file", "mcap", "mcap_file", "dataflash", "folder")
    assert bool(log.assumes) == several and not any("never changes faster" in a for a in log.assumes)


def twisted(tmp_path, kind, monkeypatch, changed):
    """A log whose stamps are those of rows ``changed`` gives, and its table."""
    monkeypatch.setattr(log_files, "T", log_files.T[changed])
    write, table = log_files.FORMATS[kind]
    if kind in ("sqlite", "sqlite_file", "mcap", "mcap_file"):
        monkeypatch.setattr(log_files.bag, "__defaults__", ("sqlite3", log_files.U, log_files.NS[changed]))
    return write(tmp_path), table


@pytest.mark.parametrize("kind", list(log_files.FORMATS))
def test_time_that_begins_anew_is_refused(tmp_path, kind, monkeypatch):
    words = sentence(*twisted(tmp_path, kind, monkeypatch, np.r_[:100, :100]))
    assert "must increase strictly" in words


@pytest.mark.parametrize("kind", list(log_files.FORMATS))
def test_one_stamp_that_goes_back_is_a_gap(tmp_path, kind, monkeypatch):
    """Row 50 has the stamp of row 48: itself and neighbours are left out, as many as make a gap."""
    order = np.arange(log_files.N)
    order[50] = 48
    path, table = twisted(tmp_path, kind, monkeypatch, order)
    log = read_log(path, mapping(table))
    away = np.setdiff1d(np.arange(log_files.N), np.round(log.t / 0.05).astype(int))
    assert 2 <= away.size <= 4 and 50 in away and np.ptp(away) == away.size - 1
    assert any("repeat, go back, jump or are missing" in n for n in log.notes) and any("gap" in n for n in log.notes)
    assert any("are right where they increase" in a for a in log.assumes)


@pytest.mark.parametrize("kind", list(log_files.FORMATS))
def test_an_infinite_value_is_refused(tmp_path, kind, monkeypatch):
    u = log_files.U.copy()
    u[7] = np.inf
    surge_velocity(monkeypatch, u)
    write, table = log_files.FORMATS[kind]
    assert "is infinite in row" in sentence(write(tmp_path), table)


@pytest.mark.parametrize("kind", list(log_files.FORMATS))
def test_a_missing_sample_stays_missing(tmp_path, kind, monkeypatch):
    u = log_files.U.copy()
    u[20:25] = np.nan
    surge_velocity(monkeypatch, u)
    write, table = log_files.FORMATS[kind]
    log = read_log(write(tmp_path), mapping(table))
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(log.columns["u"])), np.arange(20, 25))
    assert log.quality["u"].missing == 5 and log.quality["u"].longest == pytest.approx(0.3)
    assert any(n == "u misses 5 of 200 samples, at most 5 in a row" for n in log.notes)


@pytest.mark.parametrize("kind", list(log_files.FORMATS))
def test_a_channel_without_any_sample_is_refused(tmp_path, kind, monkeypatch):
    u = np.full(log_files.N, np.nan)
    surge_velocity(monkeypatch, u)
    write, table = log_files.FORMATS[kind]
    assert "column u has no sample at all" in sentence(write(tmp_path), table)


@pytest.mark.parametrize("kind", list(log_files.FORMATS))
def test_a_map_from_nothing_and_an_unknown_target_are_refused(tmp_path, kind):
    write, table = log_files.FORMATS[kind]
    path = write(tmp_path)
    columns = table.get("columns", {})
    words = sentence(path, {"columns": {**columns, "u": "nothing"}})
    assert "no column nothing, which [log] maps to u; it has" in words
    with pytest.raises(IvsidError, match="maps 'speed'"):
        read_log(path, mapping({"columns": {**columns, "speed": "u"}}))


def test_matlab_73_and_files_without_vectors(tmp_path):
    new = tmp_path / "new.mat"
    new.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64" + b" " * 100)
    assert "-v7" in sentence(new)
    words = tmp_path / "words.mat"
    savemat(words, {"name": "boat", "mass": 12.0})
    assert "no numeric vector" in sentence(words)


def test_matlab_structs_matrices_and_vectors_of_other_lengths(tmp_path):
    t, half = log_files.T, log_files.T[::2]
    path = tmp_path / "run.mat"
    savemat(
        path, {"imu": {"t": t, "gyro": {"z": log_files.R}}, "dvl": np.c_[half, log_files.U[::2]], "note": "sea trial"}
    )
    table = {
        "time": {"from": "t"},
        "columns": {"r": "imu/gyro.z", "u": {"from": "dvl(2)", "time": {"from": "dvl(1)"}}},
        "rates": {"u": 1.0},
    }
    log = read_log(path, mapping(table))
    np.testing.assert_array_equal(log.t, t)
    np.testing.assert_array_equal(log.columns["r"], log_files.R)
    off = np.abs(log.columns["u"] - log_files.U)
    there = np.isfinite(off)
    assert there.sum() == t.size - 1 and (off[there] <= log.error("u")[there]).all()


@pytest.mark.parametrize(
    ("kind", "package", "extra"),
    [("sqlite", "rosbags.highlevel", "ivsid[ros]"), ("dataflash", "pymavlink.DFReader", "ivsid[ardupilot]")],
)
def test_a_missing_optional_reader_is_named(tmp_path, kind, package, extra, monkeypatch):
    write, table = log_files.FORMATS[kind]
    path = write(tmp_path)
    real = importlib.import_module

    def without(name, *rest):
        if name == package:
            raise ModuleNotFoundError(name)
        return real(name, *rest)

    monkeypatch.setattr(importlib, "import_module", without)
    assert f"pip install '{extra}'" in sentence(path, table)


def test_a_header_without_a_stamp_counts_by_the_recorder(tmp_path, monkeypatch):
    from rosbags.rosbag2 import Writer

    real = Writer.write
    counter = iter(range(10**6))
    zero = np.zeros(log_files.N, dtype=np.int64)
    monkeypatch.setattr(
        Writer, "write", lambda self, c, _, data: real(self, c, int(log_files.NS[next(counter) // 3]), data)
    )
    log = read_log(log_files.bag(tmp_path / "bag", stamps=zero), mapping(log_files.BAG_MAP))
    np.testing.assert_allclose(log.t, log_files.T, atol=1e-9)


def test_a_stamp_keeps_every_digit(tmp_path):
    """Nanoseconds since 1970 need 61 bits; a double has 53."""
    stamps = log_files.NS + np.arange(log_files.N) % 7
    path = log_files.bag(tmp_path / "bag", stamps=stamps)
    log = read_log(path, mapping(log_files.BAG_MAP))
    exact = (stamps - stamps[0]) * 1e-9
    assert np.abs(log.t - exact).max() <= log.time_error
    # A recorder's CSV of the same stamps.
    text = "stamp,u\n" + "".join(f"{s},{u!r}\n" for s, u in zip(stamps.tolist(), log_files.U.tolist(), strict=True))
    (tmp_path / "log.csv").write_text(text)
    again = read_log(tmp_path / "log.csv", mapping({"time": {"from": "stamp", "unit": "ns"}}))
    assert np.abs(again.t - exact).max() <= again.time_error < 1e-12


def test_dates_in_parquet_are_not_taken_for_seconds(tmp_path):
    frame = log_files.frame().with_columns((pl.from_epoch(pl.Series("t", log_files.NS), "ns")).alias("t"))
    frame.write_parquet(tmp_path / "log.parquet")
    np.testing.assert_allclose(read_log(tmp_path / "log.parquet").t, log_files.T, atol=1e-9)
    frame.with_columns(pl.col("t").alias("u")).write_parquet(tmp_path / "dates.parquet")
    assert "not numbers" in sentence(tmp_path / "dates.parquet")


def test_more_cells_than_the_header_are_found_in_any_column(tmp_path):
    """Decimal commas shift every cell: also where only the first columns are used."""
    path = tmp_path / "log.csv"
    path.write_text("t,u,note,more\n" + "".join(f"{k},1,a,b\n" for k in range(50)) + "50,1,5,a,b\n")
    assert "not a readable CSV" in sentence(path)


def test_a_path_with_wildcards_is_one_file(tmp_path):
    log_files.csv(tmp_path / "a[1].csv")
    assert read_log(tmp_path / "a[1].csv").t.size == log_files.N
    assert "cannot be read" in sentence(tmp_path / "*.csv")


def test_padded_and_quoted_cells_are_numbers(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text('t , u\n0, 1.5 \n1,"2.5"\n2, nan\n3,+4e0\n')
    np.testing.assert_array_equal(read_log(path).columns["u"], [1.5, 2.5, np.nan, 4.0])


def test_a_column_that_stands_twice(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t,u,u\n0,1,2\n1,2,3\n")
    assert "column u more than once" in sentence(path)
    run = log_files.folder(tmp_path / "run")
    log_files.frame(u=log_files.U).write_csv(run / "gps.csv")
    words = sentence(run)
    assert "column u stands in dvl, gps" in words and "dvl/u" in words
    log = read_log(run, mapping({"columns": {"u": "gps/u"}}))
    assert "dvl/u" in log.ignored and not any(c.startswith("gps/u") for c in log.ignored)


def test_a_folder_without_tables_and_a_file_that_is_not_there(tmp_path):
    (tmp_path / "run").mkdir()
    assert "neither a ROS 2 bag" in sentence(tmp_path / "run")
    assert "cannot be read" in sentence(tmp_path / "none.csv")


def test_tables_below_a_folder_with_tables_of_its_own_are_noted(tmp_path):
    text = "t,u,v,r\n" + "".join(f"{0.1 * k:.1f},1,0,0\n" for k in range(40))
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "nav.csv").write_text(text)
    assert not [n for n in read_log(tmp_path / "run").notes if "below it" in n]
    (tmp_path / "run" / "imu").mkdir()
    (tmp_path / "run" / "imu" / "data.csv").write_text(text)
    (note,) = [n for n in read_log(tmp_path / "run").notes if "below it" in n]
    assert note.startswith("run has tables of its own, which are read, and 1 below it, which are not (imu/data.csv)")


@pytest.mark.parametrize("kind", list(log_files.FORMATS))
def test_the_one_log_below_a_folder_is_found(tmp_path, kind):
    below = tmp_path / "trials" / "day 1"
    below.mkdir(parents=True)
    write, table = log_files.FORMATS[kind]
    path = write(below)
    (below.parent / "notes.txt").write_text("calm")
    (below.parent / ".hidden").mkdir()
    (below.parent / ".hidden" / "old.csv").write_text("t,u\n0,1\n")
    found, given = (read_log(p, mapping(table)) for p in (tmp_path / "trials", path))
    np.testing.assert_array_equal(found.t, given.t)
    assert found.columns.keys() == given.columns.keys()


def test_a_folder_of_very_many_files_is_not_searched(tmp_path, monkeypatch):
    monkeypatch.setattr("ivsid.log.formats.MOST_FILES", 20)
    for k in range(21):
        (tmp_path / "disk" / f"{k}").mkdir(parents=True)
        (tmp_path / "disk" / f"{k}" / "notes.txt").write_text("calm")
    assert "has more than 20 files below it; give the folder of one log" in sentence(tmp_path / "disk")


def test_tables_in_folders_are_one_log_and_runs_in_folders_are_several(tmp_path):
    for k, columns in (("imu", ("r",)), ("dvl", ("u", "v"))):
        (tmp_path / "one" / k).mkdir(parents=True)
        log_files.frame(**{c: log_files.COLUMNS[c] for c in columns}).write_csv(tmp_path / "one" / k / "data.csv")
    log = read_log(tmp_path / "one")
    assert {"r", "u", "v"} <= log.columns.keys() and log.assumes
    for k in ("first", "second"):
        (tmp_path / "several" / k).mkdir(parents=True)
        log_files.csv(tmp_path / "several" / k / "log.csv")
    assert "holds 2 logs (first, second); give one of them" in sentence(tmp_path / "several")
    log_files.parquet(tmp_path / "one" / "log.mcap")
    assert "holds 3 logs (dvl, imu, log.mcap)" in sentence(tmp_path / "one")


def test_a_log_through_a_pipe(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    data = log_files.frame().write_csv().encode()
    writer = threading.Thread(target=lambda: path.write_bytes(data))
    writer.start()
    log = read_log(path)
    writer.join()
    np.testing.assert_array_equal(log.columns["u"], log_files.U)


def test_dataflash_instances_and_units_of_the_format(tmp_path):
    """Two IMUs in one message type, as ArduPilot logs them; centi-units of the format are scaled, stamps stay microseconds."""
    import struct

    def layout(number, size, name, form, labels):
        return struct.pack("<BBBBB4s16s64s", 0xA3, 0x95, 0x80, number, size, name, form, labels)

    parts = [
        layout(0x80, 89, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns"),
        layout(0x93, 3 + 8 + 1 + 16 + 16, b"FMTU", b"QBNN", b"TimeUS,FmtType,UnitIds,MultIds"),
        layout(0x91, 3 + 8 + 1 + 8 + 2, b"IMU", b"QBdc", b"TimeUS,I,GyrZ,Yaw"),
        struct.pack("<BBBQB16s16s", 0xA3, 0x95, 0x93, 1, 0x91, b"s#Ed", b"F-00"),
    ]
    for k, t in enumerate(log_files.T):
        for instance in (0, 1):
            us = round(t * 1e6) + 100 * instance
            parts.append(struct.pack("<BBBQBdh", 0xA3, 0x95, 0x91, us, instance, log_files.R[k] + instance, 150 * k))
    path = tmp_path / "log.bin"
    path.write_bytes(b"".join(parts))
    for instance in (0, 1):
        table = {"columns": {"r": f"IMU[{instance}]/GyrZ", "psi": {"from": f"IMU[{instance}]/Yaw", "unit": "deg"}}}
        log = read_log(path, mapping(table))
        np.testing.assert_array_equal(log.columns["r"], log_files.R + instance)
        np.testing.assert_allclose(log.t, log_files.T, atol=1e-9)
        np.testing.assert_allclose(log.columns["psi"], np.radians(1.5 * np.arange(log_files.N)), rtol=1e-12)
    assert "GyrZ stands in IMU[0], IMU[1]" in sentence(path, {"columns": {"r": "GyrZ"}})


def test_a_bag_by_the_command_line(tmp_path):
    """The whole way: a bag, its map in the vehicle file, and one sentence where a topic is not there."""
    from command_line import run
    from conftest import embedded

    path = log_files.bag(tmp_path / "bag", "mcap")
    columns = "".join(f'{k} = "{v}"\n' for k, v in log_files.BAG_MAP["columns"].items())
    vehicle = tmp_path / "boat.toml"
    text = embedded("swan.toml")
    vehicle.write_text(text + "\n[log.columns]\n" + columns)
    made = run("identify", vehicle, path, "--out", tmp_path / "fit")
    assert made.returncode == 2 and made.stderr.count("\n") == 1
    assert "no column demand_starboard (the demand of thruster starboard" in made.stderr
    vehicle.write_text(text + "\n[log.columns]\n" + columns + 'demand_starboard = "/port/data"\n')
    made = run("identify", vehicle, path, "--out", tmp_path / "fit", "--json")
    assert made.returncode == 0, made.stderr
    import json

    record = json.loads(made.stdout)
    assert record["quality"]["u"]["samples"] == log_files.N
    assert any("agree exactly" in a for a in record["assumes"])


def test_a_scale_that_overflows_names_the_column(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t,speed\n0,1\n1,2\n")
    words = sentence(path, {"columns": {"u": {"from": "speed", "scale": 1e308, "offset": 1e308}}})
    assert "column speed times its scale, plus its offset, is no finite number for u" in words
