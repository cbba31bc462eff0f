"""Caps and dead bands that errors of the thrust curves have taken the place of, and are looked for on the curves of the file."""

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.boxed import outside
from ivsid.effects import EFFECTS, Given
from ivsid.vehicle import parse_vehicle

CAP, BAND = "thruster.saturation", "thruster.deadband"


def drawn(seed, **given):
    c = case(seed, **given)
    return parse_vehicle(c.text, "v.toml"), *logs_of_case(c), c.truth


def test_a_cap_that_errors_had_taken_the_place_of_is_named():
    """At a quarter of full thrust: errors of twenty times the accuracy had capped the curves, and a cap on those changes nothing."""
    vehicle, train, test, truth = drawn(260745)
    fit = plain_fit(vehicle, channels(train, vehicle), everything)
    assert min(most for _, most in outside(fit)) > 10.0
    (f,) = diagnose(vehicle, train, test, null_logs=0).findings
    assert f.effect == CAP and f.parameters[CAP].lower <= truth[CAP] <= f.parameters[CAP].upper


@pytest.mark.parametrize("cap", [5.0, 15.0])
def test_beside_errors_inside_their_bounds_it_is_looked_for_where_they_are(cap):
    vehicle, train, _, _ = drawn(260745, what="none", duration=90.0)
    s = plain_fit(vehicle, channels(train, vehicle), everything).signatures
    assert s.on_file is s.h
    np.testing.assert_array_equal(s.secant(Given(EFFECTS[CAP], (cap,))), s.whole(Given(EFFECTS[CAP], (cap,))))


def test_a_dead_band_that_errors_had_taken_the_place_of_is_seen():
    """Errors of seven times the accuracy had taken the thrust away below it, and values of the grid beside it showed 3."""
    vehicle, train, _, truth = drawn(175116)
    fit = plain_fit(vehicle, channels(train, vehicle), everything)
    assert fit.signatures.hidden and min(most for _, most in outside(fit)) > 5.0
    (s,) = [s for s in score(fit)[1] if s.id == BAND]
    assert s.values[0] == pytest.approx(truth[BAND], rel=0.005) and s.fall > 2000.0


# Nightly: the log is ten minutes long at 20 Hz.
@pytest.mark.nightly
def test_a_dead_band_that_errors_had_taken_the_place_of_is_named():
    vehicle, train, test, truth = drawn(175116)
    (f,) = diagnose(vehicle, train, test, null_logs=0).findings
    assert f.effect == BAND and f.parameters[BAND].lower <= truth[BAND] <= f.parameters[BAND].upper
