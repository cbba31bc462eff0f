"""A failure is said of every thruster at which it explains as much."""

import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid import diagnose
from ivsid.vehicle import parse_vehicle


def failed(seed, **asked):
    """The truth, the thrusters' names, and the interval of the thruster that failed."""
    c = case(seed, **asked)
    vehicle = parse_vehicle(c.text, "v.toml")
    found = diagnose(vehicle, *logs_of_case(c), null_logs=0)
    said = next(f for f in found.findings if f.effect == "thruster.failure")
    names = [t.name for t in vehicle.thrusters]
    return names[int(c.truth["thruster.failure.thruster"])], names, said.parameters["thruster.failure.thruster"]


# Nightly: four thrusters and two causes take half a minute; the gate takes the log that turns of two thrusters.
@pytest.mark.nightly
def test_two_thrusters_of_a_straight_course_that_push_alike_are_both_said():
    """On a straight course of four vectored thrusters the named one was the wrong one of two: a pair aft and forward pushes alike."""
    true, names, bound = failed(236041)
    assert true in bound.stands_for.split(" or ") and 1 < len(bound.stands_for.split(" or ")) < len(names)
    assert bound.lower <= names.index(true) <= bound.upper
    # Files of a fleet keep an end to the bit.
    assert type(bound.lower) is type(bound.upper) is float


# Nightly: whole diagnoses of a minute; the gate has failures that are named in test_gradual.py, and one thruster's causes in test_one_thruster.py.
@pytest.mark.parametrize(
    ("kind", "seed", "size"),
    [
        pytest.param("vectored", 8, 0.6, marks=pytest.mark.nightly),
        pytest.param("vectored", 7, 0.5618422883674822, marks=pytest.mark.nightly),
        pytest.param("catamaran", 7, 0.6300096170681011, marks=pytest.mark.nightly),
    ],
)
def test_a_log_that_turns_says_one(kind, seed, size):
    """Losses of a tenth; those of seed 7 stand out by 40."""
    true, _, bound = failed(
        seed, what="one", effect="thruster.failure", kind=kind, style="rich", size=size, duration=200.0, rate=8.0
    )
    assert bound.stands_for == true and bound.lower == bound.upper
