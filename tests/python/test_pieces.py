"""Rows do not depend on the pieces that they are made in, bit for bit; nor do a lag and a signed square on how they are worked out."""

import weakref
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from ivsid import IntervalArray
from ivsid.effects import terms_of
from ivsid.errors import IvsidError
from ivsid.intervals import follow, pieces
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

SHIPPED = {"swan": "swan_train", "otter": "otter_programme", "vectored_rov": "vectored_rov_programme"}


def shipped(name):
    """A shipped vehicle and a log of a minute with a gap, drop-outs and a demand that is missing."""
    texts = [(files("ivsid") / "data" / f"{n}.toml").read_text() for n in (name, SHIPPED[name])]
    vehicle, scenario = parse_vehicle(texts[0], name), parse_scenario(texts[1], name)
    made = simulate(vehicle, scenario.model_copy(update={"duration": 60.0, "rate": 20.0}), 3)
    t, columns = made.t.copy(), {k: x.copy() for k, x in made.columns.items()}
    t[700:] += 3.0
    columns["u"][100:104] = np.nan
    columns[next(c for c in columns if c.startswith("demand"))][400] = np.nan
    return vehicle, Log("a.csv", "0" * 64, t, columns)


def agree(a, b):
    assert a.assumes == b.assumes and a.terms == b.terms
    for one, other in ((a.matrix, b.matrix), (a.right, b.right)):
        assert one.lower.tobytes() == other.lower.tobytes() and one.upper.tobytes() == other.upper.tobytes()
    for name in ("channel", "time", "duration", "kind"):
        assert getattr(a, name).tobytes() == getattr(b, name).tobytes()


@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.parametrize("kind", ["auto", "pointwise", "integral", "both"])
def test_rows_in_pieces_are_the_rows_in_one(name, kind):
    vehicle, log = shipped(name)
    bounded, terms = bound_log(log, vehicle, 2), terms_of(vehicle)
    try:
        whole = build_rows(bounded, vehicle, terms, kind=kind, window=(0.5, 2.0))
    except IvsidError as error:
        with pytest.raises(IvsidError) as again:
            build_rows(bounded, vehicle, terms, kind=kind, window=(0.5, 2.0), piece=160)
        assert str(again.value) == str(error)
        return
    assert whole.time.size > 500
    for piece in (160, 333, 10_000):
        agree(whole, build_rows(bounded, vehicle, terms, kind=kind, window=(0.5, 2.0), piece=piece))


STEERED = """
name = "a"
[hull]
mass = 50
centre_of_gravity = [0.1, 0.0]
[[thrusters]]
name = "stern"
position = [-0.5, 0.1]
gain = 0.3
demand_range = [-100, 100]
{claim}
[sensors.velocity]
accuracy = 0.01
scale_factor_error = 0.002
[sensors.yaw_rate]
random_walk = 1e-3
[sensors.acceleration]
random_walk = 2e-3
bias_instability = 1e-3
bias_time = 300
[sensors.heading]
accuracy = 0.01
[sensors.limits]
acceleration = 2
yaw_acceleration = 1
[model]
terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.linear", "friction.coulomb", "drag.surge.astern", "wind.steady"]
"""


@pytest.mark.parametrize(
    "claim",
    [
        "",
        'steering = "azimuth"',
        "advance_loss = 0.05",
        'time_constant = 0.4\nlag = "thrust"',
        "dead_band = 5\nlimit = 20\nreverse_factor = 0.8",
        "rudder = { area = 0.02, aspect_ratio = 2.0, position = -0.6 }",
    ],
)
@pytest.mark.parametrize("demand", ["hold", "linear"])
def test_forces_in_pieces_are_the_forces_in_one(claim, demand):
    text = STEERED.replace("{claim}", claim) + f'[log]\ndemand = "{demand}"\n'
    vehicle = parse_vehicle(text, "a.toml")
    rng, n = np.random.default_rng(5), 900
    t = np.arange(n) * 0.05
    columns = {
        c: rng.uniform(-0.3, 0.3, n) for c in ("u", "v", "r", "ax", "ay", "psi", "azimuth_stern", "rudder_stern")
    }
    columns["demand_stern"] = np.repeat(rng.uniform(-90, 90, n // 9), 9)
    log = Log("a.csv", "0" * 64, t, columns)
    if "time_constant" in claim and demand == "linear":
        with pytest.raises(IvsidError, match="claims a time_constant"):
            build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle))
        return
    bounded = bound_log(log, vehicle)
    rows = [build_rows(bounded, vehicle, terms_of(vehicle), kind="both", piece=p) for p in (10_000, 130)]
    agree(*rows)
    assert {*rows[0].kind} == {0, 1}


def test_a_demand_outside_its_curve_is_said_of_the_first_piece_that_has_one():
    vehicle, log = shipped("swan")
    columns = {**log.columns, "demand_port": log.columns["demand_port"].copy()}
    columns["demand_port"][[300, 1100]] = 150.0, 160.0
    bounded = bound_log(replace(log, columns=columns), vehicle)
    with pytest.raises(IvsidError, match=r"demand 150 of thruster port lies outside its table"):
        build_rows(bounded, vehicle, terms_of(vehicle), piece=160)


def test_pieces_cover_all_rows_once():
    for rows in (1, 2, 1000, 16384, 16385, 100_003):
        found = pieces.pieces(rows, 1000)
        assert [k for s in found for k in range(s.start, s.stop)] == list(range(rows))
        assert max(s.stop - s.start for s in found) <= 1000
    rng = np.random.default_rng(0)
    x = rng.standard_normal(3 * pieces.PIECE + 5)
    made = pieces.interval_pieces(x.size, lambda s: IntervalArray.around(x[s], 0.1))
    whole = IntervalArray.around(x, 0.1)
    assert np.array_equal(made.lower, whole.lower) and np.array_equal(made.upper, whole.upper)


