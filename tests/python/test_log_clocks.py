"""Several clocks and rates on one: what is interpolated holds the truth, and what has no stated bound stays missing."""

import itertools
from fractions import Fraction

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ivsid import IvsidError, identify, read_log
from ivsid.log.clocks import between, held
from ivsid.sensors.bounds import bound_log
from ivsid.vehicle import parse_vehicle
from log_files import log_map, rows_at, two_tables

RATE = 0.9


def truth_u(t):
    return 0.8 * np.sin(RATE / 0.8 * t)  # never faster than RATE a second


def folder(path, step=0.2, delay=0.013, seconds=20.0):
    """A Doppler log at 5 Hz, a gyro at 20 Hz, and a demand that changes when it likes."""
    path.mkdir()
    fast, slow = np.arange(0, seconds, 0.05), np.arange(0, seconds, step) + delay
    when = np.array([0.0, 3.33, 3.35, 7.0, 15.01])
    pl.DataFrame({"t": fast, "r": 0.2 * np.cos(fast)}).write_csv(path / "gyro.csv")
    pl.DataFrame({"t": slow, "u": truth_u(slow), "v": 0.1 * truth_u(slow)}).write_csv(path / "dvl.csv")
    pl.DataFrame({"t": when, "demand_port": [20.0, 40.0, 25.0, 60.0, 10.0]}).write_csv(path / "port.csv")
    return path


def test_between_samples_the_truth_is_inside_and_the_bound_is_stated(tmp_path):
    log = read_log(folder(tmp_path / "run"), log_map(rates={"u": RATE, "v": 0.1}, base="gyro"))
    there = np.isfinite(log.columns["u"])
    assert there.sum() > 380
    off = np.abs(log.columns["u"] - truth_u(log.t))
    assert (off[there] <= log.error("u")[there]).all()
    # 2 L a b / (a + b) is at most L h / 2
    assert log.error("u").max() <= RATE * 0.1 * (1 + 1e-9)
    assert any("u never changes faster than 0.9 a second" in a for a in log.assumes)
    assert any("clocks dvl/t, gyro/t, port/t agree exactly" in a for a in log.assumes)
    assert log.clocks["u"].samples == 100 and log.clocks["u"].interval == pytest.approx(0.2)


def test_without_a_rate_nothing_is_interpolated(tmp_path):
    path = folder(tmp_path / "run")
    with pytest.raises(IvsidError, match=r"no sample of u stands on the clock of the rows; state under \[log\] rates"):
        read_log(path, log_map(base="gyro"))
    aligned = folder(tmp_path / "aligned", delay=0.0)
    log = read_log(aligned, log_map(base="gyro"))
    kept = np.isfinite(log.columns["u"])
    assert kept.sum() == 100 and set(log.clocks) == {"u", "v"}
    np.testing.assert_array_equal(log.columns["u"][kept], truth_u(log.t[kept]))
    assert any("u stands on another clock than the rows and is missing on 300 of 400" in n for n in log.notes)


def test_a_gap_is_not_bridged(tmp_path):
    path = folder(tmp_path / "run")
    dvl = pl.read_csv(path / "dvl.csv").filter((pl.col("t") < 5) | (pl.col("t") > 9))
    dvl.write_csv(path / "dvl.csv")
    log = read_log(path, log_map(rates={"u": RATE, "v": 0.1}, base="gyro"))
    inside = (log.t > 5.0) & (log.t < 9.0)
    assert np.isnan(log.columns["u"][inside]).all()
    assert log.quality["u"].longest == pytest.approx(4.2, abs=0.21)


def test_clocks_that_may_disagree_widen_the_interval(tmp_path):
    path = folder(tmp_path / "run")
    exact = read_log(path, log_map(rates={"u": RATE, "v": 0.1}, base="gyro"))
    loose = read_log(path, log_map(rates={"u": RATE, "v": 0.1}, base="gyro", clock_error=0.05))
    there = np.isfinite(exact.columns["u"])
    extra = (loose.error("u") - exact.error("u"))[there]
    np.testing.assert_allclose(extra, RATE * 0.05, rtol=1e-9)
    # The Doppler log's clock is 0.04 s ahead: its samples are older than they say.
    late = np.abs(loose.columns["u"] - truth_u(log_t := loose.t - 0.04))
    assert (late[there] <= loose.error("u")[there]).all() and log_t.size
    assert any("agree to within 0.05 s" in a for a in loose.assumes)


