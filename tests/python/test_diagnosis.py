"""The diagnosis: effects that are hidden in simulated logs, logs that hide none, and what a result must look like."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from diagnosis_logs import SENSORS, TRUTH, TWIN, ZIGZAGS
from ivsid import IvsidError, diagnose
from ivsid.diagnosis import extended_vehicle, isolability, search
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.noise import declared_ambient, usable_rows
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.effects import terms_of
from ivsid.files.records import to_json
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

VEHICLE = TWIN + SENSORS
SEGMENTS = (
    ZIGZAGS
    + """\
[[segments]]
manoeuvre = "zigzag"
demand = 30.0
yaw_rate = -0.25
yaw_gain = 25.0
period = 5.0
differential_limit = 25.0
duration = 30.0
"""
)
# The seed of these draws is fixed; `tests/exam` draws fresh ones.
SEEDS = {"train": 11, "test": 12}


def logs(effects=None, vehicle=None, duration=300.0, rate=10.0, seed=0):
    vehicle = vehicle or parse_vehicle(VEHICLE, "twin.toml")
    made = []
    for name, number in SEEDS.items():
        head = f"duration = {duration}\nrate = {rate}\nseed = {number}\n[truth]\n"
        head += "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items())
        same = SEEDS["train"] + seed
        scenario = parse_scenario(head + SEGMENTS, "s.toml")
        done = simulate(vehicle, scenario, number + seed, effects or {}, thrusters=same)
        made.append(Log(f"{name}.csv", "0" * 64, done.t, done.columns))
    return vehicle, *made


def sets(result):
    return [{f.effect, *f.alternatives} for f in result.findings]


def test_a_true_model_leaves_white_errors():
    """At the true parameters the prediction errors of every channel have no memory, whatever the feedback of the programme."""
    vehicle, train, _ = logs()
    data = channels(train, vehicle)
    predictor = Predictor(vehicle, data, declared_ambient(vehicle))
    h = Hypothesis(terms_of(vehicle), TRUTH)
    states = predictor.settle(predictor.start(h), 4)
    errors, good = predictor.errors(states), usable_rows(predictor)
    for (axis, name), row in zip(predictor.labels, errors, strict=True):
        x = row[good] - row[good].mean()
        memory = [float(x[lag:] @ x[:-lag] / (x @ x)) for lag in (1, 2, 3)]
        # 4 standard deviations of 2960 samples, and the moment of the thrust errors that are declared.
        assert np.abs(memory).max() < (0.12 if axis == 2 else 0.08), (name, memory)


def test_nothing_hidden_is_adequate_and_the_parameters_come_out():
    vehicle, train, test = logs()
    result = diagnose(vehicle, train, test)
    assert result.verdict == "adequate" and not result.findings
    for id_, value in result.selection.last.h.values.items():
        assert value == pytest.approx(TRUTH[id_], rel=0.04), id_
    record = json.loads(to_json(result.record()))
    assert record["calibration"]["family_wise"] == 0.005 and record["calibration"]["logs"] == 12_000
    assert {"effect": "thruster.gain"}.items() <= next(
        q for q in record["not_tested"] if q["effect"] == "thruster.gain"
    ).items()
    assert record["detectable"]["drag.surge.linear"]["unit"] == "kg/s"
    # A model that is adequate already gains nothing.
    for before, after in result.gain.simulation_rms.values():
        assert before == pytest.approx(after, rel=1e-9)


def test_the_same_run_twice_is_noticed():
    """Another file with another zero of its clock: the samples are the same."""
    vehicle, train, _ = logs()
    again = replace(train, name="copy.csv", sha256="b" * 64, t=train.t + 100.0)
    assert train.same_samples(again) and not train.same_samples(replace(again, t=again.t[:-1]))
    result = diagnose(vehicle, train, again, null_logs=0)
    assert any("copy.csv has the same samples as" in n for n in result.notes)


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        # Nightly: the gate screens these in test_diagnosis_stages.py, and diagnoses the first in test_explanation.py.
        pytest.param("drag.surge.linear", {"drag.surge.linear": 4.0}, marks=pytest.mark.nightly),
        pytest.param("drag.yaw.linear", {"drag.yaw.linear": 1.0}, marks=pytest.mark.nightly),
        pytest.param(
            "current.steady",
            {"current.steady.north": 0.08, "current.steady.east": 0.05},
            marks=pytest.mark.nightly,
        ),
        # Nightly: the gate screens it; the whole diagnoses of test_own_effects.py and test_diagnosis_vessels.py name a cause.
        pytest.param("thruster.lag", {"thruster.lag": 0.25}, marks=pytest.mark.nightly),
        pytest.param(
            "sensor.velocity.lever_arm",
            {"sensor.velocity.lever_arm.x": 0.1, "sensor.velocity.lever_arm.y": 0.05},
            marks=pytest.mark.nightly,
        ),
        # Nightly: steps in time have tests of their profiles in the gate.
        pytest.param("payload.step", {"payload.step.mass": 8.0, "payload.step.time": 150.0}, marks=pytest.mark.nightly),
    ],
)
def test_a_hidden_effect_is_named_with_an_interval_that_holds_it(effect, values):
    vehicle, train, test = logs(values)
    result = diagnose(vehicle, train, test)
    assert result.verdict == "wrong"
    assert [effect in s for s in sets(result)] == [True], sets(result)
    # What is named has been tested, and so have its alternatives.
    named = {id_ for f in result.findings for id_ in (f.effect, *f.alternatives)}
    assert not named & {q["effect"] for q in result.not_tested}
    bounds = result.findings[0].parameters
    for name, value in values.items():
        assert bounds[name].lower <= value <= bounds[name].upper, name
        assert not bounds[name].guaranteed
    # Ambient force dominates over ten seconds, so a right finding may gain little (docs/theory.md, "Diagnosis"); channels that
    # it does not concern change within what a median over thirty windows scatters.
    worth = [*result.gain.simulation_rms.values(), *result.gain.force_rms.values()]
    assert all(after <= 1.2 * before for before, after in worth), worth
    assert any(after < 0.97 * before for before, after in worth), worth
    extended = parse_vehicle(extended_vehicle(result), "model.toml")
    if effect.startswith("drag."):
        assert effect in extended.model.terms
    if effect == "thruster.lag":
        assert extended.thrusters[0].time_constant == pytest.approx(0.25, rel=0.1)


# Nightly: the gate mirrors the scores.
@pytest.mark.nightly
def test_port_and_starboard_mirrored_mirror_the_findings():
    """A mirrored log with a mirrored vehicle: the same cause, and a parameter that is odd in sway changes its sign."""
    values = {"coupling.cg_y": 1.5}
    vehicle, train, test = logs(values)
    flip = ("v", "r", "ay", "psi", "y")

    def mirrored(log):
        columns = {k: -x if k in flip else x for k, x in log.columns.items()}
        columns["demand_port"], columns["demand_starboard"] = (
            log.columns["demand_starboard"],
            log.columns["demand_port"],
        )
        return Log(log.name, log.sha256, log.t, columns)

    one, other = diagnose(vehicle, train, test), diagnose(vehicle, mirrored(train), mirrored(test))
    assert [f.effect for f in one.findings] == [f.effect for f in other.findings] == ["coupling.cg_y"]
    a, b = (r.findings[0].parameters["coupling.cg_y"] for r in (one, other))
    assert a.lower == pytest.approx(-b.upper, rel=1e-3) and a.upper == pytest.approx(-b.lower, rel=1e-3)


# Nightly: the gate asks the scores, and test_diagnosis_claims.py a whole diagnosis of other claims.
@pytest.mark.nightly
def test_a_wrong_claim_is_a_finding_and_a_true_one_is_not():
    for claim, verdict in ((28.0, "adequate"), (20.0, "wrong")):
        text = VEHICLE + f'[model]\nvalues = {{ "drag.surge.quadratic" = {claim} }}\n'
        vehicle, train, test = logs(vehicle=parse_vehicle(text, "claims.toml"))
        result = diagnose(vehicle, train, test)
        assert result.verdict == verdict
        if verdict == "wrong":
            assert "drag.surge.quadratic" in set().union(*sets(result))
            # A claim that the log contradicts is left out of the extended model.
            assert not parse_vehicle(extended_vehicle(result), "model.toml").model.values
            bound = result.findings[0].parameters["drag.surge.quadratic"]
            assert 20.0 < bound.lower < 28.0 < bound.upper


def test_channels_that_are_missing_are_said_and_not_tested():
    vehicle, train, _ = logs(duration=120.0)
    bare = Log(
        train.name,
        train.sha256,
        train.t,
        {k: x for k, x in train.columns.items() if k not in ("psi", "x", "y", "ax", "ay")},
    )
    fit = plain_fit(vehicle, channels(bare, vehicle), everything)
    assert "psi" in fit.refused["current.steady"] and "ax" in fit.refused["sensor.acceleration.bias"]
    ids = {c.id for c in fit.candidates}
    assert "drag.surge.linear" in ids and not any(i.startswith("sensor.") for i in ids)
    assert np.isfinite([s.fall for s in score(fit)[1]]).all()


def test_isolability_orders_what_the_theory_orders():
    """Munk and lift are one column; a coast tells friction from linear drag no worse than d = 5; lag and delay are close."""
    vehicle, train, _ = logs()
    result = isolability(vehicle, train)
    index = {id_: k for k, id_ in enumerate(result.ids)}
    assert result.rho[index["added_mass.munk"], index["drag.lift.yaw"]] == pytest.approx(1.0, abs=1e-6)
    assert ("added_mass.munk", "drag.lift.yaw") in [c for c, _ in result.classes]
    assert 0.5 < result.rho[index["drag.surge.linear"], index["friction.coulomb"]] < 0.99
    assert result.rho[index["drag.surge.linear"], index["drag.yaw.linear"]] < 0.3
    assert result.visible["sensor.velocity.scale"].z < result.visible["drag.yaw.linear"].z
    for id_, v in result.visible.items():
        # The signature of a dead band or a limit is not proportional to its size.
        for part, least in {} if id_ in ("thruster.deadband", "thruster.saturation") else v.detectable.items():
            assert abs(least) * v.z == pytest.approx(8.0 * abs(v.typical[part]), rel=1e-9), id_


def test_a_dead_band_that_no_demand_enters_shows_nothing():
    """Demands of 30 to 80: a band of the usual eighth of them hides nothing, and the least that would show lies among the demands."""
    vehicle, train, _ = logs()
    used = np.abs(np.concatenate([train.columns[k] for k in train.columns if k.startswith("demand")]))
    used = used[used > 1e-9]
    band = isolability(vehicle, train).visible["thruster.deadband"]
    (typical,), (least,) = band.typical.values(), band.detectable.values()
    assert used.min() < least < np.quantile(used, 0.7)
    # Thrusters at rest lie inside any band, which takes their error, of the absolute accuracy, along.
    assert typical < used.min() and 0.0 < band.z < 1.0
    assert band.tested == (typical >= least)
    sure = parse_vehicle(re.sub(r"absolute = [0-9.]+", "absolute = 0.0", VEHICLE), "sure.toml")
    assert isolability(sure, train).visible["thruster.deadband"].z == 0.0


def test_short_logs_are_refused_in_a_sentence():
    vehicle, train, _ = logs(duration=60.0)
    keep = train.t < 20
    short = Log("short.csv", train.sha256, train.t[keep], {k: x[keep] for k, x in train.columns.items()})
    with pytest.raises(IvsidError, match="at least 60 s"):
        channels(short, vehicle)


def test_a_diagnosis_leaves_the_cores_to_its_own_threads(monkeypatch):
    """A fit with screening took twelve times its processor time beside threads of BLAS."""

    def threads():
        return {p["num_threads"] for p in threadpool_info() if p["user_api"] == "blas"}

    seen = []

    def plain_fit(*_):
        seen.append(threads())
        raise IvsidError("enough")

    monkeypatch.setattr(search, "plain_fit", plain_fit)
    vehicle, train, test = logs()
    with threadpool_limits(limits=2, user_api="blas"):
        with pytest.raises(IvsidError, match="enough"):
            diagnose(vehicle, train, test)
        assert seen == [{1}] and threads() == {2}