def test_a_piece_that_fails_is_the_first_that_fails():
    def work(part):
        if part.start >= 20:
            raise ValueError(part.start)

    with pytest.raises(ValueError, match="^20$"):
        pieces.over_pieces(pieces.pieces(100, 10), work)


def followed(goal, start, decay, slack, whole):
    """The same step by step, in Python's floats."""
    lower, upper = [start[0]], [start[1]]
    for g_low, g_high, e, s, known in zip(goal.lower[:-1], goal.upper[:-1], decay, slack, whole, strict=True):
        if not known:
            lower.append(start[0])
            upper.append(start[1])
            continue
        least, most = max(e - s, 0.0), min(e + s, 1.0)
        a, b = lower[-1], upper[-1]
        low = min(least * a + (1 - least) * g_low, most * a + (1 - most) * g_low)
        high = max(least * b + (1 - least) * g_high, most * b + (1 - most) * g_high)
        lower.append(low - 1e-15 * (abs(a) + abs(g_low)))
        upper.append(high + 1e-15 * (abs(b) + abs(g_high)))
    return np.array(lower), np.array(upper)


def test_a_lag_is_followed_as_by_hand():
    rng = np.random.default_rng(1)
    for n in (1, 2, 500):
        centre = rng.uniform(-50, 50, n)
        goal = IntervalArray.around(centre, rng.uniform(0, 1, n))
        decay, slack = rng.uniform(0, 1, n - 1), rng.choice([0.0, 1e-14, 0.3], n - 1)
        whole = rng.uniform(size=n - 1) > 0.1
        found = follow((-60.0, 60.0), goal, decay, slack, whole)
        lower, upper = followed(goal, (-60.0, 60.0), decay, slack, whole)
        assert found.lower.tobytes() == lower.tobytes() and found.upper.tobytes() == upper.tobytes()
    with pytest.raises(IvsidError, match="lag"):
        follow((0.0, 1.0), goal, decay[1:], slack, whole)


def test_a_signed_square_is_the_core_s_own_operation():
    rng = np.random.default_rng(2)
    special = np.array([0.0, 5e-324, 1e-308, 1e-160, 1.0, 1 + 2**-52, 1.3e154, 1.4e154, 1e308, np.inf])
    v = np.r_[rng.standard_normal(5000) * 10.0 ** rng.uniform(-200, 200, 5000), np.tile(np.r_[special, -special], 50)]
    a, b = rng.permutation(v), rng.permutation(v)
    low, high = np.minimum(a, b), np.maximum(a, b)
    proper = (low < np.inf) & (high > -np.inf)
    x = IntervalArray(low[proper], high[proper])
    found, reference = x.signed_square(), x._unary("signed_square")
    assert found.lower.tobytes() == reference.lower.tobytes() and found.upper.tobytes() == reference.upper.tobytes()
    assert x.magnitude.tobytes() == x._measure("magnitude").tobytes()


@pytest.mark.parametrize("threads", [1, 2, 3, 8])
def test_pieces_come_back_in_their_order_and_the_first_fault_in_order_is_raised(monkeypatch, threads):
    monkeypatch.setattr("ivsid.memory.pieces.processors", lambda: threads)
    parts = pieces.pieces(40, 1)
    assert pieces.over_pieces(parts, lambda part: part.start**2) == [k**2 for k in range(40)]
    assert pieces.over_pieces([], len) == []

    def fails(part):
        if part.start in (30, 7, 12):
            raise ValueError(part.start)
        return part.start

    for _ in range(20):
        with pytest.raises(ValueError, match="^7$"):
            pieces.over_pieces(parts, fails)


def test_work_on_pieces_waits_for_no_thread_that_does_not_begin(monkeypatch):
    waiting = []
    monkeypatch.setattr("ivsid.memory.pieces.processors", lambda: 3)
    monkeypatch.setattr("ivsid.memory.pieces.start_new_thread", lambda *task: waiting.append(task))
    assert pieces.over_pieces(pieces.pieces(9, 1), lambda part: part.start) == list(range(9))
    for function, arguments in waiting:
        # Threads that begin late find nothing to do.
        function(*arguments)

    def refused(*_):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("ivsid.memory.pieces.start_new_thread", refused)
    assert pieces.over_pieces(pieces.pieces(9, 1), lambda part: part.start) == list(range(9))


def test_an_interrupt_in_a_piece_is_raised_when_no_thread_works_any_more(monkeypatch):
    monkeypatch.setattr("ivsid.memory.pieces.processors", lambda: 2)
    done = []

    def work(part):
        if part.start == 3:
            raise KeyboardInterrupt
        done.append(part.start)

    with pytest.raises(KeyboardInterrupt):
        pieces.over_pieces(pieces.pieces(12, 1), work)
    assert sorted(done) == [k for k in range(12) if k != 3]


def test_no_thread_holds_the_memory_of_the_work_when_it_is_done(monkeypatch):
    """Rows that were given back lay in memory until a thread that was still about to end had gone."""
    monkeypatch.setattr("ivsid.memory.pieces.processors", lambda: 4)
    for _ in range(200):
        held = np.ones(64)
        kept = weakref.ref(held)
        pieces.over_pieces(pieces.pieces(held.size, 4), lambda part, held=held: held[part].sum())
        del held
        assert kept() is None
