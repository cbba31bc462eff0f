"""The core's filters against SciPy and the sums that define them, and what the diagnosis saves against what it saves it from."""

import multiprocessing
import os
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter
from tests.exam.cases import case

from diagnosis_logs import SENSORS, TRUTH, TWIN, ZIGZAGS
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.noise import (
    CONTRACTION,
    MOST_QUICKENINGS,
    QUICKENING,
    declared_ambient,
    quick_enough,
)
from ivsid.diagnosis.estimation.whitening import Whitening
from ivsid.diagnosis.plant.physics import Hypothesis, acceleration, added_force
from ivsid.diagnosis.plant.readings import added_readings, exact_readings
from ivsid.diagnosis.plant.thruster_forces import bollard_force, thruster_force
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.selection.parallel import side_by_side
from ivsid.diagnosis.statements.windows import windows
from ivsid.effects import EFFECTS, Given, Reading, terms_of
from ivsid.intervals.apart import LOOK, Apart, Prepared, in_turn
from ivsid.linear.filters import decaying, respond, table_thrust, whiten
from ivsid.log import Log
from ivsid.memory.pieces import processors
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle


@pytest.fixture(scope="module")
def predictor():
    vehicle = parse_vehicle(TWIN + SENSORS, "twin.toml")
    head = "duration = 90.0\nrate = 10.0\nseed = 5\n[truth]\n" + "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items())
    made = simulate(vehicle, parse_scenario(head + ZIGZAGS, "s.toml"), 5)
    return Predictor(
        vehicle, channels(Log("1.csv", "0" * 64, made.t, made.columns), vehicle), declared_ambient(vehicle)
    )


@pytest.fixture(scope="module")
def plain(predictor):
    return Hypothesis(terms_of(predictor.vehicle), dict(TRUTH))


def test_recursions_are_those_of_scipy(predictor):
    rng = np.random.default_rng(1)
    n = predictor.log.n
    for k, here in enumerate(predictor.axes):
        inputs = {name: rng.standard_normal(n) for name in (*here.outputs, "process")}
        expected = [
            sum(lfilter(here.numerators[name, output], here.denominator, x) for name, x in inputs.items())
            for output in here.outputs
        ]
        found = here.errors(inputs)
        assert np.allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
        # An axis answers alone as it answers among the others, to the bit.
        first = sum(len(a.outputs) for a in predictor.axes[:k])
        among = predictor.filters.errors({(k, name): x for name, x in inputs.items()})
        assert np.array_equal(among[first : first + len(here.outputs)], found)
        assert not np.delete(among, range(first, first + len(here.outputs)), axis=0).any()


