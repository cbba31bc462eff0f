"""Causes whose model fails on the other log, and the model that is left without them."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of, logs_of_case, train_of, vehicle_of, with_a_drag
from ivsid import diagnose
from ivsid.diagnosis import extended_vehicle, lost, stages
from ivsid.diagnosis.selection.structure import Adequacy
from ivsid.diagnosis.selection.verdict import OF_FORCES, Left
from ivsid.diagnosis.statements.carried import failure, in_their_place
from ivsid.diagnosis.statements.extended import extended_text
from ivsid.diagnosis.statements.findings import Finding
from ivsid.diagnosis.statements.without import without
from ivsid.vehicle import parse_vehicle

CAUSE = Finding("drag.surge.linear", 1.0, (), "", {}, {"channel": "surge", "z": 12.0})
REST = Adequacy(150.0, 100, 1e-3, (("u", "surge", 20.0),), 1e-3, {})


def gain(diverges=(None, None), **growth):
    """A gain whose errors grow by these factors at the least, each in a quantity that is worse by more than chance."""
    return SimpleNamespace(
        log="b.csv",
        losses=dict.fromkeys(growth, 1e-6),
        interval={k: (0.5 / x, 1 / x) for k, x in growth.items()},
        diverges=diverges,
    )


def fails():
    """A gain of a model that fails with the thrust errors as well."""
    return gain(X=3.0)


@pytest.mark.parametrize(("factor", "complete", "kept"), [(1.9, True, True), (2.1, True, False), (1.3, False, False)])
def test_a_model_that_fails_on_the_other_log_names_nothing(factor, complete, kept):
    assert (failure(gain(X=factor), [CAUSE], fails, complete=complete) is None) == kept
    # A quantity that is not worse by more than chance says nothing, whatever its ratio, and nothing is withdrawn where nothing is named.
    by_chance = gain(X=factor)
    by_chance.losses = {}
    assert failure(by_chance, [CAUSE], fails, complete=complete) is None
    assert failure(gain(X=factor), [], fails, complete=complete) is None


def test_a_model_fails_with_the_thrust_errors_that_the_first_log_shows_or_not_at_all():
    """Drags of the plain model may have taken what thrusters are off by: without the errors the right model loses more."""
    assert failure(gain(X=2.8), [CAUSE], lambda: gain(X=1.9), complete=True) is None
    assert failure(gain(X=2.8), [CAUSE], lambda: gain(u=2.1), complete=True) is not None
    assert failure(gain(X=2.8), [CAUSE], lambda: gain((None, 40.0)), complete=True) is not None


def test_a_finding_that_stands_by_the_thrust_errors_says_so_where_it_says_that_it_is_worse():
    worse = lost(gain(X=2.8))
    assert "missing force X" in worse and "stand" not in worse
    said = lost(gain(X=2.8), gain(u=1.3))
    assert said.startswith(worse) and "The findings stand" in said and "simulated u" in said and "1.3 or more" in said
    assert "worse in nothing" in lost(gain(X=2.8), gain())
    assert not lost(gain(), gain(u=1.3))


def test_a_model_that_diverges_names_nothing_and_has_no_factor():
    away = gain((None, 31.5), X=3.0)
    refusal = failure(away, [CAUSE], gain, complete=True)
    assert refusal is not None and "diverges from t = 31.5 s" in refusal.sentence and "factor" not in refusal.sentence
    words = in_their_place(away, [CAUSE], REST, [], complete=True).description
    assert "it diverges from t = 31.5 s" in words and "factor" not in words
    # The plain model alone may diverge: what a cause explains is then all the better.
    assert failure(gain((12.0, None)), [CAUSE], fails, complete=True) is None


@pytest.mark.parametrize(("chance", "said"), [(0.5, ()), (1e-9, ("unknown",))])
def test_causes_that_the_other_log_refutes_leave_nothing_where_the_first_does_not_ask_for_them(chance, said):
    """The causes stand in the fit of the first log; what it holds without them decides."""
    before = replace(REST, chance=chance, chance_of_one=chance)
    left = Left(replace(REST, chance=1.0, chance_of_one=1.0), before, 1)
    proof = SimpleNamespace(refuted=False, status="not_refuted", record=dict)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stages, "lasting", lambda *_: 0.5)
        rest, complete, findings = stages._refuted(
            (CAUSE,), gain(X=3.0), SimpleNamespace(found=()), left, (proof, None, None), complete=True
        )
        assert tuple(f.effect for f in findings) == said and complete
        assert rest.after is (left.after if said else before) and rest.before is before
        # A proof that no numbers explain the rows asks for a cause, whatever the statistics.
        patch.setattr(stages, "lasting", lambda *_: 1.5)
        assert stages._refuted(
            (CAUSE,), gain(X=3.0), SimpleNamespace(found=()), left, (proof, None, None), complete=True
        )[2]


# Nightly: a whole diagnosis, and a second one without the rule.
@pytest.mark.nightly
def test_gusts_that_push_and_turn_at_once_leave_no_unknown(monkeypatch):
    """An asymmetry by errors that leave their bounds diverges on the other log, and the first one holds no structure without it."""
    c = case(250110, what="none", sea="at once", sensors="any")
    vehicle, logs = parse_vehicle(c.text, "v.toml"), logs_of_case(c)
    found = diagnose(vehicle, *logs)
    assert found.verdict == "adequate" and found.withdrawn["thruster.asymmetry"].rule == "stays finite"
    monkeypatch.setattr(
        stages,
        "_refuted",
        lambda f, g, s, rest, _, complete: (rest, complete, (in_their_place(g, f, rest.after, [], complete=complete),)),
    )
    assert diagnose(vehicle, *logs).verdict == "unknown"


def test_an_unknown_says_both_readings():
    made = in_their_place(gain(X=3.0, u=1.1), [CAUSE], REST, ["drag.surge.linear"], complete=True)
    assert made.effect == "unknown" and made.evidence["z"] == 12.0
    assert "X by a factor of 3 or more, u by a factor of 1.1 or more" in made.description
    assert "the logs differ" in made.description and "another one" in made.description
    beside = in_their_place(gain(X=3.0), [CAUSE], REST, ["drag.surge.linear"], complete=False)
    assert (
        "no cause of the catalogue that this log tests explains it" in beside.description
        and "X by a factor of 3" in beside.description
    )


@pytest.fixture(scope="module")
def named():
    return with_a_drag()


def test_without_its_only_cause_the_model_is_the_plain_one(named):
    plain, last = named.selection.plain, named.selection.last
    assert [f.effect for f in named.findings] == ["drag.surge.linear"]
    assert without(plain, last, ()) is last.states
    assert without(plain, last, ["drag.surge.linear"]) is plain.states
    assert "drag.surge.linear" in named.model.values and '"drag.surge.linear"' in extended_vehicle(named)
    assert not named.gain.losses and lost(named.gain) == ""


def test_claims_in_a_table_of_their_own_do_not_stand_twice_in_the_extended_file(named):
    """A vehicle file may state [model.values] as a table."""
    vehicle = vehicle_of(extra='[ model.values ]\n"mass.surge" = 58.0\n[model]\nterms = "paper"\n')
    text = extended_text(vehicle, named.model)
    assert text.count('"mass.surge" = 58.0') == 1
    assert parse_vehicle(text, "model.toml").model.values == {"mass.surge": 58.0}


# Nightly: a whole diagnosis; the rule stands in the gate.
@pytest.mark.nightly
def test_a_current_that_turns_round_between_the_logs_is_not_named():
    """The extended model is wrong by twice the current on the other log, and one log cannot tell a current from another cause."""
    vehicle = vehicle_of()
    train, test = (
        train_of(vehicle, {"current.steady.north": speed, "current.steady.east": 0.0}, seed=seed, duration=160.0)
        for speed, seed in ((0.4, 21), (-0.4, 22))
    )
    made = diagnose(vehicle, train, test)
    assert made.verdict == "unknown" and "the logs differ" in made.findings[0].description
    assert set(made.model.values) == set(made.selection.plain.h.values) and not made.model.given
    assert made.withdrawn["current.steady"].rule == "carries over"


def test_a_cause_that_does_not_dominate_what_is_left_leaves_unknown(monkeypatch):
    """A crew that walks about had a centre of gravity by name, beside twice what that explained; noise of few frequencies may make as much."""
    for name, value in (("probability", 1.0), ("statistic", 2.0), ("unexplained", 1e6)):
        monkeypatch.setattr(Adequacy, name, value)
    monkeypatch.setattr(Adequacy, "beside", lambda *_, **__: 1e6)
    vehicle = vehicle_of()
    found = diagnose(vehicle, *logs_of(vehicle, {"drag.surge.linear": 12.0}, duration=100.0), null_logs=0)
    assert [f.effect for f in found.findings] == ["unknown"] and found.findings[0].evidence["z"] > 5
    assert found.withdrawn["drag.surge.linear"].rule == "dominant"
    # What passes every test is no chance, so that the model without it is not called adequate, whatever its own structure.
    said = found.findings[0].description
    assert "drag.surge.linear: its fall of chi²" in said
    assert "either the ambient force makes what stays unexplained" in said and "calmer sea" in said
    assert "catalogue lacks" not in said
    assert "drag.surge.linear" not in found.model.values


@pytest.mark.parametrize(("fall", "louder"), [(159.0, False), (161.0, True)])
def test_what_is_left_is_louder_than_noise_from_three_fifths_more(fall, louder):
    left = Left(replace(REST, fall=fall), replace(REST, fall=400.0), 1)
    assert left.louder == louder
    assert not replace(left, before=replace(REST, fall=1e5)).louder


def test_what_is_left_of_much_structure_is_not_little_on_a_straight_run():
    before = replace(REST, fall=1e5)
    assert Left(REST, before, 1).little and not Left(REST, before, 1, straight=True).little
    assert not Left(REST, before, 0).little
    # A cause that one force of no cause explains as well decides where it explains as much as would not be little.
    share = 0.025 * before.unexplained
    for fall, little in ((0.9 * share, True), (1.1 * share, False)):
        left = Left(REST, before, 1, imitated=(fall,))
        assert left.little is little and (OF_FORCES.refuses(left) is None) is little
