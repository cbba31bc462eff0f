"""Clocks that begin anew: times of day past midnight, seconds of a day and of a week; and what is no new day."""

import tracemalloc

import numpy as np
import polars as pl
import pytest

from ivsid.errors import IvsidError
from ivsid.log import read_log
from ivsid.log.midnight import is_clock_face
from ivsid.log.stamps import times_of
from ivsid.proposal import propose

STEPS = np.arange(40)


def words(seconds):
    """Times of day as text, to milliseconds."""
    whole = np.round(np.asarray(seconds) * 1000).astype(int) % 86_400_000
    return [f"{q // 3_600_000:02d}:{q // 60_000 % 60:02d}:{q // 1000 % 60:02d}.{q % 1000:03d}" for q in whole.tolist()]


def read(stamps, unit=None):
    return times_of(pl.Series(stamps), unit, "log.csv", "time", 2, own=False)


@pytest.mark.parametrize("days", [1, 3])
def test_times_of_day_pass_each_midnight(days):
    true = 86_398.0 + np.linspace(0.0, 86_400.0 * (days - 1) + 4.0, 40 * days)
    made = read(words(true))
    assert np.abs(made.t - (np.round(true, 3) - np.round(true[0], 3))).max() <= made.lost + 1e-6 and made.rows is None
    (note,) = made.notes
    assert f"pass midnight at row {np.flatnonzero(np.diff(true // 86_400))[0] + 3}" in note and made.assumes


def test_a_sample_of_the_day_before_goes_back_over_midnight():
    true = 86_398.0 + 0.1 * STEPS
    true[25] = 86_399.95
    made = read(words(true))
    assert made.rows.size == 38 and made.t[-1] == pytest.approx(3.9, abs=1e-9)
    assert any("pass midnight" in n for n in made.notes) and any("left out" in n for n in made.notes)


def test_columns_of_times_and_empty_cells_pass_midnight_too():
    true = 86_399.0 + 0.1 * STEPS
    column = pl.Series(words(true)).str.to_time("%H:%M:%S%.3f")
    assert np.allclose(read(column).t, 0.1 * STEPS, atol=1e-9)
    cells = words(true)
    cells[20] = None
    made = read(cells)
    assert made.rows.size == 38 and made.t[-1] == pytest.approx(3.9, abs=1e-9)


@pytest.mark.parametrize(
    ("length", "kind"), [(86_400, "text"), (86_400, "double"), (604_800, "text"), (604_800, "double")]
)
def test_a_numeric_clock_begins_anew_after_a_day_or_a_week(length, kind):
    stamps = [f"{(length - 2.05 + 0.1 * k) % length:.2f}" for k in range(40)]
    series = pl.Series(stamps) if kind == "text" else pl.Series([float(s) for s in stamps])
    made = times_of(series, None, "log.csv", "sod", 2, own=False)
    assert np.abs(made.t - 0.1 * STEPS).max() <= made.lost and made.lost < 1e-9
    assert f"begins anew at row 23: {length} s are added" in made.notes[0]


@pytest.mark.parametrize(
    "stamps",
    [
        [*np.arange(10.0), *np.arange(10.0)],  # two runs in one file
        [*(86_000.0 + np.arange(10.0)), *np.arange(10.0)],  # a gap of minutes is no step of the clock
        [*(90_000.0 + np.arange(10.0)), *(3_600.0 + np.arange(10.0))],  # beyond a day
    ],
)
def test_stamps_that_fall_back_otherwise_are_refused(stamps):
    with pytest.raises(IvsidError, match="it must increase strictly"):
        read(pl.Series(stamps))


def test_a_day_is_not_added_where_half_a_day_is_lost():
    """A rise of more than half a day is a gap; only after a midnight it may be a sample of the day before."""
    made = read(words([3_600.0, 3_600.1, 80_000.0, 80_000.1]))
    assert made.t.tolist() == pytest.approx([0.0, 0.1, 76_400.0, 76_400.1]) and not made.notes