def test_whitening_is_the_sum_that_defines_it():
    rng = np.random.default_rng(2)
    n, lags, length = 137, 5, 20
    white = Whitening(
        ((0, 2), (1,), (3,)),
        (rng.standard_normal((lags + 1, 2, 2)), rng.standard_normal((lags + 1, 1, 1)), np.zeros((1, 1, 1))),
    )
    x = rng.standard_normal((3, 4, n))
    expected = np.zeros_like(x)
    for rows, taps in zip(white.groups, white.taps, strict=True):
        for lag, tap in enumerate(taps):
            expected[:, list(rows), lag:] += np.einsum("ij,cjt->cit", tap, x[:, list(rows), : n - lag])
    assert np.allclose(white(x), expected, atol=1e-12)
    good = rng.random(n) > 0.2
    blocks, unit = white.blocks(list(x), good, length)
    kept = np.where(good, expected, 0.0)[..., : n // length * length]
    kept = kept.reshape(3, 4, -1, length).transpose(0, 2, 1, 3).reshape(3, n // length, -1)
    size = np.sqrt((kept**2).sum(axis=(1, 2)))
    assert np.allclose(unit, size) and np.allclose(blocks, kept / size[:, None, None])


@pytest.mark.parametrize(
    "call",
    [
        lambda: respond([np.zeros(5), np.zeros(6)], np.zeros((1, 2, 4)), np.ones((1, 4))),
        lambda: respond([np.zeros(5)], np.zeros((2, 1, 4)), np.ones((1, 4))),
        lambda: respond([np.zeros(5)], np.zeros((1, 1, 5)), np.ones((1, 5))),
        lambda: table_thrust(np.zeros(5), 0.0, [0.0, 1.0], [[0.0] * 4] * 2, None),
        lambda: table_thrust(np.zeros(5), 0.0, [0.0], [], None),
        lambda: table_thrust(np.zeros(5), 0.0, [0.0, 1.0], [[0.0] * 4], (1.0, 0.1, np.zeros(2), np.zeros(3), None)),
        lambda: whiten([], [[0]], [np.ones((1, 1, 1))], 5),
        lambda: whiten([np.zeros((2, 5))], [[0, 2]], [np.ones((1, 2, 2))], 5),
        lambda: whiten([np.zeros((2, 5))], [[0]], [np.ones((1, 2, 2))], 5),
        lambda: whiten([np.zeros((2, 5))], [[0]], [np.ones((1, 1, 1))], 0),
        lambda: whiten([np.zeros((2, 5))], [[0]], [np.ones((1, 1, 1))], 5, np.ones(4)),
    ],
)
def test_shapes_that_do_not_fit_are_refused(call):
    with pytest.raises(ValueError, match="fit each other"):
        call()


@pytest.mark.parametrize("id_", [i for i, e in EFFECTS.items() if e.acts.additive])
def test_what_a_force_adds_is_the_difference_of_both_models(predictor, plain, id_):
    effect = EFFECTS[id_]
    if "wind" in id_ or (effect.measured is None and any(not predictor.log.has(n) for n in effect.needs)):
        pytest.skip("this log does not have what it needs")
    values = tuple(
        0.0 if p.draw == "thruster" else (float(predictor.log.t[200]) if p.draw == "time" else p.none + p.scaled(60.0))
        for p in effect.parameters
    )
    states = predictor.settle(predictor.start(plain))
    other = plain.with_effect(Given(effect, values))
    under = states.points.under(*predictor.driving.force(other))
    added = added_force(predictor.vehicle, plain, states.points, other, under)
    expected = acceleration(predictor.vehicle, other, under) - states.nudot
    found = predictor.mass(states).solve(added)
    assert np.allclose(found, expected, rtol=1e-9, atol=1e-11)
    assert isinstance(effect.acts, Reading) == (not np.any(found)) or not np.any(expected)
    # Taken out again, it is the same with the other sign.
    back = added_force(predictor.vehicle, other, under, plain, states.points)
    assert np.allclose(back, -added, rtol=1e-12, atol=1e-12)


def test_what_states_share_is_worked_out_once_and_is_the_same(predictor, plain):
    """Headings, mass matrices and specific forces, which most signatures ask for at the same states."""
    states = predictor.start(plain)
    moved = states.points.moved(np.ones((3, 1)))
    assert moved.heading is states.points.heading
    turned = replace(states.points, psi=states.points.psi + 1.0)
    np.testing.assert_array_equal(turned.heading.cos(), np.cos(turned.psi))
    np.testing.assert_array_equal(moved.heading.sin(), np.sin(moved.psi))
    mass = predictor.constant_mass(plain)
    assert predictor.constant_mass(replace(plain, given=(Given(EFFECTS["thruster.advance_loss"], (0.1,)),))) is mass
    heavier = replace(plain, values={**plain.values, "mass.surge": 2 * plain.values["mass.surge"]})
    assert predictor.constant_mass(heavier).inverse[0, 0, 0] == pytest.approx(mass.inverse[0, 0, 0] / 2)
    assert predictor.constant_mass(replace(plain, given=(Given(EFFECTS["fouling.drift"], (1e-3,)),))) is None
    assert predictor.dynamics(plain, mass) is predictor.dynamics(plain, mass)
    nu, nudot = states.points.nu, states.nudot
    expected = np.stack([nudot[0] - nu[1] * nu[2], nudot[1] + nu[0] * nu[2], nudot[2]])
    np.testing.assert_array_equal(states.specific, expected)
    assert states.specific is states.specific and states.over is states.over


def test_angles_that_are_known_turn_thrusts_as_those_that_are_not(predictor, plain):
    states = predictor.start(plain)
    given = (Given(EFFECTS["thruster.advance_loss"], (0.3,)),)
    bare = replace(states.points, bollard=None, swing=None)
    relative = tuple(bare.nu)
    np.testing.assert_array_equal(
        thruster_force(predictor.vehicle, given, states.points, relative),
        thruster_force(predictor.vehicle, given, bare, relative),
    )


def test_what_changes_more_than_forces_is_worked_out_whole(predictor, plain):
    p = predictor.start(plain).points
    for id_, values in (("current.steady", (0.1, 0.2)), ("payload.step", (2.0, 30.0))):
        assert added_force(predictor.vehicle, plain, p, plain.with_effect(Given(EFFECTS[id_], values)), p) is None
    assert added_force(predictor.vehicle, plain, p, Hypothesis(plain.terms, dict(plain.values)), p) is None


def test_thrusts_that_are_remembered_are_those_that_are_asked_for(predictor, plain):
    lagged = plain.with_effect(Given(EFFECTS["thruster.lag"], (0.4,)))
    slower = plain.with_effect(Given(EFFECTS["thruster.lag"], (0.8,)))
    fresh = Predictor(predictor.vehicle, predictor.log, predictor.ambient)
    for h in (plain, lagged, slower, plain, lagged):
        thrusts, bollard = predictor.driving.force(h)
        again = fresh.propulsion.thrusts(h.given, [(), ()])
        assert np.array_equal(thrusts, np.concatenate([again.now, again.mean], axis=1))
        turn = np.cos(predictor.driving.turned), np.sin(predictor.driving.turned)
        assert np.array_equal(bollard, bollard_force(predictor.vehicle, thrusts, turn))
    points = predictor.start(lagged).points
    relative = tuple(points.nu)
    slow = thruster_force(predictor.vehicle, lagged.given, points.under(points.thrusts), relative)
    assert np.allclose(thruster_force(predictor.vehicle, lagged.given, points, relative), slow, rtol=1e-13, atol=1e-12)


def test_windows_sail_together_as_they_do_alone(predictor, plain):
    states = predictor.settle(predictor.start(plain))
    together = windows(predictor, states, (10.0, 30.0))
    for found, length in zip(together, (10.0, 30.0), strict=True):
        (alone,) = windows(predictor, states, (length,))
        for a, b in zip(found, alone, strict=True):
            assert np.allclose(a, b, rtol=1e-12, atol=1e-12, equal_nan=True)


def resting(t, h):
    """A hull that comes to rest under a held thrust, whose acceleration falls by 4 % in 0.1 s.

    Returns:
        Its velocity at any times, and as the product has it: points, accelerations and exact readings at the times t and in the middles of steps h.
    """
    k = 0.4

    def velocity(t):
        return np.stack([1.0 - 1.2 * np.exp(-k * t), 0.3 * np.exp(-k * t), 0.1 * np.exp(-2 * k * t)])

    at = np.r_[t, t + h / 2]
    nudot = np.stack([1.2 * k * np.exp(-k * at), -0.3 * k * np.exp(-k * at), -0.2 * k * np.exp(-2 * k * at)])
    points = SimpleNamespace(nu=velocity(at), thrusts=np.zeros((1, at.size)), psi=np.zeros(at.size))
    return velocity, points, nudot, exact_readings(points, nudot, np.zeros((3, t.size)), 0.0)


@pytest.mark.parametrize("delay", [0.03, 0.05, 0.13])
def test_a_late_velocity_is_the_one_that_the_motion_had(delay):
    h, t = 0.1, 0.1 * np.arange(50)
    velocity, points, nudot, exact = resting(t, h)
    late = (Given(EFFECTS["sensor.velocity.delay"], (delay,)),)
    added = added_readings(late, points, nudot, exact, h)
    truth = velocity(t - delay) - velocity(t)
    for name, change in zip("uv", truth, strict=False):
        # The first steps have no past. A constant acceleration over the step would be off by one to two per cent.
        assert np.allclose(added[name][4:], change[4:], rtol=2e-3), name


def test_passes_settle_however_the_axes_act_on_one_another(predictor, plain):
    calm = np.broadcast_to(np.diag([-0.1, -0.2, -0.1])[..., None], (3, 3, 50))
    assert quick_enough(predictor, calm) is predictor
    coupled = calm.copy()
    # A rotation of sway and yaw: no damping tells of it.
    coupled[1, 2], coupled[2, 1] = 4.0, -4.0
    quicker = quick_enough(predictor, coupled)
    memory = [axis.memory for axis in quicker.axes[:3]]
    assert memory[1] * memory[2] * 16.0 <= CONTRACTION**2 * 1.01
    assert all(m < axis.memory for m, axis in zip(memory, predictor.axes, strict=False))
    # States that have run away are no reason for an error here.
    assert quick_enough(predictor, np.full_like(coupled, np.nan)) is predictor
    # A push that is strong in half of the log counts.
    coupled[1, 2, ::2] = 0.0
    slower = [a.memory for a in quick_enough(predictor, coupled).axes[:3]]
    # Filters with an accelerometer are as quick as their velocities allow in both cases.
    assert slower[0] >= memory[0] and slower[1] >= memory[1] and slower[2] > memory[2]


def test_a_filter_is_made_no_quicker_than_shortens_its_memory(predictor):
    """Its accelerometer tells the ambient acceleration at once: what else is expected of that is noise of its readings."""
    fast = np.broadcast_to(np.diag([-6.0, -6.0, -0.1])[..., None], (3, 3, 50))
    quicker = quick_enough(predictor, fast)
    for k in (0, 1):
        d, first = quicker.ambient.deviation[k], predictor.ambient.deviation[k]
        assert first < d < first * QUICKENING ** (MOST_QUICKENINGS - 1)
        more = [d * QUICKENING**j if i == k else x for j in (1, 2) for i, x in enumerate(quicker.ambient.deviation)]
        after = [quicker.adopt(Ambient(tuple(more[i : i + 3]), quicker.ambient.time)).axes[k].memory for i in (0, 3)]
        assert after[0] > 0.95 * quicker.axes[k].memory
        # No shorter memory was passed over.
        assert after[1] > 0.9 * quicker.axes[k].memory
    assert quicker.ambient.deviation[2] == predictor.ambient.deviation[2]


# Nightly: the gate has the spectral radius.
@pytest.mark.nightly
def test_states_of_a_slow_vessel_that_turns_settle():
    """Coriolis terms at 2 m/s, a calm sea and a vessel that hardly damps: its states ran away from pass to pass."""
    c = case(52134, duration=300.0)
    vehicle = parse_vehicle(c.text, "v.toml")
    columns = {k: x for k, x in c.logs[0].items() if k != "t"}
    fit = plain_fit(vehicle, channels(Log("1.csv", "0" * 64, c.logs[0]["t"], columns), vehicle), everything)
    states, moves = fit.noise.predictor.settle(fit.states, 1), []
    for _ in range(4):
        new = fit.noise.predictor.settle(states, 1)
        moves.append(np.abs(new.points.nu - states.points.nu).max())
        states = new
    assert moves[-1] < 0.5 * moves[0] < 1e-3


def test_tasks_keep_their_order_their_faults_and_what_is_ignored():
    with np.errstate(over="ignore"):
        found = side_by_side([lambda k=k: (k, np.geterr()["over"]) for k in range(7)])
    assert found == [(k, "ignore") for k in range(7)]
    with pytest.raises(ZeroDivisionError):
        side_by_side([lambda: 1, lambda: 1 // 0, lambda: 2])


def test_a_task_apart_keeps_its_result_and_its_fault():
    """In a process of its own where one can be forked; a task that fails there is done again here, and raises."""
    alone = processors() < 2 or "fork" not in multiprocessing.get_all_start_methods()
    assert (Apart(os.getpid).result() == os.getpid()) == (alone or multiprocessing.current_process().daemon)
    with pytest.raises(ZeroDivisionError):
        Apart(lambda: 1 // 0).result()
    never = Apart(lambda: time.sleep(60))
    never.end()
    early, copied = Prepared.some(2, lambda x: (x, os.getpid()), lambda: None)
    first, second, beside = early.begin("a"), early.begin("b"), copied.begin("c")
    # Results keep their order, whichever is asked for first.
    (other, there), (given, where), (apart, elsewhere) = second(), first(), beside()
    assert (given, other, apart, where) == ("a", "b", "c", there)
    assert (where == os.getpid()) == (alone or multiprocessing.current_process().daemon)
    assert (elsewhere == where) == (where == os.getpid())
    # Both have looked for the process that started them.
    time.sleep(3 * LOOK)
    assert (early.begin("d")(), copied.begin("e")()) == (("d", where), ("e", elsewhere))
    early.end()
    time.sleep(3 * LOOK)
    # A copy ends with the process that it is a copy of, and its tasks are done here.
    assert copied.begin("f")() == ("f", os.getpid())
    for ready in (lambda: None, lambda: 1 // 0):
        for broken in Prepared.some(2, lambda x: 1 // x, ready):
            results = broken.begin(0), broken.begin(1)
            with pytest.raises(ZeroDivisionError):
                results[0]()
            # What comes after a fault is done here.
            assert results[1]() == 1
    (unsent,) = Prepared.some(1, lambda task: task(), lambda: None)
    assert unsent.begin(lambda: 7)() == 7
    unsent.end()
    # The processes of the other two end by themselves.
    for process in multiprocessing.active_children():
        process.join(30)
    assert not multiprocessing.active_children()


def test_tasks_in_turn_share_a_process_and_wait_for_nobody(monkeypatch):
    """A long result that nobody takes, and a task that fails, hold up no later task."""
    monkeypatch.setattr("ivsid.intervals.apart.processors", lambda: 2)
    long, broken, last = (
        Apart(task, late=late, begun=False)
        for task, late in ((lambda: bytes(1 << 22), False), (lambda: 1 // 0, False), (os.getpid, True))
    )
    in_turn(long, broken, last)
    apart = last._worker is broken._worker if hasattr(last, "_worker") else False
    where = last.result()
    assert (where != os.getpid()) == apart
    with pytest.raises(ZeroDivisionError):
        broken.result()
    long.drop()
    for process in multiprocessing.active_children():
        process.join(30)
    assert not multiprocessing.active_children()


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="null logs run on forked processes")
def test_a_forked_process_whitens_after_its_parent():
    """A pool of threads stays behind in the parent, and its child would wait for it for ever."""
    columns = list(np.random.default_rng(4).standard_normal((12, 8, 12000)))
    taps = [np.ones((3, 8, 8))]

    def work(into):
        into.send(float(whiten(columns, [range(8)], taps, 200, unit=True)[1][-1]))

    expected = whiten(columns, [range(8)], taps, 200, unit=True)[1][-1]
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe(duplex=False)
    child = context.Process(target=work, args=(there,))
    child.start()
    try:
        assert here.poll(60.0) and here.recv() == expected
    finally:
        child.kill()
        child.join()


def test_a_decaying_sum_is_that_of_scipy():
    x = np.random.default_rng(3).standard_normal((2, 500))
    np.testing.assert_allclose(decaying(x, 0.9), lfilter([1.0], [1.0, -0.9], x), rtol=1e-12, atol=1e-12)
