"""Fits stay physical: masses, inertias and drags are those of a hull, and a log that asks for others is told."""

import re
from dataclasses import replace

import numpy as np
import pytest
from tests.exam.draw import case

from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.first_values import first_values
from ivsid.diagnosis.estimation.gauss_newton import improve
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.plant.usual_hull import hull_limits
from ivsid.diagnosis.prediction.innovations import replaced
from ivsid.effects import EFFECTS, PLAIN_TERMS, terms_of
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle


def log_of(made, name="1.csv"):
    return Log(name, "0" * 64, made.t, made.columns)


def heavier(vehicle, factor):
    """The vehicle with a hull that is said to be so many times as heavy."""
    return parse_vehicle(
        re.sub(r"\nmass = ([\d.]+)", lambda m: f"\nmass = {factor * float(m[1])}", vehicle.text, count=1), "v.toml"
    )


def test_limits_of_hulls_hold_the_masses_of_known_vehicles():
    """Published sums of dry and added mass: a small open-frame vehicle, a catamaran, a supply ship's model, a slender vehicle."""
    known = (
        (11.5, 0.457, 17.0, 24.2, 0.28),
        (55.0, 2.0, 60.3, 137.5, 24.0),
        (23.8, 1.255, 25.8, 33.8, 2.76),
        (30.5, 1.33, 31.4, 66.0, 8.3),
    )
    for mass, length, surge, sway, yaw in known:
        vehicle = parse_vehicle(f'name = "v"\n[hull]\nmass = {mass}\nlength = {length}\n', "v.toml")
        limits = hull_limits(vehicle, PLAIN_TERMS)
        for id_, value in (("mass.surge", surge), ("mass.sway", sway), ("inertia.yaw", yaw)):
            low, high = limits[id_]
            assert low < value < high, (mass, id_)
            assert not low < 10 * value < high or id_ == "inertia.yaw"
        assert limits["drag.surge.quadratic"] == (0.0, np.inf)


@pytest.mark.parametrize("factor", [0.05, 20.0])
def test_first_values_are_those_of_a_hull(factor):
    c = case(7, what="none", kind="twin", duration=70.0, style="rich", rate=5.0, train_alone=True)
    vehicle = heavier(c.vehicle, factor)
    h = first_values(vehicle, channels(log_of(c.train), vehicle), terms_of(vehicle), {})
    for id_, (low, high) in hull_limits(vehicle, h.terms).items():
        assert low <= h.values[id_] <= high


def test_a_fit_from_a_start_that_no_hull_has_is_one_of_hulls():
    """A start may be a multiple of another fit; where no step makes it better, it stays what it was."""
    c = case(7, what="none", kind="twin", duration=70.0, style="rich", rate=5.0, train_alone=True)
    fit = plain_fit(c.vehicle, channels(log_of(c.train), c.vehicle), everything)
    limits = hull_limits(c.vehicle, fit.h.terms)
    far = replaced(fit.h, {"mass.surge": 1.5 * limits["mass.surge"][1], "mass.sway": 0.5 * limits["mass.sway"][0]})
    found = improve(fit.problem, fit.states.under(far), 0).h.values
    assert all(limits[i][0] <= found[i] <= limits[i][1] for i in ("mass.surge", "mass.sway"))
    # A claim of the vehicle file is not the fit's to change.
    claimed = replace(fit.problem, fixed={"mass.surge": far.values["mass.surge"]})
    assert improve(claimed, fit.states.under(far), 0).h.values["mass.surge"] == far.values["mass.surge"]


def test_a_drag_that_the_log_does_not_excite_stays_within_reach():
    """A drag astern of 7 million kg/m, in a log that never goes astern, was the start of an oscillating current by name."""
    c = case(7, what="none", kind="twin", duration=70.0, style="rich", rate=5.0, train_alone=True)
    vehicle = parse_vehicle(
        f"{c.vehicle.text}\n[model]\nterms = {[*(t.id for t in PLAIN_TERMS), 'drag.surge.astern', 'drag.lift.yaw']}\n",
        "v.toml",
    )
    fit = plain_fit(vehicle, channels(log_of(c.train), vehicle), everything)
    limits, far = hull_limits(vehicle, fit.h.terms), {"drag.surge.astern": 1e9, "drag.lift.yaw": -1e9}
    found = improve(fit.problem, fit.states.under(replaced(fit.h, far)), 0).h.values
    for id_ in far:
        low, high = limits[id_]
        assert low <= found[id_] <= high
        # Hulls of strangers reached a thousand typical sizes.
        assert high > 5e3 * abs(EFFECTS[id_].parameters[0].scaled(vehicle.hull.mass)), id_
    assert limits["drag.surge.astern"][0] == 0.0 and limits["drag.lift.yaw"][0] == -limits["drag.lift.yaw"][1]


# Nightly: whole diagnoses.
@pytest.mark.nightly
@pytest.mark.parametrize("kind", ["twin", "rov"])
@pytest.mark.parametrize("factor", [0.1, 10.0])
def test_a_log_that_asks_for_what_no_hull_has_is_unknown_and_the_sentence_says_so(kind, factor):
    c = case(7, what="none", kind=kind, duration=300.0, style="rich", rate=10.0)
    vehicle = heavier(c.vehicle, factor)
    result = diagnose(vehicle, log_of(c.train), log_of(c.test, "2.csv"), null_logs=0)
    assert [f.effect for f in result.findings] == ["unknown"]
    assert "no hull of this mass and length has" in result.findings[0].description
    h = result.selection.last.h
    for id_, (low, high) in hull_limits(vehicle, h.terms).items():
        assert low <= h.values[id_] <= high


# Nightly: whole diagnoses.
@pytest.mark.nightly
@pytest.mark.parametrize("factor", [0.8, 1.3])
def test_a_mass_that_is_stated_badly_makes_no_finding(factor):
    c = case(7, what="none", kind="twin", duration=300.0, style="rich", rate=10.0)
    result = diagnose(heavier(c.vehicle, factor), log_of(c.train), log_of(c.test, "2.csv"), null_logs=0)
    assert result.verdict == "adequate"
