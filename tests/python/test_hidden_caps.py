"""Caps that errors of the thrust curves have taken the place of, and are looked for on the curves of the file."""

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.boxed import outside
from ivsid.effects import EFFECTS, Given
from ivsid.vehicle import parse_vehicle

CAP = "thruster.saturation"


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
