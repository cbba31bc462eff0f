"""Rows that a log of the diagnosis lost, one or two in a row: what their demands were is not known."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from diagnosis_logs import rows, screened
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data import resampling
from ivsid.diagnosis.data.between import Straddled
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.data.lost_rows import LostRows
from ivsid.diagnosis.estimation import noise
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle
from test_irregular_clock import FELT, SUDDEN, sailed

SEED = 5


def waves(t):
    """Demands that change evenly from row to row."""
    turn = np.sin(0.9 * t) + 0.6 * np.sin(2.3 * t + 1.0)
    return 40.0 + 18.0 * np.sin(0.5 * t) + 9.0 * turn * np.array([1.0, -1.0])


def dropped(log, share=0.1, seed=SEED):
    """The log without a share of its rows."""
    keep = np.random.default_rng(seed).uniform(size=log.t.size) >= share
    keep[0] = True
    return rows(log, keep)


def craft(sampling="instantaneous"):
    """A craft whose thrusts are known to 0.2 %, with an accelerometer."""
    return parse_vehicle(SUDDEN.replace("[ambient]", f"{FELT.format(sampling=sampling)}[ambient]"), "craft.toml")


@pytest.mark.parametrize(
    ("sent", "usual"), [(None, 0.1), (waves, 0.1), pytest.param(waves, 0.05, marks=pytest.mark.nightly)]
)
def test_a_sound_log_without_a_tenth_of_its_rows_is_sound(sent, usual):
    """Sound logs of strangers had a delay, a payload or structure of 293 orders of magnitude."""
    log = dropped(sailed(200.0, 3, 0.0, usual, False, sent))
    found = screened(craft(), log)
    assert found.passed == [] and found.quiet
    data = found.fit.noise.predictor.log
    assert isinstance(data.between, Straddled) and data.good.mean() > 0.95
    # Steps that a lost row may hide cost what follows them, and so do readings over two of them.
    assert found.fit.noise.good.mean() > 0.35


def largest(log):
    """The largest prediction error of the yaw rate that counts by the fitted model, in their usual size."""
    fit = plain_fit(craft(), channels(log, craft()), everything)
    at = fit.noise.predictor.labels.index((2, "r"))
    error = np.abs(fit.noise.predictor.errors(fit.states)[at][fit.noise.good])
    return float(error.max() / np.median(error))


def test_steps_that_lost_rows_hide_do_not_count(monkeypatch):
    """Half a step for the time of a row turns the craft by up to 150 standard deviations of its filtered yaw rate."""
    log = dropped(sailed(200.0, 3, 0.0, 0.1, False))
    assert largest(log) < 8.0
    monkeypatch.setattr(noise, "UNSEEN", np.inf)
    assert largest(log) > 15.0


@pytest.mark.nightly
def test_demands_that_run_are_not_held_over_losses(monkeypatch):
    """A log whose demands run from row to row is not sound where they hold over a loss, and where a mean of its neighbours stands for a reading."""
    monkeypatch.setattr(LostRows, "filled", lambda self, name, unwrap=False: (self.log.t, self.log.columns[name]))
    monkeypatch.setattr(resampling, "STRAY", 1.0)
    found = screened(craft(), dropped(sailed(200.0, 3, 0.0, 0.1, False, waves)))
    assert found.passed or not found.quiet


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.floats(0.02, 0.4))
def test_lost_rows_are_those_that_were_dropped(seed, share):
    """Oracle: rows of a uniform clock that were dropped one or two in a row, at their own times, on lines between the rows that were kept."""
    rng = np.random.default_rng(seed)
    t = 0.1 * np.arange(200)
    x = np.round(rng.standard_normal(t.size), 1)
    keep = rng.uniform(size=t.size) >= share
    keep[[0, 1, -2, -1]] = True
    log = Log("x.csv", "0" * 64, t[keep], {"demand_a": x[keep]})
    starts = np.flatnonzero(keep[:-1] & ~keep[1:]) + 1
    runs = [range(s, s + int(np.argmax(keep[s:]))) for s in starts]
    wanted = [k for run in runs if len(run) <= 2 for k in run]
    lost = LostRows(log)
    np.testing.assert_allclose(lost.t, t[wanted], atol=1e-9)
    at, values = lost.filled("demand_a")
    there = sorted({*np.flatnonzero(keep).tolist(), *wanted})
    np.testing.assert_allclose(at, t[there], atol=1e-9)
    np.testing.assert_allclose(values, np.interp(t[there], t[keep], x[keep]), atol=1e-9)


def test_a_demand_that_runs_on_hides_no_jump():
    """A step over a loss may be off by half of it for the time of a row; a ramp, and a demand that is constant, may not be."""
    t = 0.1 * np.arange(100)
    keep = np.ones(t.size, dtype=bool)
    keep[[30, 60, 61]] = False
    step = np.where(t < 3.0, 0.0, 10.0) + np.where(t < 6.05, 0.0, 10.0)
    columns = {"demand_step": step, "demand_ramp": 3.0 * t, "demand_still": np.ones(t.size)}
    log = Log("x.csv", "0" * 64, t[keep], {k: x[keep] for k, x in columns.items()})
    found = LostRows(log).demands([[name] for name in columns], t)
    assert (found.before.tolist(), found.after.tolist()) == ([29, 59], [31, 62])
    np.testing.assert_allclose(found.jump, [[0.05, 0.1], [0.0, 0.0], [0.0, 0.0]], atol=1e-9)


def test_demands_in_rows_of_their_own_are_not_lost():
    """A cell that is empty beside a loss is that of a demand which holds."""
    log = sailed(70.0, 3, 0.0)
    asked = np.arange(log.t.size) % 4 == 0
    columns = {k: np.where(asked, x, np.nan) if k.startswith("demand") else x for k, x in log.columns.items()}
    rare = dropped(replace(log, columns=columns))
    lost, there = LostRows(rare), np.isfinite(rare.columns["demand_port"])
    assert lost.t.size > 40
    t, x = lost.filled("demand_port")
    assert np.array_equal(t, rare.t[there]) and np.array_equal(x, rare.columns["demand_port"][there])
    assert channels(rare, parse_vehicle(SUDDEN, "craft.toml")).lost.jump.shape[0] == 2


def test_an_angle_that_turns_through_the_stern_is_lost_there():
    """A line from 3.1 to -3.1 rad went through 0, and the thruster pushed the other way for a row."""
    t = 0.1 * np.arange(100)
    angle = np.mod(np.pi + 0.3 * np.sin(t) + np.pi, 2 * np.pi) - np.pi
    keep = np.arange(t.size) % 7 != 3
    log = Log("x.csv", "0" * 64, t[keep], {"azimuth_pod": angle[keep]})
    at, found = LostRows(log).filled("azimuth_pod")
    np.testing.assert_allclose(np.cos(found - np.interp(at, t, np.pi + 0.3 * np.sin(t))), 1.0, atol=1e-3)


def test_an_empty_cell_beside_a_loss_hides_no_jump():
    t = 0.1 * np.arange(100)
    step = np.where(t < 3.0, 0.0, 10.0)
    step[[28, 32]] = np.nan
    keep = np.arange(t.size) != 30
    log = Log("x.csv", "0" * 64, t[keep], {"demand_step": step[keep]})
    np.testing.assert_allclose(LostRows(log).demands([["demand_step"]], t).jump, [[0.05]])


@pytest.mark.parametrize("cells", ["uv", "single", pytest.param("every", marks=pytest.mark.nightly)])
def test_a_sound_log_with_empty_cells_is_sound(cells):
    """Rows without some reading, whose demands are known: an acceleration between its neighbours is none of the moment, and a delay had a name."""
    log = sailed(200.0, 3, 0.0, 0.1, False)
    rng = np.random.default_rng(SEED)
    keep, read = rng.uniform(size=log.t.size) >= 0.1, [k for k in log.columns if not k.startswith("demand")]
    lost = {
        "uv": {"u": keep, "v": keep},
        "every": dict.fromkeys(read, keep),
        "single": {k: rng.uniform(size=keep.size) >= 0.03 for k in read},
    }
    empty = {k: np.where(there, log.columns[k], np.nan) for k, there in lost[cells].items()}
    found = screened(craft(), replace(log, columns=log.columns | empty))
    assert found.passed == [] and found.quiet
    assert isinstance(found.fit.noise.predictor.log.between, Straddled)


@pytest.mark.parametrize("readings", [0, 1])
def test_accelerometers_that_were_never_read_lose_no_rows(readings):
    """Columns that a logger writes for sensors that are off: of no reading, and of one."""
    log = sailed(70.0, 3, 0.0, 0.1, False)
    for kept, straddled in ((log, False), (dropped(log), True)):
        never = np.where(np.arange(kept.t.size) < readings, 0.0, np.nan)
        there = channels(replace(kept, columns=kept.columns | {"ax": never, "ay": never}), craft())
        assert isinstance(there.between, Straddled) == straddled
        np.testing.assert_array_equal(there.nu, channels(kept, craft()).nu)


def test_velocities_that_a_rarer_sensor_lost_are_no_structure():
    """A Doppler log every third row lost a fifth of its pings: what a gyro and an accelerometer read in these rows counted at other times than it."""
    log = sailed(300.0, 3, 0.0, 0.1, False)
    row = np.arange(log.t.size)
    pinged = (row % 3 == 0) & ((np.random.default_rng(SEED).uniform(size=row.size) >= 0.2) | (row == 0))
    pings = {k: np.where(pinged, log.columns[k], np.nan) for k in "uv"}
    found = screened(craft(), replace(log, columns=log.columns | pings))
    assert found.passed == [] and found.quiet
    assert found.fit.noise.predictor.log.h == pytest.approx(0.3)
    assert found.fit.noise.predictor.log.good.mean() > 0.9


def test_losses_are_those_of_the_log_where_velocities_have_rows_of_their_own():
    """A pose gives velocities between its rows; of a tenth of the rows a dozen losses were seen, and no jump."""
    log = dropped(sailed(100.0, 3, 0.0))
    x, y = (np.cumsum(q) * 0.1 for q in (log.columns["u"], log.columns["v"]))
    posed = replace(log, columns={"x": x, "y": y, **{k: q for k, q in log.columns.items() if k not in "uvr"}})
    vehicle = parse_vehicle(SUDDEN, "craft.toml")
    of_pose, of_log = (channels(one, vehicle).lost.jump for one in (posed, log))
    np.testing.assert_allclose(of_pose, of_log)
    assert np.count_nonzero(of_pose) > 10
