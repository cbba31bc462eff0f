"""Samples between two rows are in the range of the step."""

from fractions import Fraction

import gmpy2
import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ivsid import IvsidError, read_log
from ivsid.log.step_ranges import step_range
from ivsid.sensors.bounds import bound_log
from ivsid.vehicle import parse_vehicle
from log_files import log_map, rows_at, two_tables

TURN = 2 * Fraction(*map(int, gmpy2.const_pi(200).as_integer_ratio()))


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_what_stands_between_the_rows_is_in_the_range_of_the_step(data):
    """Held values, values between their neighbours, and the extreme curve of a stated rate, over steps of other rows."""
    # Times and curves are multiples of a power of two, so that the truth between two samples is known exactly.
    t = np.cumsum(data.draw(st.lists(st.integers(7, 12), min_size=6, max_size=20))) / 64
    rows = np.cumsum(data.draw(st.lists(st.integers(1, 32), min_size=3, max_size=20))) / 64
    values = np.array(data.draw(st.lists(st.floats(-5, 5), min_size=t.size, max_size=t.size)))
    fine = np.arange(64 * t[0], 64 * t[-1] + 1) / 64
    nothing = np.zeros(t.size)
    rate = 2.0
    turns = data.draw(st.lists(st.sampled_from([-1.0, 1.0, 0.25]), min_size=fine.size - 1, max_size=fine.size - 1))
    curve = np.r_[0.0, np.cumsum(np.array(turns) * rate / 64)]
    at = curve[np.searchsorted(fine, t)]
    held_now = values[np.searchsorted(t, fine, side="right") - 1]
    place = np.clip(np.searchsorted(t, fine, side="right") - 1, 0, t.size - 2)
    shares = [Fraction(x - t[k]) / Fraction(t[k + 1] - t[k]) for k, x in zip(place, fine, strict=True)]
    straight = [
        Fraction(values[k]) + s * (Fraction(values[k + 1]) - Fraction(values[k]))
        for k, s in zip(place, shares, strict=True)
    ]
    for truth, samples, how in (
        ([Fraction(x) for x in held_now], values, {"manner": "hold"}),
        (straight, values, {"manner": "between"}),
        ([Fraction(x) for x in curve], at, {"manner": "hold", "rate": rate}),
    ):
        lower, upper = step_range(rows, t, samples, nothing, **how)
        for k in range(rows.size - 1):
            inside = (fine >= rows[k]) & (fine < rows[k + 1])
            covered = rows[k] >= t[0] and rows[k + 1] <= t[-1]
            assert np.isfinite(lower[k]) >= covered
            if covered and np.isfinite(lower[k]):
                low, high = Fraction(lower[k]), Fraction(upper[k])
                assert all(low <= truth[i] <= high for i in np.flatnonzero(inside))
                if "rate" not in how:
                    assert {lower[k], upper[k]} <= {np.nextafter(v, s) for v in values for s in (-np.inf, np.inf)}


def test_a_step_that_reaches_into_a_hole_has_no_range():
    t = np.r_[np.arange(0, 2, 0.1), np.arange(4, 6, 0.1)]
    rows, values = np.arange(0, 5.95, 0.5), np.arange(t.size, dtype=float)
    for how in ({"manner": "between"}, {"manner": "hold"}, {"manner": "hold", "rate": 20.0}):
        lower, _ = step_range(rows, t, values, np.zeros(t.size), **how)
        # Until 1.9 s there are samples, and a held value is good for 0.25 s more.
        assert (
            np.isnan(lower[4 if how == {"manner": "hold"} else 3 : 8]).all()
            and np.isfinite(lower[[0, 1, 2, 8, 9]]).all()
        )


def test_forces_between_the_rows_are_kept(tmp_path):
    """A force at 100 Hz pulses between rows at 10 Hz."""
    t, fine = np.arange(40) / 10, np.arange(400) / 100
    pulse = np.where((np.arange(400) % 10 > 2) & (np.arange(400) % 10 < 8), 30.0, 0.0)
    force = {"t": fine, "force_X": pulse, "force_Y": 0 * fine, "moment_N": 0 * fine}
    path = two_tables(tmp_path / "run", rows=rows_at(t), force=force)
    over = read_log(path, log_map(base="rows")).over
    assert set(over) == {"force_X", "force_Y", "moment_N"}
    assert (over["force_X"].lower <= 0).all() and (over["force_X"].upper >= 30).all()
    assert np.abs(over["force_X"].upper - 30).max() < 1e-14 * 30 and "neighbouring samples" in over["force_X"].assumes
    # Between two clocks that may disagree the next sample counts, too.
    pulse[:] = 0
    pulse[105] = 7.0
    pl.DataFrame({**force, "force_X": pulse}).write_csv(path / "force.csv")
    exact, loose = (
        read_log(path, log_map(base="rows", rates=dict.fromkeys(over, 10000.0), clock_error=e)) for e in (0.0, 0.05)
    )
    assert (loose.over["force_X"].upper - exact.over["force_X"].upper)[:-1].min() >= 1e4 * 0.05 * (1 - 1e-9)