def test_a_demand_that_changes_within_a_row_is_an_interval(tmp_path):
    log = read_log(folder(tmp_path / "run"), log_map(rates={"r": 0.2}, base="dvl"))
    demand, off = log.columns["demand_port"], log.error("demand_port")
    k = int(np.searchsorted(log.t, 3.33)) - 1  # holds 20, then 40, then 25
    assert demand[k] - off[k] <= 20 and demand[k] + off[k] >= 40
    assert demand[k + 1] == 25 and off[k + 1] < 1e-9
    assert any("demand_port changes within 3 of" in n for n in log.notes)


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_held_and_between_hold_every_truth(data):
    """Against a truth that is drawn: piecewise constant demands, and the extreme curve of a stated rate."""
    steps = data.draw(st.lists(st.floats(0.01, 1.0), min_size=3, max_size=20))
    t = np.cumsum(steps)
    rows = np.sort(
        np.array(data.draw(st.lists(st.floats(0.0, float(t[-1]) + 0.5), min_size=2, max_size=20, unique=True)))
    )
    values = np.array(data.draw(st.lists(st.floats(-5, 5), min_size=t.size, max_size=t.size)))
    middle, off = held(rows, t, values, 0.0)
    for k, row in enumerate(rows):
        end = rows[k + 1] if k + 1 < rows.size else row
        if row < t[0]:
            assert np.isnan(middle[k])
            continue
        if np.isnan(middle[k]):
            # A hole of more than 2.5 usual steps hides what was demanded in it: a row there is missing, which it was not before.
            longest = 2.5 * np.median(np.diff(t))
            holes = [(a + longest, b) for a, b in itertools.pairwise(t) if b - a > longest]
            assert row > t[-1] or any(a < row < b or (row < b and a < end) for a, b in holes)
            continue
        for moment in (row, *[x for x in t if row < x < end]):
            now = values[np.searchsorted(t, moment, side="right") - 1]
            assert middle[k] - off[k] <= now <= middle[k] + off[k]
    # The fastest way from sample to sample: as slow and as fast as the rate allows, in multiples of a power of two.
    t = np.cumsum(data.draw(st.lists(st.integers(1, 64), min_size=3, max_size=20))) / 64
    rate, fine = 2.0, np.arange(0, 64 * t[-1] + 1) / 64
    turns = data.draw(st.lists(st.sampled_from([-1.0, 1.0, 0.25]), min_size=fine.size - 1, max_size=fine.size - 1))
    curve = np.r_[0.0, np.cumsum(np.array(turns) * rate / 64)]
    samples = curve[np.searchsorted(fine, t)]
    line, reach = between(rows, t, samples, np.zeros(t.size), rate, 0.0)
    for row, middle_, off_ in zip(rows, line, reach, strict=True):
        if np.isfinite(middle_):
            k = min(int(row * 64), fine.size - 2)
            truth = Fraction(curve[k]) + Fraction(turns[k]) * 2 * (Fraction(row) - Fraction(fine[k]))
            assert abs(Fraction(middle_) - truth) <= Fraction(off_)
    assert np.isnan(line[(rows < t[0]) | (rows > t[-1])]).all()


def test_a_sensor_s_own_stamps_in_one_table(tmp_path):
    """A wide log whose rows repeat the last Doppler reading with its own stamp."""
    t = np.arange(0, 30, 0.1)
    own = np.floor(t / 0.5) * 0.5 - 0.03
    pl.DataFrame({"t": t, "r": np.cos(t), "speed": truth_u(own), "stamp": own}).write_csv(tmp_path / "log.csv")
    columns = {"u": {"from": "speed", "time": {"from": "stamp"}}}
    log = read_log(tmp_path / "log.csv", log_map(columns=columns, rates={"u": RATE}, base="r"))
    there = np.isfinite(log.columns["u"])
    assert there.sum() > 280 and log.clocks["u"].samples == 60
    assert (np.abs(log.columns["u"] - truth_u(log.t))[there] <= log.error("u")[there]).all()


