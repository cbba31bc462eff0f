"""Statements of a result beside its findings: claimed numbers, causes that are none, the extended model."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import TRUTH, logs_of, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis import extended_vehicle
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.candidates.intervals import intervals
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.selection.structure import Adequacy
from ivsid.diagnosis.statements.claims import claims, possible
from ivsid.diagnosis.statements.extended import extended_text, stated
from ivsid.diagnosis.statements.power import largest_drag
from ivsid.diagnosis.statements.proved import extended_proof
from ivsid.effects import EFFECTS, PLAIN_TERMS, Given
from ivsid.vehicle import parse_vehicle


def claimed(values, effects=None):
    pairs = ", ".join(f'"{k}" = {v}' for k, v in values.items())
    vehicle = vehicle_of(extra=f"[model]\nvalues = {{ {pairs} }}\n")
    result = diagnose(vehicle, *logs_of(vehicle, effects), null_logs=0)
    return result, {c.parameter: c for c in result.claims}


def test_each_claim_has_the_logs_own_interval():
    truth = {"drag.surge.quadratic": 28.0, "inertia.yaw": 9.0}
    result, said = claimed(truth)
    assert result.verdict == "adequate" and list(said) == list(truth)
    for id_, claim in said.items():
        assert not claim.contradicted and claim.value == truth[id_] and claim.z < 5
        for bound in (claim.beside, claim.alone):
            assert bound.lower <= truth[id_] <= bound.upper and bound.upper < 1.2 * bound.lower
            assert not bound.guaranteed
        # An interval with all claims fitted is no narrower than one beside the other claims.
        assert claim.alone.upper - claim.alone.lower >= 0.999 * (claim.beside.upper - claim.beside.lower)


# Nightly: a whole diagnosis; other claims stand in the gate.
@pytest.mark.nightly
def test_a_wrong_claim_stands_far_from_the_log_and_bends_the_others():
    result, said = claimed({"drag.surge.quadratic": 20.0, "mass.surge": 52.0})
    assert result.verdict == "wrong"
    assert said["drag.surge.quadratic"].z > 8 or said["mass.surge"].z > 8
    for id_ in said:
        assert said[id_].alone.lower <= TRUTH[id_] <= said[id_].alone.upper
    record = {c["parameter"]: c for c in result.record()["claims"]}
    named = {f.effect for f in result.findings}
    assert any(c["contradicted"] for c in record.values())
    for id_, c in record.items():
        assert c["contradicted"] == (id_ in named)
        assert set(c) == {"parameter", "value", "unit", "contradicted", "z", "interval", "without_claims"}


def structure(beyond):
    """What regressors find, beyond as many degrees of freedom."""
    return Adequacy(100.0 + beyond, 100, 0.0, (), 0.0, {})


def test_what_is_unknown_may_push_along_a_claims_signature_as_much_as_beside_it():
    """The oracle is a force along the drag's own column, of the energy of the structure: it moves the number by less than the room that is left."""
    vehicle = vehicle_of(extra='[model]\nvalues = { "drag.surge.quadratic" = 28.0 }\n')
    fit = plain_fit(vehicle, channels(train_of(vehicle, duration=120.0), vehicle), everything)
    (plain,), (wide,) = (claims(fit, (), (), unknown=structure(x)) for x in (0.0, 100.0))
    k = fit.gram.index["drag.surge.quadratic"]
    base = [*fit.base, k]
    # Chi-squared of this force is 100 at most, and less beside what is fitted with it.
    shift = np.linalg.solve(fit.gram.total[np.ix_(base, base)], fit.gram.total[np.ix_(base, [k])] * 10.0)[-1, 0]
    room = abs(shift) / fit.gram.unit[k]
    assert (
        wide.beside.upper >= plain.beside.upper + 0.999 * room
        and wide.beside.lower <= plain.beside.lower - 0.999 * room
    )
    assert wide.beside.within == plain.beside.within and wide.z == plain.z
    # Without anything unknown no room is left.
    (known,) = claims(fit, (), ())
    assert known.beside == plain.beside


def test_no_room_holds_masses_of_no_hull_or_drags_that_take_more_than_drives():
    """Beside an unknown without bounds the drag ends at the power of the thrusters, and the mass at twice to five times the hull's."""
    vehicle = vehicle_of(extra='[model]\nvalues = { "drag.surge.quadratic" = 28.0, "mass.surge" = 58.0 }\n')
    fit = plain_fit(vehicle, channels(train_of(vehicle, duration=120.0), vehicle), everything)
    drag, mass = (
        next(c for c in claims(fit, (), (), unknown=structure(1e8)) if c.parameter == i) for i in vehicle.model.values
    )
    (term,) = (t for t in fit.h.terms if t.id == drag.parameter)
    assert drag.beside.lower == 0.0 and drag.beside.upper == pytest.approx(largest_drag(fit, term, {}))
    assert 28.0 < drag.beside.upper < 500.0
    assert 0.0 < mass.beside.lower < 50.0 and 100.0 < mass.beside.upper < 250.0


def test_no_interval_of_a_claim_holds_a_negative_mass_or_drag():
    drag, centre = (EFFECTS[i].parameters[0] for i in ("drag.surge.linear", "coupling.cg_x"))
    assert possible(-3.0, 5.0, drag) == (0.0, 5.0) and possible(1.0, 5.0, drag) == (1.0, 5.0)
    assert possible(-3.0, 5.0, centre) == (-3.0, 5.0)
    # A log whose own number is impossible says so.
    assert possible(-3.0, -1.0, drag) == (-3.0, -1.0)


