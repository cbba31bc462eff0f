"""Proofs of a diagnosis: guaranteed intervals hold the truth of bounded twins, and a refuted model has a certificate that ``verify`` checks."""

import json

import numpy as np
import pytest

from diagnosis_logs import SENSORS, TRUTH, TWIN, ZIGZAGS
from ivsid import diagnose
from ivsid.diagnosis import GUARANTEED, REFUTED, Bound
from ivsid.diagnosis.statements.proved import Proof, extended_proof, guaranteed, lasting, proof_of
from ivsid.files.records import to_json
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from ivsid.verification.verify import verify
from ivsid.workflow.diagnosis import diagnosis_report

# Better sensors on a calmer day, so that a bounded-error set says something.
FINE = (
    SENSORS.replace("accuracy = 0.006", "accuracy = 0.001")
    .replace("random_walk = 0.002", "random_walk = 0.0002")
    .replace("force = 0.15", "force = 0.005")
    .replace("moment = 0.03", "moment = 0.001")
)
# The yaw equation asks for the largest accelerations.
LIMITS = "[sensors.limits]\nacceleration = 2.5\nyaw_acceleration = 3.0\n"
CALM = TWIN.replace("absolute = 0.1, relative = 0.02", "absolute = 0.02, relative = 0.002")


def logs(effects, text=CALM + FINE, noise="uniform", duration=180.0):
    vehicle = parse_vehicle(text, "twin.toml")
    made = []
    for name, number in (("train", 21), ("test", 22)):
        head = f'duration = {duration}\nrate = 10.0\nseed = {number}\nnoise = "{noise}"\n[truth]\n'
        head += "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items())
        done = simulate(vehicle, parse_scenario(head + ZIGZAGS, "s.toml"), number, effects)
        made.append(Log(f"{name}.csv", "0" * 64, done.t, done.columns))
    return vehicle, *made


@pytest.fixture(scope="module")
def refuted():
    """Linear drag in surge that the plain model lacks, seen by sensors that are good enough to prove it."""
    vehicle, train, test = logs({"drag.surge.linear": 6.0})
    return train, diagnose(vehicle, train, test, null_logs=0)


def test_a_guaranteed_interval_holds_the_truth_and_says_what_it_assumes(refuted):
    train, result = refuted
    assert [f.effect for f in result.findings] == ["drag.surge.linear"] and not result.findings[0].alternatives
    bound = result.findings[0].parameters["drag.surge.linear"]
    assert bound.guaranteed and bound.proved is None
    assert 0 < bound.lower <= 6.0 <= bound.upper
    # It is the proved one, as feasible gives it, and the statistical one stands beside it.
    found = extended_proof(result.vehicle, train, result.selection.last.h).identification
    assert (bound.lower, bound.upper) == (
        found.parameters["drag.surge.linear"].lower,
        found.parameters["drag.surge.linear"].upper,
    )
    assert bound.statistical[0] <= 6.0 <= bound.statistical[1]
    record = json.loads(to_json(result.record()))
    said = record["findings"][0]["parameters"]["drag.surge.linear"]
    assert said["guaranteed"] is True and set(said["statistical"]) == {"lower", "upper"}
    assert record["guarantees"]["status"] == "not_refuted" and "model structure" in record["guarantees"]["assumes"]


def test_a_refuted_model_has_a_certificate_that_is_proved_in_exact_arithmetic(refuted, tmp_path):
    train, result = refuted
    record = json.loads(to_json(result.record()))["falsified"]
    assert record["status"] == "refuted" and record["inflation"] > 1 and record["rows"]
    assert record["certificate"] == REFUTED
    files = diagnosis_report(result).files
    for name in (REFUTED, GUARANTEED):
        (tmp_path / name).write_text(files[name])
        assert verify(tmp_path / name, train).proved, name
    # The certificate is of this log: of another it proves nothing.
    other = Log(train.name, train.sha256, train.t, {k: x + 0.01 * (k == "u") for k, x in train.columns.items()})
    assert not verify(tmp_path / REFUTED, other).proved