def test_the_base_decides_the_rows_and_a_wrong_one_is_refused(tmp_path):
    path = folder(tmp_path / "run")
    assert read_log(path, log_map(rates={"r": 0.3}, base="u")).t.size == 100
    words = read_log(path, log_map(rates={"u": RATE, "v": 0.1})).notes
    assert any("the rows are the samples of gyro/t" in n for n in words)
    with pytest.raises(IvsidError, match="base = 'sonar' is neither a channel nor a table"):
        read_log(path, log_map(base="sonar"))
    with pytest.raises(IvsidError, match="rates has 'speed'"):
        read_log(path, log_map(rates={"speed": 1.0}))
    with pytest.raises(IvsidError, match='demand = "linear" is not available'):
        read_log(path, log_map(rates={"u": 1.0}, demand="linear"))


def test_clocks_without_a_common_zero_are_refused(tmp_path):
    """One computer counts from 1970, the other from when it was switched on."""
    path = folder(tmp_path / "run")
    dvl = pl.read_csv(path / "dvl.csv").with_columns(pl.col("t") + 1.7e9)
    dvl.write_csv(path / "dvl.csv")
    with pytest.raises(IvsidError, match="never run at the same time; they count from different zeros"):
        read_log(path, log_map(rates={"u": RATE, "v": 0.1}, base="gyro"))


def test_one_zero_for_all_epochs(tmp_path):
    path = folder(tmp_path / "run")
    plain = read_log(path, log_map(rates={"u": RATE, "v": 0.1}, base="gyro"))
    for name in ("dvl", "gyro", "port"):
        pl.read_csv(path / f"{name}.csv").with_columns(pl.col("t") + 1.7e9).write_csv(path / f"{name}.csv")
    log = read_log(path, log_map(rates={"u": RATE, "v": 0.1}, base="gyro"))
    np.testing.assert_allclose(log.t, plain.t, atol=3e-7)
    np.testing.assert_allclose(log.columns["u"], plain.columns["u"], atol=1e-6)


def test_a_heading_is_interpolated_across_its_wrap(tmp_path):
    t, slow = np.arange(0, 20, 0.1), np.arange(0, 20, 0.5)
    psi = np.arctan2(np.sin(0.6 * slow), np.cos(0.6 * slow))
    (tmp_path / "run").mkdir()
    pl.DataFrame({"t": t, "r": 0.6 + 0 * t}).write_csv(tmp_path / "run" / "gyro.csv")
    pl.DataFrame({"t": slow, "psi": psi}).write_csv(tmp_path / "run" / "compass.csv")
    log = read_log(tmp_path / "run", log_map(rates={"psi": 0.7}, base="gyro"))
    there = np.isfinite(log.columns["psi"])
    off = np.angle(np.exp(1j * (log.columns["psi"] - 0.6 * log.t)))
    assert (np.abs(off)[there] <= log.error("psi")[there]).all()
    assert np.abs(log.columns["psi"][there]).max() <= np.pi
    gappy = pl.read_csv(tmp_path / "run" / "compass.csv").filter((pl.col("t") < 4) | (pl.col("t") > 13))
    gappy.write_csv(tmp_path / "run" / "compass.csv")
    again = read_log(tmp_path / "run", log_map(rates={"psi": 0.7}, base="gyro"))
    inside = (again.t > 4) & (again.t < 13)
    assert np.isnan(again.columns["psi"][inside]).all()
    off = np.angle(np.exp(1j * (again.columns["psi"] - 0.6 * again.t)))[np.isfinite(again.columns["psi"])]
    assert (np.abs(off) <= again.error("psi")[np.isfinite(again.columns["psi"])]).all()
    with pytest.raises(IvsidError, match="half a circle"):
        read_log(tmp_path / "run", log_map(rates={"psi": 7.0}, base="gyro"))


def test_a_faster_gyro_keeps_its_own_noise(tmp_path):
    """White noise is bounded by the sensor's own step, not by that of slower rows, and every sample of it counts."""
    path = folder(tmp_path / "run")
    vehicle = parse_vehicle(
        'name = "a"\n[hull]\nmass = 1\n[sensors.yaw_rate]\nrandom_walk = 1e-3\n[sensors.velocity]\naccuracy = 0.01\n',
        "a.toml",
    )
    log = read_log(path, log_map(rates={"r": 0.3}, base="dvl"))
    bounded = bound_log(log, vehicle)
    half = (bounded.channels["r"].upper - bounded.channels["r"].lower)[5] / 2 - log.error("r")[5]
    assert bounded.rule.errors == log.clocks["r"].samples == 400 > log.t.size
    assert half == pytest.approx(bounded.rule.sigmas * 1e-3 / np.sqrt(0.05), rel=1e-6)


