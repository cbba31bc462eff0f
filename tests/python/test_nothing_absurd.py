"""Nothing absurd leaves the house: model files of no vessel, factors beside a divergence, guaranteed sets of no vessel without a note."""

import json
import re
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import TRUTH, logs_of, logs_of_case, vehicle_of, with_a_drag
from ivsid import diagnose, identify
from ivsid.diagnosis import diverging, model_files, worth
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.noise import declared_ambient
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.statements.comparison import compare
from ivsid.effects import CATALOGUE, terms_of
from ivsid.files.records import to_json
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.diagnosis import _lines, diagnosis_report
from ivsid.workflow.identification import identification_report

FACTOR = re.compile(r"by a factor of")


def predictor_of(vehicle, log):
    return Predictor(vehicle, channels(log, vehicle), declared_ambient(vehicle))


@pytest.fixture(scope="module")
def found():
    return with_a_drag()


def test_a_model_that_is_a_vessel_s_and_better_is_written(found):
    assert found.gain.extended and found.gain.gains and found.against_model == ()
    report = diagnosis_report(found)
    assert "model.toml" in report.files and report.record["model"] == "model.toml"
    assert any("model.toml holds the extended model" in line for line in report.lines)


@pytest.mark.parametrize(
    ("id_", "value", "words"),
    [
        ("mass.surge", 23296.0, "total mass in surge is at least 23296 kg"),
        ("mass.sway", 1.0, "total mass in sway is at most 1 kg"),
        ("inertia.yaw", -4.0, "not positive definite"),
        ("drag.surge.linear", -900.0, "the drags in surge drive"),
    ],
)
def test_a_model_of_no_vessel_is_not_written_and_the_sentence_says_why(found, id_, value, words):
    absurd = replace(found, model=replace(found.model, values={**found.model.values, id_: value}))
    assert any(words in w for w in absurd.against_model), absurd.against_model
    report = diagnosis_report(absurd)
    assert "model.toml" not in report.files and report.record["model"] is None
    assert any(words in w for w in report.record["why_no_model"])
    assert any("no model.toml is written" in line and words in line for line in report.lines)
    parts = [
        p["text"] for s in report.sections if s.title == "Gain of the extended model" for p in s.parts if "text" in p
    ]
    assert any(words in p for p in parts)
    assert not any("model.toml has it" in p.get("text", "") for s in report.sections for p in s.parts)


def test_a_model_that_is_better_by_chance_or_worse_in_anything_is_not_written(found):
    for changes, words in (
        ({"gains": {}, "interval": {"X": (0.9, 1.3)}}, "better in nothing by more than chance"),
        ({"losses": {"X": 1e-6}, "gains": {}, "interval": {}}, "worse in X, by more than chance"),
        (
            {"losses": {"X": 1e-6}, "interval": {**found.gain.interval, "X": (0.5, 0.7)}},
            "worse in X, by more than chance",
        ),
    ):
        made = replace(found, gain=replace(found.gain, **changes))
        assert not model_files(made) and words in made.against_model[0]


def test_losses_stand_first_in_terminal_summary_and_page(found):
    made = replace(found, gain=replace(found.gain, losses={"X": 1e-6}))
    report = diagnosis_report(made)
    assert "worse than the one before it in missing force X" in report.lines[0]
    assert any("worse than the one before it" in words for words in report.first.warnings)
    # An unknown tells its losses, too.
    unknown = replace(made, findings=(), verdict="unknown")
    assert "worse than the one before it" in _lines(unknown)[0]


@pytest.mark.parametrize("which", ["before", "after"])
def test_a_simulation_that_diverges_is_said_to_with_its_time_and_has_no_factor(found, which):
    """A drag of -400 kg/s moves a boat of 58 kg e times as fast every seventh of a second."""
    vehicle = vehicle_of()
    log = logs_of(vehicle, duration=70.0)[1]
    terms = (*terms_of(vehicle), CATALOGUE["drag.surge.linear"])
    plain = Hypothesis(terms, {**TRUTH, "drag.surge.linear": 0.0})
    away = Hypothesis(terms, {**TRUTH, "drag.surge.linear": -400.0, "drag.surge.quadratic": 0.0})
    pair = (away, plain) if which == "before" else (plain, away)
    gain = compare(predictor_of(vehicle, log), *pair)
    since = gain.diverges[0 if which == "before" else 1]
    assert since is not None and 0.0 < since < 10.0 and gain.diverges[1 if which == "before" else 0] is None
    name = "plain" if which == "before" else "extended"
    assert f"of the {name} model from t = {since:.6g} s on" in diverging(gain)
    assert gain.factors == {} and not any(FACTOR.search(said) for *_, said in worth(gain))
    assert {said for *_, said in worth(gain)} == {f"not compared: the {name} model diverges"}
    json.loads(to_json(gain.record()))
    made = replace(found, gain=gain)
    report = diagnosis_report(made)
    assert "diverges" in report.lines[0] and not any(FACTOR.search(line) for line in report.lines)
    assert bool(model_files(made)) == (which == "before" and not gain.losses)


