"""Stamps as people write them: dates, times of day, epochs without a unit, and seconds and nanoseconds in two columns."""

import datetime
from fractions import Fraction

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ivsid import IvsidError, read_log
from ivsid.log.dates import is_date, nanoseconds
from log_files import log_map

EPOCH = datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)
FORMS = (
    lambda d, f: f"{d:%Y-%m-%dT%H:%M:%S}.{f}Z",
    lambda d, f: f"{d:%Y-%m-%d %H:%M:%S},{f}",
    lambda d, f: f"{d:%Y/%m/%d %H:%M:%S}.{f}",
    lambda d, f: f"{d:%d.%m.%Y %H:%M:%S}.{f}",
    lambda d, f: f" {d:%Y-%m-%d %H:%M:%S}.{f} UTC",
)


def written(path, stamps, column="t"):
    path.write_text(f"{column},u\n" + "\n".join(f"{s},{np.sin(0.1 * k):.4f}" for k, s in enumerate(stamps)) + "\n")
    return path


@settings(max_examples=200, deadline=None)
@given(
    st.datetimes(datetime.datetime(1950, 1, 1), datetime.datetime(2200, 1, 1)),
    st.text("0123456789", min_size=1, max_size=9),
    st.integers(0, len(FORMS) - 1),
    st.integers(-14 * 60, 14 * 60),
)
def test_a_date_keeps_every_digit(moment, fraction, form, zone):
    moment = moment.replace(microsecond=0)
    text = FORMS[form](moment, fraction)
    whole = round((moment.replace(tzinfo=datetime.UTC) - EPOCH).total_seconds()) * 10**9
    want = whole + int(fraction.ljust(9, "0"))
    assert is_date(text) and nanoseconds(pl.Series([text]), "t", "a.csv", 2).to_list() == [want]
    if not text.strip().endswith(("Z", "UTC")):
        away = f"{text}{'-' if zone < 0 else '+'}{abs(zone) // 60:02d}:{abs(zone) % 60:02d}"
        assert nanoseconds(pl.Series([away]), "t", "a.csv", 2).to_list() == [want - zone * 60 * 10**9]


def test_a_log_with_dates_is_the_log_with_seconds(tmp_path):
    start = datetime.datetime(2024, 5, 31, 23, 59, 58)
    dates = [f"{start + datetime.timedelta(seconds=k // 10):%Y-%m-%d %H:%M:%S}.{k % 10}" for k in range(60)]
    log = read_log(written(tmp_path / "a.csv", dates))
    plain = read_log(written(tmp_path / "b.csv", [f"{k / 10}" for k in range(60)]))
    assert max(abs(Fraction(float(t)) - Fraction(k, 10)) for k, t in enumerate(log.t)) <= log.time_error < 1e-9
    np.testing.assert_array_equal(log.columns["u"], plain.columns["u"])
    of_day = read_log(written(tmp_path / "c.csv", [f"9:{k // 60:02d}:{k % 60:02d}" for k in range(90)]))
    np.testing.assert_allclose(of_day.t, np.arange(90.0))


@pytest.mark.parametrize(
    ("stamps", "words"),
    [
        (["05/06/2024 10:00:00", "05/06/2024 10:00:01"], "day and month cannot be told apart"),
        (["2024-05-31 10:00:00", "2024-05-31 soon"], "'2024-05-31 soon' in row 3"),
        (["2024-02-29 10:00:00", "2023-02-29 10:00:01"], "'2023-02-29 10:00:01' in row 3"),
        (["2024-05-31 10:00:00.1234567891", "2024-05-31 10:00:01"], "at most 9 decimals"),
        (["monday", "tuesday"], "column t holds 'monday' in row 2, which is no number"),
    ],
)
def test_words_that_are_no_date(tmp_path, stamps, words):
    with pytest.raises(IvsidError, match=words.replace("(", r"\(")):
        read_log(written(tmp_path / "a.csv", stamps))


@pytest.mark.parametrize(("unit", "size"), [("ns", 10**9), ("us", 10**6), ("ms", 10**3), ("s", 1)])
def test_the_size_of_an_epoch_says_its_unit(tmp_path, unit, size):
    stamps = [1_700_000_000 * size + k * size for k in range(50)]
    log = read_log(written(tmp_path / "a.csv", stamps))
    np.testing.assert_allclose(log.t, np.arange(50.0), atol=1e-9)
    assert any(f"t counts {unit} since 1970" in n for n in log.notes) == (unit != "s")
    assert any(f"stamps t count {unit}" in a for a in log.assumes) == (unit != "s")
    # A stated unit is believed: here stamps of an odd zero.
    stated = read_log(written(tmp_path / "b.csv", stamps), log_map(time={"from": "t", "unit": "s"}))
    np.testing.assert_allclose(stated.t, size * np.arange(50.0), atol=1e-9)


