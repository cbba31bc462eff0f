"""Logs: formats, column maps, and one sentence for each fault."""

import gzip

import numpy as np
import polars as pl
import pytest

from ivsid import IvsidError, read_log
from ivsid.files.log_map import LogMap
from ivsid.log.quality import without_held

GOOD = "t,u,v,r,other\n0,1,0,0,x\n0.1,1.1,0,0.01,y\n0.2,1.2,nan,0.02,z\n0.3,1.3,,0.03,z\n"


def written(tmp_path, data, name="log.csv"):
    path = tmp_path / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def test_csv_gzip_and_parquet_are_the_same(tmp_path):
    plain = read_log(written(tmp_path, GOOD))
    packed = read_log(written(tmp_path, gzip.compress(GOOD.encode()), "log.csv.gz"))
    frame = pl.read_csv(GOOD.encode(), null_values=["nan"]).with_columns(pl.col("v").cast(pl.Float64))
    frame.write_parquet(tmp_path / "log.parquet")
    table = read_log(tmp_path / "log.parquet")
    for log in (packed, table):
        assert (log.t == plain.t).all()
        for name, column in plain.columns.items():
            np.testing.assert_array_equal(log.columns[name], column)
    assert plain.ignored == ("other",)
    assert any("v misses 2 of 4 samples, at most 2 in a row" in n for n in plain.notes)


def test_byte_order_mark_and_windows_line_ends(tmp_path):
    log = read_log(written(tmp_path, b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode()))
    assert list(log.columns) == ["u", "v", "r"]


def test_columns_are_mapped_scaled_and_turned(tmp_path):
    text = "stamp,uu,gz,vv\n" + "".join(f"{10**18 + k * 10**8},{k},{2 * k},{3 * k}\n" for k in range(4))
    mapping = LogMap.model_validate(
        {
            "columns": {"u": "uu", "r": {"from": "gz", "scale": -1.0, "unit": "deg/s"}, "v": "vv"},
            "time": {"from": "stamp", "unit": "ns"},
            "frame": "flu",
        }
    )
    log = read_log(written(tmp_path, text), mapping)
    np.testing.assert_allclose(log.t, [0.0, 0.1, 0.2, 0.3], rtol=1e-15)
    np.testing.assert_allclose(log.columns["r"], np.radians([0, 2, 4, 6]))
    np.testing.assert_allclose(log.columns["v"], [0, -3, -6, -9])
    assert (log.error("r") > np.spacing(np.abs(log.columns["r"]))).all()


def test_held_values_are_no_measurements(tmp_path):
    rng = np.random.default_rng(0)
    u = np.repeat(rng.standard_normal(40), 6)
    r = rng.standard_normal(240)
    text = "t,u,r\n" + "".join(f"{k / 6},{a},{b}\n" for k, (a, b) in enumerate(zip(u, r, strict=True)))
    log = read_log(written(tmp_path, text))
    assert np.isfinite(log.columns["u"]).sum() == 40
    assert np.isfinite(log.columns["r"]).all()
    assert any("u holds each value over 6 rows" in n for n in log.notes)


def test_a_vehicle_at_rest_is_not_held(tmp_path):
    text = "t,u\n" + "".join(f"{k},0\n" for k in range(100))
    assert np.isfinite(read_log(written(tmp_path, text)).columns["u"]).all()