def test_parts_of_a_cause_have_either_sign():
    """Winds from north and from south are alike: the intervals of a log without any hold both. They were cut at zero, as those of drags are."""
    names = ", ".join(f'"{t.id}"' for t in PLAIN_TERMS)
    vehicle = vehicle_of(extra=f'[model]\nterms = [{names}, "wind.steady"]\n')
    fit = plain_fit(vehicle, channels(train_of(vehicle_of(), duration=120.0), vehicle), everything)
    bounds = intervals(fit, "wind.steady")
    assert len(bounds) == 2 and all(b.lower < 0.0 < b.upper for b in bounds.values())


def test_a_start_that_the_log_hardly_shows_lies_in_the_log():
    vehicle = vehicle_of()
    fit = plain_fit(vehicle, channels(train_of(vehicle, duration=120.0), vehicle, None), everything)
    late = replace(fit, states=fit.states.under(fit.h.with_effect(Given(EFFECTS["payload.step"], (1.0, 118.0)))))
    bound = intervals(late, "payload.step")["payload.step.time"]
    assert 0.0 <= bound.lower < 118.0 < bound.upper <= 120.0


# Nightly: the gate has the claims of a diagnosis with some.
@pytest.mark.nightly
def test_without_claims_nothing_is_said_of_any():
    vehicle = vehicle_of()
    assert diagnose(vehicle, *logs_of(vehicle), null_logs=0).record()["claims"] == []


def test_a_cause_that_is_no_finding_is_bounded():
    """A drag below what would be found lies inside of what the log allows; what would be found does not."""
    vehicle, hidden = vehicle_of(), 0.15
    result = diagnose(vehicle, *logs_of(vehicle, {"drag.surge.linear": hidden}), null_logs=0)
    assert result.verdict == "adequate"
    may = result.record()["allowed"]
    for id_, truth in (("drag.surge.linear", hidden), ("drag.yaw.linear", 0.0), ("coupling.cg_x", 0.0)):
        assert may[id_]["lower"] <= truth <= may[id_]["upper"]
        assert not may[id_]["guaranteed"]
        # Nothing that is allowed would have stood out much further than what is asked for.
        assert max(-may[id_]["lower"], may[id_]["upper"]) < 1.3 * result.record()["detectable"][id_]["value"]
    for q in ("current.steady.north", "wind.steady.east", "tether.tension.force"):
        assert may[q]["lower"] <= 0.0 <= may[q]["upper"]


def test_a_cause_without_any_signature_hides_nothing():
    """Fouling multiplies the quadratic drag, which this model has not: its column is nothing, and no interval is made of it."""
    terms = '"mass.surge", "mass.sway", "inertia.yaw", "drag.surge.linear", "drag.sway.quadratic"'
    vehicle = vehicle_of(extra=f"[model]\nterms = [{terms}]\n")
    fit, left = score(plain_fit(vehicle, channels(train_of(vehicle_of()), vehicle), everything))
    assert any(s.id == "fouling.drift" and s.fall == 0 for s in left)
    bound = intervals(fit, "drag.surge.linear", left, unknown=True)["drag.surge.linear"]
    assert np.isfinite([bound.lower, bound.upper]).all() and bound.lower < bound.upper


# Nightly: two whole diagnoses; the gate screens the wind, and has the text of its extended model below.
@pytest.mark.nightly
def test_a_wind_that_was_found_stands_in_the_extended_model():
    """Its two numbers are one entry of model.terms, which identify and simulate take."""
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, {"wind.steady.north": 1.5, "wind.steady.east": -1.0})
    result = diagnose(vehicle, train, test, null_logs=0)
    assert [f.effect for f in result.findings] == ["wind.steady"]
    text = extended_vehicle(result)
    model = parse_vehicle(text, "model.toml")
    assert "wind.steady" in model.model.terms and len(set(model.model.terms)) == 6
    assert model.model.numbers["wind.steady.north"] == result.model.values["wind.steady.north"]
    assert 1.0 < model.model.numbers["wind.steady.north"] < 2.0
    # The file says the same as the diagnosis: nothing is missing from it, and its proof is of the wind, too.
    assert diagnose(model, train, test, null_logs=0).verdict == "adequate"
    proof = extended_proof(vehicle, train, result.selection.last.h)
    assert {"wind.steady.north", "wind.steady.east"} <= set(proof.identification.parameters)


def test_a_wind_by_the_measured_wind_is_no_term_of_a_file_stands_in_its_numbers_and_ends_the_proof():
    result = fitted_with("wind.steady", ("wind.steady.surge", "wind.steady.sway"))
    assert stated(result)[1] == {"wind.steady.surge": 0.4, "wind.steady.sway": 0.2}
    text = extended_text(vehicle_of(), result)
    read = parse_vehicle(text, "model.toml").model
    assert read.numbers["wind.steady.surge"] == 0.4 and "wind.steady" not in read.terms and "#   " not in text
    proof = extended_proof(vehicle_of(), train_of(vehicle_of(), duration=70.0), result)
    assert proof.identification is None and "wind.steady.surge" in proof.reason


def fitted_with(id_, numbers):
    """The plain model with the measured form of an effect beside it."""
    terms = EFFECTS[id_].measured.acts.terms
    values = {t.id: 1.0 for t in PLAIN_TERMS} | dict(zip(numbers, (0.4, 0.2), strict=True))
    return Hypothesis((*PLAIN_TERMS, *terms), values)