def test_fewer_rows_than_samples_keep_the_noise_of_the_sensor(tmp_path):
    """In one table, with the Doppler log's samples as rows, a gyro reading is no average over the row."""
    t = np.arange(0, 60, 0.1)
    u = truth_u(np.floor(t))
    pl.DataFrame({"t": t, "u": u, "r": np.cos(t)}).write_csv(tmp_path / "log.csv")
    vehicle = parse_vehicle('name = "a"\n[hull]\nmass = 1\n[sensors.yaw_rate]\nrandom_walk = 1e-3\n', "a.toml")
    log = read_log(tmp_path / "log.csv", log_map(base="u"))
    assert log.t.size == 60 and log.period == pytest.approx(1.0)
    bounded = bound_log(log, vehicle)
    half = (bounded.channels["r"].upper - bounded.channels["r"].lower)[5] / 2
    assert half == pytest.approx(bounded.rule.sigmas * 1e-3 / np.sqrt(0.1), rel=1e-6)
    assert bounded.rule.errors == 600


def test_two_clocks_identify_the_truth(tmp_path, swan):
    """A simulated trial, logged by two computers, gives intervals that hold the truth; and says what it assumed."""
    from conftest import embedded
    from ivsid.programme.scenario import parse_scenario
    from ivsid.simulation import simulate

    scenario = parse_scenario(embedded("swan_train.toml"), "s").model_copy(
        update={"duration": 60.0, "noise": "uniform"}
    )
    made = simulate(swan, scenario, 3)
    t, c = made.t, made.columns
    run = tmp_path / "run"
    run.mkdir()
    imu = {k: c[k] for k in ("r", "ax", "ay", *(d for d in c if d.startswith("demand_")))}
    pl.DataFrame({"t": t, **imu}).write_csv(run / "imu.csv")
    pl.DataFrame({"t": t[::2], "u": c["u"][::2], "v": c["v"][::2]}).write_csv(run / "dvl.csv")
    log = read_log(run, log_map(rates={"u": 2.6, "v": 2.6}, base="imu"))
    fit = identify(swan, log)
    assert fit.status == "enclosed" and fit.guaranteed
    for id_, p in fit.parameters.items():
        assert p.lower <= made.truth["parameters"][id_] <= p.upper
    assert any("never changes faster than 2.6" in a for a in fit.assumes)
    assert any("clocks dvl/t, imu/t agree exactly" in a for a in fit.assumes)


def test_a_heading_whose_way_round_is_not_certain_is_refused(tmp_path):
    """3 rad between samples and an error of 0.1 rad: 3.2 and -3.08 cannot be told apart."""
    rate, slow, t = 3.0, np.arange(0, 10, 1.0), np.arange(0.5, 9, 1.0)
    psi = rate * slow + 0.1 * np.where(np.arange(10) % 2, 1, -1)
    heading = {"t": slow, "psi": np.arctan2(np.sin(psi), np.cos(psi))}
    log = read_log(
        two_tables(tmp_path / "run", rows=rows_at(t), compass=heading), log_map(base="rows", rates={"psi": rate})
    )
    text = 'name = "a"\n[hull]\nmass = 1\n[sensors.heading]\naccuracy = {}\n'
    with pytest.raises(IvsidError, match="the way round from one sample of psi to the next is not certain"):
        bound_log(log, parse_vehicle(text.format(0.1), "a.toml"))
    bound_log(log, parse_vehicle(text.format(0.05), "a.toml"))


def test_a_hole_in_a_table_of_demands_is_a_gap(tmp_path):
    t, when = np.arange(0.05, 99, 0.1), np.r_[np.arange(0, 20, 0.1), np.arange(80, 100, 0.1)]
    demands = {"t": when, "demand_a": 50 + 10 * np.sin(when)}
    log = read_log(two_tables(tmp_path / "run", rows=rows_at(t), demands=demands), log_map(base="rows"))
    demand, inside = log.columns["demand_a"], (t > 20.2) & (t < 79.9)
    assert np.isnan(demand[inside]).all() and np.isfinite(demand[~inside]).mean() > 0.99
    assert any("demand_a is missing in" in n and "reach into a hole of its samples" in n for n in log.notes)