@pytest.mark.parametrize(
    ("data", "parts"),
    [
        ("", ["is empty"]),
        ("   \n", ["is empty"]),
        ("t,u\n", ["0 rows", "at least 2"]),
        ("t,u\n0,1\n", ["1 row;", "at least 2"]),
        ("time_x,u\n0,1\n1,2\n", ["no column t"]),
        ("t,u\n0,1\n2,1\n1,1\n", ["time goes from 2 s to 1 s at row 4"]),
        ("t,u\n0,1\n0,1\n", ["must increase strictly"]),
        ("t,u\n0,1\n,1\n", ["time is missing in row 3"]),
        ("t,u\n0,1\n1,fast\n", ["column u holds 'fast' in row 3"]),
        ("t,u\n0,1\n1,inf\n", ["infinite in row 3"]),
        ("t,u\n0,\n1,\n", ["column u has no sample"]),
        ("t;u\n0;fast\n1;2\n", ["column u holds 'fast' in row 2"]),
        ("t,u\n0,1\n1,2,3\n", ["not a readable CSV"]),
        (bytes(range(256)) * 20, ["binary file"]),
        (b"\x89PNG\r\n\x1a\n" + b"\x00" * 64, ["binary file"]),
        (b"\x1f\x8bbroken", ["damaged gzip"]),
        (b"PAR1broken", ["not a readable CSV or Parquet"]),
    ],
)
def test_one_sentence_for_each_fault(tmp_path, data, parts):
    with pytest.raises(IvsidError) as caught:
        read_log(written(tmp_path, data))
    sentence = str(caught.value)
    assert "\n" not in sentence and "log.csv" in sentence
    for part in parts:
        assert part in sentence


def test_unknown_targets_of_a_map_are_refused(tmp_path):
    path = written(tmp_path, GOOD)
    with pytest.raises(IvsidError, match="maps 'speed'"):
        read_log(path, LogMap.model_validate({"columns": {"speed": "u"}}))
    with pytest.raises(IvsidError, match="no column nothing"):
        read_log(path, LogMap.model_validate({"columns": {"u": "nothing"}}))


def test_epochs_keep_their_digits(tmp_path):
    text = "t,u\n" + "".join(f"17{10**8 + k}.{123456 + 50 * k:06d},{k}\n" for k in range(4))
    log = read_log(written(tmp_path, text))
    np.testing.assert_allclose(np.diff(log.t), 1.00005, rtol=1e-13)


@pytest.mark.parametrize(("log_rate", "sensor_rate", "seconds"), [(6, 1, 8), (6, 5, 60), (6, 4.7, 60), (10, 3, 30)])
def test_sensors_a_little_slower_than_the_log_are_held(tmp_path, log_rate, sensor_rate, seconds):
    t = np.arange(seconds * log_rate) / log_rate
    u = np.sin(np.floor(t * sensor_rate + 1e-9) / sensor_rate)
    text = "t,u\n" + "".join(f"{a},{b}\n" for a, b in zip(t, u, strict=True))
    log = read_log(written(tmp_path, text))
    kept = np.isfinite(log.columns["u"])
    assert kept.sum() == len(np.unique(np.floor(t * sensor_rate + 1e-9)))
    assert any("holds each value" in n or "repeats its value" in n for n in log.notes)


def test_a_coarse_channel_that_is_alive_is_kept(tmp_path):
    rng = np.random.default_rng(1)
    r = np.round(rng.standard_normal(500) * 2.0)
    assert (np.diff(r) == 0).sum() > 30
    text = "t,r\n" + "".join(f"{k / 10},{b}\n" for k, b in enumerate(r))
    assert np.isfinite(read_log(written(tmp_path, text)).columns["r"]).all()


def test_a_time_column_with_a_unit_belongs_under_time(tmp_path):
    with pytest.raises(IvsidError, match="write time ="):
        read_log(written(tmp_path, GOOD), LogMap.model_validate({"columns": {"t": {"from": "t", "unit": "ms"}}}))


def slower(sensor_rate, log_rate=6.0, seconds=60.0):
    """The moment of the last reading at each row."""
    return np.floor(np.arange(0, seconds, 1 / log_rate) * sensor_rate + 1e-9) / sensor_rate


@pytest.mark.parametrize("fault", ["rest", "lost", "none"])
def test_a_slower_sensor_is_recognised_with_a_lost_reading_or_at_rest(fault):
    moment = slower(5.0)
    moment = np.where((moment > 20) & (moment < 20.7), 20.0, moment) if fault == "lost" else moment
    u = 0.5 * np.sin(0.5 * moment)
    u = np.where((moment > 20) & (moment < 22), 0.0, u) if fault == "rest" else u
    kept, repeats, note = without_held("u", u)
    assert repeats == (np.diff(u) == 0).sum() > 55 and np.isnan(kept).sum() == repeats and note