def test_a_held_angle_that_changes_in_a_row_that_is_left_out(tmp_path):
    """Only every second row has u; the angle changes in those between."""
    t = np.arange(40) / 10
    table = {**rows_at(t), "demand_a": 50 + 0 * t, "azimuth_a": np.where(np.arange(40) % 2, 1.0, 0.0)}
    pl.DataFrame({**table, "u": [1.0 if k % 2 == 0 else None for k in range(40)]}).write_csv(tmp_path / "log.csv")
    log = read_log(tmp_path / "log.csv", log_map(base="u"))
    over = log.over["azimuth_a"]
    assert log.t.size == 20 and (over.lower <= 0).all() and (over.upper >= 1).all() and over.upper.max() < 1 + 1e-15
    assert over.assumes == "azimuth_a holds from each of its samples to the next"


def test_angles_of_thrusters_are_followed_through_half_a_turn(tmp_path):
    """At 2.9 rad and turning: halfway between 3.1 and -3.08 the truth is 3.15, not 0.01."""
    rate, slow, t = 0.5, np.arange(0, 20, 0.2), np.arange(0.1, 19.75, 0.1)
    # Readings are the doubles next to the exact angle in its turn.
    turned = [Fraction(29, 10) + Fraction(x) / 2 for x in slow]
    angle = {"t": slow, "angle": [float(q - round(q / TURN) * TURN) for q in turned]}
    for channel in ("azimuth_a", "rudder_a"):
        path = two_tables(tmp_path / channel, rows={**rows_at(t), "demand_a": 50 + 0 * t}, angle=angle)
        log = read_log(path, log_map(columns={channel: "angle/angle"}, base="rows", rates={channel: rate}))
        off = np.angle(np.exp(1j * (log.columns[channel] - 2.9 - rate * t)))
        assert (np.abs(off) <= log.error(channel)).all() and np.abs(log.columns[channel]).max() <= np.pi
        over = log.over[channel]
        for k in range(t.size - 1):
            for tenths in (0, 4, 10):
                moment = Fraction(t[k]) + Fraction(tenths, 10) * (Fraction(t[k + 1]) - Fraction(t[k]))
                truth = Fraction(29, 10) + moment / 2
                assert Fraction(over.lower[k]) <= truth <= Fraction(over.upper[k])
        assert (over.upper - over.lower).max() < 0.2
        assert over.assumes == f"{channel} never changes faster than 0.5 a second"
        with pytest.raises(IvsidError, match="half a circle"):
            read_log(path, log_map(columns={channel: "angle/angle"}, base="rows", rates={channel: 20.0}))


def test_a_scale_factor_enlarges_what_a_velocity_can_have_moved(tmp_path):
    """The sensor shows 1.1 times a saw tooth that moves as fast as it may: the truth stays inside."""
    e, accuracy, rate = 0.1, 0.002, 1.0
    slow, t = np.arange(0.0, 20.0), np.arange(0.5, 18.75, 0.25)

    def u(t):
        return 2 - np.minimum(t % 1, 1 - t % 1) * rate

    shown = (1 + e) * u(slow) + accuracy * (1 - 1e-6 * slow)
    text = f'name = "a"\n[hull]\nmass = 1\n[sensors.velocity]\naccuracy = {accuracy}\nscale_factor_error = {e}\n[sensors.heading]\naccuracy = 0\n'
    vehicle = parse_vehicle(text, "a.toml")
    path = two_tables(
        tmp_path / "body", rows={"t": t, "r": 0.1 * np.cos(t)}, dvl={"t": slow, "u": shown, "v": 0 * slow}
    )
    bounded = bound_log(read_log(path, log_map(base="rows", rates={"u": rate, "v": rate})), vehicle).channels["u"]
    assert ((bounded.lower <= u(t)) & (u(t) <= bounded.upper)).all()
    assert (bounded.upper - bounded.lower).max() < 2 * (0.5 + accuracy + e * 3)
    earth = {"t": slow, "velocity_north": shown, "velocity_east": 0 * slow}
    path = two_tables(tmp_path / "earth", rows={"t": t, "psi": 0 * t, "r": 0.1 * np.cos(t)}, dvl=earth)
    log = read_log(path, log_map(base="rows", rates={"velocity_north": rate, "velocity_east": rate}))
    bounded = bound_log(log, vehicle).channels["u"]
    assert ((bounded.lower <= u(t)) & (u(t) <= bounded.upper)).all()