@pytest.mark.parametrize(
    ("first", "step"),
    [
        # Nanoseconds and microseconds since a computer began, which are no milliseconds since 1970.
        (130 * 10**9, 10**7),
        (3 * 86400 * 10**6, 10**4),
        # A date in milliseconds, and steps of an hour.
        (1_700_000_000_000, 3_600_000),
    ],
)
def test_large_stamps_that_are_no_epoch_need_a_unit(tmp_path, first, step):
    path = written(tmp_path / "a.csv", [first + step * k for k in range(50)])
    with pytest.raises(
        IvsidError, match=r"neither seconds nor ms, us or ns since 1970; state their unit: time = \{ from = \"t\""
    ):
        read_log(path)
    log = read_log(path, log_map(time={"from": "t", "unit": "ns"}))
    np.testing.assert_allclose(log.t, step * 1e-9 * np.arange(50.0), rtol=1e-9)


def test_seconds_and_nanoseconds_in_two_columns(tmp_path):
    ns = 1_700_000_000_987_654_321 + np.arange(60) * 100_000_003
    path = tmp_path / "a.csv"
    pl.DataFrame({"stamp.sec": ns // 10**9, "stamp.nanosec": ns % 10**9, "u": np.sin(np.arange(60.0))}).write_csv(path)
    log = read_log(path, log_map(time={"from": "stamp.sec", "nanoseconds": "stamp.nanosec"}))
    off = [abs(Fraction(float(t)) - Fraction(int(n - ns[0]), 10**9)) for t, n in zip(log.t, ns, strict=True)]
    assert max(off) <= log.time_error < 1e-12
    with pytest.raises(IvsidError, match="no column nanos, the nanoseconds of"):
        read_log(path, log_map(time={"from": "stamp.sec", "nanoseconds": "nanos"}))
    with pytest.raises(IvsidError, match="needs whole numbers"):
        read_log(path, log_map(time={"from": "stamp.sec", "nanoseconds": "u"}))
    with pytest.raises(IvsidError, match="no nanoseconds of a second"):
        read_log(path, log_map(time={"from": "stamp.nanosec", "nanoseconds": "stamp.sec"}))
    pl.DataFrame({"sec": 10**10 + np.arange(60), "nanosec": np.arange(60), "u": np.ones(60)}).write_csv(path)
    with pytest.raises(
        IvsidError, match=r"column sec goes up to 1e\+10, which are no seconds beside nanoseconds in nanosec"
    ):
        read_log(path, log_map(time={"from": "sec", "nanoseconds": "nanosec"}))


@pytest.mark.parametrize("zero", [25569, 719529])
@pytest.mark.parametrize("separator", [",", ";"])
def test_days_of_a_spreadsheet_or_matlab_are_told_by_their_size(tmp_path, zero, separator):
    """Ten samples a second from the noon of 2024-05-31, whose day is 19874 since 1970."""
    rows = [f"{zero + 19874.5 + k / 864000:.10f}{separator}{k}.5" for k in range(50)]
    path = tmp_path / "run.csv"
    path.write_text(f"t{separator}u\n" + "\n".join(rows).replace(".", "," if separator == ";" else ".") + "\n")
    log = read_log(path)
    np.testing.assert_allclose(log.t, np.arange(50) / 10, atol=1e-5)
    assert log.began == pytest.approx((19874.5) * 86400, abs=1e-4)
    assert log.time_rounding > 0 and any("t counts days, as" in n for n in log.notes)
    assert any("count days" in a for a in log.assumes)


def test_seconds_of_a_clock_that_has_run_for_hours_are_no_days(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("t,u\n" + "".join(f"{45443.5 + k / 1000},{k}\n" for k in range(50)))
    np.testing.assert_allclose(read_log(path).t, 45443.5 + np.arange(50) / 1000)


def test_days_with_too_few_decimals_say_what_to_do(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("t,u\n" + "".join(f"{45443.5 + k / 864000:.5f},{k}\n" for k in range(50)))
    with pytest.raises(IvsidError, match=r"stamps stand 0\.864 s apart and repeat; give the column nine decimals"):
        read_log(path)
