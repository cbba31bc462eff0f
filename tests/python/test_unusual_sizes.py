"""Causes that a log would hardly show at their usual size: named where they are no larger than usual sizes are, and where no noise makes so much."""

from types import SimpleNamespace

import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid import diagnose
from ivsid.diagnosis.null.screening import VISIBLE_RULE, Case
from ivsid.vehicle import parse_vehicle


@pytest.mark.parametrize(
    ("usual", "shown", "refused"),
    [
        # z at the usual size, fall of chi-squared, and whether the size is unusual, or the cause faint.
        (8.0, 26.0, False),
        (3.2, 36.0, False),
        (2.8, 36.0, True),
        (7.0, 24.0, True),
        (8.1, 4.0, False),
        # A fall beyond doubt is not asked.
        (0.1, 41.0, False),
    ],
)
def test_a_cause_of_up_to_twice_its_usual_size_is_not_unusual(usual, shown, refused):
    seen = {"friction.coulomb": SimpleNamespace(z=usual)}
    here = SimpleNamespace(seen=seen, blind=lambda _: False)
    s = SimpleNamespace(id="friction.coulomb", shown=shown, candidate=SimpleNamespace(searched=False))
    assert (VISIBLE_RULE.refuses(Case(here, s)) is not None) == refused


# Nightly: two causes of a minute; the rule itself stands above.
@pytest.mark.nightly
def test_a_thrust_curve_that_the_log_hardly_shows_is_named_beside_a_lever_arm():
    """At its usual size the curve would stand out by 3.4 standard deviations; the log holds 1.8 of that, and no thrust error inside its accuracy makes any of it."""
    c = case(263007, what="two")
    vehicle = parse_vehicle(c.text, "v.toml")
    found = diagnose(vehicle, *logs_of_case(c), null_logs=0).findings
    assert [f.effect for f in found] == ["sensor.velocity.lever_arm", "thruster.curve"]
