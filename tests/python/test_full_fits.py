"""Causes fitted in full: from the model without them, and from inside the limits of hulls."""

import pytest
from tests.exam.cases import case

from ivsid.diagnosis.candidates.families import adopted, everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.fit import survey
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.boxed import outside
from ivsid.diagnosis.selection import rivals
from ivsid.diagnosis.selection.rivals import at_limits, fitted, fitted_inside
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle


def test_a_delay_of_many_rows_is_fitted_from_inside_the_limits_of_hulls(monkeypatch):
    """Thrusts that come a second late ask for a hull of three times its mass; steps from there stayed, and a stranger's ROV was `unknown`."""
    drawn = case(
        330205, what="one", effect="thruster.delay", size=6.0, kind="rov", duration=300.0, rate=10.0, style="rich"
    )
    vehicle, columns = parse_vehicle(drawn.text, "v.toml"), drawn.logs[0]
    log = Log("1.csv", "0" * 64, columns["t"], {n: x for n, x in columns.items() if n != "t"})
    fit, scored = score(plain_fit(vehicle, channels(log, vehicle), everything))
    assert at_limits(fit)
    delay = next(s for s in scored if s.id == "thruster.delay")
    there, inside = fitted(fit.problem, fit, delay), fitted_inside(fit.problem, fit, delay)
    assert there is not None and inside is not None and inside.fall > 5.0 * there.fall
    (number,) = (g.values[0] for g in inside.states.h.given)
    assert number == pytest.approx(drawn.truth["thruster.delay"], rel=0.1)
    # On the curves of the file it is found as well: here the start from inside the limits stands alone.
    monkeypatch.setattr(rivals, "outside", lambda _: ())
    alone = fitted_inside(fit.problem, fit, delay)
    assert alone is not None and alone.fall > 5.0 * there.fall
    (number,) = (g.values[0] for g in alone.states.h.given)
    assert number == pytest.approx(drawn.truth["thruster.delay"], rel=0.1)


def test_a_further_cause_is_fitted_from_inside_the_limits_beside_one_that_has_numbers_of_its_own(monkeypatch):
    """The numbers of a cause that the model holds are no masses and drags, of which a regression knows nothing."""
    drawn = case(330205, what="none", kind="rov", duration=300.0, rate=10.0, style="rich")
    vehicle, columns = parse_vehicle(drawn.text, "v.toml"), drawn.logs[0]
    log = Log("1.csv", "0" * 64, columns["t"], {n: x for n, x in columns.items() if n != "t"})
    fit, scored = score(plain_fit(vehicle, channels(log, vehicle), everything))
    delay = next(s for s in scored if s.id == "thruster.delay")
    beside, again = score(
        survey(fit.noise, fit.noise.predictor.settle(fit.states.under(adopted(fit.h, delay, fit))), fit.fixed)
    )
    assert "thruster.delay" in beside.free
    monkeypatch.setattr(rivals, "at_limits", lambda _: True)
    pairs = [(fitted(beside.problem, beside, s), fitted_inside(beside.problem, beside, s)) for s in again[:4]]
    possible = [(own, found) for own, found in pairs if own is not None]
    assert possible and all(found is not None and found.merit >= own.merit for own, found in possible)


def test_a_lag_of_the_shaft_is_fitted_on_the_curves_of_the_file_where_errors_have_taken_its_place():
    """Errors of thirty times the accuracy between rising and falling demands stood for the shaft's lag, which beside a current was a lag of the thrust."""
    drawn = case(263125, what="one", effect="thruster.shaft_lag", size=1.0, duration=120.0)
    vehicle, columns = parse_vehicle(drawn.text, "v.toml"), drawn.logs[0]
    log = Log("1.csv", "0" * 64, columns["t"], {n: x for n, x in columns.items() if n != "t"})
    fit, scored = score(plain_fit(vehicle, channels(log, vehicle), everything))
    assert min(most for _, most in outside(fit)) > 10.0 and not at_limits(fit)
    shaft = next(s for s in scored if s.id == "thruster.shaft_lag")
    there, inside = fitted(fit.problem, fit, shaft), fitted_inside(fit.problem, fit, shaft)
    assert there is not None and inside is not None and inside.chi2 < 0.7 * there.chi2
    (number,) = (g.values[0] for g in inside.states.h.given)
    assert number == pytest.approx(drawn.truth["thruster.shaft_lag"], rel=0.1)