def test_a_log_over_midnight_is_proposed_and_read(tmp_path):
    t = 0.1 * STEPS
    rows = [f"{w},{np.sin(s):.5f},0.0,{np.cos(s):.5f},50,50" for w, s in zip(words(86_398.0 + t), t, strict=True)]
    path = tmp_path / "night.csv"
    path.write_text("\n".join(["utc_time,vx,vy,yaw_rate,demand_port,demand_starboard", *rows]) + "\n")
    made = propose([path])
    assert {n: f.match.column for n, f in made.channels.items()} == {"u": "vx", "v": "vy", "r": "yaw_rate"}
    log = read_log(path, made.mapped.checked)
    assert log.t[-1] == pytest.approx(3.9, abs=1e-9) and any("pass midnight" in n for n in log.notes)


def of_twelve(seconds):
    """The same times of day on a clock of twelve hours."""
    return [f"{(int(w[:2]) + 11) % 12 + 1:02d}{w[2:]} {'AM' if int(w[:2]) < 12 else 'PM'}" for w in words(seconds)]


@pytest.mark.parametrize("start", [43_198.0, 86_398.0])
def test_clocks_of_twelve_hours_pass_noon_and_midnight(start):
    made = read(of_twelve(start + 0.1 * STEPS))
    assert np.abs(made.t - 0.1 * STEPS).max() <= made.lost + 1e-12
    assert bool(made.notes) == (start > 43_200)
    with pytest.raises(IvsidError, match="is no time like"):
        read(["11:59:59 PM", "13:00:00 PM"])


@pytest.mark.parametrize(
    ("first", "second"), [("05/31/2024", "06/01/2024"), ("31/05/2024", "01/06/2024"), ("31-05-2024", "01-06-2024")]
)
def test_a_day_beyond_twelve_settles_the_order_of_day_and_month(first, second):
    made = read(
        [f"{first} 23:59:59.5", f"{second} 00:00:00.25", f"{second} 12:00:00 AM".replace("12:00:00 AM", "12:00:01 AM")]
    )
    assert made.t.tolist() == pytest.approx([0.0, 0.75, 1.5]) and made.first == pytest.approx(1_717_199_999.5)


def test_days_and_months_that_nothing_tells_apart_are_refused():
    for cells in (["05/06/2024 12:00:00", "05/06/2024 12:00:01"], ["31/05/2024 12:00:00", "05/31/2024 12:00:01"]):
        with pytest.raises(IvsidError, match="day and month cannot be told apart"):
            read(cells)


@pytest.mark.parametrize(("start", "step"), [(43_197.0, 0.1), (86_310.0, 1.0), (3_590.0, 5.0), (59.0, 0.5)])
def test_digits_of_a_clock_are_no_seconds(start, step):
    """12:00:00 as 120000: 59.9 is followed by 100, and the log would have a gap of 40 s a minute."""
    true = (start + step * np.arange(60)) % 86_400
    face = [w.replace(":", "") for w in words(true)]
    with pytest.raises(IvsidError, match="digits of a clock"):
        read([float(f) for f in face])
    # The same numbers without a full minute, and seconds with or without a gap, are what they were.
    assert read(0.5 * np.arange(90.0)).t.size == 90 and read(start + step * np.arange(60)).t.size == 60
    assert read([*np.arange(50.0), *(100.0 + np.arange(50.0)), *(260.0 + np.arange(30.0))]).t.size == 130


def test_stamps_of_a_long_log_are_not_copied_to_be_told_from_a_clock():
    """A hundred million rows have to fit into 2 GB; the copies of a whole column took more."""
    stamps = np.arange(1_000_000) * 1e-3
    tracemalloc.start()
    assert not is_clock_face(stamps)
    assert tracemalloc.get_traced_memory()[1] < 0.2 * stamps.nbytes
    tracemalloc.stop()


def test_short_floats_keep_their_rounding_where_a_clock_begins_anew():
    """Seconds of a day in 32 bits are off by up to 4 ms near midnight, the first stamp and any other."""
    true = 86_390.0 + np.arange(200) * 0.1
    stored = np.asarray(true % 86_400.0, dtype=np.float32)
    times = read(stored)
    assert any("begins anew" in n for n in times.notes)
    assert times.lost >= 2 * 0.5 * np.spacing(np.float32(86_399.0))
    assert (np.abs(times.t - (true - true[0])) <= times.lost).all()