def test_a_true_simulation_does_not_diverge():
    vehicle = vehicle_of()
    predictor = predictor_of(vehicle, logs_of(vehicle, duration=70.0)[1])
    truth = Hypothesis(terms_of(vehicle), dict(TRUTH))
    gain = compare(predictor, truth, truth)
    assert gain.diverges == (None, None) and diverging(gain) == "" and not gain.extended and gain.interval == {}


# The property: files that are grossly wrong, in every way that the draws know.

WRONG = ("mass", "thrust", "turned", "claims")


def wrong_file(text, how):
    """A vehicle file that is grossly wrong: thirty times the mass, thirty times the thrust, thrust astern, claims that drive."""
    if how == "mass":
        return re.sub(r"\nmass = ([\d.]+)", lambda m: f"\nmass = {30 * float(m[1])}", text, count=1)
    if how in ("thrust", "turned"):
        factor = 30.0 if how == "thrust" else -1.0
        return re.sub(
            r"thrust = \[([^\]]*)\]",
            lambda m: "thrust = [" + ", ".join(repr(factor * float(x)) for x in m[1].split(",")) + "]",
            text,
        )
    return f'{text.split("[model.values]")[0]}[model.values]\n"drag.surge.quadratic" = -300.0\n"mass.surge" = 9000.0\n'


def assert_nothing_absurd(result, vehicle):
    """By the text of the files alone: what a stranger would see."""
    report = diagnosis_report(result)
    record = json.loads(to_json(report.record))
    page = "\n".join(str(p) for s in report.sections for p in s.parts)
    everything = "\n".join([*report.lines, report.summary, page, to_json(record["findings"])])
    gain = record["gain"]
    diverges = any(x is not None for x in gain["diverges"])
    if diverges or not gain["extended"]:
        assert (
            not gain["interval"] and "better, by a factor" not in everything and "WORSE, by a factor" not in everything
        )
    if diverges:
        # What a set-up gets wrong comes first: it is why the simulation diverges.
        first = next(line for line in report.lines if not line.startswith("set-up: "))
        assert "diverge" in first and "diverge" in report.first.warnings[0]
    if gain["losses"]:
        assert any("worse than the one before it" in line for line in report.lines[:2])
    assert ("model.toml" in report.files) == (record["model"] is not None) == (not record["why_no_model"])
    if "model.toml" in report.files:
        numbers, hull = record["parameters"], vehicle.hull
        assert gain["extended"] and (gain["gains"] or any(low > 1.0 for low, _ in gain["interval"].values()))
        # Errors that grow by a quarter or more are no small losses.
        assert all(gain["interval"][k][1] >= 1 / 1.25 for k in gain["losses"] if k in gain["interval"])
        assert all(0.5 * hull.mass <= numbers[k] <= 10 * hull.mass for k in ("mass.surge", "mass.sway") if k in numbers)
        assert numbers["inertia.yaw"] > 0
        # Largest forward and sideways speeds that either log shows.
        for axis, name in enumerate(("surge", "sway")):
            speed = np.abs(result.gain.measured[axis]).max()
            drag = numbers.get(f"drag.{name}.linear", 0.0) + numbers.get(f"drag.{name}.quadratic", 0.0) * speed
            assert drag >= 0 or name == "sway"
        assert tomllib.loads(report.files["model.toml"])


def check(seed, how, duration):
    c = case(seed, duration=duration, rate=10.0)
    vehicle = parse_vehicle(wrong_file(c.text, how), "v.toml")
    train, test = logs_of_case(c)
    fit = identify(vehicle, train)
    report = identification_report(fit, train)
    hull = vehicle.hull.mass
    bad = [
        id_
        for id_, p in fit.parameters.items()
        if (id_.startswith("mass.") and (p.upper < 0.5 * hull * (1 - 1e-9) or p.lower > 10 * hull * (1 + 1e-9)))
        or (id_ == "inertia.yaw" and p.upper < 0)
    ]
    noted = {i for f in fit.physical for i in f["parameters"]}
    assert set(bad) <= noted
    assert bool(fit.physical) == any("no vessel has these parameters" in line for line in report.lines)
    assert bool(fit.physical) == ("no vessel has these parameters" in report.summary)
    assert_nothing_absurd(diagnose(vehicle, train, test, null_logs=0), vehicle)
    return bool(bad) or fit.status == "empty"


# Nightly: the second file, ten seconds of the gate for the same checks.
@pytest.mark.parametrize(("seed", "how"), [(1, "mass"), pytest.param(5, "claims", marks=pytest.mark.nightly)])
def test_a_grossly_wrong_file_gives_nothing_absurd(seed, how):
    check(seed, how, 70.0)


# Nightly: 40 identifications and diagnoses.
@pytest.mark.nightly
@pytest.mark.parametrize("how", WRONG)
def test_grossly_wrong_files_of_drawn_vessels_give_nothing_absurd(how):
    wrong = [check(seed, how, 120.0) for seed in range(200, 210)]
    assert any(wrong)
