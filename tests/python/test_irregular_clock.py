"""A log whose rows come at irregular times: demands act from their rows on, wherever the rows stand on a uniform clock."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from diagnosis_logs import screened
from ivsid.diagnosis.data import resampling
from ivsid.diagnosis.data.between import Between, Straddled
from ivsid.diagnosis.data.channels import channels
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle
from test_slow_clock import CRAFT

# Without a lag, and with thrusts that are known a little better than the other test's.
SUDDEN = CRAFT.replace("time_constant = {lag}\n", "").replace(
    "absolute = 0.1, relative = 0.01", "absolute = 0.02, relative = 0.002"
)
PARTS = 12


def sailed(seconds, seed, astray):
    """The craft by hand: rows 0.1 s apart, as a rule, and demands that change at rows and hold until the next.

    Args:
        seconds: of the log.
        seed: of demands, rows and noise.
        astray: largest share by which a step is longer or shorter than usual.
    """
    rng = np.random.default_rng(seed)
    t = np.cumsum(0.1 * (1 + astray * rng.uniform(-1, 1, round(seconds * 10))))
    state, out, demand = np.zeros(4), [], np.zeros(2)
    for k, step in enumerate(np.diff(t, append=t[-1] + 0.1)):
        if k % 8 == 0:
            demand = rng.uniform(10, 70) + rng.choice([-1.0, 1.0]) * rng.uniform(5, 16) * np.array([1.0, -1.0])
        out.append([*state, *demand])
        X, N = 0.2 * demand.sum(), 0.2 * 0.3 * (demand[0] - demand[1])

        def rates(x, X=X, N=N):
            u, v, r, _ = x
            return np.array(
                [
                    (X + 37.0 * v * r - 15.0 * u * abs(u) - 5.0 * u) / 26.0,
                    (-26.0 * u * r - 20.0 * v) / 37.0,
                    (N - 7.0 * r) / 4.3,
                    r,
                ]
            )

        h = step / PARTS
        for _ in range(PARTS):
            a = rates(state)
            b = rates(state + h * a)
            state = state + 0.5 * h * (a + b)
    u, v, r, psi, port, starboard = np.array(out).T
    noise = [size * rng.standard_normal(t.size) for size in (0.003, 0.003, 0.001, 0.003)]
    u, v, r, psi = (x + e for x, e in zip((u, v, r, psi), noise, strict=True))
    columns = {"u": u, "v": v, "r": r, "psi": psi, "demand_port": port, "demand_starboard": starboard}
    return Log("craft.csv", "0" * 64, t - t[0], columns)


# Nightly: that the log shows it without.
@pytest.mark.parametrize("followed", [True, pytest.param(False, marks=pytest.mark.nightly)])
def test_demands_of_irregular_rows_act_from_their_rows_on(followed, monkeypatch):
    """On whole steps of the clock they act up to a step late, and the sound log has a delay of its thrusters."""
    if not followed:
        monkeypatch.setattr(resampling, "STRAY", 1.0)
    found = screened(parse_vehicle(SUDDEN, "craft.toml"), sailed(200.0, 3, 0.24))
    assert (found.passed == [] and found.quiet) == followed


@pytest.mark.parametrize("first", [0, 1, 3])
def test_velocities_that_set_the_clock_are_read_at_its_times(first):
    """A velocity in every fifth row, from some row on: half-way between two of them it would be a mean of both."""
    log = sailed(70.0, 3, 0.0)
    read = np.arange(log.t.size) % 5 == first
    columns = {k: np.where(read, x, np.nan) if k in "uv" else x for k, x in log.columns.items()}
    data = channels(Log("rare.csv", "0" * 64, log.t, columns), parse_vehicle(SUDDEN, "craft.toml"))
    assert data.h == pytest.approx(0.5, rel=1e-6) and data.t[0] == pytest.approx(0.1 * first, abs=1e-9)
    np.testing.assert_allclose(data.nu[0], log.columns["u"][read][: data.n], atol=1e-6)


def test_rows_on_a_uniform_clock_are_no_strays():
    """Rounded stamps, and a row that is lost, leave the others where they are."""
    vehicle, even = parse_vehicle(SUDDEN, "craft.toml"), sailed(70.0, 3, 0.0)
    keep = np.ones(even.t.size, dtype=bool)
    keep[[150, 300]] = False
    lost = Log("lost.csv", "0" * 64, np.round(even.t, 4)[keep], {k: x[keep] for k, x in even.columns.items()})
    assert channels(lost, vehicle).between is None
    assert isinstance(channels(sailed(70.0, 3, 0.1), vehicle).between, Straddled)


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_readings_on_straight_lines_between_irregular_rows(seed):
    """Oracle: a quantity whose rate jumps at rows alone is interpolated without error, so that readings less values are what its rates add up to."""
    rng = np.random.default_rng(seed)
    count, n = 40, 30
    # Rows at whole parts of a clock of one step, so that no part is cut.
    rows = np.cumsum(rng.integers(25, 48, n + 12)) / count - 2.0
    rows = rows[: np.searchsorted(rows, n + 2.0)]
    rates, fine = rng.standard_normal(rows.size), np.arange(-2 * count, (n + 2) * count + 1) / count
    of_part = rates[np.clip(np.searchsorted(rows, fine[:-1] + 1e-9, side="right") - 1, 0, None)]
    value = np.concatenate([[0.0], np.cumsum(of_part) / count])
    clock = np.arange(n)
    read = np.interp(clock, rows, np.interp(rows, fine, value))
    parts = of_part[2 * count : (n + 2) * count].reshape(1, n, count)
    at = np.searchsorted(rows, clock + 1e-9, side="right") - 1
    between = Straddled.of(Between(parts, parts, parts), clock - rows[at], rows[at + 1] - clock)
    # A reading farther away than a step counts as one a step away.
    near = np.maximum(clock - rows[at], rows[at + 1] - clock) <= 1.0
    moved = between.moved(parts, parts[:, 0, 0])[0]
    np.testing.assert_allclose(moved[near][1:], (read - np.interp(clock, fine, value))[near][1:], atol=1e-9)
    held = of_part[2 * count : (n + 2) * count]
    first, last = rates[at], rates[at + 1]
    share = (clock - rows[at]) / (rows[at + 1] - rows[at])
    inner = near & (clock > 1) & (clock < n - 2)
    sampled = between.sampled(held[None])[0]
    np.testing.assert_allclose(sampled[inner], ((1 - share) * first + share * last)[inner], atol=1e-9)
    np.testing.assert_allclose(
        between.spread, np.where(near, share * (1 - share) * (rows[at + 1] - rows[at]) ** 2, between.spread), atol=1e-12
    )
