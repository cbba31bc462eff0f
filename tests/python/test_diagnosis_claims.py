"""What the log says of the numbers that a vehicle file claims, and of the causes that are no findings."""

import numpy as np

from diagnosis_logs import TRUTH, logs_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.channels import channels
from ivsid.diagnosis.families import everything, score
from ivsid.diagnosis.fit import plain_fit
from ivsid.diagnosis.intervals import intervals


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
        # What is not held is known no better.
        assert claim.alone.upper - claim.alone.lower >= 0.999 * (claim.beside.upper - claim.beside.lower)


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
    fit, left = score(plain_fit(vehicle, channels(logs_of(vehicle_of())[0], vehicle), everything))
    assert any(s.id == "fouling.drift" and s.gain == 0 for s in left)
    bound = intervals(fit, "drag.surge.linear", fit.held, left, unknown=True)["drag.surge.linear"]
    assert np.isfinite([bound.lower, bound.upper]).all() and bound.lower < bound.upper
