"""The stages of a diagnosis by their own functions: screening, its threshold, and the comparison on another log.

Whole diagnoses of the same logs run in `make nightly`; here stands what each of them rests on first.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt
from tests.exam.draw import case

import test_diagnosis_truth as otter
from diagnosis_logs import (
    RUDDER,
    STEERED,
    TRUTH,
    TWIN,
    epochs,
    gaps,
    logs_of,
    rows,
    screened,
    train_of,
    vehicle_of,
    wild,
    with_columns,
)
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.null.visibility import VISIBLE, visibility
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.statements.comparison import compare, low
from ivsid.effects import EFFECTS, Given, register, terms_of, unregister
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle
from test_own_effects import BLOCKS


def without(*lost):
    return lambda log, rng: Log(log.name, log.sha256, log.t, {k: x for k, x in log.columns.items() if k not in lost})


def first_half(log, rng):
    return rows(log, log.t < 120)


def second_half(log, rng):
    return rows(log, log.t >= 120)


@pytest.mark.parametrize(
    "change",
    [gaps, wild, epochs, without("psi", "x", "y"), without("ax", "ay"), without("psi", "x", "y", "ax", "ay")],
    ids=["gaps", "wild", "epochs", "no pose", "no acceleration", "velocities alone"],
)
def test_no_candidate_passes_in_a_damaged_log_of_a_true_model(change):
    vehicle = vehicle_of()
    found = screened(vehicle, change(train_of(vehicle), np.random.default_rng(5)))
    assert not found.passed and found.quiet
    for id_, value in TRUTH.items():
        assert found.fit.h.values[id_] == pytest.approx(value, rel=0.06), id_


def test_readings_that_stand_far_out_are_said_and_a_short_log_tests_less():
    vehicle = vehicle_of()
    train = train_of(vehicle)
    notes = channels(wild(train, np.random.default_rng(5)), vehicle).notes
    assert any("stand far out" in n for n in notes)
    short = screened(vehicle, rows(train, train.t < 70))
    assert not short.passed and short.quiet
    shown = visibility(short.fit)
    assert len(short.fit.refused) + sum(v.z < VISIBLE or v.blind for v in shown.values()) > 5


# Nightly: the other half of each.
@pytest.mark.parametrize(
    ("half", "effects"),
    [
        (first_half, {"drag.surge.linear": 0.15}),
        (second_half, {"friction.coulomb": 0.03}),
        pytest.param(second_half, {"drag.surge.linear": 0.15}, marks=pytest.mark.nightly),
        pytest.param(first_half, {"friction.coulomb": 0.03}, marks=pytest.mark.nightly),
    ],
)
def test_half_a_log_of_a_faint_cause_passes_nothing(effects, half):
    vehicle = vehicle_of()
    found = screened(vehicle, half(train_of(vehicle, effects), None))
    assert not found.passed and found.quiet


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        # Nightly: the gate has a cause of each other kind.
        pytest.param("drag.yaw.linear", {"drag.yaw.linear": 1.0}, marks=pytest.mark.nightly),
        # Nightly: the gate has the current of the Otter's log.
        pytest.param(
            "current.steady", {"current.steady.north": 0.08, "current.steady.east": 0.05}, marks=pytest.mark.nightly
        ),
        ("thruster.lag", {"thruster.lag": 0.25}),
        # Nightly: the gate names an arm beside its bound, and a wind beside slow forces, in tests of their own.
        pytest.param(
            "sensor.velocity.lever_arm",
            {"sensor.velocity.lever_arm.x": 0.1, "sensor.velocity.lever_arm.y": 0.05},
            marks=pytest.mark.nightly,
        ),
        pytest.param("wind.steady", {"wind.steady.north": 1.5, "wind.steady.east": -1.0}, marks=pytest.mark.nightly),
    ],
)
def test_a_hidden_effect_is_screened_first(effect, values):
    vehicle = vehicle_of()
    found = screened(vehicle, train_of(vehicle, values))
    assert found.passed[0] == effect, found.passed
    numbers = found.of(effect).values
    for part, number in zip(EFFECTS[effect].parts, numbers, strict=True):
        # A secant from the next value of a grid: 0.339 s from 0.2 s, for a lag of 0.25 s.
        assert number == pytest.approx(values[part], rel=0.37), part


def test_an_effect_is_screened_across_gaps_and_epochs():
    vehicle = vehicle_of()
    rng = np.random.default_rng(6)
    train = train_of(vehicle, {"drag.yaw.linear": 1.5})
    assert screened(vehicle, epochs(gaps(train, rng), rng)).passed[0] == "drag.yaw.linear"


# Nightly: other plants are screened in the gate.
@pytest.mark.nightly
def test_a_rudder_is_followed_and_what_is_hidden_behind_it_is_screened():
    vehicle = vehicle_of(RUDDER)
    found = screened(vehicle, train_of(vehicle, segments=STEERED, duration=120.0))
    assert not found.passed and found.quiet
    assert found.fit.h.values["inertia.yaw"] == pytest.approx(TRUTH["inertia.yaw"], rel=0.1)
    hidden = screened(vehicle, train_of(vehicle, {"drag.surge.linear": 6.0}, segments=STEERED, duration=120.0))
    assert "drag.surge.linear" in hidden.passed[:3]


@pytest.mark.parametrize(("claim", "wrong"), [(28.0, False), (20.0, True)])
def test_a_wrong_claim_passes_and_a_true_one_does_not(claim, wrong):
    vehicle = vehicle_of(extra=f'[model]\nvalues = {{ "drag.surge.quadratic" = {claim} }}\n')
    found = screened(vehicle, train_of(vehicle))
    assert ("drag.surge.quadratic" in found.passed) == wrong and bool(found.passed) == wrong


# Nightly: the gate mirrors port and starboard.
@pytest.mark.nightly
def test_turning_the_earth_frame_turns_the_score_of_a_current():
    vehicle = vehicle_of()
    train = train_of(vehicle, {"current.steady.north": 0.08, "current.steady.east": 0.05})
    c, s = np.cos(0.9), np.sin(0.9)
    x, y = train.columns["x"], train.columns["y"]
    new = {"psi": train.columns["psi"] + 0.9, "x": c * x - s * y, "y": s * x + c * y}
    turned = Log(train.name, train.sha256, train.t, {**train.columns, **new})
    one, other = screened(vehicle, train), screened(vehicle, turned)
    assert one.passed[0] == other.passed[0] == "current.steady"
    a, b = (q.of("current.steady").values for q in (one, other))
    np.testing.assert_allclose(b, [c * a[0] - s * a[1], s * a[0] + c * a[1]], atol=2e-3)


def test_port_and_starboard_mirrored_mirror_the_scores():
    vehicle = vehicle_of()
    train = train_of(vehicle, {"coupling.cg_y": 1.5}, duration=120.0)
    columns = {k: -x if k in ("v", "r", "ay", "psi", "y") else x for k, x in train.columns.items()}
    port, starboard = (train.columns[f"demand_{side}"] for side in ("port", "starboard"))
    mirrored = Log(train.name, train.sha256, train.t, {**columns, "demand_port": starboard, "demand_starboard": port})
    one, other = screened(vehicle, train), screened(vehicle, mirrored)
    assert one.passed[0] == other.passed[0] == "coupling.cg_y"
    assert one.of("coupling.cg_y").values[0] == pytest.approx(-other.of("coupling.cg_y").values[0], rel=1e-3)


def test_demands_in_other_units_change_no_score():
    demand = [-100, -60, -30, 0, 30, 60, 100]
    other = vehicle_of(TWIN.replace(str(demand), str([10 * d for d in demand])))
    vehicle = vehicle_of()
    train = train_of(vehicle, {"drag.surge.linear": 4.0}, duration=120.0)
    scaled = with_columns(train, lambda k, x: 10 * x if k.startswith("demand") else x)
    one, two = screened(vehicle, train), screened(other, scaled)
    assert one.passed == two.passed and one.passed[0] == "drag.surge.linear"
    for s in one.scores:
        if s.id in one.passed and not s.id.startswith("thruster."):
            assert two.of(s.id).values == pytest.approx(s.values, rel=1e-3), s.id


def tried(vehicle, log, effect, *values):
    """The true model and the same with an effect, on a log."""
    plain = Hypothesis(terms_of(vehicle), dict(TRUTH))
    return compare(
        Predictor(vehicle, channels(log, vehicle), declared_ambient(vehicle)),
        plain,
        plain.with_effect(Given(EFFECTS[effect], values)),
    )


def test_shuffled_demands_gain_nothing_and_those_that_moved_the_vehicle_do():
    vehicle = vehicle_of()
    _, test = logs_of(vehicle, {"thruster.lag": 0.4})
    assert max(b / a for b, a in tried(vehicle, test, "thruster.lag", 0.4).simulation_rms.values()) > 1.5
    blocks = np.random.default_rng(8).permutation(test.t.size // 40)

    def shuffled(k, x):
        if not k.startswith("demand"):
            return x
        parts = x[: blocks.size * 40].reshape(-1, 40)
        return np.r_[parts[blocks].ravel(), x[blocks.size * 40 :]]

    worth = tried(vehicle, with_columns(test, shuffled), "thruster.lag", 0.4).simulation_rms
    assert all(b / a < 1.15 for b, a in worth.values()), worth


def test_an_effect_that_is_not_there_makes_the_motion_worse():
    vehicle = vehicle_of()
    worth = tried(vehicle, logs_of(vehicle)[1], "thruster.lag", 0.8).simulation_rms
    assert max(after / before for before, after in worth.values()) > 1.25, worth


def test_an_effect_of_ones_own_with_two_channels_is_screened():
    names, before = {}, set(EFFECTS)
    exec(BLOCKS["python"][1], names)
    register(names["FIN"])
    try:
        vehicle = vehicle_of()
        found = screened(vehicle, train_of(vehicle, {"drag.stern_fin": 15.0}))
        assert "drag.stern_fin" in found.passed[:3], found.passed
    finally:
        for id_ in set(EFFECTS) - before:
            unregister(id_)


@pytest.mark.parametrize(
    ("name", "first"),
    [
        # Nightly: the gate has the same drag beside a current.
        pytest.param(otter.CALM, "drag.surge.linear", id="calm", marks=pytest.mark.nightly),
        pytest.param(otter.CURRENT, "current.steady", id="current"),
    ],
)
def test_the_otters_strongest_cause_passes_first(real, name, first):
    """The simulator's drag in calm water, and its current where one runs."""
    found = screened(parse_vehicle(otter.OTTER, "otter.toml"), otter.part(real(name), 0, 3000, 1))
    assert not found.quiet
    # A thrust curve inside its accuracy takes some of the current in one direction, and a hump is a drag of surge in another form: the three change places.
    count = 1 + 2 * (first != "drag.surge.linear")
    assert (
        {first, "drag.surge.linear"} <= set(found.passed[:count]) <= {first, "drag.surge.linear", "drag.surge.hump"}
    ), found.passed


