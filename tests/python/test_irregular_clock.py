"""A log whose rows come at irregular times: demands act from their rows on, wherever the rows stand on a uniform clock."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from diagnosis_logs import screened
from ivsid.diagnosis.data import resampling
from ivsid.diagnosis.data.between import Between, Rows, Straddled
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.data.lost_rows import LostRows
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle
from test_slow_clock import CRAFT

# Without a lag, and with thrusts that are known a little better than the other test's.
SUDDEN = CRAFT.replace("time_constant = {lag}\n", "").replace(
    "absolute = 0.1, relative = 0.01", "absolute = 0.02, relative = 0.002"
)
PARTS = 12
FELT = """[sensors.acceleration]
accuracy = 0.02
sampling = "{sampling}"

"""


def sailed(seconds, seed, astray, usual=0.1, feels=None, sent=None, turns=False):
    """The craft by hand: rows a usual step apart, as a rule, and demands that change at rows and hold until the next.

    Args:
        seconds: of the log.
        seed: of demands, rows and noise.
        astray: largest share by which a step is longer or shorter than usual.
        usual: step [s].
        feels: whether an accelerometer is read at the rows (False) or gives means over the step before them (True), or there is none.
        sent: both demands at a time, in place of new ones every 0.8 s.
        turns: whether the yaw acceleration is read at the rows.
    """
    rng = np.random.default_rng(seed)
    t = np.cumsum(usual * (1 + astray * rng.uniform(-1, 1, round(seconds / usual))))
    state, out, demand, felt, mean, turned = np.zeros(4), [], np.zeros(2), [], np.zeros(2), []
    for k, step in enumerate(np.diff(t, append=t[-1] + usual)):
        if sent is not None:
            demand = sent(t[k])
        elif k % round(0.8 / usual) == 0:
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

        def push(x, rates=rates):
            du, dv = rates(x)[:2]
            return np.array([du - x[1] * x[2], dv + x[0] * x[2]])

        felt.append(mean if feels and k else push(state))
        turned.append(rates(state)[2])
        h, mean = step / PARTS, np.zeros(2)
        for _ in range(PARTS):
            a = rates(state)
            b = rates(state + h * a)
            after = state + 0.5 * h * (a + b)
            mean = mean + 0.5 * (push(state) + push(after)) / PARTS
            state = after
    u, v, r, psi, port, starboard = np.array(out).T
    noise = [size * rng.standard_normal(t.size) for size in (0.003, 0.003, 0.001, 0.003)]
    u, v, r, psi = (x + e for x, e in zip((u, v, r, psi), noise, strict=True))
    columns = {"u": u, "v": v, "r": r, "psi": psi, "demand_port": port, "demand_starboard": starboard}
    if feels is not None:
        ax, ay = np.array(felt).T + 0.005 * rng.standard_normal((2, t.size))
        columns |= {"ax": ax, "ay": ay}
    if turns:
        columns["rdot"] = np.array(turned) + 0.002 * rng.standard_normal(t.size)
    return Log("craft.csv", "0" * 64, t - t[0], columns)


# Nightly: that the log shows it without.
@pytest.mark.parametrize("followed", [True, pytest.param(False, marks=pytest.mark.nightly)])
def test_demands_of_irregular_rows_act_from_their_rows_on(followed, monkeypatch):
    """On whole steps of the clock they act up to a step late, and the sound log has a delay of its thrusters."""
    if not followed:
        monkeypatch.setattr(resampling, "STRAY", 1.0)
    found = screened(parse_vehicle(SUDDEN, "craft.toml"), sailed(200.0, 3, 0.24))
    assert (found.passed == [] and found.quiet) == followed


# Nightly: quicker rows.
@pytest.mark.parametrize(
    ("usual", "sampling"),
    [
        (0.04, "instantaneous"),
        (0.05, "averaged"),
        *(pytest.param(*q, marks=pytest.mark.nightly) for q in [(0.02, "averaged"), (0.03, "averaged")]),
    ],
)
def test_means_over_irregular_rows_are_those_of_their_rows(usual, sampling):
    """Each reading of a mean lies between two rows, and a demand, or a mean over a step, acts between its own rows."""
    craft = CRAFT.replace("time_constant = {lag}\n", "")
    vehicle = parse_vehicle(craft.replace("[ambient]", f"{FELT.format(sampling=sampling)}[ambient]"), "craft.toml")
    log = sailed(100.0, 3, 0.3, usual, sampling == "averaged")
    data = channels(log, vehicle)
    assert data.h > 1.5 * usual and isinstance(data.between, Straddled)
    found = screened(vehicle, log)
    assert found.passed == [] and found.quiet


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
    # Two readings make a sample, which lies between their rows.
    quick = channels(sailed(70.0, 3, 0.0, 0.05), vehicle).between
    assert quick is not None and not isinstance(quick, Straddled)
    assert isinstance(channels(sailed(70.0, 3, 0.1), vehicle).between, Straddled)


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 2, 3]))
def test_readings_on_straight_lines_between_irregular_rows(seed, readings):
    """Oracle: a quantity whose rate jumps at rows alone is interpolated without error, so that readings less values are what its rates add up to."""
    rng = np.random.default_rng(seed)
    count, n = 120, 30
    # Rows at whole parts of a clock of one step, so that no part is cut.
    rows = np.cumsum(rng.integers(75 // readings, 144 // readings, readings * n + 40)) / count - 2.0
    rows = rows[: np.searchsorted(rows, n + 2.0)]
    rates, fine = rng.standard_normal(rows.size), np.arange(-2 * count, (n + 2) * count + 1) / count
    of_part = rates[np.clip(np.searchsorted(rows, fine[:-1] + 1e-9, side="right") - 1, 0, None)]
    value = np.concatenate([[0.0], np.cumsum(of_part) / count])
    clock = np.arange(n)
    places = (np.arange(readings) - 0.5 * (readings - 1)) / readings
    wanted = clock + places[:, None]
    read = np.interp(wanted, rows, np.interp(rows, fine, value)).mean(axis=0)
    parts = of_part[2 * count : (n + 2) * count].reshape(1, n, count)
    at = np.searchsorted(rows, wanted + 1e-9, side="right") - 1
    own = np.clip(np.round(np.concatenate([rows[at], rows[at + 1]]) * count).astype(int), 0, n * count - 1)
    around = Rows(wanted - rows[at], rows[at + 1] - wanted, own, np.zeros(wanted.shape, dtype=bool))
    between = Straddled.of(Between(parts, parts, parts), places, around, around)
    # A row farther away than a step counts as one a step away.
    near = (np.maximum(clock - rows[at], rows[at + 1] - clock) <= 1.0).all(axis=0)
    moved = between.moved(parts, parts[:, 0, 0])[0]
    np.testing.assert_allclose(moved[near][1:], (read - np.interp(clock, fine, value))[near][1:], atol=1e-9)
    held = of_part[2 * count : (n + 2) * count]
    share = (wanted - rows[at]) / (rows[at + 1] - rows[at])
    inner = near & (clock > 1) & (clock < n - 2)
    sampled = between.sampled(held[None])[0]
    there = ((1 - share) * rates[at] + share * rates[at + 1]).mean(axis=0)
    np.testing.assert_allclose(sampled[inner], there[inner], atol=1e-9)
    spread = ((1 - share) * (rows[at] - clock) ** 2 + share * (rows[at + 1] - clock) ** 2).mean(axis=0)
    np.testing.assert_allclose(between.spread[near], spread[near], atol=1e-12)


def test_means_over_steps_of_irregular_rows_add_up():
    """Oracle: what steps between rows add up to is the integral; with parts, each row counts from the nearest part on."""
    rng = np.random.default_rng(7)
    rows = np.cumsum(rng.uniform(0.03, 0.05, 400))
    rows -= rows[0]
    rates = rng.standard_normal(400)
    log = Log("means.csv", "0" * 64, rows, {"ax": rates})
    clock = np.arange(0.04, rows[-1], 0.08)
    resample = resampling.Resampler(log, LostRows(log), clock, 0.08, 2)
    fine = (np.arange(80000) + 0.5) * (rows[-1] / 80000)
    for parts in (0, 4):
        at = rows if not parts else clock[0] + np.round((rows - clock[0]) / 0.02) * 0.02
        whole = np.concatenate([[0.0], np.cumsum(rates[np.searchsorted(at, fine)]) * fine[0] * 2])
        expected = np.diff(np.interp([clock[1:] - 0.08, clock[1:]], np.arange(80001) * (2 * fine[0]), whole), axis=0)
        np.testing.assert_allclose(resample("ax", since=parts)[1:], expected[0] / 0.08, atol=0.02)


def test_readings_have_the_demands_that_are_in_force_at_their_rows():
    """Oracle: an accelerometer that reads the last demand that was sent, in rows of their own, reads what the model has there."""
    log, rng = sailed(70.0, 3, 0.15), np.random.default_rng(5)
    sent = np.sort(rng.uniform(0.0, log.t[-1], 90))
    sent[0] = 0.0
    values = {f"demand_{side}": rng.uniform(-80.0, 80.0, sent.size) for side in ("port", "starboard")}
    t = np.union1d(log.t, sent)
    blank = {k: np.full(t.size, np.nan) for k in (*log.columns, "ax", "ay")}
    for k, x in log.columns.items():
        if k not in values:
            blank[k][np.searchsorted(t, log.t)] = x
    for k, x in values.items():
        blank[k][np.searchsorted(t, sent)] = x
    force = values["demand_port"][np.searchsorted(sent, log.t, side="right") - 1]
    for k in ("ax", "ay"):
        blank[k][np.searchsorted(t, log.t)] = force
    vehicle = parse_vehicle(SUDDEN.replace("[ambient]", f"{FELT.format(sampling='instantaneous')}[ambient]"), "c.toml")
    data = channels(Log("apart.csv", "0" * 64, t, blank), vehicle)
    assert isinstance(data.between, Straddled)
    found = data.between.sampled(data.between.demands[0].reshape(1, -1))[0]
    # A row farther away than a step has the weight of one a step away.
    near = (np.abs(data.between.times) < 1.0).all(axis=0)
    assert near.mean() > 0.7
    np.testing.assert_allclose(found[near], data.acceleration[0][near], atol=1e-9)