@pytest.mark.parametrize("chance", [0.02, 0.1, 0.2, 0.3, 0.4])
def test_a_live_channel_that_repeats_by_chance_keeps_its_values(chance):
    for seed in range(20):
        rng = np.random.default_rng(seed)
        u = np.cumsum(rng.uniform(size=600) > chance).astype(float)
        if np.unique(np.diff(np.flatnonzero(np.r_[1.0, np.diff(u)]))).size > 2:
            assert without_held("u", u)[1] == 0


@pytest.mark.parametrize(("scale", "noise"), [(0.008, 0.001), (0.045, 0.01), (0.1, 0.0)])
def test_a_live_channel_on_a_coarse_scale_keeps_its_values(scale, noise):
    """A speed log of few decimals changes by one of them at any time; most of its rows repeat."""
    t = np.arange(0, 600, 0.1)
    for seed in range(10):
        rng = np.random.default_rng(seed)
        live = np.sin(0.04 * t + rng.uniform(0, 6)) + 0.3 * np.sin(0.11 * t) + noise * rng.standard_normal(t.size)
        u = np.round(live / scale) * scale
        assert (np.diff(u) == 0).sum() > t.size / 3
        assert without_held("u", u)[1] == 0


@pytest.mark.parametrize("period", [2, 2.5, 4, 4.7, 20])
@pytest.mark.parametrize("scale", [0.001, 0.02])
def test_a_slower_sensor_of_a_vehicle_at_rest_is_held(period, scale):
    """Its readings are one decimal or two apart, and equal to each other as often as not: they keep their time."""
    reading = np.floor(np.arange(6000) / period + 1e-9).astype(int)
    for seed in range(10):
        noise = np.random.default_rng(seed).standard_normal(reading[-1] + 1)
        u = (np.round(0.35 * noise / np.abs(noise).mean()) * scale)[reading]
        assert without_held("u", u)[1] == (np.diff(u) == 0).sum()


def test_what_held_values_rest_on_is_said(tmp_path):
    moment = slower(2.0)
    frame = pl.DataFrame({"t": np.arange(moment.size) / 6, "u": np.sin(moment), "v": np.cos(np.arange(moment.size))})
    frame.write_csv(tmp_path / "log.csv")
    assert read_log(tmp_path / "log.csv").assumes == ("the first of equal values of u is a measurement at its row",)


def test_what_equal_values_on_a_coarse_scale_rest_on_is_said(tmp_path):
    """A slower sensor that changes by one step at any time would look alike, so that a proof states what it takes them for."""
    t = np.arange(0, 600, 0.1)
    u = np.round((np.sin(0.04 * t) + 0.3 * np.sin(0.11 * t)) / 0.1) * 0.1
    pl.DataFrame({"t": t, "u": u, "v": np.cos(t)}).write_csv(tmp_path / "log.csv")
    log = read_log(tmp_path / "log.csv")
    said = "equal values of u, which changes by one step of its scale at any time, are measurements at their rows"
    assert log.assumes == (said,) and any("u is on a coarse scale" in n for n in log.notes)
    assert np.isfinite(log.columns["u"]).all()


def test_a_header_of_letters_without_names_is_text(tmp_path):
    (tmp_path / "log.csv").write_text(
        "t,u,\ud7fc\ud7fc\U00011daa\U0001342f\U00018cd6\n0,1,0\n1,2,0\n2,1,0\n", encoding="utf-8"
    )
    log = read_log(tmp_path / "log.csv")
    assert log.ignored == ("\ud7fc\ud7fc\U00011daa\U0001342f\U00018cd6",) and log.columns["u"].tolist() == [
        1.0,
        2.0,
        1.0,
    ]