def test_the_report_and_the_console_say_what_is_refuted(refuted):
    report = diagnosis_report(refuted[1])
    assert any("proved: no numbers of the model explain the log" in line for line in report.lines)
    assert "It is proved that no numbers" in report.summary


def test_a_true_model_inside_its_bounds_is_not_refuted():
    vehicle, train, test = logs({})
    result = diagnose(vehicle, train, test, null_logs=0)
    assert result.verdict == "adequate" and result.proofs[0].status == "not_refuted"
    assert result.proofs[1] is None and result.record()["guarantees"] is None
    # A model that was not extended is no file of its own.
    assert not diagnosis_report(result).files and result.record()["model"] is None
    assert result.record()["falsified"]["inflation"] < 1


def test_a_refutation_lasts_where_the_model_is_wrong_and_not_where_a_few_readings_are(refuted):
    train, result = refuted
    assert lasting(result.proofs[0], result.vehicle, train) > 1.0
    vehicle, train, _ = logs({})
    spoilt = {k: x.copy() for k, x in train.columns.items()}
    for at in (700, 900):
        spoilt["ax"][at : at + 2] += 0.1
    other = Log("train.csv", "0" * 64, train.t, spoilt)
    proof = proof_of(vehicle, other)
    assert proof.refuted and proof.wider > 1.0 and lasting(proof, vehicle, other) == 0.0


# Nightly: the gate has the proof of a refuted model and of one that is not.
@pytest.mark.nightly
def test_adequate_never_stands_beside_a_refutation_in_silence():
    """A few readings far outside of their bound: too few for the statistics, and the proof says where the bound does not hold."""
    vehicle, train, test = logs({}, noise="gaussian")
    spoilt = {k: x.copy() for k, x in train.columns.items()}
    spoilt["ax"][900:902] += 0.1
    result = diagnose(vehicle, Log("train.csv", "0" * 64, train.t, spoilt), test, null_logs=0)
    assert result.proofs[0].refuted
    (note,) = [n for n in result.notes if n.startswith("proved:")]
    times = [r["time"] for r in result.proofs[0].contradiction]
    assert any(abs(t - 90.1) < 11 for t in times)
    if result.verdict == "adequate":
        assert "larger there than declared" in note and "as they are declared" in note
    assert any("proved: no numbers" in line for line in diagnosis_report(result).lines)


@pytest.mark.parametrize(
    ("effect", "value"),
    [("drag.yaw.linear", 1.5), ("drag.sway.linear", 20.0), ("drag.surge.sideslip", 60.0), ("coupling.cg_x", 4.0)],
)
def test_proved_intervals_hold_the_truth_of_bounded_twins(effect, value):
    vehicle, train, _ = logs({effect: value}, CALM + FINE + LIMITS)
    model = parse_vehicle(
        vehicle.text + "[model]\nterms = [" + ", ".join(f'"{i}"' for i in (*TRUTH, effect)) + "]\n", "twin.toml"
    )
    fit = proof_of(model, train)
    assert fit.status == "not_refuted"
    bounds = guaranteed({effect: Bound(0.9 * value, 1.1 * value, "", "")}, fit)
    ends = (bounds[effect].lower, bounds[effect].upper) if bounds[effect].guaranteed else bounds[effect].proved
    assert ends[0] <= value <= ends[1]
    # Bounds that hold what the vehicle file claims do not prove the claim wrong.
    beside = guaranteed({effect: Bound(0.9 * value, 1.1 * value, "", "")}, fit, {effect: value})[effect]
    assert not beside.guaranteed and beside.proved == ends


def test_nothing_is_guaranteed_where_nothing_is_proved():
    bound = Bound(1.0, 2.0, "kg/s", "-X_u")
    assert guaranteed({"drag.surge.linear": bound}, Proof(None, "no bounds")) == {"drag.surge.linear": bound}
    assert Proof(None, "no bounds").record() == {"status": "not_applicable", "reason": "no bounds"}
    vehicle = parse_vehicle(TWIN, "twin.toml")
    assert proof_of(vehicle, logs({})[1]).status == "not_applicable"
    assert np.isfinite([bound.lower, bound.upper]).all()