@pytest.mark.parametrize(
    ("seed", "given", "effect"),
    [
        # Nightly: the gate diagnoses a lag, of the same grid of times.
        pytest.param(113018, {"what": "one"}, "thruster.delay", marks=pytest.mark.nightly),
        # Nightly: a longer sail with the cause of the one before.
        pytest.param(113027, {"what": "one"}, "thruster.delay", marks=pytest.mark.nightly),
        # Nightly: the gate scores a copy of a tether (test_own_effects.py).
        pytest.param(113002, {"what": "one"}, "tether.tension", marks=pytest.mark.nightly),
        # Nightly: the gate scores a copy of a dead band (test_own_effects.py).
        pytest.param(
            112004,
            {"what": "one", "effect": "thruster.deadband", "duration": 150.0},
            "thruster.deadband",
            marks=pytest.mark.nightly,
        ),
        # Nightly: the longer sail, which is diagnosed as a whole there, too.
        pytest.param(
            112004,
            {"what": "one", "effect": "thruster.deadband", "duration": 300.0, "size": 0.6},
            "thruster.deadband",
            marks=pytest.mark.nightly,
        ),
    ],
)
def test_the_cause_of_a_drawn_case_is_among_those_that_pass(seed, given, effect):
    c = case(seed, **given, train_alone=True)
    found = screened(c.vehicle, Log("1.csv", "0" * 64, c.train.t, c.train.columns))
    assert effect in found.passed, found.passed


