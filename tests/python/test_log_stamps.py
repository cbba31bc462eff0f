"""Stamps: what doubles, decimals and integers keep of a moment."""

import datetime
from fractions import Fraction

import numpy as np
import polars as pl
import pytest

from ivsid import IvsidError, read_log
from ivsid.log.clocks import between
from log_files import log_map

NS = 1_700_000_000_123_456_789 + np.arange(500) * 100_000_003


def worst(log, truth):
    return max(abs(Fraction(float(t)) - w) for t, w in zip(log.t, truth, strict=True))


@pytest.mark.parametrize(("unit", "scale"), [("s", 10**9), ("ms", 10**6), ("us", 10**3)])
def test_stamps_in_doubles_know_what_they_lost(tmp_path, unit, scale):
    """Epochs of nanoseconds, divided as everybody does: rounded twice."""
    pl.DataFrame({"t": NS / scale, "u": np.sin(0.1 * np.arange(500))}).write_parquet(tmp_path / "log.parquet")
    log = read_log(tmp_path / "log.parquet", log_map(time={"from": "t", "unit": unit}))
    assert worst(log, [Fraction(int(n - NS[0]), 10**9) for n in NS]) <= log.time_error < 7e-7


def test_integer_stamps_of_a_matlab_file_keep_every_digit(tmp_path):
    from scipy.io import savemat

    savemat(tmp_path / "log.mat", {"t": NS, "u": np.sin(0.1 * np.arange(500))})
    log = read_log(tmp_path / "log.mat", log_map(time={"from": "t", "unit": "ns"}))
    assert worst(log, [Fraction(int(n - NS[0]), 10**9) for n in NS]) <= log.time_error < 1e-12


def test_times_of_day_dates_and_truth_values_as_stamps(tmp_path):
    u = np.sin(np.arange(10.0))
    pl.DataFrame({"t": [datetime.time(12, 0, 0, 100000 * k) for k in range(10)], "u": u}).write_parquet(
        tmp_path / "a.parquet"
    )
    np.testing.assert_allclose(read_log(tmp_path / "a.parquet").t, 0.1 * np.arange(10), atol=1e-12)
    pl.DataFrame({"t": [datetime.date(2024, 1, k + 1) for k in range(10)], "u": u}).write_parquet(
        tmp_path / "b.parquet"
    )
    np.testing.assert_allclose(read_log(tmp_path / "b.parquet").t, 86400.0 * np.arange(10))
    pl.DataFrame({"t": [k > 4 for k in range(10)], "u": u}).write_parquet(tmp_path / "c.parquet")
    with pytest.raises(IvsidError, match="column t holds true and false, not times"):
        read_log(tmp_path / "c.parquet")
    short = (0.1 * np.arange(2000)).astype(np.float32)
    pl.DataFrame({"t": short, "u": np.sin(np.arange(2000.0))}).write_parquet(tmp_path / "d.parquet")
    log = read_log(tmp_path / "d.parquet")
    assert worst(log, [Fraction(k, 10) for k in range(2000)]) <= log.time_error


def test_two_clocks_with_one_zero_keep_the_rounding_of_both(tmp_path):
    """One clock counts milliseconds, the other has plain seconds near 9e5."""
    seconds = [Fraction(9_000_000 + k, 10) + Fraction(1, 1000) for k in range(300)]
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "imu.csv").write_text(
        "t,r\n" + "\n".join(f"{float(x):.4f},{0.1 * np.sin(0.1 * k):.4f}" for k, x in enumerate(seconds))
    )
    (tmp_path / "run" / "dvl.csv").write_text(
        "ms,u,v\n" + "\n".join(f"{900_000_000 + 37 * k},{np.sin(0.01 * k):.4f},0.1" for k in range(900))
    )
    columns = {n: {"from": f"dvl/{n}", "time": {"from": "dvl/ms", "unit": "ms"}} for n in "uv"}
    log = read_log(tmp_path / "run", log_map(columns=columns, base="imu", rates={"u": 1.0, "v": 1.0}))
    assert worst(log, [x - 900_000 for x in seconds]) <= log.time_error < 1e-9


def test_stamps_of_one_clock_are_rounded_too():
    """A saw tooth as fast as it may be, at stamps whose decimals were rounded near 1e6 s."""
    step, rate, n = Fraction(1, 10), Fraction(1, 2), 400
    t = np.array([float(999_000 + step * k) for k in range(n)])
    truth = [1 + (rate * step if k % 2 else 0) for k in range(n)]
    keep = np.arange(n) % 2 == 0
    line, reach = between(t, t[keep], np.array([float(x) for x in truth])[keep], np.zeros(keep.sum()), float(rate), 0.0)
    for k in range(n - 1):
        assert abs(Fraction(float(line[k])) - truth[k]) <= Fraction(float(reach[k])) + Fraction(1, 2**52)