# Nightly: longer sails of the same kind.
@pytest.mark.parametrize(
    ("seed", "given"),
    [
        pytest.param(46502, {}, marks=pytest.mark.nightly),
        pytest.param(46503, {}, marks=pytest.mark.nightly),
        (46503, {"duration": 150.0}),
    ],
)
def test_velocities_every_fourth_row_pass_nothing(seed, given):
    c = case(seed, what="none", **given)
    kept = np.arange(c.train.t.size) % 4 == 0
    columns = {k: np.where(kept, x, np.nan) if k in ("u", "v") else x for k, x in c.train.columns.items()}
    found = screened(c.vehicle, Log("1.csv", "0" * 64, c.train.t, columns))
    assert not found.passed and found.quiet


@pytest.mark.parametrize("h", [0.02, 0.1, 0.5])
def test_forces_are_those_of_a_butterworth_filter_both_ways(h):
    """SciPy's filter starts from fifteen samples beyond each end, so that the ends differ."""
    n = round(600 / h)
    rows_ = np.random.default_rng(3).standard_normal((3, n)).cumsum(axis=1)
    found = low(SimpleNamespace(log=SimpleNamespace(h=h)), rows_)
    both_ways = sosfiltfilt(butter(4, 0.35, fs=1 / h, output="sos"), rows_, axis=1)
    inner = slice(round(60 / h), n - round(60 / h))
    np.testing.assert_allclose(found[:, inner], both_ways[:, inner], atol=1e-7 * rows_.std())
    # A straight line is passed up to its ends.
    line = np.linspace(-3.0, 5.0, n)[None]
    np.testing.assert_allclose(low(SimpleNamespace(log=SimpleNamespace(h=h)), line), line, atol=1e-6)


def test_a_log_slower_than_the_cut_off_is_passed_whole():
    x = np.random.default_rng(4).standard_normal((2, 90))
    np.testing.assert_allclose(low(SimpleNamespace(log=SimpleNamespace(h=2.0)), x), x, atol=1e-9)
